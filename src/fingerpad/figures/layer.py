"""What bone below the pad would change, by the thickness of the tissue over it."""

from typing import Final

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array
from fingerpad.figures.panels import AnyAxes
from fingerpad.figures.style import BLACK, BLUE, VERMILLION, in_style, legend_above, mark_synthetic

_TICKS: Final = (3, 4, 6, 8, 12, 16)


@in_style
def plot_layer_effect(
    axes: AnyAxes,
    thickness: ArrayLike,
    *,
    modulus_ratio: ArrayLike,
    radius_ratio: ArrayLike,
    marked: ArrayLike = (4.0, 8.0, 12.0),
    synthetic: bool = False,
) -> AnyAxes:
    """Draw modulus and loading radius over those of Hertz theory, against the thickness of tissue over bone.

    Parameters
    ----------
    axes : Axes
        Where to draw.
    thickness : array_like
        Ascending, mm; NaN in the ratios is left out.
    modulus_ratio, radius_ratio : array_like
        Young's modulus from load and area, and A/(πξ), each over that of Hertz theory.
    marked : array_like
        Thicknesses to mark with their ratios, among those of `thickness`.
    synthetic : bool
        Whether the contact was rendered or simulated.

    Returns
    -------
    Axes
        `axes`.

    Examples
    --------
    >>> from fingerpad.figures import new_figure
    >>> figure, (axes,) = new_figure()
    >>> axes = plot_layer_effect(axes, [4, 8, 12], modulus_ratio=[0.5, 0.7, 0.8], radius_ratio=[2, 1.5, 1.4])
    >>> [text.get_text() for text in axes.texts]
    ['Hertz', '0.50', '0.70', '0.80', '2.0', '1.5', '1.4']
    """
    at = as_float_array(thickness)
    axes.axhline(1.0, color=BLACK, linewidth=0.8, linestyle=":")
    axes.annotate(
        "Hertz", (1, 1), (-2, 2), xycoords=("axes fraction", "data"), textcoords="offset points", ha="right"
    )
    ratios: list[FloatArray] = [
        np.atleast_1d(as_float_array(ratio)) for ratio in (modulus_ratio, radius_ratio)
    ]
    for values, colour, label, side in zip(
        ratios,
        (BLUE, VERMILLION),
        ("E from load and area", r"$R_\mathrm{g} = A/(\pi\xi)$"),
        (-1, 1),
        strict=True,
    ):
        axes.plot(at, values, color=colour, label=label)
        _mark(axes, at, values, as_float_array(marked), colour=colour, side=side)
    axes.set_xscale("log")
    axes.set_xticks(_TICKS, [str(tick) for tick in _TICKS])
    axes.minorticks_off()
    axes.set_ylim(0, 1.2 * float(np.nanmax(np.concatenate([[1.0], *ratios]))))
    axes.set_xlabel("assumed effective thickness of the tissue (mm)")
    axes.set_ylabel("over Hertz theory")
    legend_above(axes)
    mark_synthetic(axes, synthetic)
    return axes


def _mark(
    axes: AnyAxes, at: FloatArray, values: FloatArray, marked: FloatArray, *, colour: str, side: int
) -> None:
    """Mark some thicknesses, their ratios with two digits."""
    for place in np.flatnonzero(np.isin(at, marked) & np.isfinite(values)):
        axes.plot(at[place], values[place], "o", color=colour)
        axes.annotate(
            f"{values[place]:#.2g}",
            (at[place], values[place]),
            (0, 6 * side),
            textcoords="offset points",
            ha="center",
            va="bottom" if side > 0 else "top",
            color=colour,
        )
