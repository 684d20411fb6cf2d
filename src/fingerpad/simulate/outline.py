"""Noisy points on the outline of an ellipse."""

import math

import numpy as np

from fingerpad._arrays import FloatArray, check_radians


def outline_points(
    semi_x: float,
    semi_y: float,
    *,
    count: int = 60,
    arc: tuple[float, float] = (0.0, 2 * math.pi),
    centre: tuple[float, float] = (0.0, 0.0),
    angle: float = 0.0,
    noise_std: float = 0.0,
    seed: int = 0,
) -> FloatArray:
    """Return noisy points (x, y) on an arc of an ellipse, in the unit of its semi-axes.

    Parameters
    ----------
    semi_x, semi_y : float
        Semi-axes along x and y before the turn by `angle`.
    count : int
        Number of points, evenly spaced in the parametric angle.
    arc : (float, float)
        First and last parametric angle, radians; the last is left out.
    centre : (float, float)
        Centre (x, y).
    angle : float
        Turn from x towards y, radians.
    noise_std : float
        Standard deviation of each coordinate.
    seed : int
        Of the noise.

    Returns
    -------
    ndarray, shape (count, 2)
        Points (x, y).

    Raises
    ------
    GeometryError
        If an angle is beyond a full turn, as degrees are.

    Examples
    --------
    >>> outline_points(2.0, 1.0, count=4).round(6).tolist()
    [[2.0, 0.0], [0.0, 1.0], [-2.0, 0.0], [-0.0, -1.0]]
    """
    check_radians("angle", angle)
    check_radians("arc", arc)
    t = np.linspace(*arc, count, endpoint=False)
    x, y = semi_x * np.cos(t), semi_y * np.sin(t)
    turned = np.stack(
        [x * math.cos(angle) - y * math.sin(angle), x * math.sin(angle) + y * math.cos(angle)], axis=-1
    )
    return turned + centre + np.random.default_rng(seed).normal(0, noise_std, turned.shape)
