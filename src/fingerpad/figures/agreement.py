"""Figure of the agreement of two persons, after Bland and Altman."""

from collections.abc import Sequence

import numpy as np

from fingerpad._arrays import ArrayLike, as_float_array
from fingerpad.figures.marks import Axis, Panel, Rule, Text, measured, synthetic_tag
from fingerpad.figures.mpl import on_axes
from fingerpad.figures.style import BLUE, GREY
from fingerpad.uncertainty import Agreement


@on_axes
def plot_agreement(
    axes: Panel,
    first: ArrayLike,
    second: ArrayLike,
    found: Agreement,
    *,
    quantity: str,
    names: Sequence[str] = ("first", "second"),
    synthetic: ArrayLike = False,
) -> None:
    """Draw the relative difference of pairs against their geometric mean, with bias and limits of agreement.

    The limits are dashed, the 95 % interval of the bias is a band.
    """
    one, other = as_float_array(first), as_float_array(second)
    axes.add(
        *measured(np.sqrt(one * other), 100 * (other / one - 1), synthetic=synthetic),
        *synthetic_tag(synthetic),
        Rule("y", 0, colour=GREY, width=0.6),
        Rule("y", 100 * found.bias, width=1.0),
    )
    lines = [("bias", found.bias)]
    if np.isfinite(found.std):
        axes.add(Rule("y", *(100 * end for end in found.bias_interval), colour=BLUE, alpha=0.15))
        axes.add(*(Rule("y", 100 * end, dash="--", width=1.0) for end in found.limits))
        lines += [("limit", end) for end in found.limits if np.isfinite(end)]
    for words, value in lines:
        place = 1.0, 100 * value
        axes.add(
            Text(f"{words} {100 * value:+.1f} %", *place, right=3, frame="x", vertical="center", size=6.8)
        )
    axes.x = Axis(f"{quantity}, mean of both", margin=0.1)
    axes.y = Axis(f"{names[1]}, difference from {names[0]} (%)", margin=0.2)
