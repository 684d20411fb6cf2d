"""Drawn figures with names and captions, and how pages show them."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Concatenate, Final, ParamSpec

from markupsafe import Markup

from fingerpad.figures import save_figure
from fingerpad.figures.marks import Figure, Panel, new_panels
from fingerpad.units import MM_PER_INCH

Arguments = ParamSpec("Arguments")
_PX_PER_INCH: Final = 140  # how large a page shows figures that stand alone


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Plot:
    """A drawn figure."""

    name: str
    figure: Figure
    caption: str


def panel(
    plot: Callable[Concatenate[Panel, Arguments], object], *args: Arguments.args, **kwargs: Arguments.kwargs
) -> Figure:
    """Return a figure of one panel, drawn by a ``plot_*`` function."""
    figure, (axes,) = new_panels()
    plot(axes, *args, **kwargs)
    return figure


def save_plots(
    plots: Iterable[Plot], folder: Path, on_drawn: Callable[[str], None] = lambda _: None
) -> list[dict[str, Any]]:
    """Write the files of each plot into a folder, and return what a page shows of it.

    `on_drawn` is called with the name of each as it is drawn.
    """
    shown = []
    for plot in plots:
        save_figure(plot.figure, folder / f"{plot.name}.json")
        file = save_figure(plot.figure, folder / f"{plot.name}.svg", description=plot.caption)
        width_px = round(_PX_PER_INCH * plot.figure.width_mm / MM_PER_INCH)
        shown.append({"file": file, "caption": plot.caption, "width_px": width_px})
        on_drawn(plot.name.replace("_", " "))
    return shown


def drawing(file: Path) -> Markup:
    """Return a drawing as an element of a page."""
    _, _, svg = file.read_text(encoding="utf-8").partition("\n")  # without the XML declaration
    return Markup(svg)  # noqa: S704 (drawn here)
