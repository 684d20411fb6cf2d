"""The command line: it asks the library and prints what it says."""

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from enum import IntEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import numpy as np
import typer

import fingerpad
from fingerpad._json import dumps, plain
from fingerpad.exceptions import CalibrationError, FingerpadError, GeometryError
from fingerpad.units import KPA_PER_MPA

if TYPE_CHECKING:
    from fingerpad.image import Scale
    from fingerpad.published import AuditItem
    from fingerpad.study.pipeline import StudyResult

app = typer.Typer(
    name="fingerpad",
    help="Contact mechanics of the human finger pad.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
measure_app = typer.Typer(help="Measure pictures.", no_args_is_help=True)
app.add_typer(measure_app, name="measure")


class Exit(IntEnum):
    """Exit codes."""

    USAGE = 2
    SOME_FAILED = 3


AsJson: TypeAlias = Annotated[bool, typer.Option("--json", help="Print one JSON document instead of text.")]


def _show_version(value: bool) -> None:
    if value:
        typer.echo(f"fingerpad {fingerpad.__version__}")
        raise typer.Exit


@app.callback()
def _main(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Contact mechanics of the human finger pad."""


@contextmanager
def _plain_errors() -> Iterator[None]:
    """Turn the library's errors into lines on stderr and an exit code."""
    try:
        yield
    except FingerpadError as error:
        for line in str(error).splitlines():
            typer.echo(f"fingerpad: {line}", err=True)
        raise typer.Exit(Exit.USAGE) from None


@app.command()
def geometry(
    semi_axes: Annotated[
        tuple[float, float, float], typer.Option(help="Palmar, distal and radial-ulnar semi-axes, mm.")
    ],
    wedge: Annotated[float, typer.Option(help="Wedge angle, degrees: 0 is flat, 90 on the fingertip.")],
    roll: Annotated[float | None, typer.Option(help="Roll about the finger's long axis, degrees.")] = None,
    as_json: AsJson = False,
) -> None:
    """Find where a pad on a wedge touches the platen, and how it is curved there."""
    from fingerpad.geometry import Ellipsoid, Placement

    with _plain_errors():
        placement = Placement.of(
            Ellipsoid.of(*semi_axes), wedge_angle=np.radians(wedge), roll_angle=np.radians(roll or 0.0)
        )
    curvature = placement.curvature
    record = {
        "u_deg": np.degrees(placement.u),
        "v_deg": np.degrees(placement.v),
        "in_plane_radius_mm": curvature.in_plane_radius,
        "transverse_radius_mm": curvature.transverse_radius,
        "mean_curvature_radius_mm": curvature.mean_curvature_radius,
        "geometric_mean_radius_mm": curvature.geometric_mean_radius,
        "mean_curvature_per_mm": curvature.mean_curvature,
        "gaussian_curvature_per_mm2": curvature.gaussian_curvature,
        "point_mm": placement.point,
    }
    if roll is not None:
        record |= {
            "principal_radii_mm": curvature.principal_radii,
            "principal_directions": curvature.principal_directions,
        }
    _print_record(record, as_json)


@app.command()
def hertz(
    radii: Annotated[tuple[float, float], typer.Option(help="Relative principal radii of curvature, mm.")],
    modulus_kpa: Annotated[float, typer.Option(help="Reduced modulus E*, kPa.")],
    load: Annotated[float | None, typer.Option(help="Normal force, N.")] = None,
    indentation_mm: Annotated[float | None, typer.Option(help="Indentation, mm, instead of --load.")] = None,
    as_json: AsJson = False,
) -> None:
    """Solve the elliptical Hertz contact under a load, or at an indentation."""
    from fingerpad.contact import HertzGeometry, indentation_factor, size_factor

    if (load is None) == (indentation_mm is None):
        raise typer.BadParameter("give either --load or --indentation-mm")
    with _plain_errors():
        for flag, value in (
            ("--modulus-kpa", modulus_kpa),
            ("--load", load),
            ("--indentation-mm", indentation_mm),
        ):
            _require_positive(flag, value)
        pair = HertzGeometry.of(*radii)
    modulus = modulus_kpa / KPA_PER_MPA
    if load is not None:
        contact = pair.under_load(load, reduced_modulus=modulus)
    else:
        contact = pair.at_indentation(indentation_mm or 0.0, reduced_modulus=modulus)
    record = {
        "load_N": contact.load,
        "semi_major_mm": contact.semi_major,
        "semi_minor_mm": contact.semi_minor,
        "area_mm2": contact.area,
        "indentation_mm": contact.indentation,
        "peak_pressure_kpa": KPA_PER_MPA * contact.peak_pressure,
        "mean_pressure_kpa": KPA_PER_MPA * contact.mean_pressure,
        "stiffness_N_per_mm": contact.stiffness,
        "F1": size_factor(pair.axis_ratio),
        "F2": indentation_factor(pair.axis_ratio),
        "long_axis_along": {0.0: "first", 1.0: "second"}.get(float(pair.long_axis), "either"),
    }
    _print_record(record, as_json)


@app.command()
def correct(
    ellipse: Annotated[
        tuple[float, float], typer.Option(help="Semi-major and semi-minor axis of the contact, mm.")
    ],
    radius: Annotated[float, typer.Option(help="Radius of curvature of the undeformed pad, mm.")],
    as_json: AsJson = False,
) -> None:
    """Correct a radius of curvature for the observed contact ellipse."""
    from fingerpad import contact
    from fingerpad.geometry import Ellipse

    with _plain_errors():
        observed = Ellipse.of(*ellipse)
        _require_positive("--radius", radius)
    k = observed.axis_ratio
    first, b, d = contact.complete_integrals(k)
    record = {
        "eccentricity": observed.eccentricity,
        "K": first,
        "E": b + k**2 * d,
        "F1": contact.size_factor(k),
        "F2": contact.indentation_factor(k),
        "radius_from_indentation_mm": contact.equivalent_radius_from_indentation(radius, k),
        "radius_from_area_mm": contact.equivalent_radius_from_area(radius, k),
        "radius_from_compliance_mm": contact.equivalent_radius_from_compliance(radius, k),
    }
    _print_record(record, as_json)


@measure_app.command("print")
def measure_print(
    images: Annotated[list[Path], typer.Argument(help="Contact images.", show_default=False)],
    ppi: Annotated[float | None, typer.Option(help="Scale, pixels per inch.")] = None,
    mm_per_px: Annotated[float | None, typer.Option(help="Scale, millimetres per pixel.")] = None,
    overlay: Annotated[Path | None, typer.Option(help="Folder for pictures of the measurement.")] = None,
    as_json: AsJson = False,
) -> None:
    """Measure the contact region and its ellipse in fingerprint images."""
    from fingerpad.image import Scale

    with _plain_errors():
        if (ppi is None) == (mm_per_px is None):
            raise CalibrationError("the pictures need a scale: give either --ppi or --mm-per-px")
        scale = Scale.of_ppi(ppi) if ppi is not None else Scale.of_mm_per_px(mm_per_px or 0.0)
        if overlay is not None:
            _make_folder(overlay)
    records = [_measured_print(path, scale, overlay) for path in images]
    if as_json:
        _print_json(records)
    else:
        for record in records:
            _print_text(record)
            typer.echo()
    if any("error" in record for record in records):
        raise typer.Exit(Exit.SOME_FAILED)


def _measured_print(path: Path, scale: "Scale", overlay: Path | None) -> dict[str, Any]:
    from fingerpad.image import measure_imprint, read_image, write_overlay

    try:
        pixels = read_image(path).pixels
        imprint = measure_imprint(pixels, scale)
        if overlay is not None:
            write_overlay(overlay / f"{path.stem}.png", pixels, imprint)
    except FingerpadError as error:
        return {"file": str(path), "error": str(error)}
    return {
        "file": str(path),
        "semi_major_mm": imprint.ellipse.semi_major,
        "semi_major_mm_std": imprint.semi_major_std,
        "semi_minor_mm": imprint.ellipse.semi_minor,
        "semi_minor_mm_std": imprint.semi_minor_std,
        "orientation_deg": np.degrees(imprint.orientation),
        "gross_area_mm2": imprint.gross_area,
        "gross_area_mm2_std": imprint.gross_area_std,
        "ridge_area_mm2": imprint.ridge_area,
        "ridge_area_mm2_std": imprint.ridge_area_std,
        "ridge_period_mm": imprint.ridge_period,
        "ellipse_overlap": imprint.overlap,
        "centroid_px": imprint.centroid,
        "flags": imprint.flags,
    }


@app.command()
def reproduce(
    figures: Annotated[
        Path | None, typer.Option(help="Folder for the source's Figs 1, 4, 5 and 6, as SVG and PNG.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Compute every number printed in the source, and say which are reproduced."""
    from fingerpad.published import audit

    items = audit()
    if figures is not None:
        from fingerpad.figures import save_figure, source_figures

        with _plain_errors():
            _make_folder(figures)
        for name, figure, caption in source_figures():
            save_figure(figure, figures / name, description=caption)
    if as_json:
        _print_json([item.as_record() for item in items])
    else:
        _print_audit(items)


@app.command()
def init(
    folder: Annotated[Path, typer.Argument(help="Folder to make, or an empty one.", show_default=False)],
) -> None:
    """Write a commented study manifest to start from."""
    from fingerpad.study.template import write_template

    with _plain_errors():
        manifest = write_template(folder)
    typer.echo(f"Wrote {manifest}. Put your pictures beside it, fill it in, then: fingerpad run {manifest}")


@app.command()
def run(
    study: Annotated[Path, typer.Argument(help="The study's manifest.", show_default=False)],
    out: Annotated[Path, typer.Option(help="Folder for tables, figures and report.")] = Path("results"),
    workers: Annotated[int, typer.Option(min=1, help="Number of processes that measure.")] = 1,
) -> None:
    """Run a study: measure, model, pool, and write tables, figures and a report."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    from fingerpad.report import write_report
    from fingerpad.study.output import write_tables
    from fingerpad.study.pipeline import run_study

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with _plain_errors():
        _make_folder(out)
        with Progress(*columns, console=Console(stderr=True)) as progress:
            task = progress.add_task("Measuring", total=None)
            result = run_study(
                study,
                out,
                workers=workers,
                on_start=lambda total: progress.update(task, total=total),
                on_measured=lambda done: progress.update(
                    task, advance=1, description=f"Measured {done.observation}"
                ),
            )
            progress.update(task, description="Writing tables and report")
            write_tables(result, out)
            report = write_report(result, out)
    _print_outcome(result, report)
    if result.failures:
        raise typer.Exit(Exit.SOME_FAILED)


def _print_outcome(result: "StudyResult", report: Path) -> None:
    from fingerpad.report.text import value_with_uncertainty

    for summary in result.summaries:
        pooled = summary.corrected_radius
        label = "  (synthetic)" if summary.synthetic else ""
        typer.echo(
            f"{summary.finger}, wedge {summary.wedge_angle_deg:g}°: corrected radius "
            f"{value_with_uncertainty(pooled.value, pooled.total_std)} mm from {pooled.count} "
            f"observation{'s' if pooled.count != 1 else ''}{label}"
        )
    for failure in result.failures:
        typer.echo(f"failed: {failure}", err=True)
    typer.echo(f"Report: {report}")


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FingerpadError(
            f"{folder}: cannot make this folder ({error.strerror}); choose another"
        ) from error


def _require_positive(flag: str, value: float | None) -> None:
    if value is not None and not (value > 0 and math.isfinite(value)):
        raise GeometryError(f"{flag} must be positive and finite, found {value:g}")


def _print_json(value: Any) -> None:
    typer.echo(dumps(value))


def _print_record(record: Mapping[str, Any], as_json: bool) -> None:
    if as_json:
        _print_json(record)
    else:
        _print_text(record)


def _print_text(record: Mapping[str, Any]) -> None:
    width = max(map(len, record))
    for key, value in plain(record).items():
        typer.echo(f"{key:<{width}}  {_text(value)}")


def _text(value: Any) -> str:
    if isinstance(value, list):
        return ", ".join(map(_text, value)) or "none"
    if value is None:
        return "not known"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _print_audit(items: "list[AuditItem]") -> None:
    width = max(len(item.item) for item in items)
    typer.echo(f"{'item':<{width}}  {'printed':>7}  {'computed':>8}  unit  verdict")
    for item in items:
        computed = "–" if item.computed is None else f"{item.computed:.2f}"
        verdict = f"{item.verdict} (measured)" if item.computed is None else item.verdict
        typer.echo(f"{item.item:<{width}}  {item.printed:>7.1f}  {computed:>8}  {item.unit:<4}  {verdict}")
