"""Import measurements from other programs."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer
from typer import Argument, Option

import fingerpad as fp
from fingerpad._words import counted
from fingerpad.cli import options, show
from fingerpad.cli.commands import Group
from fingerpad.cli.scale import WAYS, scale_of_flags
from fingerpad.exceptions import CalibrationError, ManifestError

if TYPE_CHECKING:
    from fingerpad.study.imports.ellipses import ManualObservation, MeasuredEllipse

app = typer.Typer(
    cls=Group, rich_markup_mode=None, help="Import measurements from other programs.", no_args_is_help=True
)

_MM_PER_UNIT: Final = {"mm": 1.0, "um": 1e-3, "µm": 1e-3, "cm": 10.0, "inch": 25.4}
_SHOWN = 5


def rows_of(
    *,
    std_mm: Annotated[
        float, Option(min=1e-9, help="Standard uncertainty of either semi-axis, mm.", show_default=False)
    ],
    finger: Annotated[str | None, Option(help="Finger name for all rows.")] = None,
    wedge_deg: Annotated[
        float | None, Option(min=0, max=90, help="Wedge angle for all rows, degrees.")
    ] = None,
    roll_deg: Annotated[
        float | None, Option(min=-90, max=90, help="Roll angle for all rows, degrees.")
    ] = None,
    load_n: Annotated[float | None, Option(min=1e-6, help="Load for all rows, N.")] = None,
    label_pattern: Annotated[
        str | None, Option(help='Pattern of labels, as in "{finger}_{wedge}deg_{load}N".')
    ] = None,
    finger_axis_deg: Annotated[
        float, Option(help="The finger's direction in the pictures, from straight up, counter-clockwise.")
    ] = 0.0,
    synthetic: Annotated[bool, Option("--synthetic", help="The pictures were rendered.")] = False,
) -> "Callable[..., list[ManualObservation]]":
    """Return what makes observations of ellipses, whatever program measured them."""
    from fingerpad.study.imports.ellipses import manual_observations

    given = {"finger": finger, "wedge_angle_deg": wedge_deg, "roll_angle_deg": roll_deg, "load_N": load_n}
    return partial(
        manual_observations,
        semi_axis_mm_std=std_mm,
        known={name: value for name, value in given.items() if value is not None},
        pattern=label_pattern,
        finger_axis_deg=finger_axis_deg,
        synthetic=synthetic,
    )


@app.command("fiji")
@options.takes(rows=rows_of, scale=scale_of_flags)
def import_fiji(
    files: Annotated[
        list[Path],
        Argument(
            metavar="FILE...", help="Results.csv, .txt or .xls; .roi or RoiSet.zip.", show_default=False
        ),
    ],
    *,
    unit: Annotated[
        str | None, Option(help="Unit of a table whose pictures had a scale in Fiji: mm, um, cm or inch.")
    ] = None,
    rows: "Callable[..., list[ManualObservation]]",
    out: Annotated[Path, Option(help="Output CSV (must not exist).")] = Path("observations.csv"),
    as_json: options.AsJson = False,
    scale: "fp.Scale | None" = None,
) -> None:
    """Turn ellipses measured manually in Fiji or ImageJ into observations of a study.

    A table gives Major and Minor of "Fit ellipse"; ROIs are ovals, ellipses, or traced outlines. What
    neither flags nor labels give is left empty, to be filled in.
    """
    from fingerpad.study.imports.ellipses import write_observations
    from fingerpad.study.imports.fiji import UNIT_HINT

    mm_per_unit = _mm_per_unit(files, unit, scale)
    ellipses = _read(files)
    relative_std = scale.relative_std if scale else 0.0
    found = rows(ellipses, mm_per_unit=mm_per_unit, relative_scale_std=relative_std, unit_hint=UNIT_HINT)
    write_observations(out, found)
    for ellipse in ellipses:
        for doubt in ellipse.doubts:
            typer.echo(f"doubtful: {ellipse.source}: {doubt}", err=True)
    show.result([row.model_dump() for row in found], as_json, lambda _: _print_outcome(out, found))


def _mm_per_unit(files: list[Path], unit: str | None, scale: "fp.Scale | None") -> float:
    from fingerpad.study.imports.fiji import is_roi_file

    rois = [path for path in files if is_roi_file(path)]
    if unit is not None and (scale is not None or rois):
        found = "a scale beside it" if scale else f"{rois[0]}, which is in px"
        raise CalibrationError(f"--unit is for tables whose pictures had a scale in Fiji; found {found}")
    if scale is not None:
        return scale.mm_per_px
    if unit is None:
        raise CalibrationError(
            f"Fiji's files name no unit: for lengths in px give {WAYS}"
            + ("" if rois else "; for a table whose pictures had a scale, --unit mm")
        )
    if unit not in _MM_PER_UNIT:
        raise CalibrationError(f"--unit takes {', '.join(_MM_PER_UNIT)}, found {unit!r}")
    return _MM_PER_UNIT[unit]


def _read(files: list[Path]) -> list["MeasuredEllipse"]:
    from fingerpad.study.imports.fiji import is_roi_file, read_results_table, read_rois

    places = [path.resolve() for path in files]
    for path, place in zip(files, places, strict=True):
        if places.count(place) > 1:
            raise ManifestError(f"{path}: is named twice, and would count each contact twice; name it once")
    return [
        found for path in files for found in (read_rois if is_roi_file(path) else read_results_table)(path)
    ]


def _print_outcome(out: Path, rows: list["ManualObservation"]) -> None:
    typer.echo(f"Wrote {out}: {counted(len(rows), 'contact')} measured manually.")
    lacking = [row for row in rows if row.missing]
    if lacking:
        columns = dict.fromkeys(name for row in lacking for name in row.missing)
        names = ", ".join(row.name for row in lacking[:_SHOWN]) + (", …" if len(lacking) > _SHOWN else "")
        typer.echo(f"Fill in {', '.join(columns)} for {len(lacking)} of them: {names}")
    if any(row.long_axis is None for row in rows):
        typer.echo("No angle, or circles: long_axis is left empty, and need not be filled in.")
    typer.echo(f'Then name it in the study, above the first table: observations_csv = "{out.name}"')
