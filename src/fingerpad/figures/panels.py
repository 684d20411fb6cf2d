"""Figures as data: what is drawn on each of their axes, from which SVG, PDF, PNG and CSV are made.

A `Panel` takes the calls that the ``plot_*`` functions make on Matplotlib's axes, and keeps them.
`fingerpad.figures.svg` draws them in a millisecond or two, Matplotlib in any format.
"""

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final, NamedTuple, Self, TypeVar

import numpy as np
from matplotlib.axes import Axes

from fingerpad._arrays import as_float_array

# Of the numbers kept: far more than a drawing shows.
_DIGITS: Final = 7

_LINE: Final = frozenset(("alpha", "clip_on", "color", "label", "linestyle", "linewidth", "zorder"))
_MARKERS: Final = frozenset(("markersize", "markerfacecolor", "markeredgecolor", "markeredgewidth"))
_BAND: Final = frozenset(("alpha", "color", "label", "linewidth", "zorder"))
_NOTHING: Final[frozenset[str]] = frozenset()
# What can be drawn, and with which options: the file of a figure, which may come with somebody else's study,
# can call nothing else of Matplotlib.
_OPTIONS: Final[Mapping[str, frozenset[str]]] = {
    "plot": _LINE | _MARKERS | {"solid_capstyle"},
    "errorbar": _LINE | _MARKERS | {"elinewidth", "fmt", "xerr", "yerr"},
    "fill_between": _BAND,
    "barh": _BAND | {"height"},
    "axhline": _LINE,
    "axvline": _LINE,
    "axhspan": _BAND,
    "axvspan": _BAND,
    "annotate": frozenset(("bbox", "color", "fontsize", "gid", "ha", "style", "textcoords", "va", "weight"))
    | {"annotation_clip", "xycoords", "xytext", "zorder"},
    "legend": frozenset(("bbox_to_anchor", "loc", "ncols")),
    "legend_above": frozenset(("columns",)),
    "margins": frozenset(("x", "y")),
    "grid": frozenset(("axis", "visible", "which")),
    "set_xlim": frozenset(("left", "right")),
    "set_ylim": frozenset(("bottom", "top")),
    "tick_params": frozenset(("axis", "bottom", "labelbottom", "labelleft", "left", "length", "which")),
    "draw_shapes": frozenset(("angles_deg", "beside", "edge", "face", "heights", "widths")),
    **dict.fromkeys(
        ("draw_picture", "minorticks_off", "plain_log_ticks", "set_aspect", "set_axis_off", "set_title"),
        _NOTHING,
    ),
    **dict.fromkeys((f"set_{axis}{what}" for axis in "xy" for what in ("label", "scale", "ticks")), _NOTHING),
}
# Of options that are tables themselves.
_INNER: Final[Mapping[str, frozenset[str]]] = {"bbox": frozenset(("alpha", "edgecolor", "facecolor", "pad"))}


class Call(NamedTuple):
    """A call on axes.

    Attributes
    ----------
    name : str
        Method of Matplotlib's axes, or helper of `fingerpad.figures.style`.
    args : tuple
        What it is called with: numbers, text, and lists of them; None where a number is missing.
    options : dict
        Its keywords.
    """

    name: str
    args: tuple[Any, ...]
    options: dict[str, Any]


def _kept(name: str) -> Callable[..., None]:
    """Return a method that keeps the calls of it."""

    def keep(self: "Panel", *args: Any, **options: Any) -> None:
        self.record(name, *args, **options)

    return keep


class Panel:
    """Axes that keep what is drawn on them, with the methods of Matplotlib's axes that figures here use."""

    def __init__(self, calls: list[Call] | None = None) -> None:
        self.calls: list[Call] = calls or []

    def record(self, name: str, *args: Any, **options: Any) -> None:
        """Keep a call."""
        known = {key: _plain(value) for key, value in options.items() if value is not None}
        self.calls.append(_checked(Call(name, tuple(_plain(value) for value in args), known)))

    plot = _kept("plot")
    errorbar = _kept("errorbar")
    fill_between = _kept("fill_between")
    barh = _kept("barh")
    axhline = _kept("axhline")
    axvline = _kept("axvline")
    axhspan = _kept("axhspan")
    axvspan = _kept("axvspan")
    annotate = _kept("annotate")
    legend = _kept("legend")
    margins = _kept("margins")
    grid = _kept("grid")
    minorticks_off = _kept("minorticks_off")
    set_aspect = _kept("set_aspect")
    set_axis_off = _kept("set_axis_off")
    set_title = _kept("set_title")
    set_xlabel = _kept("set_xlabel")
    set_ylabel = _kept("set_ylabel")
    set_xlim = _kept("set_xlim")
    set_ylim = _kept("set_ylim")
    set_xscale = _kept("set_xscale")
    set_yscale = _kept("set_yscale")
    tick_params = _kept("tick_params")
    set_xticks = _kept("set_xticks")
    set_yticks = _kept("set_yticks")

    def get_xlim(self) -> tuple[float, float]:
        """Return the limits that were set."""
        low, high = self.last("set_xlim").args
        return low, high

    def get_ylim(self) -> tuple[float, float]:
        """Return the limits that were set."""
        low, high = self.last("set_ylim").args
        return low, high

    def last(self, name: str) -> Call:
        """Return the last call of a name, an empty one if there is none."""
        return next((call for call in reversed(self.calls) if call.name == name), Call(name, (), {}))


# Axes of Matplotlib, or a panel: what is drawn on is returned.
AnyAxes = TypeVar("AnyAxes", Axes, Panel)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PanelFigure:
    """A figure as data.

    Attributes
    ----------
    width_mm, height_mm : float
        Size on paper.
    rows, columns : int
        Arrangement of the panels.
    panels : list of Panel
        Row by row.
    """

    width_mm: float
    height_mm: float
    rows: int
    columns: int
    panels: list[Panel]

    def to_json(self) -> str:
        """Return the figure as JSON, the same text for the same figure."""
        record = {name: getattr(self, name) for name in ("width_mm", "height_mm", "rows", "columns")}
        panels = [[list(call) for call in panel.calls] for panel in self.panels]
        return json.dumps(
            {**record, "panels": panels}, ensure_ascii=False, separators=(",", ":"), allow_nan=False
        )

    @classmethod
    def of_json(cls, text: str) -> Self:
        """Return a figure that was written as JSON.

        Raises
        ------
        ValueError
            If it is none.
        """
        try:
            record = json.loads(text)
            panels = [
                Panel([_checked(Call(name, tuple(args), dict(options))) for name, args, options in calls])
                for calls in record.pop("panels")
            ]
            return cls(panels=panels, **record)
        except (KeyError, TypeError, AttributeError) as error:
            raise ValueError(f"not a figure: {error}") from error


def new_panels(
    *, width_mm: float = 85.0, height_mm: float = 64.0, rows: int = 1, columns: int = 1
) -> tuple[PanelFigure, list[Panel]]:
    """Return an empty figure as data and its panels, as `new_figure` does of Matplotlib's.

    Parameters
    ----------
    width_mm, height_mm : float
        Size on paper; 85 mm is one column of a journal.
    rows, columns : int
        Number of panels.

    Returns
    -------
    figure : PanelFigure
        The figure.
    panels : list of Panel
        Row by row.

    Examples
    --------
    >>> from fingerpad.figures import plot_layer_effect
    >>> figure, (panel,) = new_panels()
    >>> _ = plot_layer_effect(panel, [4, 8], modulus_ratio=[0.5, 0.7], radius_ratio=[2.0, 1.5], marked=())
    >>> [call.name for call in figure.panels[0].calls][:3]
    ['axhline', 'annotate', 'plot']
    """
    panels = [Panel() for _ in range(rows * columns)]
    return PanelFigure(
        width_mm=width_mm, height_mm=height_mm, rows=rows, columns=columns, panels=panels
    ), panels


def _checked(call: Call) -> Call:
    """Return a call of what a panel can draw; refuse others."""
    allowed = _OPTIONS.get(call.name)
    if allowed is None:
        raise ValueError(f"{call.name}: a figure draws {', '.join(sorted(_OPTIONS))}")
    unknown = call.options.keys() - allowed
    for key in call.options.keys() & _INNER.keys():
        unknown |= set(call.options[key]) - _INNER[key]
    if unknown:
        raise ValueError(f"{call.name}: a figure takes no {', '.join(sorted(unknown))} here")
    return call


def _plain(value: Any) -> Any:
    """Return a value as JSON has it."""
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, float):
        return float(f"{value:.{_DIGITS}g}") if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {key: _plain(one) for key, one in value.items()}
    if isinstance(value, (list, tuple, range)):
        return [_plain(one) for one in value]
    return value


def numbers(values: Any) -> Any:
    """Return kept numbers as an array, NaN where one is missing."""
    if isinstance(values, list):
        return as_float_array([math.nan if value is None else value for value in values])
    return as_float_array(math.nan if values is None else values)
