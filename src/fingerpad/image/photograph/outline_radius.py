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
# Where the curvature changes fast, a wider window and a higher degree show other radii: so much of
# each difference is added.
_WIDER, _HIGHER, _OF_DIFFERENCE = 0.5, 5, 0.55
# What the finger's axis may be off the ellipse's beyond the latter's own uncertainty: no finger is one.
_AXIS_STD: Final = math.radians(2.5)
# Points on so much of the window, on either side, and so many of them, are needed.
_SHARE: Final = 0.85
_MIN_POINTS: Final = 20
_ROUNDS: Final = 8
_MAX_CHANGE: Final = 1.5

NOT_SHOWN: Final = (math.nan, math.nan)
_UNSEEN: Final = (math.nan, math.nan, math.nan)


class _Ellipse:
    """An ellipse as height over its tangent at the place of a normal."""

    def __init__(self, semi_axes: tuple[float, float], frame: FloatArray) -> None:
        # w'Qw = 1 with w = (along, out).
        quadric = frame @ np.diag(1 / np.square(semi_axes)) @ frame.T
        (self._p, self._q), (_, self._r) = quadric
        support = math.sqrt(self._p / np.linalg.det(quadric))
        self._place = -self._q * support / self._p
        self._support = support
        self.radius = self._r * support / self._p - self._q**2 * support / self._p**2
        steps = 0.02 * self.radius * np.array([-2, -1, 1, 2])
        self.third = float(self.height(steps) @ [-0.5, 1, -1, 0.5]) / (0.02 * self.radius) ** 3

    def height(self, along: FloatArray) -> FloatArray:
        """Return the height, zero at the place; NaN beyond the ellipse."""
        u = along + self._place
        with np.errstate(invalid="ignore"):
            root = np.sqrt(np.square(self._q * u) - self._r * (self._p * u**2 - 1))
        return np.asarray((root - self._q * u) / self._r - self._support)


def radius_of_outline(
    points: FloatArray, semi_axes: tuple[float, float], angle: float, angle_std: float
) -> tuple[float, float]:
    """Return the radius of curvature where the outward normal has an angle, and its standard uncertainty.

    In the frame of the normal, a cubic is fitted to the distance of the outline from the ellipse within 0.35
    radii on either side of the place where the outline's slope vanishes.

    Parameters
    ----------
    points : ndarray, (n, 2)
        Points (x, y) of the outline, in order, in the frame of the ellipse.
    semi_axes : (float, float)
        Semi-axes of the ellipse along x and y.
    angle, angle_std : float
        Angle of the normal from x towards y and its standard uncertainty, radians.

    Returns
    -------
    (float, float)
        In the unit of the points; NaN where the outline does not show the place.
    """
    if len(points) < _MIN_POINTS:
        return NOT_SHOWN
    frame = np.array([[-math.sin(angle), math.cos(angle)], [math.cos(angle), math.sin(angle)]])
    seen, ellipse = points @ frame.T, _Ellipse(semi_axes, frame)
    radius, noise, third = _fitted(seen, ellipse, _WINDOW, _DEGREE)
    if math.isnan(radius):
        return NOT_SHOWN
    others = [_fitted(seen, ellipse, _WIDER, degree)[0] for degree in (_DEGREE, _HIGHER)]
    changes = [_OF_DIFFERENCE * math.log(one / radius) for one in others if math.isfinite(one)]
    turn = third * radius**2 * math.hypot(angle_std, _AXIS_STD)
    return radius, radius * math.hypot(noise * radius, turn, _MISSED_STD, *changes)


def _fitted(seen: FloatArray, ellipse: _Ellipse, window: float, degree: int) -> tuple[float, float, float]:
    """Return the radius, the standard uncertainty of the curvature, the third derivative; or NaN."""
    along, out = seen.T
    place, radius = float(along[out.argmax()]), ellipse.radius
    for _ in range(_ROUNDS):
        half = window * radius
        near = (np.abs(along - place) < half) & (out > out.max() - half)
        s = (along[near] - place) / half
        if near.sum() < _MIN_POINTS or s.min() > -_SHARE or s.max() < _SHARE:
            return _UNSEEN
        off = out[near] - ellipse.height(s * half)
        if not np.isfinite(off).all():
            return _UNSEEN
        curve = np.polynomial.Polynomial.fit(s, off, degree, domain=[-1, 1])
        # The place moves by one step of Newton's method on the slope.
        slope, bend = float(curve.deriv(1)(0)), float(curve.deriv(2)(0)) - half**2 / ellipse.radius
        if not bend < 0:
            return _UNSEEN
        top = float(np.clip(-slope / bend, -0.5, 0.5))
        place += top * half
        before, radius = radius, float(np.clip(-(half**2) / bend, radius / _MAX_CHANGE, radius * _MAX_CHANGE))
        if abs(radius / before - 1) < 0.01 and abs(top) < 0.02:
            break
    design = np.vander(s, degree + 1, increasing=True)
    left = off - curve(s)
    freedom = max(len(left) / correlation_length(left, np.arange(len(left))) - degree - 1, 2)
    noise = 2 * math.sqrt(np.linalg.inv(design.T @ design)[2, 2] * float(left @ left) / freedom) / half**2
    return radius, noise, float(curve.deriv(3)(0)) / half**3 + ellipse.third
