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
    """Return noisy points (x, y), evenly spaced in the parametric angle, on an arc of an ellipse.

    `arc` is first and last angle, the last left out; `angle` the turn from x towards y, radians.
    """
    check_radians("angle", angle)
    check_radians("arc", arc)
    t = np.linspace(*arc, count, endpoint=False)
    x, y = semi_x * np.cos(t), semi_y * np.sin(t)
    turned = np.stack(
        [x * math.cos(angle) - y * math.sin(angle), x * math.sin(angle) + y * math.cos(angle)], axis=-1
    )
    return turned + centre + np.random.default_rng(seed).normal(0, noise_std, turned.shape)
