"""Covariance matrices: validation and square roots."""

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array, check_all
from fingerpad.exceptions import UncertaintyError

# Rounding may leave the smallest eigenvalue of a correlation matrix below zero by this much.
_ROUNDING = 1e-9


def covariance_of(value: ArrayLike) -> FloatArray:
    """Return `value` as covariance matrices, validated.

    Parameters
    ----------
    value : array_like, shape (..., n, n)
        One matrix or several.

    Returns
    -------
    ndarray, shape (..., n, n)

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
    """Return F with F Fᵀ = `covariance`, which may be singular.

    In units of the standard deviations F is the symmetric root, which does not depend on the order of the
    inputs. Negative eigenvalues are taken to be zero, as those that rounding leaves.

    Parameters
    ----------
    covariance : ndarray, shape (..., n, n)
        One matrix or several.

    Returns
    -------
    ndarray, shape (..., n, n)
        NaN where a matrix is not finite.

    Examples
    --------
    >>> covariance_root(np.array([[4.0, 0.0], [0.0, 9.0]]))
    array([[2., 0.],
           [0., 3.]])
    """
    finite = np.isfinite(covariance).all(axis=(-2, -1), keepdims=True)
    clean = np.where(finite, covariance, 0.0)
    variance = np.diagonal(clean, axis1=-2, axis2=-1)
    unit = np.sqrt(np.where(variance > 0, variance, 1.0))
    size, direction = np.linalg.eigh(clean / (unit[..., :, None] * unit[..., None, :]))
    root = direction * np.sqrt(np.maximum(size, 0))[..., None, :] @ np.swapaxes(direction, -1, -2)
    return np.where(finite, unit[..., :, None] * root, np.nan)
