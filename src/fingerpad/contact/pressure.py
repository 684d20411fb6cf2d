"""The pressure of a frictionless contact on one grid.

It is nowhere negative, positive only where the gap is closed, and there the gap is the same throughout: the
conjugate gradients of Polonsky and Keer (1999), which drop cells that come under tension and take up cells
that overlap. Preconditioned by the inverse of the periodic convolution they need some ten steps on any grid.
"""

import numpy as np

from fingerpad._arrays import BoolArray, FloatArray
from fingerpad.contact.influence import Convolution
from fingerpad.exceptions import ConvergenceError

_TOLERANCE = 1e-7  # of the gap left in contact, over the indentation
_STEPS = 400


def solve_pressure(
    convolution: Convolution,
    gap: FloatArray,
    start: FloatArray,
    *,
    total: float | None = None,
    indentation: float | None = None,
) -> tuple[FloatArray, float]:
    """Return the pressure over E* and the indentation.

    Exactly one of `total`, the sum of the pressures, and `indentation` is given. `gap` is that of the
    undeformed surfaces, `start` a first guess of the pressure in any unit, positive somewhere.
    """
    pressure = _scaled(start, convolution, gap, total, indentation)
    search: FloatArray | None = None
    for _ in range(_STEPS):
        if search is None:  # cells came or went: what follows holds for these
            touching = pressure > 0
            if not touching.any():
                raise ConvergenceError(
                    "the pressure vanished everywhere: check the gap, thickness and indentation"
                )
            displacement = convolution.apply(pressure)
            uniform = _inverse_on(touching, touching.astype(float), convolution)
            before = 1.0
        residual = displacement + gap
        step = _inverse_on(touching, residual, convolution)
        # Of all steps, the one that changes no load, or the one towards the given indentation.
        approach = float(step.sum() / uniform.sum()) if indentation is None else indentation
        step -= approach * uniform
        residual -= approach
        overlapping = ~touching & (residual < 0)
        left = float(np.abs(residual[touching]).max()) / abs(approach)
        if left < _TOLERANCE and not overlapping.any():
            return pressure, approach
        descent = float(np.sum(residual * step))
        search = step if search is None else step + descent / before * search
        response = convolution.apply(search)
        length = descent / float(np.sum(search * response))
        pressure = pressure - length * search
        displacement -= length * response
        before = descent
        if overlapping.any() or (pressure < 0).any():
            pressure = np.maximum(pressure, 0)
            pressure[overlapping] = -0.5 * residual[overlapping] / convolution.centre
            if total is not None:
                pressure *= total / pressure.sum()
            search = None
    raise ConvergenceError(
        f"the contact pressure did not converge in {_STEPS} steps: "
        f"the gap left in contact is {left:.1e} of the indentation"
    )


def _inverse_on(touching: BoolArray, field: FloatArray, convolution: Convolution) -> FloatArray:
    """Return the preconditioned field, of the touching cells alone."""
    return np.where(touching, convolution.approximate_inverse(np.where(touching, field, 0.0)), 0.0)


def _scaled(
    start: FloatArray,
    convolution: Convolution,
    gap: FloatArray,
    total: float | None,
    indentation: float | None,
) -> FloatArray:
    """Return the first guess, scaled to the load or to least energy at the indentation."""
    if indentation is None:
        assert total is not None
        return start * (total / float(start.sum()))
    work = float(np.sum(start * (indentation - gap)))
    if not work > 0:  # the guess is far too wide
        start = np.maximum(indentation - gap, 0)
        work = float(np.sum(start * (indentation - gap)))
    if not work > 0:
        raise ConvergenceError(f"the gap exceeds the indentation of {indentation:g} on the whole grid")
    scale = work / float(np.sum(start * convolution.apply(start)))
    return start * scale
