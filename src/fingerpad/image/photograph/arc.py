"""The part of a finger's outline that is pad, and its ellipse.

It is the longest arc round the pad's middle that one ellipse fits, along the finger's own axis, which comes
from the sides of the outline. Neighbouring points share errors, by a correlation length that their residuals
show. Beyond the ends of the arc the outline continues without a corner, and its curvature changes by about
its own size: points there are weighted accordingly.
"""

import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any, Final, NamedTuple, Self

import numpy as np
import numpy.typing as npt
from scipy import special
from scipy.linalg import solve_triangular

from fingerpad._arrays import ArrayLike, BoolArray, FloatArray, IndexArray, as_float_array, robust_std
from fingerpad.exceptions import FitError
from fingerpad.image.ellipse import PlaneEllipse, rotation, runs
from fingerpad.image.ellipse_fit import (
    EllipseFit,
    Parameters,
    correlation_length,
    distances,
    fit_aligned_ellipse,
    normalise,
    refine,
)
from fingerpad.image.photograph.faces import Face
from fingerpad.image.scale import Scale

# Middle of the pad's arc as parametric angle from x (across) towards y (along), radians.
PAD_MIDDLE: Mapping[Face, float] = {
    **dict.fromkeys(("palmar", "distal"), math.pi / 2),
    **dict.fromkeys(("radial", "ulnar"), math.pi / 6),
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
_ROUNDS = 2
# Farther beyond the arc, in radii of curvature, the outline can be 3 percent of one off, and is not used.
_REACH = 0.25
_REJECTION = 4.0
_MIN_FREEDOM = 3.0
# Semi-axes in units of the points' spread.
_SEARCH: Final[dict[str, Any]] = {"sizes": (0.02, 50.0), "tolerance": 1e-9, "max_steps": 60}
_TWO_SIDED_95 = 1.959964
# So many points left out at an end of the arc say that the pad ends there.
_END = 8


_POINT = np.dtype(
    [
        ("xy", np.float64, 2),  # px, in the face's frame
        ("step_ratio", np.float64),  # step across the edge over the noise beside it, NaN without an edge
        ("pad", np.bool_),  # whether it can be pad
        ("used", np.bool_),  # whether it is of the arc
        ("rejected", np.bool_),  # whether it would be, and stands out
        ("marked", np.bool_),  # whether it was added manually
    ]
)


def outline_points(xy: FloatArray, **known: ArrayLike) -> npt.NDArray[np.void]:
    """Return points of an outline: of the pad's arc, without an edge, unless other things are known."""
    points = np.zeros(len(xy), dtype=_POINT)
    for name, values in {"xy": xy, "step_ratio": math.nan, "pad": True, "used": True, **known}.items():
        points[name] = values
    return points


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FaceArc:
    """The arc of a face's outline, in the outline, and what is known beside it.

    Lengths are px of the picture. The outline's points are in order; the arc is one piece of them.
    """

    face: Face
    scale: Scale
    frame: tuple[FloatArray, FloatArray]  # steps (row, column) of the face's x and y; their origin there
    tilt: tuple[float, float]  # radians; of the finger's axis, known without the arc, and its std
    points: npt.NDArray[np.void]  # (n,); see `outline_points`
    start: FloatArray  # (x, y, semi_x, semi_y, tilt) of a rough ellipse
    ends_known: bool = True  # whether they were given: what lies beyond tells nothing of the lengths then
    erased: FloatArray = field(default_factory=lambda: np.empty((0, 2)))  # points of the arc
    alike: int = 8  # so many neighbouring points share an error, as by the roughness of the skin
    blur: float = math.nan  # standard deviation of the edges' blur, NaN without edges
    border: tuple[float, float, float] | None = None  # last row, last column, how near the frame cuts an arc

    @property
    def xy(self) -> FloatArray:
        """The points in the face's frame, (n, 2), px."""
        return np.asarray(self.points["xy"], dtype=np.float64)

    @property
    def searched(self) -> BoolArray:
        """Among which points the arc was found."""
        arc: BoolArray = self.points["used"] | self.points["rejected"]
        return arc if self.ends_known else np.asarray(self.points["pad"])

    def about(self, ellipse: PlaneEllipse, angle: float) -> tuple[FloatArray, FloatArray]:
        """Return two outlines about an ellipse's centre, x turned by an angle, without points added manually.

        The first is, of a palmar face, all that was found, the shaft with it; the second what can be pad.
        """
        found = self.points[~self.points["marked"]]
        local = (found["xy"] - ellipse.parameters[:2]) @ rotation(angle)
        pad = local[found["pad"]]
        return local if self.face == "palmar" else pad, pad

    def in_picture(self, points: FloatArray) -> FloatArray:
        """Return points of the face's frame as (row, column), px."""
        axes, place = self.frame
        return np.asarray(points @ axes + place)

    def without(self, gone: BoolArray) -> Self:
        """Return the arc without some points of the outline.

        Where the end of the arc goes, so does all beyond it: the pad ends there.
        """
        used = self.points["used"]
        gone, left = gone.copy(), np.flatnonzero(used & ~gone)
        for beyond in (slice(left[0]), slice(left[-1] + 1, None)) if len(left) else ():
            gone[beyond] |= (gone & used)[beyond].sum() >= _END
        of_arc = gone & (used | self.points["rejected"])
        erased = np.concatenate([self.erased, self.xy[of_arc]])
        return replace(self, erased=erased, points=self.points[~gone])

    def with_marks(self, marks: FloatArray) -> Self:
        """Return the arc with points on the pad, (row, column), px, added manually, each in its turn."""
        axes, place = self.frame
        local = (marks - place) @ axes.T
        near = np.flatnonzero(self.points["pad"] | self.searched)
        turns, wanted = (turns_from(PAD_MIDDLE[self.face], xy, self.start) for xy in (self.xy[near], local))
        sign = -1.0 if len(turns) and turns[-1] < turns[0] else 1.0
        order = np.argsort(sign * wanted, kind="stable")
        before = np.searchsorted(np.maximum.accumulate(sign * turns), sign * wanted[order])
        at = np.append(near, near[-1] + 1 if len(near) else 0)[before]
        return replace(self, points=np.insert(self.points, at, outline_points(local[order], marked=True)))


def fit_arc_ellipse(
    points: ArrayLike,
    tilt: tuple[float, float] = (0.0, math.radians(2)),
    *,
    places: ArrayLike | None = None,
    start: ArrayLike | None = None,
    beyond: ArrayLike | None = None,
) -> EllipseFit:
    """Fit the ellipse of least orthogonal distance to ordered, evenly spaced points (x, y) of an outline.

    `tilt` is the turn of the finger's axis from x towards y as known beforehand, and its standard
    uncertainty, radians. `places` are those of the points in the outline, rising, where some are left out.
    `start` is (x, y, semi_x, semi_y, tilt), the least-squares conic if left out. `beyond` is how far along
    the outline each point lies past an end of the arc: negative before the first, positive after the last.
    """
    points = as_float_array(points)
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < 8 or not np.isfinite(points).all():
        raise FitError(f"an outline needs at least eight finite points (x, y), found shape {points.shape}")
    rows = np.asarray(np.arange(len(points)) if places is None else places, dtype=np.int64)
    past = np.zeros(len(points)) if beyond is None else as_float_array(beyond)
    on_arc = past == 0
    local, shift, size = normalise(points)
    past, unit = past / size, np.array([size, size, size, size, 1.0])
    if start is None:
        values = conic_start(local[on_arc], tilt[0])
    else:
        values = (as_float_array(start) - [*shift, 0, 0, 0]) / unit
    values = refine(local[on_arc], values, tilt=(tilt[0], math.inf), **_SEARCH)
    for _ in range(_ROUNDS):
        variance, correlation = _noise(distances(values, local[on_arc])[0], rows[on_arc])
        spread = bend_covariance(past[~on_arc], _radii_of_curvature(values, local[on_arc][[0, -1]]))
        whitened = _whitening(on_arc, variance * correlation, spread)
        values = refine(local, values, whitened=whitened, tilt=tilt, **_SEARCH)
    residuals, design = distances(values, local)
    white = whitened(design)
    information = white.T @ white
    information[4, 4] += 1 / tilt[1] ** 2
    # So that 1.96 deviations hold 95 %, whatever the degrees of freedom.
    freedom = max(on_arc.sum() / correlation - values.size, _MIN_FREEDOM)
    widening = (special.stdtrit(freedom, 0.975) / _TWO_SIDED_95) ** 2
    covariance = widening * np.linalg.pinv(information, hermitian=True) * np.outer(unit, unit)
    values = values * unit + [*shift, 0, 0, 0]
    return EllipseFit(
        ellipse=PlaneEllipse(*values.tolist()),
        covariance=np.asarray(covariance, dtype=np.float64),
        residual_std=float(np.std(residuals[on_arc])) * size,
        correlation=correlation,
    )


def extend_arc(
    points: FloatArray, used: IndexArray, fit: EllipseFit, tilt: tuple[float, float]
) -> EllipseFit:
    """Fit an arc's ellipse again, with the outline just beyond the ends of the points used."""
    values, (first, last) = fit.ellipse.parameters, used[[0, -1]]
    places, spacing = outline_places(points)
    beyond = spacing * (np.minimum(places - places[first], 0) + np.maximum(places - places[last], 0))
    order, sides = [used], (np.arange(first)[::-1], np.arange(last + 1, len(points)))
    for side, radius in zip(sides, _radii_of_curvature(values, points[[first, last]]), strict=True):
        near = side[np.abs(beyond[side]) <= _REACH * radius]
        spread = np.diagonal(bend_covariance(np.abs(beyond[near]), (radius, radius)))
        off = np.abs(distances(values, points[near])[0])
        # What stands out is a hair, a nail or the frame, and so may be all that follows.
        good = np.logical_and.accumulate(off < _REJECTION * np.sqrt(spread + fit.residual_std**2))
        order.append(near[good])
    both = np.sort(np.concatenate(order))
    return fit_arc_ellipse(points[both], tilt, places=places[both], start=values, beyond=beyond[both])


def _whitening(on_arc: BoolArray, density: float, bends: FloatArray) -> Callable[[FloatArray], FloatArray]:
    """Return what scales values, one row for each point, to independent unit errors.

    The points' errors are independent on the arc and run together beyond its ends.
    """
    root = np.linalg.cholesky(bends + density * np.eye(len(bends)))

    def whitened(values: FloatArray) -> FloatArray:
        out = values / math.sqrt(density)
        if len(root):
            out[~on_arc] = solve_triangular(root, values[~on_arc], lower=True)
        return out

    return whitened


def bend_covariance(beyond: FloatArray, radii: tuple[float, ...]) -> FloatArray:
    """Return the covariance of an outline's distance from the ellipse beyond the ends of its arc.

    The outline has no corner. Its curvature, in units of the ellipse's at the end, jumps there by a normal
    deviate and then follows a random walk, both of standard deviation one (the walk's after one radian).
    Integrated twice, with s < t two distances in radii of curvature R of the end, the covariance is
    R² [s² t² / 4 + (s⁵/5 + (t − s) s⁴/2 + (t − s)² s³/3) / 4]; the two ends are independent.

    `beyond` is the distance past the arc, negative before its first end; `radii` are those at both ends.
    """
    radius = np.where(beyond < 0, *radii)
    angle = np.abs(beyond) / radius
    near, far = np.minimum(angle[:, None], angle), np.maximum(angle[:, None], angle)
    gap = far - near
    spread = (near * far) ** 2 / 4 + near**3 * (near**2 / 5 + gap * near / 2 + gap**2 / 3) / 4
    same = np.sign(beyond)[:, None] == np.sign(beyond)
    return np.asarray(np.where(same, spread, 0) * np.outer(radius, radius), dtype=np.float64)


def _radii_of_curvature(values: Parameters, points: FloatArray) -> tuple[float, ...]:
    """Return the ellipse's radius of curvature (a² sin² t + b² cos² t)^(3/2) / (a b) at each point."""
    angles = parametric_angles(points, values)
    speed = np.hypot(values[2] * np.sin(angles), values[3] * np.cos(angles))
    return tuple((speed**3 / (values[2] * values[3])).tolist())


def parametric_angles(points: FloatArray, values: Parameters) -> FloatArray:
    """Return the parametric angle of points seen from an ellipse's centre, radians in (−π, π]."""
    local = (points - values[:2]) @ rotation(values[4])
    with np.errstate(divide="ignore", invalid="ignore"):  # of an axis that vanishes on the way of a search
        return np.asarray(np.arctan2(local[:, 1] / values[3], local[:, 0] / values[2]), dtype=np.float64)


def turns_from(middle: float, points: FloatArray, values: Parameters) -> FloatArray:
    """Return how far the parametric angles of points lie beyond a middle one, radians in [−π, π)."""
    return (parametric_angles(points, values) - middle + math.pi) % (2 * math.pi) - math.pi


def outline_places(points: FloatArray) -> tuple[npt.NDArray[np.int64], float]:
    """Return the place of each point along its outline, in steps of it, and the length of a step.

    Points are evenly spaced but for gaps, where some were left out; no two have one place.
    """
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    step = float(np.median(lengths[lengths > 0])) if (lengths > 0).any() else 1.0
    steps = np.maximum(np.rint(lengths / step), 1)
    return np.concatenate([[0], np.cumsum(steps)]).astype(np.int64)[: len(points)], step


def conic_start(points: FloatArray, tilt: float) -> Parameters:
    """Return the conic of least squares through points, its axis turned by a tilt."""
    turn = rotation(tilt)
    x, y, semi_x, semi_y, _ = fit_aligned_ellipse(points @ turn).ellipse.parameters
    return np.array([*(turn @ (x, y)), semi_x, semi_y, tilt])


def _noise(residuals: FloatArray, places: npt.NDArray[np.int64]) -> tuple[float, float]:
    """Return the variance of single points and the number of neighbours that count as one.

    The fit has taken five degrees of freedom from the residuals, each worth one correlation length.
    """
    mean_square = float(np.mean(residuals**2))
    if not mean_square > 0:
        return 1e-24, 1.0
    correlation = correlation_length(residuals, places)
    independent = len(residuals) / correlation
    return mean_square * (independent / max(independent - 5, _MIN_FREEDOM)), correlation


class PadArc(NamedTuple):
    """The arc of the pad and its ellipse."""

    fit: EllipseFit  # the ellipse of the points used
    used: IndexArray  # into the outline, in order along it
    rejected: IndexArray


def candidate_points(points: FloatArray, face: Face) -> IndexArray:
    """Return the indices of the points, px, of an outline in the face's frame that can be pad, in order."""
    guess = initial_ellipse(points, face)
    off = turns_from(PAD_MIDDLE[face], points, guess)
    middle = np.argmin(np.abs(off))
    within_reach = runs(np.abs(off) < PAD_REACH[face])
    return next((run for run in within_reach if middle in run), np.arange(0))


def initial_ellipse(points: FloatArray, face: Face) -> FloatArray:
    """Return a rough ellipse (x, y, semi_x, semi_y, tilt) from the outline's extent near the pad's end."""
    end = points[:, 1].max()
    height = np.ptp(points[:, 1]) if face == "distal" else np.ptp(points[:, 0])
    for _ in range(4):
        near = points[points[:, 1] > end - height]
        width = np.ptp(near[:, 0])
        if not width > 0:
            raise FitError("one point lies far beyond the tip of the outline: erase it, or mark more there")
        height = 0.6 * np.ptp(points[:, 1]) if face == "distal" else 1.1 * width
    if face in ("palmar", "distal"):
        along = 0.58 * width if face == "palmar" else height
        middle = (near[:, 0].max() + near[:, 0].min()) / 2
        return np.array([middle, end - along, width / 2, along, 0.0])
    return np.array([near[:, 0].max() - 0.6 * width, end - 0.95 * width, 0.6 * width, 0.95 * width, 0.0])


def finger_tilt(points: FloatArray, face: Face) -> tuple[float, float]:
    """Return the tilt of the finger from x towards y, and its standard uncertainty, radians.

    That of the middle line between the two sides below the pad; where they do not show, as of a finger seen
    end on, upright within 5 degrees.
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

    `order` has the candidates' indices along the outline; `middle` is a parametric angle, `tilt` the finger's
    axis and its std, radians; `rough` an ellipse (x, y, semi_x, semi_y, tilt).
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
    spread = robust_std(off - centre) + 0.02
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
    deviation = robust_std(r[2:] - 2 * r[1:-1] + r[:-2]) / math.sqrt(6) + 0.03
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
