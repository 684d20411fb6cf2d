"""The flags that give a picture its scale, the same for every command that measures."""

from collections.abc import Callable, Mapping
from functools import wraps
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fingerpad.cli.measure.flags import numbers_of
from fingerpad.exceptions import CalibrationError

if TYPE_CHECKING:
    from fingerpad.image import Scale

WAYS = "either --ppi, --mm-per-px, --scale-line or --coin"


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
    line_mm_std: Annotated[float | None, typer.Option(min=0, help="Its standard uncertainty.")] = None,
    line_px_std: Annotated[
        float | None, typer.Option(min=0, help="Standard uncertainty of each end along the line, px.")
    ] = None,
    coin: Annotated[
        Path | None, typer.Option(help="Scale from a coin: a picture of it, taken like those to measure.")
    ] = None,
    coin_mm: Annotated[float | None, typer.Option(min=1e-6, help="Diameter of that coin.")] = None,
    coin_mm_std: Annotated[float | None, typer.Option(min=0, help="Its standard uncertainty.")] = None,
) -> "Scale | None":
    """Return the scale that the flags give, None for none."""
    from fingerpad.image import Scale

    ways = {"--ppi": ppi, "--mm-per-px": mm_per_px, "--scale-line": scale_line, "--coin": coin}
    given = [flag for flag, value in ways.items() if value is not None]
    if len(given) > 1:
        raise CalibrationError(f"give {WAYS}, found {' and '.join(given)}")
    way = given[0] if given else None
    _refuse_idle(way, ("--ppi", "--mm-per-px"), {"--scale-relative-std": scale_relative_std})
    lengths = {"--line-mm": line_mm, "--line-mm-std": line_mm_std, "--line-px-std": line_px_std}
    _refuse_idle(way, ("--scale-line",), lengths)
    _refuse_idle(way, ("--coin",), {"--coin-mm": coin_mm, "--coin-mm-std": coin_mm_std})
    relative = scale_relative_std or 0.0
    if ppi is not None:
        return Scale.of_ppi(ppi, ppi * relative)
    if mm_per_px is not None:
        return Scale(mm_per_px, mm_per_px * relative)
    if scale_line is not None:
        return _of_line(scale_line, line_mm, line_mm_std or 0.0, line_px_std or 0.0)
    return None if coin is None else _of_coin(coin, coin_mm, coin_mm_std or 0.0)


def _refuse_idle(way: str | None, ways: tuple[str, ...], flags: Mapping[str, object]) -> None:
    """Refuse flags that belong to another way than the one given."""
    idle = [flag for flag, value in flags.items() if value is not None]
    if idle and way not in ways:
        found = f"beside {way}" if way else "alone"
        raise CalibrationError(f"{idle[0]} belongs to {' or '.join(ways)}, found it {found}")


def _of_line(line: str, length_mm: float | None, length_mm_std: float, point_px_std: float) -> "Scale":
    from fingerpad.image import Scale

    row, column, end_row, end_column = numbers_of("--scale-line", line, 4)
    if min(row, column, end_row, end_column) < 0:
        raise CalibrationError(f"--scale-line must lie in the picture, found {line}")
    if length_mm is None:
        raise CalibrationError("--scale-line needs the line's length: give --line-mm")
    try:
        return Scale.of_line(
            length_mm,
            (row, column),
            (end_row, end_column),
            length_mm_std=length_mm_std,
            point_px_std=point_px_std,
        )
    except CalibrationError as error:
        raise CalibrationError(f"--scale-line, --line-mm: {error}") from error


def _of_coin(picture: Path, diameter_mm: float | None, diameter_mm_std: float) -> "Scale":
    from fingerpad.image import measure_coin, read_image

    if diameter_mm is None:
        raise CalibrationError("--coin needs the coin's diameter: give --coin-mm")
    pixels = read_image(picture).pixels
    try:
        coin = measure_coin(pixels)
    except CalibrationError as error:
        raise CalibrationError(f"--coin {picture}: {error}") from error
    try:
        scale = coin.scale(diameter_mm, diameter_mm_std)
    except CalibrationError as error:
        raise CalibrationError(f"--coin-mm: {error}") from error
    if "shadow" in coin.flags:
        typer.echo(f"note: {picture}: a shadow beside the coin may make the scale too small", err=True)
    return scale
