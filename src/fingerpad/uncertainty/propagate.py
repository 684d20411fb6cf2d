"""Propagation of uncertainty through any model of arrays (GUM, clause 5)."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, floats

# Central differences err by step² from curvature and by eps/step from rounding: the cube root balances them.
_RELATIVE_STEP = np.finfo(float).eps ** (1 / 3)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Propagated:
    """Values of a model with their uncertainty.

    Attributes
    ----------
    value : ndarray, shape (..., m)
        The model at the inputs' means.
    covariance : ndarray, shape (..., m, m)
        First-order covariance, with the second-order term of each input.
    jacobian : ndarray, shape (..., m, n)
        Derivative of each output by each input.
    second_order : ndarray, shape (..., m, n)
        Signed standard deviation of each output from the curvature of the model along each input.
    """

    value: FloatArray
    covariance: FloatArray
    jacobian: FloatArray
    second_order: FloatArray

    @property
    def std(self) -> FloatArray:
        """Standard uncertainty of each output, shape (..., m)."""
        return np.sqrt(np.diagonal(self.covariance, axis1=-2, axis2=-1))


@np.errstate(all="ignore")
def propagate(
    model: Callable[[FloatArray], FloatArray], mean: ArrayLike, covariance: ArrayLike
) -> Propagated:
    r"""Propagate a covariance through `model`, to first order and where that vanishes to second.

    :math:`\Sigma_y = J \Sigma_x J^T + \sum_i s_i s_i^T`, with
    :math:`s_i = (f(x + u_i) + f(x - u_i) - 2 f(x))/\sqrt{2}`: GUM Eq. 13 with the second-order term of
    the note to 5.1.2 for each input by itself, as normal inputs have it. The second term matters where
    an output is flat in an input, as the corrected radius is in the elongation of a circular contact.
    The shift of the mean that goes with it is not applied.

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
    Propagated
        Outputs and their covariance. Derivatives are taken by differences.

    Examples
    --------
    The area of an ellipse whose axes are known to 1 and 2 %, through one shared scale to 3 %:

    >>> import numpy as np
    >>> mean = np.array([7.4, 5.0])
    >>> relative = np.diag([0.01**2, 0.02**2]) + 0.03**2
    >>> area = propagate(lambda x: np.pi * x.prod(-1, keepdims=True), mean, relative * np.outer(mean, mean))
    >>> print(f"{area.value[0]:.1f} ± {area.std[0]:.1f}")
    116.2 ± 7.4
    """
    mean, covariance = floats(mean), floats(covariance)
    value = model(mean)
    std = np.sqrt(np.diagonal(covariance, axis1=-2, axis2=-1))
    step = _RELATIVE_STEP * np.maximum(np.abs(mean), std)
    upper, lower, width = _moved(model, mean, np.where(step > 0, step, _RELATIVE_STEP))
    jacobian = np.swapaxes((upper - lower) / width[..., None], -1, -2)
    upper, lower, _ = _moved(model, mean, std)
    second_order = np.swapaxes(upper + lower - 2 * value[..., None, :], -1, -2) / np.sqrt(2)
    propagated = jacobian @ covariance @ np.swapaxes(jacobian, -1, -2)
    propagated += second_order @ np.swapaxes(second_order, -1, -2)
    return Propagated(value=value, covariance=propagated, jacobian=jacobian, second_order=second_order)


def _moved(
    model: Callable[[FloatArray], FloatArray], mean: FloatArray, step: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the model with each input moved up and down, and the width between the two."""
    moves = step[..., None, :] * np.eye(mean.shape[-1])
    upper, lower = mean[..., None, :] + moves, mean[..., None, :] - moves
    return model(upper), model(lower), np.diagonal(upper - lower, axis1=-2, axis2=-1)
