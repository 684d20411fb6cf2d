"""Fit one loading curve."""

from collections.abc import Callable, Mapping
from inspect import Parameter, Signature
from pathlib import Path
from typing import Annotated, Any

from typer import Argument, Option, echo

import fingerpad as fp
from fingerpad._plausible import unit_doubts
from fingerpad.cli import options, show
from fingerpad.exceptions import FitError, LoadingError


def estimate_of(
    flag: str, words: str, unit: str = "", *, read: Callable[[str], float] | None = None, **limits: Any
) -> Callable[..., "fp.Estimate | None"]:
    """Return a function of a flag and its standard uncertainty, for `takes`, which returns the two as one.

    Text is read by a function where it is not a finite number.
    """
    name = flag[2:].replace("-", "_")

    def make(**given: Any) -> "fp.Estimate | None":
        value, std = given[name], given[f"{name}_std"]
        if not std >= 0 or (std and value is None):
            raise LoadingError(f"{flag}-std must not be negative, and goes with {flag}")
        if value is None:
            return None
        return fp.Estimate.symmetric(value if read is None else read(value), std)

    kind = str if read else float
    own = Annotated[kind | None, Option(help=words, **limits)]  # type: ignore[valid-type]
    std = Annotated[float, Option(min=0, help=f"Its standard uncertainty{unit and ', '}{unit}.")]
    parameters = ((name, None, own), (f"{name}_std", 0.0, std))
    make.__signature__ = Signature(  # type: ignore[attr-defined]
        [Parameter(each, Parameter.KEYWORD_ONLY, default=of, annotation=to) for each, of, to in parameters]
    )
    return make


def _thickness(text: str) -> float:
    """Return a thickness; as text, since numbers on the command line are finite."""
    try:
        return options.noted_thickness(float(text))
    except ValueError:
        raise LoadingError(f"--thickness-mm takes a thickness in mm or inf, found {text!r}") from None


@options.takes(
    loading_radius=estimate_of(
        "--loading-radius-mm", "Loading radius R_g, mm, where the curve has no area.", "mm", min=1e-6, max=1e6
    ),
    stage_compliance=estimate_of(
        "--stage-compliance-mm-per-n", "By how much the stage yields under load, mm/N.", "mm/N", min=0
    ),
    area_delay=estimate_of("--area-delay-s", "By how much the areas are late, s.", "s"),
    thickness=estimate_of(
        "--thickness-mm",
        "Thickness of the layer that is pressed, mm; inf for a half-space, which has none.",
        "mm",
        read=_thickness,
        metavar="MM",
    ),
    constraint=estimate_of(
        "--constraint",
        "Factor by which bone stiffens the pad; uncertain. Moduli are divided by it.",
        min=1e-6,
    ),
)
def fit(
    curve: Annotated[
        Path, Argument(help="CSV, XLSX, MAT or TDMS file with force and displacement.", show_default=False)
    ],
    *,
    column: options.Columns = None,
    poisson_ratio: Annotated[float, Option(min=-0.99, max=0.5, help="Poisson's ratio of the pad.")] = 0.5,
    loading_radius: "fp.Estimate | None",
    cycle: Annotated[int, Option(min=0, help="Which press of the record, from 0.")] = 0,
    contact_point: Annotated[
        str, Option(help="joint, or hold it by contact_by_threshold, two_lines, gradient or power_law.")
    ] = "joint",
    load_range_n: Annotated[
        tuple[float, float] | None, Option(help="Loads, N, between which the modulus grows.")
    ] = None,
    stage_compliance: "fp.Estimate | None",
    area_delay: "fp.Estimate | None",
    thickness: "fp.Estimate | None",
    semi_axes_mm: Annotated[
        tuple[float, float, float] | None,
        Option(help="Palmar, distal and radial-ulnar semi-axes, mm: the thickness over bone is fitted, too."),
    ] = None,
    wedge_deg: options.WedgeAngle = 0.0,
    pad_radius_mm_std: Annotated[
        float, Option(min=0, help="Standard uncertainty of the pad's radius 1/H, mm.")
    ] = 0.0,
    poisson_ratio_std: Annotated[
        float, Option(min=0, max=0.5, help="Standard uncertainty of Poisson's ratio.")
    ] = 0.0,
    load_relative_std: Annotated[
        float, Option(min=0, max=1, help="Relative, of all forces alike, as of the sensor's gain.")
    ] = 0.0,
    area_relative_std: Annotated[
        float | None,
        Option(
            min=0,
            max=1,
            help="Relative, of all areas alike, as of their scale; 0.02 for the layer if not given.",
        ),
    ] = None,
    constraint: "fp.Estimate | None",
    law: Annotated[
        str | None,
        Option(
            metavar="NAME|FILE.py:NAME|MODULE:NAME",
            help="A contact law to fit as well and compare: jkr, where there is a pull-off, or your own.",
        ),
    ] = None,
    plot: Annotated[Path | None, Option(help="Folder for the figures, as SVG and JSON.")] = None,
    as_json: options.AsJson = False,
) -> None:
    """Fit radius, moduli, place of contact and exponents to a loading curve.

    The header names quantities with units: time_s, force_N, displacement_mm, area_mm2; time and area are
    optional. Each number comes with its standard uncertainty and 95 % interval, or the reason why the
    curve does not determine it. With --semi-axes-mm the curve is also fitted by the whole pad on a layer of
    tissue over bone, and compared with a half-space.
    """
    from fingerpad._columns import columns_named_by
    from fingerpad.loading import fit_adhesion, fit_layer_thickness
    from fingerpad.loading.curve import unread_curve_columns
    from fingerpad.loading.law_registry import find_law

    if semi_axes_mm is not None and thickness is not None:
        raise LoadingError("--semi-axes-mm fits the thickness that --thickness-mm states; give one of them")
    if (wedge_deg or pad_radius_mm_std) and semi_axes_mm is None:
        raise LoadingError("--wedge-deg and --pad-radius-mm-std go with --semi-axes-mm")
    columns = options.columns_of(column, "time", "force", "displacement", "area")
    with columns_named_by(options.column_flags):
        record = fp.read_loading_curve(curve, columns)
    for doubt in unit_doubts(record.load, record.indentation, record.area):
        show.note(doubt)
    options.note_unread(unread_curve_columns(curve, columns))
    given: dict[str, Any] = {"cycle": cycle, "stage_compliance": stage_compliance, "area_delay": area_delay}
    given |= {} if area_relative_std is None else {"area_relative_std": area_relative_std}
    of_half_space = {**given, "poisson_ratio": poisson_ratio, "loading_radius": loading_radius}
    asked: dict[str, Any] = {
        "contact_point": contact_point,
        "fit_load_range": load_range_n,
        "thickness": thickness,
        "load_relative_std": load_relative_std,
        "poisson_ratio_std": poisson_ratio_std,
    }
    try:
        found = fp.fit_loading_curve(record, law=law, **of_half_space, **asked)
    except FitError as error:
        # An adhesive law does not need the way in.
        if thickness is not None or law is None or find_law(law).pull_off is None:
            raise
        alone = fit_adhesion(record, law=law, **of_half_space)
        wanted = {"--constraint": constraint, "--semi-axes-mm": semi_axes_mm, "--plot": plot}
        idle = " and ".join(flag for flag, value in wanted.items() if value is not None)
        without = f", without {idle}, for which the way in is needed" if idle else ""
        show.note(f"the way in is not fitted, the way out alone is{without}: {error}")
        _show(alone.summary(), {"file": str(curve), "law": alone.as_record()}, as_json=as_json)
        return
    if constraint is not None:
        found = found.divide_by_constraint(constraint)
    lines: list[str] = []
    shown = {"file": str(curve), **found.as_record()}
    if semi_axes_mm is not None:
        layer = fit_layer_thickness(
            record,
            placement=options.placement_of(semi_axes_mm=semi_axes_mm, wedge_deg=wedge_deg),
            radius_std=pad_radius_mm_std,
            poisson_ratio=poisson_ratio,
            poisson_ratio_std=poisson_ratio_std,
            load_relative_std=load_relative_std,
            **given,
        )
        lines += [layer.summary(), ""]
        shown["layer"] = layer.as_record()
    if plot is not None:
        from fingerpad._files import make_folder
        from fingerpad.report.loading import loading_plots
        from fingerpad.report.plot import save_plots

        make_folder(plot)
        save_plots(loading_plots(curve.stem, record, found, cycle=cycle), plot)
    _show("\n".join([*lines, found.summary()]), shown, as_json=as_json)
    show.folder("Figures", plot, as_json)


def _show(text: str, record: Mapping[str, Any], *, as_json: bool) -> None:
    show.result(record, as_json, lambda _: echo(text.replace("or loading_radius", "or --loading-radius-mm")))
