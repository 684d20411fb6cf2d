"""First-order propagation of uncertainty through any model of arrays (GUM, clause 5)."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, floats

# Central differences err by step² from curvature and by eps/step from rounding: the cube root balances them.
_RELATIVE_STEP = np.finfo(float).eps ** (1 / 3)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FirstOrder:
    """Values of a model with their first-order uncertainty.

    Attributes
    ----------
    value : ndarray, shape (..., m)
        The model at the inputs' means.
    covariance : ndarray, shape (..., m, m)
        J Σ Jᵀ.
    jacobian : ndarray, shape (..., m, n)
        Derivative of each output by each input.
    """

    value: FloatArray
    covariance: FloatArray
    jacobian: FloatArray

    @property
    def std(self) -> FloatArray:
        """Standard uncertainty of each output, shape (..., m)."""
        return np.sqrt(np.diagonal(self.covariance, axis1=-2, axis2=-1))


def first_order(
    model: Callable[[FloatArray], FloatArray], mean: ArrayLike, covariance: ArrayLike
) -> FirstOrder:
    r"""Propagate a covariance through `model`, :math:`\Sigma_y = J \Sigma_x J^T` (GUM Eq. 13).

    Parameters
    ----------
    model : callable
        Maps inputs of shape (..., n) to outputs of shape (..., m), elementwise over the leading axes.
    mean : array_like, shape (..., n)
        Best estimates of the inputs.
    covariance : array_like, shape (..., n, n)
        Their covariance.

    Returns
    -------
    FirstOrder
        Outputs, their covariance, and the Jacobian, which is taken by central differences.

    Examples
    --------
    The area of an ellipse whose axes are known to 1 and 2 %, through one shared scale to 3 %:

    >>> import numpy as np
    >>> mean = np.array([7.4, 5.0])
    >>> relative = np.diag([0.01**2, 0.02**2]) + 0.03**2
    >>> area = first_order(lambda x: np.pi * x.prod(-1, keepdims=True), mean, relative * np.outer(mean, mean))
    >>> print(f"{area.value[0]:.1f} ± {area.std[0]:.1f}")
    116.2 ± 7.4
    """
    mean, covariance = floats(mean), floats(covariance)
    value = model(mean)
    n = mean.shape[-1]
    step = _RELATIVE_STEP * np.maximum(np.abs(mean), np.sqrt(np.diagonal(covariance, axis1=-2, axis2=-1)))
    step = np.where(step > 0, step, _RELATIVE_STEP)
    moves = step[..., None, :] * np.eye(n)
    upper, lower = mean[..., None, :] + moves, mean[..., None, :] - moves
    width = np.diagonal(upper - lower, axis1=-2, axis2=-1)
    jacobian = np.swapaxes((model(upper) - model(lower)) / width[..., None], -1, -2)
    propagated = jacobian @ covariance @ np.swapaxes(jacobian, -1, -2)
    return FirstOrder(value=value, covariance=propagated, jacobian=jacobian)
