"""What a face's outline tells beside its ellipse.

Its lengths and its radius of curvature need none; where it is no ellipse, a superellipse has other semi-axes.
"""

import math
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.optimize import OptimizeResult, least_squares
from scipy.special import expit

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array, robust_std
from fingerpad.image.ellipse import PlaneEllipse
from fingerpad.image.ellipse_fit import EllipseFit, correlation_length
from fingerpad.image.photograph.arc import PAD_MIDDLE, SURELY_PAD, FaceArc, initial_ellipse, turns_from
from fingerpad.image.photograph.calibration import DOUBT, LENGTHS, RADIUS

# Points are too few below this, and a place is found in so many rounds.
_MIN_POINTS_OF_LENGTHS, _MIN_POINTS_OF_RADIUS, _ROUNDS = 12, 20, 8
# Shares of half of the width at which the height of the tip is read where the shaft hides the widest place.
_WIDTHS: Final = (0.95, 0.97, 0.98)
# Changes of the radius in one round, at most.
_MAX_CHANGE: Final = 1.5

_EXPONENTS: Final = (1.2, 5.0)  # searched
_MIN_BLOCKS = 10
_UNSEEN: Final = (math.nan, math.nan, math.nan)


def contradicted(
    arc: FaceArc, ellipse: PlaneEllipse, tilt_std: float, share: float
) -> tuple[FloatArray, float]:
    """Return by how much, relatively, an outline's lengths differ from an ellipse's, and its turn, radians.

    Both beyond chance. The ellipse follows an arc. Where the outline beyond it reaches farther than the
    ellipse, or less far, nothing tells which of the two is the pad; zero where the outline does not show a
    length. Where the ellipse is tilted otherwise than the finger, another curve was taken for a turned
    ellipse: its axis is uncertain by that turn, and its semi-axes by about as many radians.

    The axis has the standard uncertainty `tilt_std`, radians; an ellipse describes the pad's arc with the
    probability `share`.
    """
    turn = 0.0
    if arc.face != "distal":
        turn = float(_beyond_chance(ellipse.angle - arc.tilt[0], LENGTHS.of_tilt_std * arc.tilt[1]))
    points, _ = arc.about(ellipse, ellipse.angle)
    if len(points) < _MIN_POINTS_OF_LENGTHS:
        return np.zeros(2), turn
    across, along = ellipse.semi_axes
    top = int(points[:, 1].argmax())
    sides = points[top:], points[top::-1]
    tip_x, tip_y = _turning_point(points, across**2 / along)
    if arc.face in ("radial", "ulnar"):
        # From the tip to the palmar side, the one that reaches farther.
        width = _turning_point(points[:, ::-1], along**2 / across)[1] - tip_x
        palmar = sides[0] if points[:, 0].argmax() > top else sides[1]
        heights = _heights(palmar[:, 0] - tip_x, palmar[:, 1], tip_y, width)
        axis = math.hypot(tilt_std, LENGTHS.side_axis_std)
        own = LENGTHS.side_across_std, LENGTHS.side_along_std
        stds = np.hypot(own, np.array([across / along, along / across]) * axis)
    else:
        width, hidden, middle = _half_width(arc, ellipse, ellipse.angle)
        outward = [(np.abs(side[:, 0] - middle), side[:, 1]) for side in sides]
        heights = [height for side in outward for height in _heights(*side, tip_y, width)]
        shaft = (1 + (LENGTHS.hidden - 1) * share) * hidden / across
        own = LENGTHS.front_across_std, LENGTHS.front_along_std
        stds = np.hypot(own, np.array([1, LENGTHS.height_by_width]) * shaft)
    lengths = np.array([width, np.mean(heights)])
    return _beyond_chance(np.nan_to_num(lengths / ellipse.semi_axes - 1), stds), turn


def _beyond_chance(off: ArrayLike, std: ArrayLike) -> FloatArray:
    """Return what chance does not explain of a difference: all of a large one, little of a small one."""
    off, std = as_float_array(off), as_float_array(std)
    return np.asarray(off**3 / (off**2 + std**2))


def _half_width(arc: FaceArc, ellipse: PlaneEllipse, angle: float) -> tuple[float, float, float]:
    """Return half of an outline's width at the pad's widest place, what is hidden of it, and its middle.

    Hidden is what a wider shaft covers, or what lies below the outline's end. Of a palmar face the widest
    place lies at the ellipse's centre or above: below, the shaft may be wider than the pad. How much wider it
    is beyond what is common, is the pad's.
    """
    points, pad = arc.about(ellipse, angle)
    if not len(points):
        return math.nan, 0.0, math.nan
    across, along = ellipse.semi_axes
    top = int(points[:, 1].argmax())
    way = math.copysign(1, points[-1, 0] - points[0, 0])
    ends, hidden = [], 0.0
    for sign, side in ((way, slice(top, None)), (-way, slice(top, None, -1))):
        x, y = sign * points[side, 0], np.minimum.accumulate(points[side, 1])
        short = min(max(float(y[-1]) / along, 0.0), 1.0)
        missing = across * (1 - math.sqrt(1 - short**2))
        widest = np.maximum.accumulate(x)
        shown = float(np.interp(0.0, -y, widest) if arc.face == "palmar" else widest[-1])
        ends.append(sign * (shown + missing))
        hidden += missing / 2
    value = abs(ends[0] - ends[1]) / 2
    more = 0.0
    if arc.face == "palmar" and len(pad):
        more = max(float(np.ptp(pad[:, 0])) / 2 - value, 0.0)
    more_pad = float(_beyond_chance(more, LENGTHS.shaft * across))
    return value + more_pad, hidden + more - more_pad, sum(ends) / 2


def _heights(out: FloatArray, y: FloatArray, tip_y: float, width: float) -> list[float]:
    """Return the height of the tip above the widest place by places of nearly that width, as on an ellipse.

    The shaft hides the widest place itself. A side is in order from the tip; `out` is how far off it lies.
    """
    out = np.maximum.accumulate(out)
    return [
        (tip_y - float(np.interp(share * width, out, y))) / (1 - math.sqrt(1 - share**2)) for share in _WIDTHS
    ]


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
    """Return the radius of curvature where the outward normal has an angle, and its std; NaN where unseen.

    There a cubic is fitted to the distance of the points (x, y), in the ellipse's frame, from the ellipse.
    """
    if len(points) < _MIN_POINTS_OF_RADIUS:
        return _UNSEEN[:2]
    frame = np.array([[-math.sin(angle), math.cos(angle)], [math.cos(angle), math.sin(angle)]])
    seen, ellipse = points @ frame.T, _Ellipse(semi_axes, frame)
    radius, noise, third = _fit_radius(seen, ellipse)
    turn = third * radius**2 * math.hypot(angle_std, RADIUS.axis_std)
    return radius, radius * math.hypot(noise * radius, turn, RADIUS.missed_std)


def _fit_radius(seen: FloatArray, ellipse: _Ellipse) -> tuple[float, float, float]:
    """Return the radius, the standard uncertainty of the curvature, the third derivative; or NaN."""
    along, out = seen.T
    place, radius = float(along[out.argmax()]), ellipse.radius
    for _ in range(_ROUNDS):
        half = RADIUS.window * radius
        near = (np.abs(along - place) < half) & (out > out.max() - half)
        s = (along[near] - place) / half
        if near.sum() < _MIN_POINTS_OF_RADIUS or s.min() > -RADIUS.seen or s.max() < RADIUS.seen:
            return _UNSEEN
        off = out[near] - ellipse.height(s * half)
        if not np.isfinite(off).all():
            return _UNSEEN
        curve = np.polynomial.Polynomial.fit(s, off, RADIUS.degree, domain=[-1, 1])
        # The place moves by one step of Newton's method on the slope.
        slope, bend = float(curve.deriv(1)(0)), float(curve.deriv(2)(0)) - half**2 / ellipse.radius
        if not bend < 0:
            return _UNSEEN
        top = float(np.clip(-slope / bend, -0.5, 0.5))
        place += top * half
        before, radius = radius, float(np.clip(-(half**2) / bend, radius / _MAX_CHANGE, radius * _MAX_CHANGE))
        if abs(radius / before - 1) < 0.01 and abs(top) < 0.02:
            break
    design = np.vander(s, RADIUS.degree + 1, increasing=True)
    left = off - curve(s)
    freedom = max(len(left) / correlation_length(left, np.arange(len(left))) - RADIUS.degree - 1, 2)
    noise = 2 * math.sqrt(np.linalg.inv(design.T @ design)[2, 2] * float(left @ left) / freedom) / half**2
    return radius, noise, float(curve.deriv(3)(0)) / half**3 + ellipse.third


class ShapeAverage(NamedTuple):
    """An ellipse and a superellipse along the same outline, averaged by the odds of the two."""

    ellipse: PlaneEllipse  # mean centre, semi-axes and angle, px
    covariance: FloatArray  # (2, 2); of its semi-axes, px²
    weight: float  # probability of the superellipse
    exponent: float  # mean exponent of the superellipse along the arc; 2 is an ellipse
    exponent_std: float  # its standard uncertainty


def is_significant(exponent: float, std: float) -> bool:
    """Return whether an exponent differs from 2 by more than chance and the skin's roughness allow."""
    return abs(exponent - 2) > max(DOUBT.significant * std, DOUBT.least_significant)


def average_over_shapes(arc: FaceArc, fit: EllipseFit) -> ShapeAverage:
    """Fit a superellipse whose quadrants have exponents of their own, and average with the ellipse by odds.

    |X/a|^p + |Y/b|^p = 1, where p differs from 2 by normal deviates, one for all quadrants and one for each.
    The semi-axes of both curves are the extents to which they continue the arc, and the pad's middle where
    the arc leaves it out. Half of the finger's width tells too, where the face shows it. Too few points tell
    no exponent.
    """
    ellipse, covariance = fit.ellipse, fit.covariance[2:4, 2:4]
    middle, alike = PAD_MIDDLE[arc.face], arc.alike
    core = np.abs(turns_from(middle, arc.xy, initial_ellipse(arc.xy, arc.face))) < SURELY_PAD
    if arc.face in ("radial", "ulnar"):  # below the widest place the palmar side may be shaft
        core &= turns_from(middle, arc.xy, ellipse.parameters) > -middle
    points = arc.xy[arc.searched & (arc.points["used"] | core)]
    half_width, hidden = math.nan, 0.0
    # A side face shows the nail's side too, whose distance is no semi-axis.
    if arc.face in ("palmar", "distal"):
        half_width, hidden, _ = _half_width(arc, ellipse, arc.tilt[0])
    size = math.sqrt(ellipse.semi_x * ellipse.semi_y)
    blocks, counts = _blocks(points / size, alike)
    if counts.sum() < _MIN_BLOCKS * alike:
        rough = np.diag((DOUBT.rough_std * ellipse.semi_axes) ** 2)
        return ShapeAverage(ellipse, covariance + rough, 0.0, math.nan, math.nan)
    weights = np.sqrt(np.minimum(counts / alike, 1))
    given = ellipse.semi_axes
    start = np.array([ellipse.x / size, ellipse.y / size, *np.log(given / size), ellipse.angle])
    width_std = math.hypot(DOUBT.width_std, hidden / ellipse.semi_x)
    curve = _Curve(blocks, weights, arc.tilt, (math.log(half_width / size), width_std), DOUBT.least_px / size)
    bent = curve.fitted(np.append(curve.fitted(start).x, np.zeros(5)))
    for _ in range(2):
        deviation = max(DOUBT.least_px / size, curve.deviation(bent.x))
        curve = curve._replace(noise=deviation)
        bent = curve.fitted(bent.x)
    plain = curve.fitted(start)
    weight = float(expit(DOUBT.log_odds + _log_evidence(bent) - _log_evidence(plain)))
    more, off = np.exp(bent.x[2:4]) * size, np.exp(plain.x[2:4]) * size - given
    apart = more - given
    inverse = np.linalg.pinv(bent.jac.T @ bent.jac)
    relative = DOUBT.widening**2 * inverse[2:4, 2:4] + DOUBT.floor**2 * np.eye(2)
    bent_covariance = relative * np.outer(more, more)
    # What half of the finger's width contradicts beyond chance.
    gap = 0.0 if math.isnan(half_width) else half_width - given[0]
    excess = max(gap**2 - covariance[0, 0] - (width_std * given[0]) ** 2, 0.0)
    along = covariance[:, 0] / covariance[0, 0]
    plain_covariance = covariance + excess * np.outer(along, along) + np.outer(off, off)
    x, y, _, _, angle = map(float, weight * bent.x[:5] + (1 - weight) * start)
    semi_x, semi_y = map(float, weight * more + (1 - weight) * given)
    in_quadrants = np.bincount(_quadrants(*curve.along_axes(bent.x)), weights=counts, minlength=4)
    shares = np.append(1, in_quadrants / counts.sum())
    return ShapeAverage(
        ellipse=PlaneEllipse(x * size, y * size, semi_x, semi_y, angle),
        covariance=np.asarray(
            weight * bent_covariance
            + (1 - weight) * plain_covariance
            + weight * (1 - weight) * np.outer(apart, apart)
        ),
        weight=weight,
        exponent=float(2 + shares @ bent.x[5:]),
        exponent_std=math.sqrt(shares @ inverse[5:, 5:] @ shares),
    )


def _blocks(points: FloatArray, alike: int) -> tuple[FloatArray, FloatArray]:
    """Return the means of points over equal lengths of outline, and the number of points in each."""
    starts = np.arange(len(points))
    if alike > 1:
        lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
        block = np.floor(np.append(0, np.cumsum(lengths)) / (alike * float(np.median(lengths))) + 1e-6)
        starts = np.flatnonzero(np.append(True, np.diff(block) > 0))
    counts = np.diff(np.append(starts, len(points))).astype(np.float64)
    return np.asarray(np.add.reduceat(points, starts, axis=0) / counts[:, None]), counts


class _Curve(NamedTuple):
    """Points near an ellipse (x, y, log a, log b, angle) or, with five more values, a superellipse.

    The five are the difference of all exponents from 2, and that of each quadrant from theirs.
    """

    points: FloatArray
    weights: FloatArray
    tilt: tuple[float, float]
    log_width: tuple[float, float]  # NaN where it is not known; and its standard uncertainty
    noise: float

    def fitted(self, start: FloatArray) -> OptimizeResult:
        """Return the values of least squares; what is known beforehand counts as more observations."""
        return least_squares(self._off, start, self._slopes, x_scale="jac", max_nfev=100)

    def deviation(self, values: FloatArray) -> float:
        """Return the points' standard deviation from a superellipse, but for those that stand out.

        Neighbours that err alike count as fewer.
        """
        off = self.weights * self._distances(values)
        most = DOUBT.far * robust_std(off)
        off = np.clip(off, -most, most)
        alike = min(max(float(off[1:] @ off[:-1]) / float(off @ off + 1e-30), 0.0), DOUBT.most_alike)
        return math.sqrt(float(off @ off) / max(len(off) - 8, 3) * (1 + alike) / (1 - alike))

    def along_axes(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the points' places along the axes, over the semi-axes; values may be stacked."""
        cosine, sine = np.cos(values[..., 4, None]), np.sin(values[..., 4, None])
        x, y = (self.points[:, k] - values[..., k, None] for k in range(2))
        log_a, log_b = values[..., 2, None], values[..., 3, None]
        return (x * cosine + y * sine) * np.exp(-log_a), (y * cosine - x * sine) * np.exp(-log_b)

    def _distances(self, values: FloatArray) -> FloatArray:
        """Return the points' distances from the curve, to first order."""
        x, y = self.along_axes(values)
        exponent: float | FloatArray = 2.0
        if values.shape[-1] > 5:
            each = values[..., 5, None] + np.take_along_axis(values[..., 6:], _quadrants(x, y), axis=-1)
            exponent = np.clip(2 + each, *_EXPONENTS)
        x, y = (np.maximum(np.abs(part), 1e-9) for part in (x, y))
        level = (x**exponent + y**exponent) ** (1 / exponent)
        slope = np.hypot(
            (x / level) ** (exponent - 1) * np.exp(-values[..., 2, None]),
            (y / level) ** (exponent - 1) * np.exp(-values[..., 3, None]),
        )
        return np.asarray((level - 1) / slope)

    def _off(self, values: FloatArray) -> FloatArray:
        off = self.weights * self._distances(values) / (DOUBT.far * self.noise)
        robust = DOUBT.far * np.sign(off) * np.sqrt(2 * (np.sqrt(1 + off**2) - 1))
        known = [(values[..., 4:5] - self.tilt[0]) / self.tilt[1]]
        if not math.isnan(self.log_width[0]):
            known += [(values[..., 2:3] - self.log_width[0]) / self.log_width[1]]
        if values.shape[-1] > 5:
            known += [values[..., 5:6] / DOUBT.exponent_std, values[..., 6:] / DOUBT.quadrant_std]
        return np.concatenate([robust, *known], axis=-1)

    def _slopes(self, values: FloatArray) -> FloatArray:
        """Return the derivatives of what is off, from all values stepped at once."""
        step = 1e-7
        here, *stepped = self._off(np.vstack([values, values + step * np.eye(values.size)]))
        return np.asarray((np.array(stepped) - here).T / step)


def _quadrants(x: FloatArray, y: FloatArray) -> npt.NDArray[np.intp]:
    """Return the number of the quadrant of each point, anticlockwise."""
    return np.asarray(2 * (y < 0) + ((x < 0) ^ (y < 0)))


def _log_evidence(fit: OptimizeResult) -> float:
    """Return the log of a curve's evidence, by Laplace's approximation."""
    of_exponents = math.log(DOUBT.exponent_std) + 4 * math.log(DOUBT.quadrant_std)
    prior = 0.0 if fit.x.size == 5 else of_exponents
    return float(-fit.cost - 0.5 * np.linalg.slogdet(fit.jac.T @ fit.jac)[1] - prior)
