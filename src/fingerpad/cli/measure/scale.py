"""The flags that give a picture its scale, the same for every command that measures."""

from collections.abc import Callable, Mapping
from functools import wraps
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, TypeAlias

import typer

from fingerpad.cli.measure.flags import numbers_of
from fingerpad.exceptions import CalibrationError
from fingerpad.flags import flags_in

if TYPE_CHECKING:
    from fingerpad.image import Scale

WAYS = "either --ppi, --mm-per-px, --scale-line, --scale-circle, --coin or --grid"

_Std: TypeAlias = Annotated[float | None, typer.Option(min=0, help="Its standard uncertainty.")]
_PointStd: TypeAlias = Annotated[
    float | None, typer.Option(min=0, help="Standard uncertainty of each point, px.")
]


def takes_scale(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command the flags of `scale_of_flags`, and pass the result as `scale`, None for none."""
    flags = signature(scale_of_flags).parameters
    own = signature(command)

    @wraps(command)
    def with_scale(**given: Any) -> None:
        scale = scale_of_flags(**{name: given.pop(name) for name in flags})
        command(**given, scale=scale)

    kept = [parameter for name, parameter in own.parameters.items() if name != "scale"]
    parameters = [*kept, *flags.values()]
    with_scale.__signature__ = own.replace(parameters=parameters)  # type: ignore[attr-defined]
    with_scale.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    return with_scale


def scale_of_flags(
    *,
    ppi: Annotated[float | None, typer.Option(min=0.254, max=2.54e6, help="Scale, pixels per inch.")] = None,
    mm_per_px: Annotated[
        float | None, typer.Option(min=1e-5, max=100, help="Scale, millimetres per pixel.")
    ] = None,
    scale_relative_std: Annotated[
        float | None,
        typer.Option(min=0, max=1, help="Relative standard uncertainty of --ppi or --mm-per-px."),
    ] = None,
    scale_line: Annotated[
        str | None,
        typer.Option(metavar="R0,C0,R1,C1", help="Scale from a line of known length: its two ends, px."),
    ] = None,
    line_mm: Annotated[float | None, typer.Option(min=1e-6, help="Length of that line.")] = None,
    line_mm_std: _Std = None,
    line_px_std: _PointStd = None,
    scale_circle: Annotated[
        str | None,
        typer.Option(
            metavar="R0,C0,R1,C1,R2,C2",
            help="Scale from a circle of known diameter: three points on its rim, px.",
        ),
    ] = None,
    circle_mm: Annotated[float | None, typer.Option(min=1e-6, help="Diameter of that circle.")] = None,
    circle_mm_std: _Std = None,
    circle_px_std: _PointStd = None,
    coin: Annotated[
        Path | None, typer.Option(help="Scale from a coin: a picture of it, taken like those to measure.")
    ] = None,
    coin_mm: Annotated[float | None, typer.Option(min=1e-6, help="Diameter of that coin.")] = None,
    coin_mm_std: _Std = None,
    grid: Annotated[
        Path | None, typer.Option(help="Scale from a checkerboard or a grid of dots: a picture of it.")
    ] = None,
    grid_points: Annotated[
        str | None,
        typer.Option(metavar="DOWN,ACROSS", help="Number of its inner corners, or of its dots."),
    ] = None,
    grid_spacing_mm: Annotated[
        float | None, typer.Option(min=1e-6, help="Distance of neighbouring points.")
    ] = None,
    grid_spacing_mm_std: _Std = None,
    grid_pattern: Annotated[
        str | None, typer.Option(help="What it consists of: checkerboard (default) or dots.")
    ] = None,
) -> "Scale | None":
    """Return the scale that the flags give, None for none."""
    given = {name: value for name, value in locals().items() if value is not None}
    ways = [flag for flag in _WAYS if _name(flag) in given]
    if len(ways) > 1:
        raise CalibrationError(f"give {WAYS}, found {' and '.join(ways)}")
    way = ways[0] if ways else None
    _refuse_idle(way, given)
    return None if way is None else _WAYS[way](given)


def _name(flag: str) -> str:
    """Return the name of a flag's parameter."""
    return flag.removeprefix("--").replace("-", "_")


def _refuse_idle(way: str | None, given: Mapping[str, Any]) -> None:
    """Refuse flags that belong to another way than the one given."""
    for ways, flags in _BELONGING.items():
        idle = [flag for flag in flags if _name(flag) in given]
        if idle and way not in ways:
            found = f"beside {way}" if way else "alone"
            raise CalibrationError(f"{idle[0]} belongs to {' or '.join(ways)}, found it {found}")


def _need(given: Mapping[str, Any], flag: str, what: str, way: str) -> Any:
    """Return the value of a flag that a way cannot do without."""
    if _name(flag) not in given:
        raise CalibrationError(f"{way} needs {what}: give {flag}")
    return given[_name(flag)]


def _points(flag: str, text: str, count: int) -> list[tuple[float, float]]:
    """Return points (row, column) of a flag, px."""
    numbers = numbers_of(flag, text, 2 * count)
    if min(numbers) < 0:
        raise CalibrationError(f"{flag} must lie in the picture, found {text}")
    return list(zip(numbers[::2], numbers[1::2], strict=True))


def _of_ppi(given: Mapping[str, Any]) -> "Scale":
    from fingerpad.image import Scale

    return Scale.of_ppi(given["ppi"], given["ppi"] * given.get("scale_relative_std", 0.0))


def _of_pitch(given: Mapping[str, Any]) -> "Scale":
    from fingerpad.image import Scale

    return Scale(given["mm_per_px"], given["mm_per_px"] * given.get("scale_relative_std", 0.0))


def _of_line(given: Mapping[str, Any]) -> "Scale":
    from fingerpad.image import Scale

    start, end = _points("--scale-line", given["scale_line"], 2)
    length_mm = _need(given, "--line-mm", "the line's length", "--scale-line")
    try:
        return Scale.of_line(
            length_mm,
            start,
            end,
            length_mm_std=given.get("line_mm_std", 0.0),
            point_px_std=given.get("line_px_std", 0.0),
        )
    except CalibrationError as error:
        raise CalibrationError(f"--scale-line, --line-mm: {error}") from error


def _of_circle(given: Mapping[str, Any]) -> "Scale":
    from fingerpad.image import Scale

    points = _points("--scale-circle", given["scale_circle"], 3)
    diameter_mm = _need(given, "--circle-mm", "the circle's diameter", "--scale-circle")
    try:
        return Scale.of_circle(
            diameter_mm,
            points,
            diameter_mm_std=given.get("circle_mm_std", 0.0),
            point_px_std=given.get("circle_px_std", 0.0),
        )
    except CalibrationError as error:
        raise CalibrationError(f"--scale-circle, --circle-mm: {error}") from error


def _of_coin(given: Mapping[str, Any]) -> "Scale":
    from fingerpad.image import measure_coin, read_image

    picture: Path = given["coin"]
    diameter_mm = _need(given, "--coin-mm", "the coin's diameter", "--coin")
    pixels = read_image(picture).pixels
    try:
        coin = measure_coin(pixels)
    except CalibrationError as error:
        raise CalibrationError(f"--coin {picture}: {error}") from error
    try:
        scale = coin.scale(diameter_mm, given.get("coin_mm_std", 0.0))
    except CalibrationError as error:
        raise CalibrationError(f"--coin-mm: {error}") from error
    _print_flags(picture, coin.flags)
    return scale


def _of_grid(given: Mapping[str, Any]) -> "Scale":
    from fingerpad.image import measure_grid, read_image

    picture: Path = given["grid"]
    text = _need(given, "--grid-points", "its points down and across", "--grid")
    down, across = numbers_of("--grid-points", text, 2)
    if not (down.is_integer() and across.is_integer() and min(down, across) >= 3):
        raise CalibrationError(f"--grid-points takes two whole numbers, 3 or more each, found {text}")
    spacing_mm = _need(given, "--grid-spacing-mm", "the distance of its points", "--grid")
    pattern = given.get("grid_pattern", "checkerboard")
    if pattern not in {"checkerboard", "dots"}:
        raise CalibrationError(f"--grid-pattern must be checkerboard or dots, found {pattern!r}")
    pixels = read_image(picture).pixels
    try:
        grid = measure_grid(
            pixels,
            (int(down), int(across)),
            spacing_mm,
            spacing_mm_std=given.get("grid_spacing_mm_std", 0.0),
            pattern=pattern,
        )
    except CalibrationError as error:
        raise CalibrationError(f"--grid {picture}: {error}") from error
    _print_flags(picture, grid.flags)
    return grid.scale


def _print_flags(picture: Path, codes: tuple[str, ...]) -> None:
    for flag in flags_in(codes, "scale"):
        typer.echo(f"note: {picture}: {flag.words}. To do: {flag.to_do}.", err=True)


# The ways to give a scale; each takes the flags that were given, by their parameters' names.
_WAYS: Final[Mapping[str, Callable[[Mapping[str, Any]], "Scale"]]] = {
    "--ppi": _of_ppi,
    "--mm-per-px": _of_pitch,
    "--scale-line": _of_line,
    "--scale-circle": _of_circle,
    "--coin": _of_coin,
    "--grid": _of_grid,
}
_BELONGING: Final[Mapping[tuple[str, ...], tuple[str, ...]]] = {
    ("--ppi", "--mm-per-px"): ("--scale-relative-std",),
    ("--scale-line",): ("--line-mm", "--line-mm-std", "--line-px-std"),
    ("--scale-circle",): ("--circle-mm", "--circle-mm-std", "--circle-px-std"),
    ("--coin",): ("--coin-mm", "--coin-mm-std"),
    ("--grid",): ("--grid-points", "--grid-spacing-mm", "--grid-spacing-mm-std", "--grid-pattern"),
}
