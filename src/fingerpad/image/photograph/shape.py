"""Semi-axes of a face whose outline may be no ellipse: an average over ellipse and superellipse."""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.optimize import OptimizeResult, least_squares
from scipy.special import expit

from fingerpad._arrays import FloatArray
from fingerpad.image.ellipse import PlaneEllipse
from fingerpad.image.photograph.calibration import DOUBT

# Exponents searched, and differences from 2 to start from.
_EXPONENTS, _STARTS = (1.2, 5.0), (-0.35, -0.15, 0.2, 0.5)
# Neighbouring points share the skin's roughness; blocks of so many hardly do.
BLOCK, _MIN_BLOCKS = 8, 10


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


def average_over_shapes(
    points: FloatArray,
    ellipse: PlaneEllipse,
    covariance: FloatArray,
    *,
    tilt: tuple[float, float],
    half_width: float = math.nan,
    hidden: float = 0.0,
    noise: float = math.inf,
    alike: int = BLOCK,
) -> ShapeAverage | None:
    """Fit a superellipse whose quadrants have exponents of their own, and average with the ellipse by odds.

    |X/a|^p + |Y/b|^p = 1, where p differs from 2 by normal deviates, one for all quadrants together and one
    for each. The semi-axes of both curves are the extents to which they continue the arc.

    Points of the pad, in order, may have been fitted along an arc only by the ellipse, whose semi-axes have
    the covariance given. `half_width` is half of the finger's width, NaN where this face does not show the
    pad's, of which the outline does not show the part `hidden`. `noise` is the standard deviation of the
    points on the ellipse's arc; `alike` neighbouring points share an error. Lengths are px. None where the
    points are too few to tell.
    """
    size = math.sqrt(ellipse.semi_x * ellipse.semi_y)
    blocks, counts = _blocks(points / size, alike)
    if counts.sum() < _MIN_BLOCKS * alike:
        return None
    weights = np.sqrt(np.minimum(counts / alike, 1))
    given = ellipse.semi_axes
    start = np.array([ellipse.x / size, ellipse.y / size, *np.log(given / size), ellipse.angle])
    width_std = math.hypot(DOUBT.width_std, hidden / ellipse.semi_x)
    curve = _Curve(blocks, weights, tilt, (math.log(half_width / size), width_std), DOUBT.least_px / size)
    bent = min((curve.bent(start, about) for about in (0.0, *_STARTS)), key=lambda fit: fit.cost)
    for _ in range(2):
        deviation = max(DOUBT.least_px / size, curve.deviation(bent.x))
        curve = curve._replace(noise=deviation)
        bent = curve.fitted(bent.x)
    plain = curve.fitted(start)
    weight = float(expit(DOUBT.log_odds + _log_evidence(bent) - _log_evidence(plain)))
    more, off = np.exp(bent.x[2:4]) * size, np.exp(plain.x[2:4]) * size - given
    if deviation * size > DOUBT.too_rough * max(noise, DOUBT.least_px):
        weight, off = 0.0, DOUBT.rough_std * given
    apart = more - given
    inverse = np.linalg.pinv(bent.jac.T @ bent.jac)
    bent_covariance = (
        DOUBT.widening**2 * inverse[2:4, 2:4] * np.outer(more, more)
        + DOUBT.missed**2 * np.outer(apart, apart)
        + DOUBT.floor**2 * np.diag(more**2)
    )
    # What half of the finger's width contradicts beyond chance.
    gap = 0.0 if math.isnan(half_width) else half_width - given[0]
    excess = max(gap**2 - covariance[0, 0] - (width_std * given[0]) ** 2, 0.0)
    along = covariance[:, 0] / covariance[0, 0]
    plain_covariance = covariance + excess * np.outer(along, along) + np.outer(off, off)
    x, y, _, _, angle = map(float, weight * bent.x[:5] + (1 - weight) * start)
    semi_x, semi_y = map(float, weight * more + (1 - weight) * given)
    in_quadrants = np.bincount(curve.quadrants(bent.x), weights=counts, minlength=4)
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

    def bent(self, start: FloatArray, about: float) -> OptimizeResult:
        """Return the best superellipse next to the best one whose exponents differ so far from 2."""
        exponents = np.array([about, 0.0, 0.0, 0.0, 0.0])
        held = least_squares(
            lambda values: self._off(np.append(values, exponents)),
            start,
            lambda values: self._slopes(np.append(values, exponents))[:, : start.size],
            x_scale="jac",
            max_nfev=30,
        )
        return self.fitted(np.append(held.x, exponents))

    def quadrants(self, values: FloatArray) -> npt.NDArray[np.intp]:
        """Return the number of the quadrant in which each point lies."""
        return _quadrants(*self._local(values))

    def deviation(self, values: FloatArray) -> float:
        """Return the points' standard deviation from a superellipse, but for those that stand out.

        Neighbours that err alike count as fewer.
        """
        off = self.weights * self._distances(values)
        most = DOUBT.far * 1.4826 * float(np.median(np.abs(off)))
        off = np.clip(off, -most, most)
        alike = min(max(float(off[1:] @ off[:-1]) / float(off @ off + 1e-30), 0.0), DOUBT.most_alike)
        return math.sqrt(float(off @ off) / max(len(off) - 8, 3) * (1 + alike) / (1 - alike))

    def _local(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the points' places along the axes, over the semi-axes; values may be stacked."""
        cosine, sine = np.cos(values[..., 4, None]), np.sin(values[..., 4, None])
        x, y = (self.points[:, k] - values[..., k, None] for k in range(2))
        log_a, log_b = values[..., 2, None], values[..., 3, None]
        return (x * cosine + y * sine) * np.exp(-log_a), (y * cosine - x * sine) * np.exp(-log_b)

    def _distances(self, values: FloatArray) -> FloatArray:
        """Return the points' distances from the curve, to first order."""
        x, y = self._local(values)
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
        stepped = self._off(values + step * np.eye(values.size))
        return np.asarray((stepped - self._off(values)).T / step)


def _quadrants(x: FloatArray, y: FloatArray) -> npt.NDArray[np.intp]:
    """Return the number of the quadrant of each point, anticlockwise."""
    return np.asarray(2 * (y < 0) + ((x < 0) ^ (y < 0)))


def _log_evidence(fit: OptimizeResult) -> float:
    """Return the log of a curve's evidence, by Laplace's approximation."""
    of_exponents = math.log(DOUBT.exponent_std) + 4 * math.log(DOUBT.quadrant_std)
    prior = 0.0 if fit.x.size == 5 else of_exponents
    return float(-fit.cost - 0.5 * np.linalg.slogdet(fit.jac.T @ fit.jac)[1] - prior)
