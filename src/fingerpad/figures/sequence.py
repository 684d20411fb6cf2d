"""The figure of one press: contact area and semi-axes against time and against force."""

from collections.abc import Sequence
from typing import Final

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import ArrayLike, BoolArray, FloatArray, as_float_array, broadcast
from fingerpad.figures.panels import AnyAxes
from fingerpad.figures.style import BLUE, GREY, VERMILLION, in_style, legend_above, mark_synthetic

# Distinguished by colour and by shape.
_PHASES: Final = (("loading", BLUE, "o"), ("hold", GREY, "s"), ("unloading", VERMILLION, "v"))


@in_style
def plot_press(
    axes: Sequence[AnyAxes],
    *,
    time: ArrayLike,
    load: ArrayLike,
    phase: npt.ArrayLike,
    area: ArrayLike,
    semi_major: ArrayLike,
    semi_minor: ArrayLike,
    synthetic: bool = False,
) -> Sequence[AnyAxes]:
    """Draw area and semi-axes of a contact against time and force, loading and unloading marked differently.

    Parameters
    ----------
    axes : sequence of four Axes
        Area against time and against force, then the semi-axes against both.
    time, load : array_like, shape (n,)
        Time (s) and normal force (N) of each frame.
    phase : array_like of str, shape (n,)
        ``loading``, ``hold`` or ``unloading``.
    area, semi_major, semi_minor : array_like, shape (n,)
        Contact area (mm²) and semi-axes (mm).
    synthetic : bool
        Whether the frames are rendered: hollow.

    Returns
    -------
    sequence of Axes

    Examples
    --------
    >>> from fingerpad.figures import new_figure
    >>> figure, axes = new_figure(rows=2, columns=2)
    >>> names = ["loading", "unloading"]
    >>> axes = plot_press(
    ...     axes, time=[0, 1], load=[1, 2], phase=names, area=[9, 12], semi_major=[2, 2], semi_minor=[1, 2]
    ... )
    >>> [each.get_xlabel() for each in axes]
    ['time (s)', 'normal load W (N)', 'time (s)', 'normal load W (N)']
    """
    area_by_time, area_by_load, axes_by_time, axes_by_load = axes
    t, W, A, major, minor = broadcast(time, load, area, semi_major, semi_minor)
    phases = np.asarray(phase)
    for panel, x in ((area_by_time, t), (area_by_load, W)):
        _draw(panel, x, A, phases, hollow=synthetic)
        panel.set_ylabel("contact area A (mm²)")
    for panel, x in ((axes_by_time, t), (axes_by_load, W)):
        _draw(panel, x, major, phases, hollow=synthetic)
        _draw(panel, x, minor, phases, hollow=synthetic, named=False)
        panel.set_ylabel("semi-axes (mm)")
    _name(axes_by_time, t, major, r"$\ell_\mathrm{d}$", above=True)
    _name(axes_by_time, t, minor, r"$\ell_\mathrm{e}$", above=False)
    for panel in axes:
        panel.margins(y=0.12)
        panel.set_ylim(bottom=0)
    for panel, label in ((area_by_time, "time (s)"), (axes_by_time, "time (s)")):
        panel.set_xlabel(label)
    for panel in (area_by_load, axes_by_load):
        panel.set_xlabel("normal load W (N)")
        panel.set_xlim(left=min(0.0, float(W.min())) if W.size else 0.0)
    if t.size:
        legend_above(area_by_time, columns=3)
    mark_synthetic(area_by_load, synthetic)
    return axes


@in_style
def plot_area_against_indentation(
    axes: AnyAxes,
    indentation: ArrayLike,
    area: ArrayLike,
    *,
    phase: npt.ArrayLike,
    synthetic: bool = False,
) -> AnyAxes:
    """Draw the contact area of the frames of a press against the measured indentation.

    Parameters
    ----------
    axes : Axes
        Where to draw.
    indentation, area : array_like, shape (n,)
        Indentation (mm) and contact area (mm²) of each frame.
    phase : array_like of str, shape (n,)
        ``loading``, ``hold`` or ``unloading``.
    synthetic : bool
        Whether the frames are rendered: hollow.

    Returns
    -------
    Axes

    Examples
    --------
    >>> from fingerpad.figures import new_figure
    >>> figure, (axes,) = new_figure()
    >>> axes = plot_area_against_indentation(axes, [0.1, 0.4], [9, 32], phase=["loading", "loading"])
    >>> axes.get_xlabel()
    'measured indentation ξ (mm)'
    """
    xi, A = broadcast(indentation, area)
    _draw(axes, xi, A, np.asarray(phase), hollow=synthetic)
    axes.set_xlabel("measured indentation ξ (mm)")
    axes.set_ylabel("contact area A (mm²)")
    axes.margins(y=0.12)
    axes.set_ylim(bottom=0)
    axes.set_xlim(left=min(0.0, float(xi.min())) if xi.size else 0.0)
    if xi.size:
        legend_above(axes, columns=3)
    mark_synthetic(axes, synthetic)
    return axes


def _draw(
    axes: AnyAxes,
    x: FloatArray,
    y: FloatArray,
    phase: npt.NDArray[np.str_],
    *,
    hollow: bool,
    named: bool = True,
) -> None:
    size = 1.8 if x.size > 80 else 3.6
    axes.plot(x, y, color="#c9c9c9", linewidth=0.7, zorder=2)
    for name, colour, marker in _PHASES:
        chosen: BoolArray = phase == name
        if chosen.any():
            axes.plot(
                x[chosen],
                y[chosen],
                marker,
                color=colour,
                markerfacecolor="white" if hollow else colour,
                markersize=size,
                markeredgewidth=0.5 if x.size > 80 else 0.9,
                label=name if named else None,
                zorder=3,
            )


def _name(axes: AnyAxes, x: FloatArray, y: FloatArray, name: str, *, above: bool) -> None:
    """Write the name of a curve above or below its largest value."""
    if x.size:
        k = int(np.argmax(as_float_array(y)))
        axes.annotate(
            name,
            (x[k], y[k]),
            xytext=(0, 4 if above else -4),
            textcoords="offset points",
            ha="center",
            va="bottom" if above else "top",
            fontsize=7.5,
        )
