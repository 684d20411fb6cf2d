"""Figures of uncertainty budgets."""

from collections.abc import Mapping

import numpy as np

from fingerpad.figures.panels import AnyAxes
from fingerpad.figures.style import BLUE, ORANGE, in_style, legend_above, mark_synthetic


@in_style
def plot_uncertainty_budget(
    axes: AnyAxes,
    first_order: Mapping[str, float],
    *,
    total: Mapping[str, float] | None = None,
    synthetic: bool = False,
) -> AnyAxes:
    """Draw the contribution of each source to the variance of a result, as bars from the largest down.

    Parameters
    ----------
    axes : Axes
        Where to draw.
    first_order : mapping
        From the name of a source to its share of the variance, as `Propagated.budget` gives it.
    total : mapping, optional
        Sobol's total indices of the same sources, as `sobol_indices` gives them: narrow bars.
    synthetic : bool
        Whether the data were simulated.

    Returns
    -------
    Axes

    Examples
    --------
    >>> from fingerpad.figures import new_figure
    >>> figure, (axes,) = new_figure()
    >>> axes = plot_uncertainty_budget(axes, {"load": 0.1, "wedge angle": 0.7, "contact ellipse": 0.2})
    >>> axes.get_xlabel()
    'share of the variance (%)'
    """
    names = sorted(first_order, key=lambda name: first_order[name])
    places = np.arange(len(names))
    label = "first order" if total is not None else ""
    axes.barh(places, [100 * first_order[name] for name in names], color=BLUE, height=0.6, label=label)
    if total is not None:
        shares = [100 * total[name] for name in names]
        axes.barh(places, shares, color=ORANGE, height=0.18, label="Sobol, total")
        legend_above(axes)
    for place, name in zip(places, names, strict=True):
        share = 100 * max(first_order[name], 0.0 if total is None else total[name])
        axes.annotate(
            f"{100 * first_order[name]:.1f} %",
            (max(share, 0), place),
            xytext=(3, 0),
            textcoords="offset points",
            va="center",
            fontsize=6.8,
        )
    axes.set_yticks(places, names)
    axes.set_xlim(min(0, *(100 * share for share in first_order.values())), 118)
    axes.grid(visible=False, axis="y")
    axes.set_xlabel("share of the variance (%)")
    mark_synthetic(axes, synthetic)
    return axes
