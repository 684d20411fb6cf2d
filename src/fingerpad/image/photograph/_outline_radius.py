"""The radius of curvature of an outline itself, at the place where its normal has a given angle."""

import math
from typing import Final

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.image._correlation import correlation_length

# Half of the window, in radii of curvature, and the degree of the polynomial in it: chosen on outlines of
# known radius (benchmarks/finger_shapes.py). What changes of curvature in the window leave unknown.
_WINDOW: Final = 0.35
_DEGREE: Final = 3
_MISSED_STD: Final = 0.04
# Points on so much of the window, on either side, and so many of them, are needed.
_SHARE: Final = 0.85
_MIN_POINTS: Final = 20
_ROUNDS: Final = 8
_MAX_CHANGE: Final = 1.5

NOT_SHOWN: Final = (math.nan, math.nan)


def radius_of_outline(
    points: FloatArray, angle: float, angle_std: float, guess: float
) -> tuple[float, float]:
    """Return the radius of curvature where the outward normal has an angle, and its standard uncertainty.

    In the frame of the normal, a cubic is fitted to the outline within 0.35 radii on either side of the place
    where its slope vanishes.

    Parameters
    ----------
    points : ndarray, (n, 2)
        Points (x, y) of the outline, in order.
    angle, angle_std : float
        Angle of the normal from x towards y and its standard uncertainty, radians.
    guess : float
        Radius to start from.

    Returns
    -------
    (float, float)
        In the unit of the points; NaN where the outline does not show the place.
    """
    if len(points) < _MIN_POINTS:
        return NOT_SHOWN
    along = points @ np.array([-math.sin(angle), math.cos(angle)])
    out = points @ np.array([math.cos(angle), math.sin(angle)])
    place, radius = float(along[out.argmax()]), guess
    for _ in range(_ROUNDS):
        half = _WINDOW * radius
        near = (np.abs(along - place) < half) & (out > out.max() - half)
        s, height = (along[near] - place) / half, out[near]
        if near.sum() < _MIN_POINTS or s.min() > -_SHARE or s.max() < _SHARE:
            return NOT_SHOWN
        curve = np.polynomial.Polynomial.fit(s, height, _DEGREE, domain=[-1, 1])
        roots = np.asarray(curve.deriv().roots(), dtype=np.complex128)
        tops = roots.real[(np.abs(roots.imag) < 1e-9) & (np.abs(roots) < 1)].tolist()
        bend = [float(-curve.deriv(2)(top)) / half**2 for top in tops]
        if not bend or not max(bend) > 0:
            return NOT_SHOWN
        top, curvature = tops[int(np.argmax(bend))], max(bend)
        place += top * half
        found, before = 1 / curvature, radius
        radius = min(max(found, before / _MAX_CHANGE), before * _MAX_CHANGE)
        if abs(radius / before - 1) < 0.01 and abs(top) < 0.02:
            break
    design = np.vander(s, _DEGREE + 1, increasing=True)
    off = height - curve(s)
    alike = correlation_length(off, np.arange(len(off)))
    freedom = max(len(off) / alike - _DEGREE - 1, 2)
    variance = float(off @ off) / freedom
    bending = np.array([0, 0, 2, 6 * top]) / half**2
    noise = float(bending @ np.linalg.solve(design.T @ design, bending)) * variance * radius**2
    turn = float(curve.deriv(3)(top)) / half**3 * radius**2 * angle_std
    return radius, radius * math.sqrt(noise + turn**2 + _MISSED_STD**2)
