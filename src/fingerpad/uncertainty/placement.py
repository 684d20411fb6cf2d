"""Where a pad touches the platen and how it is curved there, as one function of arrays."""

from typing import Final

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.geometry.ellipsoid import principal_radii_kernel
from fingerpad.geometry.placement import platen_normal_kernel

PLACEMENT_INPUTS: Final = ("palmar", "distal", "radial_ulnar", "wedge_angle", "roll_angle")
PLACEMENT_OUTPUTS: Final = (
    "in_plane_radius",
    "transverse_radius",
    "mean_curvature_radius",
    "geometric_mean_radius",
    "u",
)


def placement_model(inputs: FloatArray) -> FloatArray:
    """Return radii and the angle u at the place of contact, from `PLACEMENT_INPUTS` along the last axis.

    Any way of propagating uncertainty can take it; lengths in any unit, angles in radians.

    Examples
    --------
    >>> outputs = placement_model(np.array([7.9, 13.8, 11.8, np.radians(30), 0.0]))
    >>> dict(zip(PLACEMENT_OUTPUTS, outputs.round(2).tolist()))["mean_curvature_radius"]
    13.61
    >>> print(f"{np.degrees(outputs[-1]):.1f}")
    45.2
    """
    palmar, distal, radial_ulnar, wedge, roll = np.moveaxis(inputs, -1, 0)
    normal = platen_normal_kernel(wedge, roll)
    radii = principal_radii_kernel(palmar, distal, radial_ulnar, normal=normal)
    in_plane, transverse = np.moveaxis(radii, -1, 0)
    x, y = palmar * normal[..., 0], distal * normal[..., 1]
    u = 2 * np.arctan(y / (x + np.sqrt(x * x + y * y)))  # arctan2, for complex steps too
    mean, geometric = 2 / (1 / in_plane + 1 / transverse), np.sqrt(in_plane * transverse)
    return np.stack([in_plane, transverse, mean, geometric, u], axis=-1)
