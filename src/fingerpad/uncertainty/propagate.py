"""First-order propagation of uncertainty through any model of arrays (GUM, clause 5)."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array
from fingerpad.exceptions import UncertaintyError
from fingerpad.uncertainty.covariance import covariance_of

# Inputs of shape (..., n) to outputs of shape (..., m), elementwise over the leading axes.
Model: TypeAlias = Callable[[FloatArray], FloatArray]

# The imaginary part of f(x + ih) is h f'(x) + O(h³). Nothing is subtracted, so h may be tiny.
_COMPLEX_STEP = 1e-30


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

    @property
    def interval(self) -> FloatArray:
        """Lower and upper ends of the 95 % interval of a normal output, shape (..., m, 2)."""
        half = 1.959963984540054 * self.std
        return np.stack([self.value - half, self.value + half], axis=-1)


@np.errstate(all="ignore")
def propagate(model: Model, mean: ArrayLike, covariance: ArrayLike) -> Propagated:
    r"""Propagate a covariance through `model`, to first order and where that vanishes to second.

    :math:`\Sigma_y = J \Sigma_x J^T + \sum_i s_i s_i^T`, with
    :math:`s_i = (f(x + u_i) + f(x - u_i) - 2 f(x))/\sqrt{2}`: GUM Eq. 13 with the second-order term of
    the note to 5.1.2 for each input by itself, as normal inputs have it. The second term matters where
    an output is flat in an input, as the corrected radius is in the elongation of a circular contact.
    The shift of the mean that goes with it is not applied.

    The derivatives are those of complex steps, exact to rounding: the model is called with complex
    arrays, and must be made of analytic functions (no ``abs``, no rounding, comparisons on real parts).

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

    Raises
    ------
    UncertaintyError
        If `covariance` is none, or the model drops the imaginary part of a complex step.

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
    mean, covariance = as_float_array(mean), covariance_of(covariance)
    value = model(mean)
    std = np.sqrt(np.diagonal(covariance, axis1=-2, axis2=-1))
    moves = std[..., None, :] * np.eye(mean.shape[-1])
    centre = mean[..., None, :]
    bent = model(centre + moves) + model(centre - moves) - 2 * value[..., None, :]
    second_order = np.swapaxes(bent, -1, -2) / np.sqrt(2)
    jacobian = _jacobian(model, mean)
    propagated = jacobian @ covariance @ np.swapaxes(jacobian, -1, -2)
    propagated += second_order @ np.swapaxes(second_order, -1, -2)
    return Propagated(value=value, covariance=propagated, jacobian=jacobian, second_order=second_order)


def _jacobian(model: Model, mean: FloatArray) -> FloatArray:
    """Return the derivative of each output by each input, shape (..., m, n), by complex steps."""
    stepped = model(mean[..., None, :] + 1j * _COMPLEX_STEP * np.eye(mean.shape[-1]))
    if not np.iscomplexobj(stepped):
        raise UncertaintyError(
            "the model returns real numbers for complex steps: leave out abs, real and rounding, "
            "or propagate by Monte Carlo"
        )
    return np.swapaxes(stepped.imag, -1, -2) / _COMPLEX_STEP
