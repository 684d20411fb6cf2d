"""A drawn figure with its name and caption."""

from dataclasses import dataclass

from matplotlib.figure import Figure


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Plot:
    """A drawn figure.

    Attributes
    ----------
    name : str
        File name without suffix.
    figure : Figure
        The drawing.
    caption : str
        What is seen.
    """

    name: str
    figure: Figure
    caption: str
