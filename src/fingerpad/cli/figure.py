"""The command that draws a figure of a report for publication."""

from pathlib import Path
from typing import Annotated

import typer

from fingerpad.exceptions import FigureError


def figure(
    file: Annotated[
        Path,
        typer.Argument(help="A figure of a report as data, results/figures/NAME.json.", show_default=False),
    ],
    out: Annotated[
        Path, typer.Option(help="File to write: .svg, .pdf, .png, or .csv for its data.", show_default=False)
    ],
    width_mm: Annotated[float | None, typer.Option(help="Width, mm: a journal's column.")] = None,
    height_mm: Annotated[float | None, typer.Option(help="Height, mm.")] = None,
    font_pt: Annotated[float | None, typer.Option(help="Size of labels, points.")] = None,
    x_range: Annotated[
        str, typer.Option(help="Ends of the x axis, as 0:2 or 0: or :2.", show_default=False)
    ] = ":",
    y_range: Annotated[str, typer.Option(help="Ends of the y axis.", show_default=False)] = ":",
    x_scale: Annotated[str | None, typer.Option(help="linear or log.", show_default=False)] = None,
    y_scale: Annotated[str | None, typer.Option(help="linear or log.", show_default=False)] = None,
    colours: Annotated[
        str, typer.Option(help="Colours of the data in their order, as black,#D55E00.", show_default=False)
    ] = "",
    dpi: Annotated[float, typer.Option(help="Resolution of a PNG, dots per inch.")] = 300.0,
) -> None:
    """Draw a figure of a report for publication, or write the data behind it."""
    from fingerpad.figures.marks import Figure
    from fingerpad.figures.publish import FORMATS, FigureSettings, figure_file

    kind = next((each for each in FORMATS if out.suffix.lower() == f".{each}"), None)
    if kind is None:
        raise FigureError(f"--out: a figure is written as .svg, .pdf, .png or .csv, found {out.name}")
    ranges = {"x_range": _range("--x-range", x_range), "y_range": _range("--y-range", y_range)}
    try:
        settings = FigureSettings(
            width_mm=width_mm,
            height_mm=height_mm,
            font_pt=font_pt,
            **ranges,
            x_scale=x_scale,  # type: ignore[arg-type]  # checked there
            y_scale=y_scale,  # type: ignore[arg-type]
            colours=tuple(filter(None, colours.split(","))),
            dpi=dpi,
        )
    except FigureError as error:
        name, _, words = str(error).partition(":")
        raise FigureError(f"--{name.replace('_', '-')}:{words}") from None
    try:
        drawn = Figure.of_json(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise FigureError(
            f"{file}: not a figure of a report: name a file of results/figures that ends in .json"
        ) from error
    content = figure_file(drawn, kind, settings)
    try:
        out.write_bytes(content)
    except OSError as error:
        raise FigureError(f"{out}: cannot be written ({error.strerror}): choose another --out") from error
    typer.echo(f"Wrote {out}")


def _range(option: str, text: str) -> tuple[float | None, float | None]:
    try:
        low, high = (float(end) if end else None for end in text.split(":"))
    except ValueError:
        raise FigureError(f"{option}: takes two numbers separated by a colon, found {text!r}") from None
    return low, high
