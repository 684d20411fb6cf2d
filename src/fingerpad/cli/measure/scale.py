"""The flags that give a picture its scale, the same for every command that measures."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, TypeAlias

import typer

from fingerpad.cli.measure.flags import numbers_of
from fingerpad.exceptions import CalibrationError
from fingerpad.flags import flags_in

if TYPE_CHECKING:
    from fingerpad.image import Scale

WAYS = "either --ppi, --mm-per-px, --scale-line, --scale-circle, --coin or --grid"

# Each way to give a scale, with its flags by the keys of the same scale in a manifest.
_WAYS: Final[Mapping[str, Mapping[str, str]]] = {
    "--ppi": {"ppi": "--ppi", "relative_std": "--scale-relative-std"},
    "--mm-per-px": {"mm_per_px": "--mm-per-px", "relative_std": "--scale-relative-std"},
    "--scale-line": {
        "line": "--scale-line",
        "length_mm": "--line-mm",
        "length_mm_std": "--line-mm-std",
        "ends_px_std": "--line-px-std",
    },
    "--scale-circle": {
        "circle": "--scale-circle",
        "diameter_mm": "--circle-mm",
        "diameter_mm_std": "--circle-mm-std",
        "points_px_std": "--circle-px-std",
    },
    "--coin": {"coin": "--coin", "diameter_mm": "--coin-mm", "diameter_mm_std": "--coin-mm-std"},
    "--grid": {
        "grid": "--grid",
        "points": "--grid-points",
        "spacing_mm": "--grid-spacing-mm",
        "spacing_mm_std": "--grid-spacing-mm-std",
        "pattern": "--grid-pattern",
    },
}

_Std: TypeAlias = Annotated[float | None, typer.Option(help="Its standard uncertainty.")]
_PointStd: TypeAlias = Annotated[float | None, typer.Option(help="Standard uncertainty of each point, px.")]


def scale_of_flags(
    *,
    ppi: Annotated[float | None, typer.Option(help="Scale, pixels per inch.")] = None,
    mm_per_px: Annotated[float | None, typer.Option(help="Scale, millimetres per pixel.")] = None,
    scale_relative_std: Annotated[
        float | None,
        typer.Option(help="Relative standard uncertainty of --ppi or --mm-per-px."),
    ] = None,
    scale_line: Annotated[
        str | None,
        typer.Option(metavar="R0,C0,R1,C1", help="Scale from a line of known length: its two ends, px."),
    ] = None,
    line_mm: Annotated[float | None, typer.Option(help="Length of that line.")] = None,
    line_mm_std: _Std = None,
    line_px_std: _PointStd = None,
    scale_circle: Annotated[
        str | None,
        typer.Option(
            metavar="R0,C0,R1,C1,R2,C2",
            help="Scale from a circle of known diameter: three points on its rim, px.",
        ),
    ] = None,
    circle_mm: Annotated[float | None, typer.Option(help="Diameter of that circle.")] = None,
    circle_mm_std: _Std = None,
    circle_px_std: _PointStd = None,
    coin: Annotated[
        Path | None, typer.Option(help="Scale from a coin: a picture of it, taken like those to measure.")
    ] = None,
    coin_mm: Annotated[float | None, typer.Option(help="Diameter of that coin.")] = None,
    coin_mm_std: _Std = None,
    grid: Annotated[
        Path | None, typer.Option(help="Scale from a checkerboard or a grid of dots: a picture of it.")
    ] = None,
    grid_points: Annotated[
        str | None,
        typer.Option(metavar="DOWN,ACROSS", help="Number of its inner corners, or of its dots."),
    ] = None,
    grid_spacing_mm: Annotated[float | None, typer.Option(help="Distance of neighbouring points.")] = None,
    grid_spacing_mm_std: _Std = None,
    grid_pattern: Annotated[
        str | None, typer.Option(help="What it consists of: checkerboard (default) or dots.")
    ] = None,
) -> "Scale | None":
    """Return the scale that the flags give, None for none."""
    given = {f"--{name.replace('_', '-')}": value for name, value in locals().items() if value is not None}
    ways = [way for way in _WAYS if way in given]
    if len(ways) > 1:
        raise CalibrationError(f"give {WAYS}, found {' and '.join(ways)}")
    for flag in given:
        belongs = [way for way, flags in _WAYS.items() if flag in flags.values()]
        if not set(ways) & set(belongs):
            found = f"beside {ways[0]}" if ways else "alone"
            raise CalibrationError(f"{flag} belongs to {' or '.join(belongs)}, found it {found}")
    return _measured(ways[0], given) if ways else None


def _measured(way: str, given: Mapping[str, Any]) -> "Scale":
    """Return the scale that a way means, checked and measured as that of a manifest."""
    from pydantic import TypeAdapter

    from fingerpad.study.manifest.messages import checked
    from fingerpad.study.manifest.models import OwnScale
    from fingerpad.study.measuring.scales import measure_scale

    flags = {key: flag for key, flag in _WAYS[way].items() if flag in given}
    content = {key: _content(flag, given[flag]) for key, flag in flags.items()}
    table, faults = checked(TypeAdapter(OwnScale), content, strict=True)
    if faults:
        place, words = faults[0]
        flag = _WAYS[way].get(place.partition("[")[0], way)
        missing = flag not in given
        raise CalibrationError(f"{way} needs {flag}: give it too" if missing else f"{flag}: {words}")
    try:
        found = measure_scale(table, Path())
    except CalibrationError as error:
        raise CalibrationError(f"{', '.join(flags.values())}: {error}") from error
    for one in flags_in(found.flags, "scale"):
        typer.echo(f"note: {given[way]}: {one.words}. To do: {one.to_do}.", err=True)
    return found.scale


def _content(flag: str, value: Any) -> Any:
    """Return the value of a flag as a manifest says it."""
    if isinstance(value, Path):
        return str(value)
    if count := {"--scale-line": 4, "--scale-circle": 6}.get(flag):
        numbers = numbers_of(flag, value, count)
        return [[*pair] for pair in zip(numbers[::2], numbers[1::2], strict=True)]
    if flag == "--grid-points":
        return [int(one) if one.is_integer() else one for one in numbers_of(flag, value, 2)]
    return value
