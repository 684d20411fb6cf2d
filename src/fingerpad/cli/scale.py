"""The flags that give a picture its scale, the same for every command that measures."""

from collections.abc import Mapping
from inspect import Parameter, Signature
from pathlib import Path
from typing import Annotated, Any, Final

import typer
from typer import Option

import fingerpad as fp
from fingerpad.exceptions import CalibrationError, ImageError
from fingerpad.flags import flags_in

# No picture has so many rows or columns; NaN is not below it.
_MOST_PX: Final = 1e9

WAYS: Final = "either --ppi, --mm-per-px, --scale-line, --scale-circle, --coin or --grid"
_STD, _POINT_STD = "Its standard uncertainty.", "Standard uncertainty of each point, px."

# Each flag: its key in a scale of a manifest, its type or the numbers that its text consists of, what it is.
_FLAGS: Final[Mapping[str, tuple[str, type | str, str]]] = {
    "--ppi": ("ppi", float, "Scale, pixels per inch."),
    "--mm-per-px": ("mm_per_px", float, "Scale, millimetres per pixel."),
    "--scale-relative-std": ("relative_std", float, "Relative standard uncertainty of --ppi or --mm-per-px."),
    "--scale-line": ("line", "R0,C0,R1,C1", "Scale from a line of known length: its two ends, px."),
    "--line-mm": ("length_mm", float, "Length of that line."),
    "--line-mm-std": ("length_mm_std", float, _STD),
    "--line-px-std": ("ends_px_std", float, _POINT_STD),
    "--scale-circle": (
        "circle",
        "R0,C0,R1,C1,R2,C2",
        "Scale from a circle of known diameter: three points on its rim, px.",
    ),
    "--circle-mm": ("diameter_mm", float, "Diameter of that circle."),
    "--circle-mm-std": ("diameter_mm_std", float, _STD),
    "--circle-px-std": ("points_px_std", float, _POINT_STD),
    "--coin": ("coin", Path, "Scale from a coin: a picture of it, taken like those to measure."),
    "--coin-mm": ("diameter_mm", float, "Diameter of that coin."),
    "--coin-mm-std": ("diameter_mm_std", float, _STD),
    "--grid": ("grid", Path, "Scale from a checkerboard or a grid of dots: a picture of it."),
    "--grid-points": ("points", "DOWN,ACROSS", "Number of its inner corners, or of its dots."),
    "--grid-spacing-mm": ("spacing_mm", float, "Distance of neighbouring points."),
    "--grid-spacing-mm-std": ("spacing_mm_std", float, _STD),
    "--grid-pattern": ("pattern", str, "What it consists of: checkerboard (default) or dots."),
}
# Each way to give a scale, and how the names of the flags that go with it begin.
_WAYS: Final = {
    "--ppi": "--scale-relative",
    "--mm-per-px": "--scale-relative",
    "--scale-line": "--line-",
    "--scale-circle": "--circle-",
    "--coin": "--coin-",
    "--grid": "--grid-",
}


def numbers_of(flag: str, text: str, count: int) -> list[float]:
    """Return the numbers of a flag such as "250,200"."""
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) != count or not all(abs(number) < _MOST_PX for number in numbers):
        raise ImageError(f"{flag} takes {count} numbers of pixels separated by commas, found {text!r}")
    return numbers


def scale_of_flags(**values: Any) -> "fp.Scale | None":
    """Return the scale that the flags give, None for none."""
    given = {flag: value for flag, value in zip(_FLAGS, values.values(), strict=True) if value is not None}
    ways = [way for way in _WAYS if way in given]
    if len(ways) > 1:
        raise CalibrationError(f"give {WAYS}, found {' and '.join(ways)}")
    for flag in given:
        belongs = [way for way in _WAYS if flag in _flags_of(way)]
        if not set(ways) & set(belongs):
            found = f"beside {ways[0]}" if ways else "alone"
            raise CalibrationError(f"{flag} belongs to {' or '.join(belongs)}, found it {found}")
    return _measured(ways[0], given) if ways else None


def _parameter(flag: str, takes: type | str, words: str) -> Parameter:
    kind, metavar = (str, takes) if isinstance(takes, str) else (takes, None)
    annotation = Annotated[kind | None, Option(help=words, metavar=metavar)]  # type: ignore[valid-type]
    return Parameter(flag[2:].replace("-", "_"), Parameter.KEYWORD_ONLY, default=None, annotation=annotation)


scale_of_flags.__signature__ = Signature(  # type: ignore[attr-defined]
    [_parameter(flag, takes, words) for flag, (_, takes, words) in _FLAGS.items()]
)


def _flags_of(way: str) -> list[str]:
    return [flag for flag in _FLAGS if flag == way or flag.startswith(_WAYS[way])]


def _measured(way: str, given: Mapping[str, Any]) -> "fp.Scale":
    """Return the scale that a way means, checked and measured as that of a manifest."""
    from pydantic import TypeAdapter

    from fingerpad.study.manifest.models import OwnScale, checked
    from fingerpad.study.measuring.context import measure_scale

    keys = {_FLAGS[flag][0]: flag for flag in _flags_of(way)}
    content = {key: _content(flag, given[flag]) for key, flag in keys.items() if flag in given}
    table, faults = checked(TypeAdapter(OwnScale), content, strict=True)
    if faults:
        place, words = faults[0]
        flag = keys.get(place.partition("[")[0], way)
        missing = flag not in given
        raise CalibrationError(f"{way} needs {flag}: give it too" if missing else f"{flag}: {words}")
    try:
        found = measure_scale(table, Path())
    except CalibrationError as error:
        raise CalibrationError(f"{', '.join(keys[key] for key in content)}: {error}") from error
    for one in flags_in(found.flags, "scale"):
        typer.echo(f"note: {given[way]}: {one.words}. To do: {one.to_do}.", err=True)
    return found.scale


def _content(flag: str, value: Any) -> Any:
    """Return the value of a flag as a manifest says it."""
    takes = _FLAGS[flag][1]
    if not isinstance(takes, str):
        return str(value) if takes is Path else value
    numbers = numbers_of(flag, value, takes.count(",") + 1)
    if flag == "--grid-points":
        return [int(one) if one.is_integer() else one for one in numbers]
    return [[*pair] for pair in zip(numbers[::2], numbers[1::2], strict=True)]
