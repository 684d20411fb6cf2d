"""The pad's ellipse where the ends of its arc are unknown: an average over them, weighted by evidence."""

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import solve_triangular
from scipy.special import softmax

from fingerpad._arrays import FloatArray
from fingerpad.image.ellipse import PlaneEllipse
from fingerpad.image.ellipse_fit import distances
from fingerpad.image.photograph.arc_fit import (
    ArcFit,
    block_starts,
    departure_covariance,
    radii_of_curvature,
    student_widening,
    turns_from,
)

# Neighbouring points share the skin's roughness; blocks of so many hardly do.
_BLOCK = 8
_MIN_BLOCKS = 12
_OUTLYING = 6.0
# Ends are tried from here on, on either side of the pad's middle.
_FIRST_END = math.radians(45)
_STEP = math.radians(4)
# What the departure may be, as shares of the usual one: the curvature may hardly change, or twofold.
_SHARES = (0.03, 0.1, 0.3, 1.0)
# Farther out, in radii of curvature, the outline may step aside (a nail, a fold), by this share of one.
_REACH, _ASIDE = 0.25, 0.03
# The fit is linear about the arc as found, and no good far from it.
_MAX_CHANGE = 0.1


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Blocks:
    """Means over neighbouring points.

    Attributes
    ----------
    terms : ndarray, (n, 6)
        Derivatives of the distance by the parameters, and the distance.
    turns : ndarray, (n,)
        Parametric angle from the pad's middle, radians.
    along : ndarray, (n,)
        Place along the outline, px.
    """

    terms: FloatArray
    turns: FloatArray
    along: FloatArray


def average_over_ends(
    points: FloatArray,
    fit: ArcFit,
    *,
    middle: float,
    tilt: tuple[float, float],
    certain: tuple[float, float] = (0.0, 0.0),
) -> tuple[ArcFit, FloatArray]:
    """Fit the ellipse again for every place where the arc may end, and average by evidence.

    About the arc as found the fit is linear. For each pair of ends the outline beyond departs as
    `departure_covariance` gives; the marginal likelihood (ellipse flat, noise's level unknown) weighs the
    pair. The covariance is that within the pairs and between them; a slight departure can still pass for
    the ellipse, which the errors that points share allow for.

    Parameters
    ----------
    points : ndarray, (n, 2)
        Points of the outline that can be pad, px, in order, without those that stand out from the arc.
    fit : ArcFit
        The ellipse of the arc as found.
    middle : float
        Parametric angle of the pad's middle, radians.
    tilt : (float, float)
        Tilt of the finger's axis and its standard uncertainty, radians.
    certain : (float, float)
        As far from the middle, towards lower and higher angles, the outline is known to be pad, radians.

    Returns
    -------
    ArcFit
        The average, with the covariance within the pairs.
    ndarray, (5, 5)
        The covariance between the pairs.
    """
    values = np.array(fit.ellipse)
    semi = math.sqrt(values[2] * values[3])
    unit = np.array([semi, semi, semi, semi, 1.0])
    noise = fit.residual_std * math.sqrt(fit.correlation / _BLOCK)
    blocks = _blocks(points, values, middle)
    blocks = replace(blocks, terms=blocks.terms * np.append(unit, 1) / noise)
    if len(blocks.turns) < _MIN_BLOCKS:
        return fit, np.zeros((5, 5))
    sides = [
        _side(blocks, values, (middle, sign, max(_FIRST_END, first)), noise)
        for sign, first in zip((-1, 1), certain, strict=True)
    ]
    known = np.array([0, 0, 0, 0, 1, values[4] - tilt[0]]) / tilt[1]
    grams = sides[0][0][:, None] + sides[1][0] + np.outer(known, known)
    logs = sides[0][1][:, None] + sides[1][1]
    change, within, between = _average(grams.reshape(-1, 6, 6), logs.ravel(), len(blocks.turns))
    change, within, between = change * unit, within * np.outer(unit, unit), between * np.outer(unit, unit)
    if not (np.abs(change[2:4]) < _MAX_CHANGE * values[2:4]).all():
        return fit, np.zeros((5, 5))
    return replace(fit, ellipse=PlaneEllipse(*(values + change).tolist()), covariance=within), between


def _blocks(points: FloatArray, values: FloatArray, middle: float) -> _Blocks:
    """Return the blocks of the outline, px, but for those that stand out from their neighbours."""
    off, slopes = distances(values, points)
    turns = turns_from(middle, points, values)
    along = np.append(0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1)))
    starts = block_starts(points, _BLOCK)
    counts = np.diff(np.append(starts, len(points)))
    every = np.column_stack([slopes, off, turns, along])
    means = np.add.reduceat(every, starts, axis=0) / counts[:, None]
    level = np.array([np.median(means[max(0, k - 4) : k + 5, 5]) for k in range(len(means))])
    apart = np.abs(means[:, 5] - level)
    good = apart < _OUTLYING * (1.4826 * np.median(apart) + 0.02)
    # Blocks of fewer points know less.
    weights = np.sqrt(np.minimum(counts / _BLOCK, 1))[:, None]
    return _Blocks(terms=(weights * means[:, :6])[good], turns=means[good, 6], along=means[good, 7])


def _side(
    blocks: _Blocks, values: FloatArray, side: tuple[float, int, float], noise: float
) -> tuple[FloatArray, FloatArray]:
    """Return, for each end and departure on one side, the terms' weighted products and a log weight.

    The side is the pad's middle, the sign of turns from there, and the turn from which on ends are tried.
    """
    middle, sign, first_end = side
    mine = np.flatnonzero(sign * blocks.turns > 0)
    mine = mine[np.argsort(sign * blocks.turns[mine])]
    terms, turns = blocks.terms[mine], sign * blocks.turns[mine]
    along = np.abs(blocks.along[mine] - blocks.along[mine[:1]])
    # The arc may also end beyond all that is seen.
    grams, logs = [terms.T @ terms], [0.0]
    for end in np.arange(first_end, turns.max(initial=0), _STEP):
        past = along - np.interp(end, turns, along)
        on_arc = terms[past <= 0]
        beyond = past[past > 0]
        radius = float(radii_of_curvature(values, middle + sign * np.array(end)))
        far = np.maximum(beyond / radius - _REACH, 0)
        aside = (_ASIDE * radius / noise) ** 2 * np.minimum(far[:, None], far) + np.eye(len(beyond))
        usual = departure_covariance(beyond, (radius, radius)) / noise**2
        for share in _SHARES:
            root = np.linalg.cholesky(share**2 * usual + aside)
            white = solve_triangular(root, terms[past > 0], lower=True)
            grams.append(on_arc.T @ on_arc + white.T @ white)
            logs.append(-float(np.log(np.diagonal(root)).sum()) - math.log(len(_SHARES)))
    return np.array(grams), np.array(logs)


def _average(grams: FloatArray, logs: FloatArray, count: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the parameters' change, averaged by marginal likelihood, and covariance within and between."""
    inverse = np.linalg.inv(grams[:, :5, :5])
    changes = -np.einsum("nij,nj->ni", inverse, grams[:, :5, 5])
    left = np.maximum(grams[:, 5, 5] + np.einsum("ni,ni->n", changes, grams[:, :5, 5]), 1e-12)
    freedom = count - 5
    weights = softmax(logs + 0.5 * np.linalg.slogdet(inverse)[1] - 0.5 * freedom * np.log(left))
    change = weights @ changes
    within = np.einsum("n,nij->ij", weights * left / freedom, inverse)
    apart = changes - change
    between = np.einsum("n,ni,nj->ij", weights, apart, apart)
    return change, np.asarray(student_widening(freedom) * within), np.asarray(between)
