"""The edge of a contact without ridges: where the picture steps from the contact to what lies around it.

Signals are how far a picture lies above or below its ground, or how far its colour lies from it. In each a
rough patch is found, profiles are read across its outline, and the outline is moved to where they step.
The signal whose step is clearest all round shows the contact.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

import cv2
import numpy as np
import numpy.typing as npt
from scipy.ndimage import gaussian_filter1d

from fingerpad._arrays import BoolArray, Float32Array, FloatArray, as_float32, as_float_array, robust_std
from fingerpad.image._masks import (
    disk,
    distance_to,
    fill_holes,
    filled_polygon,
    largest_piece,
    longest_contour,
)
from fingerpad.image.contact_image.calibration import SMOOTH
from fingerpad.image.contact_image.view import reduced_shape
from fingerpad.image.ellipse import evenly_spaced, outward_normals, polygon_moments, shifted, signed_area
from fingerpad.image.levels import quadratic_surface, quadratic_terms

_ROUGH_SIDE: Final = 200  # longer side of the copy in which patches are found, px
_ROUGH_BLUR: Final = 1.2  # px of it, before
_LEVELS: Final = (1.0, 0.6, 1.6)  # that are tried, in parts of Otsu's
_LEAST_AREA: Final = 0.003
_MOST_AREA: Final = 0.9
_APPENDAGE: Final = 0.4  # parts of a patch narrower than this share of its width are reflections, not contact
_CLEAR: Final = 0.4  # beyond this score signals of another kind are not tried,
_VERY_CLEAR: Final = 0.85  # and beyond this one neither other levels nor signals
# A second edge is as steep, and drops, by no less than this share of the main one: a film may be nearly as
# dark as the contact.
_LEAST_SECOND: Final = 0.2
_SEEN: Final = 0.85  # a contact of which less of the outline is seen may leave the frame
_DIRECTIONS: Final = 180
# How far profiles reach to both sides, in parts of the contact's mean radius, round by round.
_REACHES: Final = (0.45, 0.4, 0.3, 0.25, 0.25)
_ORDERS: Final = (2, 2, 4, 12, 12)  # waves round the outline: few first, which no reflection draws along
_SEARCH: Final = 0.25  # of that reach; no contact is an ellipse, so its edge is sought at least so far off
# Times the wave number to the fourth power: where nothing is seen, fine waves stay small.
_STIFF: Final = 3e-5
_SETTLED: Final = 0.01  # px; an outline that a round moves by less moves no more
_BEYOND: Final = 0.1, 1.0  # of the radius; reflections over the edge are seen so far beyond it
_CHORD: Final = 12  # points of the outline between which its bend is looked at
_DENT: Final = 0.032  # of the radius; an edge that far off the other waves counts still a little


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Step:
    """The step of a picture along an outline, px of the picture."""

    points: FloatArray  # (n, 2); (x, y) of the outline, evenly spaced
    off: FloatArray  # (n,); how far out from it the edge lies in each profile; NaN where none is seen
    seen: float  # share of the outline at which the edge is seen
    height: float  # level of the contact above what lies around it, median along the outline, grey levels
    width: float  # width of the step at half height of its slope
    sign: int  # +1 where the contact is brighter than the ground, -1 where darker, 0 where of another colour
    ring: bool  # whether the edge is a crest, not a step
    narrow: bool  # whether that crest is a narrow ring round a level floor
    second: float  # how far outside a second edge lies, 0 for none
    contrast: float  # level of the contact above the ground, that of a film between them left out
    overshoot: float  # how far the first fringe outside rises beyond the ground, over the height; 0 for none
    fringe: float  # how far outside the edge it lies
    begin: float  # how far inside it the fall from the contact's level begins, on average; 0 of a crest
    noise: float = 0.0  # standard deviation of the level around the contact, grey levels
    cut: bool = False  # whether the contact leaves the picture
    overlap: float = 1.0  # intersection over union of the contact and its ellipse
    bend: float = math.inf  # least curvature, times the radius, where a reflection may lie over the outline

    @property
    def radius(self) -> float:
        """Mean radius of the contact."""
        return math.sqrt(abs(signed_area(self.points)) / math.pi)

    @property
    def scatter(self) -> float:
        """Robust standard deviation of the edge in profiles about the outline."""
        off = self.off[np.isfinite(self.off)]
        return robust_std(off - np.median(off)) if len(off) else math.inf

    @property
    def score(self) -> float:
        """How clear the step is, 0 to 1."""
        sharp = 1 / (1 + (self.width / (0.25 * self.radius)) ** 2)
        straight = 1 / (1 + (self.scatter / (0.03 * self.radius + 0.5)) ** 2)
        clear = self.height / (self.height + 2 * self.noise)
        return self.seen * sharp * straight * clear * self.overlap


def find_steps(
    picture: npt.NDArray[np.number],
    background: npt.NDArray[np.number] | None,
    inside: BoolArray,
    *,
    dark: bool | None = None,
    levels: Sequence[float] = _LEVELS,
) -> list[Step]:
    """Return the steps found round patches, all or only dark or bright ones, the clearest first.

    An edge that only its colour shows is neither. Patches are sought at levels in parts of Otsu's.
    """
    steps: list[Step] = []
    for signal, sign in _signals(picture, background, inside):
        if dark is not None and sign == (1 if dark else -1):
            continue
        # Colour off the ground in any direction shows contacts of gels, and rounds all other edges.
        if max((step.score for step in steps), default=0.0) > (_VERY_CLEAR if sign else _CLEAR):
            break
        for patch, factor in _patches(signal, inside, levels):
            contour = longest_contour(patch).reshape(-1, 2).astype(np.float64)
            step = _refined((contour + 0.5) * factor - 0.5, signal, inside, sign)
            if step is not None:
                # The frame cuts a contact whose outline reaches it, or hides where its patch does.
                reach = np.array(signal.shape[::-1]) - 2.5
                at_frame = bool(((step.points < 1.5) | (step.points > reach)).any())
                beside = int(np.count_nonzero(patch)) - int(np.count_nonzero(patch[1:-1, 1:-1])) > 3
                steps.append(replace(step, cut=at_frame or (step.seen < _SEEN and beside)))
                if step.score > _VERY_CLEAR:
                    break
    return sorted(steps, key=lambda step: -step.score)


def _signals(
    picture: npt.NDArray[np.number], background: npt.NDArray[np.number] | None, inside: BoolArray
) -> Iterator[tuple[Float32Array, int]]:
    """Yield how far a picture lies above and below its ground, and how far off in any way."""
    values = np.atleast_3d(as_float32(picture))
    if background is not None:
        light = np.atleast_3d(as_float32(background))
        if light.shape[2] != values.shape[2]:
            values, light = (each.mean(axis=2, keepdims=True) for each in (values, light))
        rim = _rim(inside)
        some = min(1.0, float(light.max()) / 100)  # keeps the dark from being divided by; levels may end at 1
        gain = np.median((values[rim].mean(axis=1) + some) / (light[rim].mean(axis=1) + some))
        ground = gain * (light + some) - some
    else:
        ground = np.stack([_even_ground(values[..., k], inside) for k in range(values.shape[2])], axis=-1)
    off = values - ground
    off -= np.median(off[_rim(inside)], axis=0)
    off[~inside] = 0
    small = cv2.resize(off, None, fx=0.25, fy=0.25, interpolation=cv2.INTER_AREA).reshape(-1, off.shape[2])
    _, ways = np.linalg.eigh(small.T @ small)
    way = ways[:, -1] * (1 if ways[:, -1].sum() >= 0 else -1)
    level = as_float32(off @ way)
    yield level, 1
    yield as_float32(-level), -1
    soft = np.atleast_3d(cv2.GaussianBlur(off, (0, 0), 1.5))
    yield as_float32(np.sqrt((soft**2).sum(axis=2))), 0


def _rim(inside: BoolArray) -> BoolArray:
    """Return where a picture has its rim, which a contact seldom fills."""
    rows, columns = inside.shape
    rim = inside.copy()
    margin = max(2, round(0.1 * min(rows, columns)))
    rim[margin:-margin, margin:-margin] = False
    return rim if rim.any() else inside


def _even_ground(values: Float32Array, inside: BoolArray) -> Float32Array:
    """Return a smooth surface of second degree through most of a picture."""
    rows, columns = values.shape
    some = np.zeros_like(inside)
    some[:: max(1, rows // 80), :: max(1, columns // 80)] = True
    row, column = np.nonzero(some & inside)
    base = quadratic_terms(np.linspace(-1, 1, columns)[column], np.linspace(-1, 1, rows)[row])
    level, rim = values[row, column], _rim(inside)[row, column]
    weight = np.where(rim.any(), rim, True).astype(np.float64)  # of a mask few places may be at the rim
    for _ in range(12):
        weighted = base.T * weight**2
        found = as_float_array(np.linalg.lstsq(weighted @ base, weighted @ level, rcond=None)[0])
        rest = level - base @ found
        spread = robust_std(rest[weight > 0.1]) + 1e-6
        weight = np.where(rim, 1.0, 0.5) / (1 + (rest / (2 * spread)) ** 2)
    return as_float32(quadratic_surface(found, values.shape))


def _patches(
    signal: Float32Array, inside: BoolArray, levels: Sequence[float]
) -> Iterator[tuple[BoolArray, FloatArray]]:
    """Yield compact patches of a reduced copy above several levels, and the picture's pixels in one of it."""
    rows, columns = signal.shape
    shape = reduced_shape(signal.shape, max(rows, columns) / _ROUGH_SIDE)
    small = cv2.resize(signal, shape[::-1], interpolation=cv2.INTER_AREA)
    small = cv2.GaussianBlur(small, (0, 0), _ROUGH_BLUR)
    counts = cv2.resize(inside.astype(np.uint8), shape[::-1], interpolation=cv2.INTER_NEAREST) > 0
    low, high = np.percentile(small[counts], (2, 99.5))
    if not high > low:
        return
    scaled = ((small - low) / (high - low) * 255).clip(0, 255).astype(np.uint8)
    otsu, _ = cv2.threshold(scaled[counts].reshape(-1, 1), 0, 255, cv2.THRESH_BINARY | cv2.THRESH_OTSU)
    factor = np.array([columns / shape[1], rows / shape[0]])
    seen: list[BoolArray] = []
    for part in levels:
        patch = _compact((scaled > part * otsu) & counts)
        if patch is None or any(np.array_equal(patch, other) for other in seen):
            continue
        seen.append(patch)
        yield patch, factor


def _compact(mask: BoolArray) -> BoolArray | None:
    """Return the largest compact piece of a mask, without holes, None where there is none of some size."""
    closed = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_CLOSE, disk(3)) > 0
    filled = fill_holes(closed)
    pad = 40
    wide = np.pad(filled, pad, mode="edge")
    within = distance_to(~np.pad(filled, 1))[1:-1, 1:-1]
    _, labels = cv2.connectedComponents(filled.astype(np.uint8))
    radius = max(2.0, min(pad - 2.0, _APPENDAGE * float(within.max())))
    part = np.pad(np.asarray(labels == labels.flat[within.argmax()]), pad, mode="edge") & wide
    opened = cv2.morphologyEx(part.astype(np.uint8), cv2.MORPH_OPEN, disk(radius))[pad:-pad, pad:-pad] > 0
    patch = largest_piece(opened)
    return patch if _LEAST_AREA < np.count_nonzero(patch) / mask.size < _MOST_AREA else None


def _refined(contour: FloatArray, signal: Float32Array, inside: BoolArray, sign: int) -> Step | None:
    """Move a rough outline to the step of a signal."""
    moments = polygon_moments(contour)
    (row, column), (major, minor) = moments.ellipse.centre, moments.semi_axes
    if not minor > 3:
        return None
    t = np.linspace(0, 2 * math.pi, 720, endpoint=False)
    rough = (column, row) + np.stack([np.cos(t) * major, np.sin(t) * minor], axis=1) @ moments.axes
    points = evenly_spaced(rough, math.inf, min_count=_DIRECTIONS)
    seen = np.where(inside, signal, np.float32(np.nan))
    for reach, order in zip(_REACHES, _ORDERS, strict=True):
        step = _step_across(points, seen, sign, reach)
        if step is None:
            return None
        shift = _low_order(step.off, order, step.radius)
        if shift is None:
            return None
        limit = 0.5 * reach * step.radius
        moved = points + outward_normals(points) * shift.clip(-limit, limit)[:, None]
        points = evenly_spaced(moved, math.inf, min_count=_DIRECTIONS)
        if not abs(signed_area(points)) > 20:
            return None
    moments = polygon_moments(points)
    if not moments.spread[1] > 0:  # an outline that crosses itself
        return None
    step = _step_across(points, seen, sign, _REACHES[-1])
    return step and replace(
        step,
        overlap=moments.overlap(points),
        noise=_ground_spread(step, signal, inside),
        bend=_reflected_bend(step, seen),
    )


def _low_order(off: FloatArray, order: int, radius: float) -> FloatArray | None:
    """Return a robust sum of waves round the outline, up to an order, through what is seen of it."""
    good = np.isfinite(off)
    if np.count_nonzero(good) < 0.25 * len(off):
        return None
    t = 2 * math.pi * np.arange(len(off)) / len(off)
    waves = [np.ones_like(t)] + [each(k * t) for k in range(1, order + 1) for each in (np.cos, np.sin)]
    base = np.stack(waves, axis=1)
    number = (np.arange(base.shape[1]) + 1) // 2
    stiff = np.diag(_STIFF * len(off) * number**4 + 1e-6)
    values, weight = np.where(good, off, 0.0), good.astype(np.float64)
    shift = np.full(len(off), np.median(off[good]))
    for _ in range(15):
        rest = values - shift
        spread = robust_std(rest[good]) + 0.05 + _DENT / 4 * radius
        weight = good * np.maximum(0.0, 1 - (rest / (4 * spread)) ** 2) ** 2
        normal = base.T @ (base * weight[:, None]) + stiff
        before, shift = shift, base @ np.linalg.solve(normal, base.T @ (weight * values))
        if np.abs(shift - before).max() < _SETTLED:
            break
    return np.asarray(shift)


def _step_across(points: FloatArray, signal: Float32Array, sign: int, reach: float) -> Step | None:
    """Return the step along an outline as profiles across it show it; the signal is NaN where nothing is."""
    radius = math.sqrt(abs(signed_area(points)) / math.pi)
    far = max(6.0, reach * radius)
    spacing = max(0.5, far / 200)
    across = np.arange(-far, far + spacing / 2, spacing)
    profiles = _profiles(points, signal, across)
    seen = np.isfinite(profiles).mean(axis=0) > 0.3
    if not seen.all():
        across, profiles = across[seen], profiles[:, seen]
    if len(across) < 12:
        return None
    typical = _nanmedian(profiles, axis=0)
    sigma = max(0.7, 0.6 / spacing)
    smooth = gaussian_filter1d(typical, sigma, mode="nearest", radius=math.ceil(3 * sigma))
    place, width, others, ring = _edge_of(smooth, across, sign)
    if place is None or (sign == 0 and not ring):
        return None
    near = _near(width, radius)
    inner = (across < place - near) & (across > place - near - max(4.0, 0.12 * radius))
    outer = (across > place + near) & (across < place + near + max(4.0, 0.12 * radius))
    if (inner.sum() < 3 and not ring) or outer.sum() < 3:
        return None
    top = float(np.median(smooth[inner])) if inner.any() else math.nan  # of a ring no plateau is seen
    ground = float(np.median(smooth[len(smooth) - int(outer.sum()) :]))
    first, overshoot = _first_fringe(smooth[across > place], top, ground)
    # The fall to a fringe begins at the edge: what lies far beyond a narrow step is the rim of a film.
    if width < SMOOTH.rim * first * spacing:
        overshoot = 0.0
    second = 0.0 if overshoot > SMOOTH.least_overshoot else min(others, default=place) - place
    between = np.abs(across - place - second / 2) <= second / 4
    if between.sum() > 2:  # the contact ends half-way to the level between two edges
        outer = between
    high, low = (_running_median(_nanmedian(profiles[:, band], axis=1)) for band in (inner, outer))
    # Along each profile only.
    blur = max(0.5, 0.25 * width / spacing)
    blurred = as_float32(cv2.GaussianBlur(as_float32(np.nan_to_num(profiles)), (0, 0), blur, sigmaY=1e-3))
    search = max(3.0, min(0.5 * far, 2.5 * width), _SEARCH * reach * radius)
    if ring:
        search = min(max(search, 0.1 * radius), 0.5 * far)
        off, height = _crests(blurred, across, place, search, low)
    else:
        off, height = _crossings(blurred, across, place, search, (high + low) / 2), high - low
    typical_height = float(np.nanmedian(height))
    if not typical_height > 0:
        return None
    off = np.where(np.isfinite(profiles).mean(axis=1) > 0.7, off, np.nan)
    off = np.where(height > 0.35 * typical_height, off, np.nan)
    fall = max(top - float(np.median(smooth[outer])), 1e-9)
    before = smooth[(across < place) & (across > place - 3 * near)]
    begin = 0.0 if ring else 2 * spacing * float(((top - before) / fall).clip(0, 1).sum())
    return Step(
        points=points,
        off=off,
        seen=float(np.isfinite(off).mean()),
        height=typical_height,
        width=width,
        sign=sign,
        ring=ring,
        narrow=ring and _is_narrow(smooth, across, place, 0.2 * radius),
        second=second,
        contrast=max(typical_height, top - ground) if second > 0 else typical_height,
        overshoot=overshoot,
        fringe=first * spacing,
        begin=begin,
    )


def _profiles(points: FloatArray, signal: Float32Array, across: FloatArray) -> Float32Array:
    """Return the levels across an outline, a row for each point; NaN beyond the picture."""
    out, normals = as_float32(across), outward_normals(points)
    x, y = (as_float32(points[:, [k]]) + as_float32(normals[:, [k]]) * out for k in (0, 1))
    levels = cv2.remap(signal, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=math.nan)
    return as_float32(levels)


def _first_fringe(beyond: FloatArray, top: float, bottom: float) -> tuple[int, float]:
    """Return how many samples beyond an edge a profile is first least, and how far below the ground then.

    That is a share of the fall from `top` to the ground's level `bottom`.
    """
    first = int(np.append(np.flatnonzero(np.diff(beyond) > 0), len(beyond) - 1)[0])
    return first + 1, max(0.0, (bottom - float(beyond[first])) / max(top - bottom, 1e-9))


def _reflected_bend(step: Step, signal: Float32Array) -> float:
    """Return how little the outline bends where a reflection may lie over the edge, times the radius.

    There the picture steps once more beyond it. An outline that follows the side of a reflection in place of
    the edge is straight or has a dent.
    """
    levels = _profiles(step.points, signal, step.radius * np.linspace(*_BEYOND, 40))
    spread = np.subtract(*np.percentile(levels, (95, 5), axis=1))  # NaN where the picture ends
    if not np.isfinite(spread).any():
        return math.inf
    reflected = spread > np.nanmedian(spread) + SMOOTH.beyond * step.height
    before, after = step.points - shifted(step.points, -_CHORD), shifted(step.points, _CHORD) - step.points
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    bend = cross * step.radius / np.linalg.norm(before, axis=1) ** 3
    bend = math.copysign(1.0, signed_area(step.points)) * bend
    return float(bend[reflected].min(initial=math.inf))


def _near(width: float, radius: float) -> float:
    """Return how far from an edge of a width the level is that of what lies there."""
    return min(1.2 * width + 0.5, 0.15 * radius)


def _ground_spread(step: Step, signal: Float32Array, inside: BoolArray) -> float:
    """Return the robust standard deviation of a signal outside a step."""
    every = max(2, round(max(signal.shape) / _ROUGH_SIDE))
    rows, columns = signal.shape[0] // every, signal.shape[1] // every
    whole = np.s_[: rows * every, : columns * every]
    small = cv2.resize(signal[whole], (columns, rows), interpolation=cv2.INTER_AREA)
    counts = cv2.resize(inside[whole].astype(np.uint8), (columns, rows), interpolation=cv2.INTER_NEAREST)
    far = step.second + _near(step.width, step.radius)
    centre, larger = step.points.mean(axis=0), 1 + far / step.radius
    wide = (centre + (step.points - centre) * larger + 0.5) / every - 0.5
    ground = small[(filled_polygon(wide, small.shape) == 0) & (counts > 0)]
    if len(ground) < 20:
        return 0.0
    return float(np.subtract(*np.percentile(ground, (84, 16)))) / 2


def _running_median(values: FloatArray) -> FloatArray:
    """Return medians over nine neighbours along a closed outline."""
    around = np.concatenate([values[-4:], values, values[:4]])
    return _nanmedian(np.lib.stride_tricks.sliding_window_view(around, 9), axis=1)


def _nanmedian(values: npt.NDArray[np.floating], axis: int) -> FloatArray:
    """Return medians along an axis, NaN where there is nothing; NumPy's take ten times as long."""
    if not values.size:
        return np.full(np.delete(values.shape, axis), np.nan)
    ordered = np.sort(values, axis=axis)  # NaN last
    last = np.maximum(np.isfinite(values).sum(axis=axis, keepdims=True) - 1, 0)
    low, high = (np.take_along_axis(ordered, place, axis) for place in (last // 2, (last + 1) // 2))
    return as_float_array((low + high) / 2).squeeze(axis)


def _edge_of(
    profile: FloatArray, across: FloatArray, sign: int
) -> tuple[float | None, float, list[float], bool]:
    """Return the place of the main edge of a profile that falls outward, its width, and other edges."""
    spacing = float(across[1] - across[0])
    slope = -np.gradient(profile, spacing)
    if sign == 0:
        found = _crest_of(profile, across)
        if found is not None:
            return (*found, [], True)
    rises, falls = slope[1:-1] >= slope[:-2], slope[1:-1] > slope[2:]
    peaks = (np.flatnonzero(rises & falls & (slope[1:-1] > 0)) + 1).tolist()
    if not peaks:
        return None, 0.0, [], False
    best = max(peaks, key=lambda k: slope[k])
    strong = [k for k in peaks if slope[k] > _LEAST_SECOND * slope[best]]
    width = _width_at(slope, best) * spacing
    least = _LEAST_SECOND * _drop(profile, slope, best)
    edges = [best]
    for k in strong:
        low, high = sorted((k, best))
        # Between two edges lies a level stretch.
        level = slope[low : high + 1].min() < 0.4 * slope[k]
        if level and across[high] - across[low] > 1.2 * width and _drop(profile, slope, k) > least:
            edges.append(k)
    chosen = min(edges)
    rest = [float(across[k]) for k in edges if k != chosen]
    return float(across[chosen]), _width_at(slope, chosen) * spacing, rest, False


def _drop(profile: FloatArray, slope: FloatArray, k: int) -> float:
    """Return by how much a profile falls across a peak of its slope."""
    reach = round(_width_at(slope, k))
    return float(profile[max(0, k - reach)] - profile[min(len(profile) - 1, k + reach)])


def _crest_of(profile: FloatArray, across: FloatArray) -> tuple[float, float] | None:
    """Return the place and the width of a crest that is lower on both sides, None where there is none."""
    k = int(profile.argmax())
    if not 2 < k < len(profile) - 3:
        return None
    inner, outer = float(profile[:k].min()), float(profile[k:].min())
    top = float(profile[k])
    if not top - inner > 0.25 * (top - outer):
        return None
    spacing = float(across[1] - across[0])
    lower, centre, upper = profile[k - 1 : k + 2]
    shift = 0.5 * (lower - upper) / min(lower - 2 * centre + upper, -1e-12)
    # The outer flank tells how sharp it is.
    slope = -np.gradient(profile, spacing)
    flank = k + int(slope[k : k + max(3, len(slope) // 4)].argmax())
    return float(across[k] + shift * spacing), float(2 * (across[flank] - across[k]) + spacing)


def _is_narrow(profile: FloatArray, across: FloatArray, place: float, depth: float) -> bool:
    """Return whether a profile falls to half of its crest within a depth inside it."""
    crest = profile[np.abs(across - place).argmin()]
    inner = profile[(across < place) & (across > place - depth)]
    return bool(len(inner) and inner.min() < 0.5 * crest)


def _width_at(values: FloatArray, k: int) -> float:
    """Return the full width of a peak at half of its height, in samples."""
    less = np.flatnonzero(values <= values[k] / 2)
    low, high = less[less < k].max(initial=0), less[less > k].min(initial=len(values) - 1)
    return max(1.0, float(high - low - 1))


def _crossings(
    profiles: npt.NDArray[np.floating], across: FloatArray, place: float, search: float, level: FloatArray
) -> FloatArray:
    """Return where each profile falls through its level nearest to a place, NaN where it does not."""
    above = profiles - level[:, None]
    falls = (above[:, :-1] > 0) & (above[:, 1:] <= 0)
    middle = (across[:-1] + across[1:]) / 2
    distance = np.where(falls, np.abs(middle - place), np.inf)
    k = distance.argmin(axis=1)
    row = np.arange(len(profiles))
    first, second = above[row, k], above[row, k + 1]
    share = first / np.where(first > second, first - second, 1.0)
    found = across[k] + share * (across[1] - across[0])
    return np.where(distance[row, k] < search, found, np.nan)


def _crests(
    profiles: npt.NDArray[np.floating], across: FloatArray, place: float, search: float, low: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return where each profile is highest near a place, and how high."""
    near = np.abs(across - place) < search
    band, where = profiles[:, near], across[near]
    k = band.argmax(axis=1)
    row = np.arange(len(band))
    edge = (k == 0) | (k == len(where) - 1)
    k = k.clip(1, len(where) - 2)
    lower, centre, upper = band[row, k - 1], band[row, k], band[row, k + 1]
    shift = 0.5 * (lower - upper) / np.minimum(lower - 2 * centre + upper, -1e-12)
    found = where[k] + shift.clip(-1, 1) * (across[1] - across[0])
    return np.where(edge, np.nan, found), centre - low
