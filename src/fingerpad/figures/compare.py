"""Figures that compare fingers and people."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import cycle
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from matplotlib.ticker import MaxNLocator

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array, broadcast
from fingerpad.figures.marks import Axis, Band, Dash, Line, Marker, Panel, Points, Rule, Text, measured
from fingerpad.figures.mpl import on_axes
from fingerpad.figures.style import BLUE, GREEN, GREY, ORANGE, SKY, VERMILLION

if TYPE_CHECKING:
    from fingerpad.study.compare import Mean, Value

_COLOURS: Final = (BLUE, ORANGE, GREEN, VERMILLION, SKY, "#CC79A7", GREY)
MOST_NAMES: Final = 8
_WIDEST_SHIFT_DEG: Final = 1.4
_SHIFT: Final = 0.025  # of the highest load: about the width of a mark


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Series:
    """Values of one finger, against the load (N) at one placement, or against the wedge angle (degrees)."""

    name: str  # of the finger and its angle, or of the person
    colour: str
    x: ArrayLike
    value: ArrayLike
    std: ArrayLike
    synthetic: bool = False
    left_out: ArrayLike = False  # not pooled: faded
    beside: Sequence[tuple[float, float]] = ()  # that belong to no load, each with its std; NaN if unknown
    kind: str = ""  # of the values, in words for the legend, where series differ in it
    marker: Marker = "o"  # of that kind


def colours_of(people: Sequence[str]) -> dict[str, str]:
    """Return one colour for each person, again from the first where there are more than seven."""
    return dict(zip(dict.fromkeys(people), cycle(_COLOURS)))


@on_axes
def plot_forest(
    axes: Panel,
    rows: "Sequence[tuple[int, Value]]",
    *,
    colours: Mapping[str, str],
    symbols: Mapping[str, str],
    means: Sequence[tuple[float, "Mean"]] = (),
    title: str = "",
) -> None:
    """Draw values in rows, each with its standard uncertainty, and means below them.

    A mean is a diamond on its 95 % interval; the bar round it is one standard deviation between people.
    `colours` are those of people; of `symbols` that of a value's verdict stands at the end of its row.
    """
    y, x, spread = np.array([(row, one.value, one.std) for row, one in rows]).reshape(-1, 3).T
    people = np.array([one.person.name for _, one in rows])
    hollow = np.array([one.synthetic for _, one in rows])
    for person in dict.fromkeys(people.tolist()):
        mine = people == person
        points = x[mine], y[mine]
        axes.add(*measured(*points, x_std=spread[mine], synthetic=hollow[mine], colour=colours[person]))
    ends = [x - np.nan_to_num(spread), x + np.nan_to_num(spread)]
    for line, mean in means:
        if np.isfinite(mean.between_people_std):
            band = mean.value - mean.between_people_std, mean.value + mean.between_people_std
            axes.add(Band(band, line - 0.4, line + 0.4, alpha=0.15))
            ends.append(as_float_array(band))
        if mean.interval is not None:
            axes.add(Line(mean.interval, line))
        axes.add(Points(mean.value, line, marker="D", face="white" if mean.synthetic else "", size=5))
    every = np.concatenate([np.ravel(end) for end in ends])
    if every.size:
        room = 0.08 * (np.ptp(every) or abs(every[0]) or 1.0)
        axes.x = Axis(low=float(every.min() - room), high=float(every.max() + room))
    for row, one in rows:
        axes.add(Text(symbols.get(one.verdict, ""), 1.015, row, frame="x", vertical="center"))
    axes.y = Axis(lines=False)
    axes.title = title


@on_axes
def plot_by_wedge(
    axes: Panel, lines: Sequence[Series], means: Sequence[tuple[float, "Mean"]] = (), *, label: str
) -> None:
    """Draw each finger's values against the wedge angle, people by colour, and the means over people.

    More than eight people have thin grey lines without names or bars.
    """
    crowded = len({line.name for line in lines}) > MOST_NAMES
    named: set[str] = set()
    for place, line in enumerate(lines):
        name = f"{'a finger' if crowded else line.name}{' (synthetic)' if line.synthetic else ''}"
        said = f"_{name}" if name in named else name
        named.add(name)
        angle = as_float_array(line.x)
        if crowded:
            dash: Dash = ":" if line.synthetic else "-"
            axes.add(Line(angle, line.value, dash=dash, colour=GREY, width=0.5, label=said))
            continue
        # Beside one another where fingers share an angle.
        angle = angle + _WIDEST_SHIFT_DEG * (2 * (place + 0.5) / len(lines) - 1)
        look: dict[str, Any] = {"size": 3.6, "bar_width": 0.7, "face": "white" if line.synthetic else ""}
        axes.add(
            Line(angle, line.value, colour=line.colour, width=0.7, label=said),
            Points(angle, line.value, y_std=line.std, colour=line.colour, label=said, **look),
        )
    for synthetic in (False, True):
        chosen = [(angle, mean) for angle, mean in means if mean.synthetic is synthetic]
        if chosen:
            _draw_means(axes, *zip(*sorted(chosen, key=lambda one: one[0]), strict=True), synthetic=synthetic)
    angles = {float(angle) for line in lines for angle in as_float_array(line.x)}
    axes.x = Axis("wedge angle (°)", ticks=tuple(sorted(angles)))
    axes.y = Axis(label, margin=0.12)
    axes.legend = "above"


@on_axes
def plot_over_load(axes: Panel, lines: Sequence[Series], *, label: str, beside: Sequence[str] = ()) -> None:
    """Draw values of several fingers and angles against load, each with its standard uncertainty.

    Points at one load stand beside one another. More than eight fingers are grey, without names or bars, and
    at their loads. What kind of values they are, as by Hertz theory, tells the mark, and the legend in words.
    """
    crowded = len(lines) > MOST_NAMES
    loads = np.concatenate([np.zeros(1), *(as_float_array(line.x) for line in lines)])
    top = float(loads.max()) or 1.0
    values = as_float_array([line.beside for line in lines]).reshape(len(lines), len(beside), 2)
    known = np.flatnonzero(np.isfinite(values[..., 0]).any(axis=0))
    values, names = values[:, known], [beside[place] for place in known.tolist()]
    places = top * (1.2 + 0.22 * np.arange(len(names)))
    for number, line in enumerate(lines):
        x, y, std, out = broadcast(line.x, line.value, line.std, line.left_out)
        x, (y, std) = np.append(x, places), np.concatenate([[y, std], values[number].T], axis=1)
        seen = np.isfinite(y)
        colour, kind = GREY if crowded else line.colour, f", {line.kind}" if line.kind else ""
        shift = 0.0 if crowded else _SHIFT * top * (2 * (number + 0.5) / len(lines) - 1)
        axes.add(
            *measured(
                x[seen] + shift,
                y[seen],
                y_std=None if crowded else std[seen],
                synthetic=line.synthetic,
                left_out=np.append(out, np.zeros(len(names)))[seen],
                colour=colour,
                marker=line.marker,
                label=f"_{kind}" if crowded else f"_{line.name}{kind}",  # named below, once
            )
        )
        if not crowded:
            axes.add(_sample(line.name, line.marker, colour=colour, hollow=line.synthetic))
    kinds = {line.kind: line.marker for line in lines if line.kind}
    axes.add(*(_sample(kind, marker, colour=GREY) for kind, marker in kinds.items()))
    right = 1.08 * top + (places[-1] - 0.97 * top if places.size else 0.0)
    axes.x = Axis("normal load W (N)", low=0, high=float(right))
    # Areas and moduli from zero, as they grow; radii differ by little.
    axes.y = Axis(label, low=None if names else 0.0, margin=0.08)
    if names:
        axes.add(Rule("x", 1.09 * top, colour=GREY, width=0.5))
        ticks = as_float_array(MaxNLocator(4).tick_values(0, top))
        ticks = ticks[ticks <= 1.01 * top]
        every = tuple(np.append(ticks, places).tolist())
        axes.x = replace(axes.x, ticks=every, names=(*(f"{tick:g}" for tick in ticks), *names))
    if kinds or not crowded:
        axes.legend, axes.columns = "above", 2


def _sample(label: str, marker: Marker, *, colour: str, hollow: bool = False) -> Points:
    """Return a mark that the legend alone shows."""
    return Points([], [], marker=marker, colour=colour, face="white" if hollow else "", size=4.2, label=label)


def _draw_means(axes: Panel, angles: Sequence[float], means: Sequence["Mean"], *, synthetic: bool) -> None:
    value: FloatArray = as_float_array([mean.value for mean in means])
    spread = np.nan_to_num(as_float_array([mean.between_people_std for mean in means]))
    label = f"mean over people{' (synthetic)' if synthetic else ''}, band: between people"
    axes.add(
        Band(angles, value - spread, value + spread, alpha=0.13),
        Line(angles, value, dash="--", label=label),
        Points(angles, value, marker="D", size=4.5, face="white" if synthetic else "", label=label),
    )
