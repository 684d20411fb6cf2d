"""A drawn figure with its name and caption."""

from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

from fingerpad.figures import save_figure, save_panels
from fingerpad.figures.panels import PanelFigure
from fingerpad.units import MM_PER_INCH


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Plot:
    """A drawn figure.

    Attributes
    ----------
    name : str
        File name without suffix.
    figure : Figure or PanelFigure
        The drawing, of Matplotlib or as data.
    caption : str
        What is seen.
    """

    name: str
    figure: Figure | PanelFigure
    caption: str

    @property
    def width_mm(self) -> float:
        """Width on paper."""
        if isinstance(self.figure, PanelFigure):
            return self.figure.width_mm
        return MM_PER_INCH * self.figure.get_figwidth()


def save_plot(plot: Plot, folder: Path) -> Path:
    """Write the files of a plot into a folder, and return its SVG."""
    path = folder / plot.name
    if isinstance(plot.figure, PanelFigure):
        return save_panels(plot.figure, path, description=plot.caption)[0]
    return save_figure(plot.figure, path, description=plot.caption)[0]
