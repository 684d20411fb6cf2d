"""Figures of uncertainty budgets."""

from collections.abc import Mapping

import numpy as np

from fingerpad.figures.marks import Axis, Bars, Panel, Text, synthetic_tag
from fingerpad.figures.mpl import on_axes
from fingerpad.figures.style import BLUE, ORANGE


@on_axes
def plot_uncertainty_budget(
    axes: Panel,
    first_order: Mapping[str, float],
    *,
    total: Mapping[str, float] | None = None,
    synthetic: bool = False,
) -> None:
    """Draw the contribution of each source to the variance of a result, as bars from the largest down."""
    names = sorted(first_order, key=lambda name: first_order[name])
    places = np.arange(len(names))
    label = "first order" if total is not None else ""
    axes.add(Bars(places, [100 * first_order[name] for name in names], colour=BLUE, height=0.6, label=label))
    if total is not None:
        shares = [100 * total[name] for name in names]
        axes.add(Bars(places, shares, colour=ORANGE, height=0.18, label="Sobol, total"))
        axes.legend = "above"
    for place, name in enumerate(names):
        share = 100 * max(first_order[name], 0.0 if total is None else total[name])
        words = f"{100 * first_order[name]:.1f} %"
        axes.add(Text(words, max(share, 0), place, right=3, vertical="center", size=6.8))
    lowest = min([0.0, *(100 * share for share in first_order.values())])
    axes.x = Axis("share of the variance (%)", low=lowest, high=118)
    axes.y = Axis(ticks=tuple(places), names=tuple(names), lines=False)
    axes.add(*synthetic_tag(synthetic))
