"""Stress under a point load: the second implementation behind all stresses."""

import numpy as np

from fingerpad._arrays import FloatArray


def point_load_stress(x: FloatArray, y: FloatArray, z: FloatArray, poisson_ratio: float) -> FloatArray:
    """Boussinesq's stress under a unit force (Johnson 1985, Eq. 3.20)."""
    r, loss = np.sqrt(x**2 + y**2 + z**2), 1 - 2 * poisson_ratio
    plane = np.array([[x * x, x * y], [x * y, y * y]])
    eye = np.eye(2)[:, :, None, None]
    stress = np.empty((3, 3, *r.shape))
    stress[:2, :2] = loss * (
        eye * (z / r**3 - 1 / (r * (r + z))) + plane * (2 * r + z) / (r**3 * (r + z) ** 2)
    )
    stress[:2, :2] -= 3 * plane * z / r**5
    stress[0, 2] = stress[2, 0] = -3 * x * z**2 / r**5
    stress[1, 2] = stress[2, 1] = -3 * y * z**2 / r**5
    stress[2, 2] = -3 * z**3 / r**5
    return stress / (2 * np.pi)
