"""A drawn figure with its name and caption."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Concatenate, ParamSpec

from matplotlib.figure import Figure as Drawn

from fingerpad.figures import save_figure, save_panels
from fingerpad.figures.marks import Figure, Panel, new_panels
from fingerpad.units import MM_PER_INCH

Arguments = ParamSpec("Arguments")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Plot:
    """A drawn figure.

    Attributes
    ----------
    name : str
        File name without suffix.
    figure : Figure of marks or of Matplotlib
        The drawing, of Matplotlib or as data.
    caption : str
        What is seen.
    """

    name: str
    figure: Figure | Drawn
    caption: str

    @property
    def width_mm(self) -> float:
        """Width on paper."""
        if isinstance(self.figure, Figure):
            return self.figure.width_mm
        return MM_PER_INCH * self.figure.get_figwidth()


def panel(
    plot: Callable[Concatenate[Panel, Arguments], object], *args: Arguments.args, **kwargs: Arguments.kwargs
) -> Figure:
    """Return a figure of one panel, drawn by a ``plot_*`` function."""
    figure, (axes,) = new_panels()
    plot(axes, *args, **kwargs)
    return figure


def save_plot(plot: Plot, folder: Path) -> Path:
    """Write the files of a plot into a folder, and return its SVG."""
    path = folder / plot.name
    if isinstance(plot.figure, Figure):
        return save_panels(plot.figure, path, description=plot.caption)[0]
    return save_figure(plot.figure, path, description=plot.caption)[0]
