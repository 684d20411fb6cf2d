"""First-order propagation of uncertainty through a model (GUM, clause 5)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.uncertainty.quantities import Inputs, Model, Outputs, check_inputs, covariance_of, evaluate

# The imaginary part of f(x + ih) is h f'(x) + O(h³). Nothing is subtracted, so h may be tiny.
_COMPLEX_STEP = 1e-30
NORMAL_97_5 = 1.959963984540054


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Propagated(Outputs):
    """Outputs of a model by first-order propagation.

    Attributes
    ----------
    names, value, covariance, interval
        As in `Outputs`: values at the inputs' means, their covariance to first order with the second-order
        term of each input, and the intervals of normal outputs.
    inputs : Inputs
        What was propagated.
    jacobian : ndarray, shape (..., m, n)
        Derivative of each output with respect to each input.
    second_order : ndarray, shape (..., m, n)
        Signed standard deviation of each output from the curvature of the model along each input.

    Examples
    --------
    >>> sides = Inputs.of(length=(2.0, 0.03), width=(1.0, 0.02))
    >>> result = propagate(lambda length, width: {"area": length * width}, sides)
    >>> print(f"{result['area']:.3f}", result.jacobian)
    2.000 ± 0.050 [[1. 2.]]
    """

    inputs: Inputs
    jacobian: FloatArray
    second_order: FloatArray

    def budget(self, output: str) -> dict[str, FloatArray]:
        """Return the share of each source in the variance of one output.

        A source takes the variance of its inputs and half of their covariance with others, so that all
        shares sum to one. A share is negative where a correlation reduces the variance.

        Parameters
        ----------
        output : str
            Name of the output.

        Returns
        -------
        dict of str to ndarray, shape (...)
            Shares by the names in ``inputs.groups``; NaN for an output without variance.

        Raises
        ------
        UncertaintyError
            If there is no output of that name.

        Examples
        --------
        >>> sides = Inputs.of(length=(2.0, 0.03), width=(1.0, 0.02))
        >>> budget = propagate(lambda length, width: {"perimeter": 2 * (length + width)}, sides).budget(
        ...     "perimeter"
        ... )
        >>> {name: round(float(share), 3) for name, share in budget.items()}
        {'length': 0.692, 'width': 0.308}
        """
        place = self.place(output)
        row = self.jacobian[..., place, :]
        by_input = row * np.einsum("...ij,...j->...i", self.inputs.covariance, row)
        by_input = by_input + self.second_order[..., place, :] ** 2
        with np.errstate(all="ignore"):
            shares = by_input / by_input.sum(axis=-1, keepdims=True)
        return {
            source: shares[..., self.inputs.places(names)].sum(axis=-1)
            for source, names in self.inputs.groups.items()
        }


@np.errstate(all="ignore")
def propagate(model: Model, inputs: Inputs) -> Propagated:
    r"""Propagate a covariance through `model`, to first order with each input's second-order term.

    :math:`\Sigma_y = J \Sigma_x J^T + \sum_i s_i s_i^T`, with
    :math:`s_i = (f(x + u_i) + f(x - u_i) - 2 f(x))/\sqrt{2}`: GUM Eq. 13 with the second-order term of
    the note to 5.1.2 for each input alone, for normal inputs. The second term matters where
    an output is flat in an input, as the corrected radius is in the elongation of a circular contact.
    The corresponding shift of the mean is not applied.

    Derivatives are taken by complex steps, exact to rounding: the model is called with complex
    arrays, and must be made of analytic functions (no ``abs``, no rounding, comparisons on real parts).

    Parameters
    ----------
    model : callable
        Takes the inputs as keyword arguments and returns a mapping from the names of outputs to arrays,
        elementwise.
    inputs : Inputs
        Best estimates and their covariance; leading axes are propagated all at once.

    Returns
    -------
    Propagated

    Raises
    ------
    UncertaintyError
        If the model takes other inputs, the covariance is not one, or the model drops the imaginary part of
        a complex step.
    GeometryError
        If an input whose name ends in ``_angle`` cannot be one in radians.

    Examples
    --------
    The area of an ellipse:

    >>> import numpy as np
    >>> axes = Inputs.of(
    ...     semi_major=(7.4, 0.1), semi_minor=(5.0, 0.1), correlations={("semi_major", "semi_minor"): 0.9}
    ... )
    >>> result = propagate(
    ...     lambda semi_major, semi_minor: {"area": np.pi * semi_major * semi_minor}, axes
    ... )
    >>> print(f"{result['area']:.1f}")
    116.2 ± 3.8
    """
    check_inputs(model, inputs)
    mean, covariance = inputs.mean, covariance_of(inputs.covariance)
    names, value = evaluate(model, inputs.names, mean)
    steps = inputs.std[..., None, :] * np.eye(mean.shape[-1])
    centre = mean[..., None, :]
    ends = [evaluate(model, inputs.names, centre + sign * steps)[1] for sign in (1, -1)]
    curvature = ends[0] + ends[1] - 2 * value[..., None, :]
    second_order = np.swapaxes(curvature, -1, -2) / np.sqrt(2)
    jacobian = _jacobian(model, inputs)
    propagated = jacobian @ covariance @ np.swapaxes(jacobian, -1, -2)
    propagated += second_order @ np.swapaxes(second_order, -1, -2)
    half = NORMAL_97_5 * np.sqrt(np.diagonal(propagated, axis1=-2, axis2=-1))
    return Propagated(
        names=names,
        value=value,
        covariance=propagated,
        interval=np.stack([value - half, value + half], axis=-1),
        inputs=inputs,
        jacobian=jacobian,
        second_order=second_order,
    )


def _jacobian(model: Model, inputs: Inputs) -> FloatArray:
    """Return the derivative of each output with respect to each input, shape (..., m, n)."""
    steps = 1j * _COMPLEX_STEP * np.eye(inputs.mean.shape[-1])
    _, stepped = evaluate(model, inputs.names, inputs.mean[..., None, :] + steps)
    return np.swapaxes(stepped.imag, -1, -2) / _COMPLEX_STEP
