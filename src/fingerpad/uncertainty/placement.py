"""Placement and curvature of a pad as a model of named quantities."""

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.geometry.ellipsoid import principal_radii_kernel
from fingerpad.geometry.placement import platen_normal_kernel


def placement_model(
    *,
    palmar: FloatArray,
    distal: FloatArray,
    radial_ulnar: FloatArray,
    wedge_angle: FloatArray,
    roll_angle: FloatArray,
) -> dict[str, FloatArray]:
    """Return radii of curvature and the angle u at the place of contact.

    Parameters
    ----------
    palmar, distal, radial_ulnar : ndarray
        Semi-axes of the pad, in any unit.
    wedge_angle, roll_angle : ndarray
        Placement, radians.

    Returns
    -------
    dict of str to ndarray
        ``in_plane_radius``, ``transverse_radius``, ``mean_curvature_radius`` and ``geometric_mean_radius``
        in the unit of the semi-axes, ``u`` in radians.

    Examples
    --------
    >>> from fingerpad.uncertainty import Inputs, propagate
    >>> inputs = Inputs.of(
    ...     palmar=(7.9, 0.1),
    ...     distal=(13.8, 0.1),
    ...     radial_ulnar=(11.8, 0.1),
    ...     wedge_angle=(np.radians(30), np.radians(0.5)),
    ...     roll_angle=0.0,
    ... )
    >>> print(f"{propagate(placement_model, inputs)['mean_curvature_radius']:.2f}")
    13.61 ± 0.18
    """
    normal = platen_normal_kernel(wedge_angle, roll_angle)
    in_plane, transverse = principal_radii_kernel(palmar, distal, radial_ulnar, normal=normal)
    x, y = palmar * normal[..., 0], distal * normal[..., 1]
    return {
        "in_plane_radius": in_plane,
        "transverse_radius": transverse,
        "mean_curvature_radius": 2 / (1 / in_plane + 1 / transverse),
        "geometric_mean_radius": np.sqrt(in_plane * transverse),
        "u": 2 * np.arctan(y / (x + np.sqrt(x * x + y * y))),  # arctan2, for complex steps too
    }
