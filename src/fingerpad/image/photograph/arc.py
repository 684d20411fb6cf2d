"""The part of a finger's outline that is pad: the longest arc round its middle that one ellipse fits.

The finger's own axis, along which that ellipse lies, comes from the sides of the outline.
"""

import math
from collections.abc import Mapping
from contextlib import suppress
from itertools import pairwise
from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, FloatArray
from fingerpad.exceptions import FitError
from fingerpad.image.ellipse_fit import distances
from fingerpad.image.photograph.arc_fit import ArcFit, conic_start, fit_arc_ellipse, turns_from
from fingerpad.image.photograph.faces import Face

IndexArray: TypeAlias = npt.NDArray[np.intp]

# Middle of the pad's arc as parametric angle from x (across) towards y (along), radians.
PAD_MIDDLE: Mapping[Face, float] = {
    "palmar": math.pi / 2,
    "distal": math.pi / 2,
    "radial": math.pi / 6,
    "ulnar": math.pi / 6,
}
# Widest arc that can be pad, on either side of its middle.
PAD_REACH: Mapping[Face, float] = {
    "palmar": math.radians(100),
    "distal": math.radians(105),
    "radial": math.radians(95),
    "ulnar": math.radians(95),
}

_BLOCKS = 72
_MIN_BLOCKS = 22
# A block may be this many squared deviations off, on average, and still be used.
_WORTH = 2.0
_END_MARGIN = 0.04
_SLACKS = (1.0, 2.0, 4.0, 8.0, 16.0)
_GOOD_ENOUGH = 0.02
# An arc that leaves a semi-axis unknown by more determines none.
MAX_RELATIVE_STD = 0.4
_MIN_POINTS = 24
_REJECTION = 4.0
# Semi-axes along over across of a pad.
_AXIS_RATIOS = (0.3, 3.0)
# So far on either side of its middle the outline is pad, whether one ellipse fits it or not.
SURELY_PAD = math.radians(60)

# From the tip in widths: where the sides begin to run along the finger.
_SIDES_FROM = {"palmar": 1.15, "radial": 2.1, "ulnar": 2.1}
_MIN_LENGTH = 0.35
# How far the middle line of the sides can be off the ellipse's axis: a finger tapers unevenly.
_AXIS_STD = {"palmar": math.radians(1.5), "radial": math.radians(3.0), "ulnar": math.radians(3.0)}
# A finger held upright by eye.
_UPRIGHT_STD = math.radians(5.0)
_MAX_TILT = math.radians(35)


class PadArc(NamedTuple):
    """The arc of the pad and its ellipse."""

    fit: ArcFit  # the ellipse of the points used
    used: IndexArray  # into the outline, in order along it
    rejected: IndexArray


def candidate_points(points: FloatArray, face: Face) -> IndexArray:
    """Return the indices of the points, px, of an outline in the face's frame that can be pad, in order."""
    guess = initial_ellipse(points, face)
    off = turns_from(PAD_MIDDLE[face], points, guess)
    inside = np.abs(off) < PAD_REACH[face]
    # Turned so that the outline begins outside, and the run that holds the middle is one piece.
    start = int(np.argmin(inside)) if not inside.all() else 0
    order = np.roll(np.arange(len(points)), -start)
    middle = int(np.argmin(np.abs(off[order])))
    breaks = np.flatnonzero(~inside[order])
    first = breaks[breaks < middle].max(initial=-1) + 1
    last = breaks[breaks > middle].min(initial=len(order))
    return order[first:last]


def initial_ellipse(points: FloatArray, face: Face) -> FloatArray:
    """Return a rough ellipse (x, y, semi_x, semi_y, tilt) from the outline's extent near the pad's end."""
    end = points[:, 1].max()
    height = np.ptp(points[:, 1]) if face == "distal" else np.ptp(points[:, 0])
    for _ in range(4):
        near = points[points[:, 1] > end - height]
        width = np.ptp(near[:, 0])
        height = 0.6 * np.ptp(points[:, 1]) if face == "distal" else 1.1 * width
    if face in ("palmar", "distal"):
        along = 0.58 * width if face == "palmar" else height
        middle = (near[:, 0].max() + near[:, 0].min()) / 2
        return np.array([middle, end - along, width / 2, along, 0.0])
    return np.array([near[:, 0].max() - 0.6 * width, end - 0.95 * width, 0.6 * width, 0.95 * width, 0.0])


def finger_tilt(points: FloatArray, face: Face) -> tuple[float, float]:
    """Return the tilt of the finger from x towards y, and its standard uncertainty, radians.

    The middle line between the two sides below the pad, where they show; upright within 5 degrees where
    they do not, as when the finger is seen end on.
    """
    if face == "distal":
        return 0.0, _UPRIGHT_STD
    tip = int(points[:, 1].argmax())
    end = points[tip, 1]
    near = points[points[:, 1] > end - 0.6 * np.ptp(points[:, 0])]
    width = float(np.ptp(near[:, 0]))
    sides = points[:tip], points[tip:]
    top = end - _SIDES_FROM[face] * width
    bottom = max(side[:, 1].min(initial=end) for side in sides) + 2
    if top - bottom < _MIN_LENGTH * width:
        return 0.0, _UPRIGHT_STD
    levels = np.linspace(bottom, top, 40)
    first, second = (np.interp(levels, *side[np.argsort(side[:, 1])][:, ::-1].T) for side in sides)
    middle = (first + second) / 2
    slope = np.polynomial.Polynomial.fit(levels, middle, 1).convert().coef[1]
    tilt = -math.atan(float(slope))
    if abs(tilt) > _MAX_TILT:
        return 0.0, _UPRIGHT_STD
    # A short stretch of the sides determines the axis less.
    return tilt, _AXIS_STD[face] * max(1.0, width / float(top - bottom))


def longest_arc(
    points: FloatArray, order: IndexArray, middle: float, tilt: tuple[float, float], rough: FloatArray
) -> PadArc:
    """Find the longest arc through the middle of the candidates that one ellipse fits, and fit it.

    `points` of the outline are in the face's frame, px; `order` has the indices of the candidates along it;
    `middle` is the pad's as a parametric angle, `tilt` that of the finger's axis and its std, radians;
    `rough` is an ellipse (x, y, semi_x, semi_y, tilt).
    """
    track = points[order]
    sure = np.abs(turns_from(middle, track, rough)) < SURELY_PAD
    start = rough_start(track[sure], tilt, rough)
    arcs: dict[float, PadArc] = {}
    # A finger is no perfect ellipse: where the noise alone allows but a short arc, more is let pass.
    for slack in _SLACKS:
        values = start
        try:
            for _ in range(3):
                first, last = _longest_window(track, values, middle, tilt, slack)
                trim = round(_END_MARGIN * (last - first))
                arc = fit_arc(points, order[first + trim : last - trim], tilt, start=values)
                values = arc.fit.ellipse.parameters
        except FitError:
            continue
        doubt = float((np.sqrt(np.diagonal(arc.fit.covariance))[2:4] / values[2:4]).max())
        if doubt < _GOOD_ENOUGH:
            return arc
        arcs.setdefault(doubt, arc)
    if min(arcs, default=math.inf) > MAX_RELATIVE_STD:
        # No ellipse follows a squarish pad: the middle of one still tells what it can, doubtful as that is.
        with suppress(FitError):
            return fit_arc(points, order[sure], tilt, start)
    if not arcs:
        raise FitError(
            "no arc of the outline near the pad is elliptic: check face, tip and palmar, "
            "or mark points on the pad"
        )
    return arcs[min(arcs)]


def fit_arc(points: FloatArray, order: IndexArray, tilt: tuple[float, float], start: FloatArray) -> PadArc:
    """Fit an ellipse to all of an arc but the points that stand out from it."""
    track = points[order]
    if len(track) < _MIN_POINTS:
        raise FitError(f"only {len(track)} points of the outline were found on the arc: give a longer arc")
    values, good = start, _inliers(distances(start, track)[0])
    for _ in range(3):
        fit = fit_arc_ellipse(track[good], tilt, places=np.flatnonzero(good), start=values)
        values, before = fit.ellipse.parameters, good
        good = _inliers(distances(values, track)[0])
        if good.sum() < _MIN_POINTS or (good == before).all():
            break
    return PadArc(fit=fit, used=order[before], rejected=order[~before])


def _inliers(off: FloatArray) -> BoolArray:
    """Return which points belong: not many robust deviations off, nor next to one that is."""
    centre = np.median(off)
    spread = 1.4826 * float(np.median(np.abs(off - centre))) + 0.02
    far = np.abs(off) > _REJECTION * spread
    wide = np.convolve(far, np.ones(7), mode="same") > 0
    return np.asarray(~wide if (~wide).sum() >= _MIN_POINTS else ~far, dtype=bool)


def rough_start(track: FloatArray, tilt: tuple[float, float], rough: FloatArray) -> FloatArray:
    """Return the conic through points along the finger's axis, or a rough ellipse where no pad is such."""
    try:
        found = conic_start(track, tilt[0])
    except FitError:
        return rough
    low, high = _AXIS_RATIOS
    return found if low < found[3] / found[2] < high and found[2:4].max() < 3 * rough[2:4].max() else rough


def _longest_window(
    track: FloatArray, values: FloatArray, middle: float, tilt: tuple[float, float], slack: float
) -> tuple[int, int]:
    """Return the first and last index of the arc whose blocks one ellipse fits at the accepted misfit.

    About the ellipse so far the fit is linear, and running sums of its normal equations give every window.
    """
    edges = np.linspace(0, len(track), min(_BLOCKS, len(track) // 4) + 1).astype(int)
    off, slopes = distances(values, track)
    blocks = list(pairwise(edges))
    r = np.array([np.median(off[i:j]) for i, j in blocks])
    rows = np.array([slopes[i:j].mean(axis=0) for i, j in blocks])
    deviation = 1.4826 * float(np.median(np.abs(r[2:] - 2 * r[1:-1] + r[:-2]))) / math.sqrt(6) + 0.03
    deviation *= slack
    # Hairs and dust: blocks that stand out by far are neither fitted nor counted.
    level = float(np.median(np.abs(r)))
    keep = np.abs(r) < max(8 * level, 10 * deviation, 1.0)
    z, rows = np.where(keep, r / deviation, 0.0), np.where(keep[:, None], rows / deviation, 0.0)
    products = (rows[:, :, None] * rows[:, None, :], rows * z[:, None], z * z, keep.astype(float))
    run = [np.concatenate([np.zeros_like(part[:1]), np.cumsum(part, axis=0)]) for part in products]
    turns = np.abs(turns_from(middle, track, values))
    pivot = int(np.searchsorted(edges, np.argmin(turns), side="right")) - 1
    starts, ends = np.meshgrid(np.arange(0, pivot + 1), np.arange(pivot + 1, len(r) + 1), indexing="ij")
    wide = ends - starts >= min(_MIN_BLOCKS, len(r))
    starts, ends = starts[wide], ends[wide]
    normal, side, square, count = (part[ends] - part[starts] for part in run)
    normal[:, 4, 4] += 1 / tilt[1] ** 2
    side[:, 4] += (values[4] - tilt[0]) / tilt[1] ** 2
    scale = 1 / np.sqrt(np.einsum("nii->ni", normal) + 1e-12)
    scaled = normal * scale[:, :, None] * scale[:, None, :] + 1e-10 * np.eye(5)
    side = side * scale
    gain = np.einsum("ni,ni->n", side, np.linalg.solve(scaled, side[..., None])[..., 0])
    score = _WORTH * count - 0.5 * _WORTH * (ends - starts - count) - (square - gain)
    best = int(np.argmax(score))
    return int(edges[starts[best]]), int(edges[ends[best]])
