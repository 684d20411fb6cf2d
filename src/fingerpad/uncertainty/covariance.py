"""Covariance matrices: what makes one, its factors, and the groups of inputs that vary together."""

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array, check_all
from fingerpad.exceptions import UncertaintyError

# Rounding may leave the smallest eigenvalue of a correlation matrix below zero by this much.
_ROUNDING = 1e-9


def covariance_of(value: ArrayLike) -> FloatArray:
    """Return `value` as covariance matrices, shape (..., n, n), or refuse it.

    Raises
    ------
    UncertaintyError
        If a matrix is not square, finite or symmetric, has a negative variance, a correlation outside
        [−1, 1], or is not positive semidefinite.

    Examples
    --------
    >>> covariance_of([[1.0, 0.5], [0.5, 1.0]]).shape
    (2, 2)
    """
    covariance = as_float_array(value)
    if covariance.ndim < 2 or covariance.shape[-1] != covariance.shape[-2]:
        raise UncertaintyError(f"a covariance must be square, found the shape {covariance.shape}")
    variance = np.diagonal(covariance, axis1=-2, axis2=-1)
    check_all(np.isfinite(covariance), "covariance", covariance, "finite", UncertaintyError)
    check_all(variance >= 0, "variance", variance, "positive or zero", UncertaintyError)
    std = np.sqrt(variance)
    scale = std[..., :, None] * std[..., None, :]
    other = np.swapaxes(covariance, -1, -2)
    symmetric = np.abs(covariance - other) <= _ROUNDING * (scale + np.abs(covariance))
    check_all(symmetric, "covariance", covariance, "symmetric", UncertaintyError)
    correlation = np.divide(covariance, scale, out=np.where(covariance == 0, 0.0, np.inf), where=scale > 0)
    check_all(
        np.abs(correlation) <= 1 + _ROUNDING, "correlation", correlation, "within [-1, 1]", UncertaintyError
    )
    smallest = np.linalg.eigvalsh(correlation)[..., :1]
    check_all(
        smallest >= -_ROUNDING * covariance.shape[-1],
        "smallest eigenvalue of the correlations",
        smallest,
        "positive or zero (a covariance is positive semidefinite)",
        UncertaintyError,
    )
    return covariance


def covariance_root(covariance: FloatArray) -> FloatArray:
    """Return F with F Fᵀ = `covariance`, which may be singular, shape (..., n, n).

    In units of the standard deviations F is the symmetric root, the same for the same matrix wherever it
    stands.
    """
    std = np.sqrt(np.diagonal(covariance, axis1=-2, axis2=-1))
    unit = np.where(std > 0, std, 1.0)
    size, direction = np.linalg.eigh(covariance / (unit[..., :, None] * unit[..., None, :]))
    root = direction * np.sqrt(np.maximum(size, 0))[..., None, :] @ np.swapaxes(direction, -1, -2)
    factor: FloatArray = unit[..., :, None] * root
    return factor
