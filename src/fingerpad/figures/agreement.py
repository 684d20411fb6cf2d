"""Figure of the agreement of two persons, after Bland and Altman."""

from collections.abc import Sequence

import numpy as np

from fingerpad._arrays import ArrayLike, as_float_array
from fingerpad.figures.panels import AnyAxes
from fingerpad.figures.style import BLACK, BLUE, GREY, draw_points, in_style, mark_synthetic
from fingerpad.uncertainty import Agreement


@in_style
def plot_agreement(
    axes: AnyAxes,
    first: ArrayLike,
    second: ArrayLike,
    found: Agreement,
    *,
    quantity: str,
    names: Sequence[str] = ("first", "second"),
    synthetic: ArrayLike = False,
) -> AnyAxes:
    """Draw the relative difference of pairs against their geometric mean, with bias and limits of agreement.

    Parameters
    ----------
    axes : Axes
        Where to draw.
    first, second : array_like, shape (n,)
        The same quantities by either person.
    found : Agreement
        Their agreement, as of `agreement`: its limits are dashed, the 95 % interval of the bias is a band.
    quantity : str
        Name and unit of the quantity, for the axis.
    names : (str, str)
        Who is first and second.
    synthetic : array_like of bool
        Points that are not measured: hollow.

    Returns
    -------
    Axes

    Examples
    --------
    >>> from fingerpad.figures import new_figure
    >>> from fingerpad.uncertainty import agreement
    >>> first, second = [100, 120, 140, 90], [101, 119, 143, 91]
    >>> figure, (axes,) = new_figure()
    >>> found = agreement(first, second)
    >>> plot_agreement(axes, first, second, found, quantity="gross area (mm²)").get_xlabel()
    'gross area (mm²), mean of both'
    """
    one, other = as_float_array(first), as_float_array(second)
    draw_points(axes, np.sqrt(one * other), 100 * (other / one - 1), synthetic=synthetic)
    mark_synthetic(axes, synthetic)
    axes.axhline(0, color=GREY, linewidth=0.6)
    axes.axhline(100 * found.bias, color=BLACK, linewidth=1.0)
    if np.isfinite(found.std):
        axes.axhspan(*(100 * end for end in found.bias_interval), color=BLUE, alpha=0.15, linewidth=0)
        for end in found.limits:
            axes.axhline(100 * end, color=BLACK, linestyle="--", linewidth=1.0)
    lines = [("bias", found.bias), *(("limit", end) for end in found.limits if np.isfinite(end))]
    for words, value in lines:
        axes.annotate(
            f"{words} {100 * value:+.1f} %",
            (1.0, 100 * value),
            xycoords=("axes fraction", "data"),
            xytext=(3, 0),
            textcoords="offset points",
            va="center",
            fontsize=6.8,
        )
    axes.margins(x=0.1, y=0.2)
    axes.set_xlabel(f"{quantity}, mean of both")
    axes.set_ylabel(f"{names[1]}, difference from {names[0]} (%)")
    return axes
