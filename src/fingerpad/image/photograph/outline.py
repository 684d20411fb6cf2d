"""What a face's outline tells without an ellipse: its lengths, and its radius of curvature."""

import math
from typing import Final, NamedTuple

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array
from fingerpad.image.ellipse_fit import correlation_length
from fingerpad.image.photograph.calibration import LENGTHS, RADIUS
from fingerpad.image.photograph.faces import Face

# Points are too few below this, and a place is found in so many rounds.
_MIN_POINTS_OF_LENGTHS, _MIN_POINTS_OF_RADIUS, _ROUNDS = 12, 20, 8
# Shares of half of the width at which the height of the tip is read where the shaft hides the widest place.
_WIDTHS: Final = (0.95, 0.97, 0.98)
# Changes of the radius in one round, at most.
_MAX_CHANGE: Final = 1.5

_UNSEEN: Final = (math.nan, math.nan, math.nan)


def contradicted_by_lengths(
    face: Face,
    points: FloatArray,
    semi_axes: FloatArray,
    *,
    pad: FloatArray,
    tilt_std: float,
    ellipse: float = 1.0,
) -> FloatArray:
    """Return by how much, relatively, an outline's lengths differ from semi-axes beyond chance.

    The ellipse follows an arc. Where the outline beyond it reaches farther than the ellipse, or less far,
    nothing tells which of the two is the pad. Zero where the outline does not show a length.

    Points (x, y) are about the ellipse's centre, in order, along its axes: of a palmar face with the shaft,
    in `pad` those that can be pad. The ellipse's axis has the standard uncertainty `tilt_std`, radians; it
    describes the pad's arc with the probability `ellipse`.
    """
    if len(points) < _MIN_POINTS_OF_LENGTHS:
        return np.zeros(2)
    across, along = semi_axes
    if face in ("radial", "ulnar"):
        lengths = _side_lengths(points, across, along)
        axis = math.hypot(tilt_std, LENGTHS.side_axis_std)
        own = LENGTHS.side_across_std, LENGTHS.side_along_std
        stds = np.hypot(own, np.array([across / along, along / across]) * axis)
    else:
        width = half_width(points, pad, across, along, face)
        lengths = _front_lengths(points, across, along, width)
        shaft = (1 + (LENGTHS.hidden - 1) * ellipse) * width.hidden / across
        own = LENGTHS.front_across_std, LENGTHS.front_along_std
        stds = np.hypot(own, np.array([1, LENGTHS.height_by_width]) * shaft)
    return beyond_chance(np.nan_to_num(lengths / semi_axes - 1), stds)


def beyond_chance(off: ArrayLike, std: ArrayLike) -> FloatArray:
    """Return what chance does not explain of a difference: all of a large one, little of a small one."""
    off, std = as_float_array(off), as_float_array(std)
    return np.asarray(off**3 / (off**2 + std**2))


class HalfWidth(NamedTuple):
    """Half of an outline's width at the pad's widest place."""

    value: float
    hidden: float  # how much is not seen, for the shaft that is wider or because the outline ends above
    middle: float  # x of the place midway between the sides


def half_width(points: FloatArray, pad: FloatArray, across: float, along: float, face: Face) -> HalfWidth:
    """Return half of an outline's width; arguments are those of `contradicted_by_lengths`.

    Of a palmar face the widest place lies at the ellipse's centre or above: below, the shaft may be wider
    than the pad. How much wider it is beyond what is common, is the pad's.
    """
    top = int(points[:, 1].argmax())
    way = math.copysign(1, points[-1, 0] - points[0, 0])
    ends, hidden = [], 0.0
    for sign, side in ((way, slice(top, None)), (-way, slice(top, None, -1))):
        x, y = sign * points[side, 0], np.minimum.accumulate(points[side, 1])
        short = min(max(float(y[-1]) / along, 0.0), 1.0)
        missing = across * (1 - math.sqrt(1 - short**2))
        widest = np.maximum.accumulate(x)
        shown = float(np.interp(0.0, -y, widest) if face == "palmar" else widest[-1])
        ends.append(sign * (shown + missing))
        hidden += missing / 2
    value = abs(ends[0] - ends[1]) / 2
    more = max(float(np.ptp(pad[:, 0])) / 2 - value, 0.0) if face == "palmar" and len(pad) else 0.0
    more_pad = float(beyond_chance(more, LENGTHS.shaft * across))
    return HalfWidth(value + more_pad, hidden + more - more_pad, sum(ends) / 2)


def _side_lengths(points: FloatArray, across: float, along: float) -> FloatArray:
    """Return how far the palmar side lies from the tip, and the tip from the palmar side."""
    tip_x, tip_y = _turning_point(points, across**2 / along)
    side_y, side_x = _turning_point(points[:, ::-1], along**2 / across)
    return np.array([side_x - tip_x, tip_y - side_y])


def _front_lengths(points: FloatArray, across: float, along: float, width: HalfWidth) -> FloatArray:
    """Return half of the width and the height of the tip above the widest place.

    The shaft hides that place: its height is that of an ellipse through the places of nearly that width.
    """
    tip_y = _turning_point(points, across**2 / along)[1]
    x = points[:, 0] - width.middle
    top = int(points[:, 1].argmax())
    heights = []
    for side in (slice(top, None), slice(top, None, -1)):
        out, y = np.maximum.accumulate(np.abs(x[side])), points[side, 1]
        for share in _WIDTHS:
            at = float(np.interp(share * width.value, out, y))
            heights.append((tip_y - at) / (1 - math.sqrt(1 - share**2)))
    return np.array([width.value, np.mean(heights)])


def _turning_point(points: FloatArray, radius: float) -> tuple[float, float]:
    """Return x and y of the place where y is greatest, NaN where the outline does not show it."""
    x, y = points.T
    place, half = float(x[y.argmax()]), LENGTHS.window * radius
    for _ in range(_ROUNDS):
        near = (np.abs(x - place) < half) & (y > y.max() - half)
        s = (x[near] - place) / half
        if near.sum() < _MIN_POINTS_OF_LENGTHS or s.min() > -LENGTHS.seen or s.max() < LENGTHS.seen:
            return _UNSEEN[:2]
        curve = np.polynomial.Polynomial.fit(s, y[near], 3, domain=[-1, 1])
        slope, bend = float(curve.deriv(1)(0)), float(curve.deriv(2)(0))
        if not bend < 0:
            return _UNSEEN[:2]
        step = float(np.clip(-slope / bend, -0.4, 0.4))
        place += step * half
        if abs(step) < 0.01:
            break
    return place, float(curve(step))


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

    In the frame of the normal, a cubic is fitted to the outline's distance from the ellipse about the place
    where its slope vanishes; NaN where that is not shown. Points (x, y) are in order, in the ellipse's frame.
    """
    if len(points) < _MIN_POINTS_OF_RADIUS:
        return _UNSEEN[:2]
    frame = np.array([[-math.sin(angle), math.cos(angle)], [math.cos(angle), math.sin(angle)]])
    seen, ellipse = points @ frame.T, _Ellipse(semi_axes, frame)
    radius, noise, third = _fit_radius(seen, ellipse, RADIUS.window, RADIUS.degree)
    if math.isnan(radius):
        return _UNSEEN[:2]
    degrees = (RADIUS.degree, RADIUS.higher)
    others = (_fit_radius(seen, ellipse, RADIUS.wider, degree)[0] for degree in degrees)
    changes = [RADIUS.of_difference * math.log(one / radius) for one in others if math.isfinite(one)]
    turn = third * radius**2 * math.hypot(angle_std, RADIUS.axis_std)
    return radius, radius * math.hypot(noise * radius, turn, RADIUS.missed_std, *changes)


def _fit_radius(
    seen: FloatArray, ellipse: _Ellipse, window: float, degree: int
) -> tuple[float, float, float]:
    """Return the radius, the standard uncertainty of the curvature, the third derivative; or NaN."""
    along, out = seen.T
    place, radius = float(along[out.argmax()]), ellipse.radius
    for _ in range(_ROUNDS):
        half = window * radius
        near = (np.abs(along - place) < half) & (out > out.max() - half)
        s = (along[near] - place) / half
        if near.sum() < _MIN_POINTS_OF_RADIUS or s.min() > -RADIUS.seen or s.max() < RADIUS.seen:
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
