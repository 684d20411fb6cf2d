"""A finger's outline before a plain backdrop: a silhouette in whole pixels, then edges along its normals."""

import math
from functools import lru_cache
from typing import Any, NamedTuple, TypeAlias

import cv2
import numpy as np
import numpy.typing as npt
from scipy.ndimage import gaussian_filter1d
from scipy.special import ndtr

from fingerpad._arrays import BoolArray, Float32Array, FloatArray, IndexArray, as_float32, as_float_array
from fingerpad.exceptions import ImageError
from fingerpad.image._masks import fill_holes, longest_contour, sample
from fingerpad.image.ellipse import evenly_spaced, outward_normals, runs
from fingerpad.image.levels import LUMA, linear_light, quadratic_surface, quadratic_terms, shares_of_top
from fingerpad.image.photograph.faces import STEPS, Direction, opposite

_SIDE_PX = 900
_MIN_SIDE_PX = 32
# Distances are counted in standard deviations of the backdrop.
_MIN_DISTANCE = 5.0
_SHARE_OF_CONTRAST = 0.3
_MIN_AREA_SHARE = 0.004
_MAX_AREA_SHARE = 0.92
# What comes in through the frame's side is the finger if it is at least this share of the largest region.
_LEAST_COMING_IN = 0.2
# A second region of at least this share of the largest may be the finger as well: where the finger comes in
# only another that does, such as a second finger; seen end on any, such as a coin or a ruler.
_RIVAL_COMING_IN, _RIVAL_END_ON = 0.5, 0.2
_SMOOTHING_PX = 3.0

# Samples per pixel along a normal, and how far beyond the reach, px; blurs (standard deviation, px) tried.
_DENSITY, _BEYOND_PX = 2, 7.0
_BLURS = np.geomspace(0.5, 6.0, 13)
# Places tried along a normal, px apart.
_TRIAL_STEP = 0.25
_MIN_STEP_RATIO = 3.0
_ALONG_PX = 1.5
_MIN_VARIANCE = 1e-6
# Where a finger enters the picture it is cut within this share of its extent from its middle.
_MIDDLE = 0.2
# How far a mark may be off the outline, in widths of the finger.
_MARK_REACH = 0.1

Window: TypeAlias = tuple[slice, slice]


class Silhouette(NamedTuple):
    """A finger set apart from its backdrop."""

    mask: BoolArray  # the finger, in a reduced copy
    reduction: float  # pixels of the photograph per pixel of the copy
    alone: bool  # whether nothing else in view may be the finger as well

    def contour(self) -> FloatArray:
        """Return its outline, (row, column) in px of the photograph, in order, without the frame."""
        longest = longest_contour(self.mask)[:, 0, ::-1].astype(np.float64)
        rows, columns = self.mask.shape
        framed = (longest.min(axis=1) <= 1) | (longest[:, 0] >= rows - 2) | (longest[:, 1] >= columns - 2)
        between = runs(~framed)
        if not between:
            return np.empty((0, 2))
        smooth = _smooth_contour(longest[max(between, key=len)], closed=not framed.any())
        # The contour of a mask runs along its pixels' middles, half a pixel inside.
        return (smooth + 0.5) * self.reduction - 0.5

    def cut_sides(self) -> dict[Direction, IndexArray]:
        """Return the sides of the frame that cut the finger, with the cut's rows or columns in the copy."""
        bands: dict[Direction, BoolArray] = {
            "up": self.mask[:2],
            "down": self.mask[-2:],
            "left": self.mask[:, :2].T,
            "right": self.mask[:, -2:].T,
        }
        cuts = {side: np.flatnonzero(band.any(axis=0)) for side, band in bands.items()}
        return {side: cut for side, cut in cuts.items() if cut.size > 2}

    def check_alone(self) -> None:
        """Refuse to guess which of several objects is the finger."""
        if not self.alone:
            raise ImageError(
                "more than one object stands out that may be the finger, such as a coin, a ruler or another "
                "finger: crop the picture to the finger, or give region_of_interest round the arc of its pad"
            )

    def check_tip(self, tip: Direction) -> None:
        """Refuse a finger that enters the picture from a side beside its tip, in the middle of its extent."""
        finger = np.flatnonzero(self.mask.any(axis=1 if tip in ("up", "down") else 0))
        cuts = self.cut_sides()
        for side, cut in () if opposite(tip) in cuts else cuts.items():
            off = abs(cut[0] + cut[-1] - finger[0] - finger[-1]) / 2
            if side != tip and off < _MIDDLE * np.ptp(finger):
                raise ImageError(
                    f"the finger enters the picture from the {side}, and with tip {tip} it would from the "
                    f"opposite side: give tip {opposite(side)}"
                )

    def check_not_cut(self, sides: tuple[Direction, ...], tip: Direction) -> None:
        """Refuse a finger whose pad lies on the frame."""
        finger = np.flatnonzero(self.mask.any(axis=1 if tip in ("up", "down") else 0))
        cuts = self.cut_sides()
        for side, cut in ((side, cuts[side]) for side in sides if side in cuts):
            # A tilted finger may leave through a side; its half at the tip may not.
            depth = cut[0] - finger[0] if tip in ("up", "left") else finger[-1] - cut[-1]
            if side == tip or len(sides) == 1 or depth < (finger[-1] - finger[0]) / 2:
                raise ImageError(
                    f"the frame cuts the finger on its {side} side, where the pad is: leave a margin there, "
                    "give region_of_interest or points for the part that shows, or check tip and palmar"
                )


def opponent_light(pixels: npt.NDArray[Any]) -> Float32Array:
    """Return luma as light, then the levels of red and blue beyond it; luma alone for a grey picture.

    Files keep luma sharp and colour at half the resolution, both of levels: apart, each is trusted as
    it deserves, and in levels the coarse colour neither blurs luma nor moves an edge.
    """
    if pixels.ndim == 2:
        return linear_light(pixels)[..., None]
    levels = as_float32(shares_of_top(pixels)[..., :3])
    luma = as_float32(levels @ LUMA)
    return np.stack([linear_light(luma), levels[..., 0] - luma, levels[..., 2] - luma], axis=-1)


def find_silhouette(light: Float32Array, root: Direction | None, window: Window | None) -> Silhouette:
    """Set the finger apart from the backdrop whose colour is that of the frame's border.

    `root` is the side of the frame through which the finger comes in, None when it is seen end on; `window`
    is where the finger that is meant lies, if it need not be the largest: without it, a coin that lies beside
    the finger and fills more of the frame is left out, as it does not come in.
    """
    reduction = max(1.0, max(light.shape[:2]) / _SIDE_PX)
    rows, columns = (max(1, round(side / reduction)) for side in light.shape[:2])
    if min(rows, columns) < _MIN_SIDE_PX:
        raise ImageError(
            f"a photograph of {light.shape[0]} × {light.shape[1]} pixels is too small: "
            f"{_MIN_SIDE_PX} px a side are the least"
        )
    small = as_float32(cv2.resize(light, (columns, rows), interpolation=cv2.INTER_AREA))
    small = as_float32(cv2.GaussianBlur(small, (0, 0), 1.2)).reshape(rows, columns, -1)
    off, noise = _off_backdrop(small, root)
    # Channel by channel, since sums over three neighbours in memory take several times as long.
    whitened = cv2.split(cv2.transform(off, np.linalg.inv(np.linalg.cholesky(noise))))
    distance = np.sqrt(sum(part * part for part in whitened))
    first, second = (
        slice(int(part.start / reduction), math.ceil(part.stop / reduction))
        for part in window or (slice(0, light.shape[0]), slice(0, light.shape[1]))
    )
    way_in = root if window is None else None
    mask, rival = _component(_finger(distance), (first, second), way_in)
    alone = rival < (_RIVAL_END_ON if root is None else _RIVAL_COMING_IN)
    return Silhouette(mask, reduction, alone)


def _off_backdrop(small: Float32Array, root: Direction | None) -> tuple[FloatArray, FloatArray]:
    """Return what each pixel has beyond the backdrop, a smooth surface through the border, and its noise."""
    rows, columns = small.shape[:2]
    band = max(3, round(0.025 * min(rows, columns)))
    border = np.ones((rows, columns), dtype=bool)
    border[band:-band, band:-band] = False
    if root is not None:
        step = STEPS[root]
        cut = np.arange(rows)[:, None] * step[0] + np.arange(columns)[None, :] * step[1]
        border &= cut < cut.max() - 2 * band
    down, across = np.linspace(-1, 1, rows)[:, None], np.linspace(-1, 1, columns)
    y, x = (np.broadcast_to(part, border.shape)[border] for part in (down, across))
    design = quadratic_terms(x, y)
    colours = small[border].astype(np.float64)
    # To begin with, those nearest to the commonest colour.
    far = np.abs(colours - np.median(colours, axis=0)).sum(axis=1)
    for _ in range(5):
        near = far <= np.quantile(far, 0.6)
        far = np.abs(colours - colours[near].mean(axis=0)).sum(axis=1)
    good = far <= np.quantile(far, 0.6)
    floor = np.eye(colours.shape[1]) * 1e-6
    for order in (1, 3, 3, 6, 6, 6):
        factors = np.linalg.lstsq(design[good, :order], colours[good], rcond=None)[0]
        left = colours - design[:, :order] @ factors
        noise = left[good].T @ left[good] / good.sum() + floor
        far = np.sqrt(np.sum(left @ np.linalg.inv(noise) * left, axis=1))
        good = far < max(4.0, 2 * float(np.median(far[good])))
    if good.mean() < 0.4:
        raise ImageError(
            f"only {100 * good.mean():.0f} % of the frame's border shows one backdrop: "
            "photograph the finger before a plain backdrop, and leave a margin round the pad"
        )
    surfaces = [quadratic_surface(part, border.shape) for part in factors.T]
    off = cv2.subtract(small, cv2.merge(surfaces), dtype=cv2.CV_64F).reshape(small.shape)
    return np.asarray(off, dtype=np.float64), noise


def _finger(distance: FloatArray) -> BoolArray:
    """Return what stands out from the backdrop."""
    level = np.clip(np.log1p(distance) * 40, 0, 255).astype(np.uint8)
    otsu, _ = cv2.threshold(level, 0, 255, cv2.THRESH_BINARY + cv2.THRESH_OTSU)
    out = distance > max(_MIN_DISTANCE, math.expm1(otsu / 40))
    if out.mean() < _MIN_AREA_SHARE:
        raise ImageError(
            f"no finger found, {100 * out.mean():.1f} % of the photograph stands out from the backdrop: "
            "choose a backdrop of another colour than the skin, or come nearer"
        )
    mask = distance > max(_MIN_DISTANCE, _SHARE_OF_CONTRAST * float(np.median(distance[out])))
    if mask.mean() > _MAX_AREA_SHARE:
        raise ImageError(
            f"{100 * mask.mean():.0f} % of the photograph would be finger: leave a margin of backdrop"
        )
    return np.asarray(mask, dtype=bool)


def _component(mask: BoolArray, window: Window, way_in: Direction | None) -> tuple[BoolArray, float]:
    """Return the region that fills most of the window, without holes; first one that comes in by `way_in`.

    Beside it the size of the next, relative to it.
    """
    size = max(3, round(0.006 * max(mask.shape)) | 1)
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size))
    padded = cv2.copyMakeBorder(mask.astype(np.uint8), size, size, size, size, cv2.BORDER_REPLICATE)
    opened = cv2.morphologyEx(cv2.morphologyEx(padded, cv2.MORPH_CLOSE, kernel), cv2.MORPH_OPEN, kernel)
    _, labels = cv2.connectedComponents(opened[size:-size, size:-size])
    counts = np.bincount(labels[window].ravel(), minlength=labels.max() + 1)
    counts[0] = 0
    if way_in is not None:
        sides = {"up": labels[0], "down": labels[-1], "left": labels[:, 0], "right": labels[:, -1]}
        coming_in = np.where(np.bincount(sides[way_in], minlength=len(counts)) > 0, counts, 0)
        if coming_in.max() > _LEAST_COMING_IN * counts.max():
            counts = coming_in
    if counts.max() < _MIN_AREA_SHARE * mask.size / 4:
        raise ImageError(
            "no finger found where it was looked for: move region_of_interest, or leave it out"
            if counts.max() < np.bincount(labels.ravel())[1:].max(initial=0)
            else "no finger found, only specks stand out from the backdrop: come nearer"
        )
    following, largest = np.sort(counts)[-2:]
    return fill_holes(labels == counts.argmax()), float(following / largest)


def _smooth_contour(points: FloatArray, *, closed: bool) -> FloatArray:
    """Return a pixel contour without its stairs, the ends of an open one in place."""
    reach = math.ceil(4 * _SMOOTHING_PX)
    if len(points) < 2 * reach:
        return points
    mode: dict[str, Any] = {"mode": "wrap"} if closed else {"mode": "reflect", "reflect_type": "odd"}
    padded = np.pad(points, ((reach, reach), (0, 0)), **mode)
    return as_float_array(gaussian_filter1d(padded, _SMOOTHING_PX, axis=0, radius=reach))[reach:-reach]


class SubpixelOutline(NamedTuple):
    """Points of an outline, evenly spaced."""

    points: FloatArray  # (n, 2); (row, column), px, in order
    found: BoolArray  # (n,); whether the edge was found there: where not, the point is the rough contour's
    blur: float  # px; standard deviation of the edges' blur
    step_ratio: FloatArray  # (n,); step across the edge over what its model leaves, both in light
    closed: bool  # whether the last point is next to the first

    def between(self, marks: FloatArray) -> IndexArray:
        """Return the indices of the outline's points from the first to the last mark, by way of all."""
        away = np.linalg.norm(self.points[:, None] - marks, axis=2)
        nearest, off = np.sort(away.argmin(axis=0)), away.min(axis=0)
        if off.max() > _MARK_REACH * float(np.ptp(self.points, axis=0).min()):
            row, column = marks[off.argmax()]
            raise ImageError(
                f"points: the mark at row {row:g}, column {column:g} is {off.max():.0f} px off "
                "the finger's outline: put marks on the edge of the pad"
            )
        count = len(self.points)
        if self.closed:
            # The arc leaves out the widest gap between marks.
            gaps = np.diff(np.append(nearest, nearest[0] + count))
            first = int((np.argmax(gaps) + 1) % len(nearest))
            return np.asarray(
                (nearest[first] + np.arange(count - int(gaps.max()) + 1)) % count, dtype=np.intp
            )
        return np.arange(nearest[0], nearest[-1] + 1)

    def within(self, window: Window) -> IndexArray:
        """Return the indices of the outline's points in the longest piece inside the region of interest."""
        rows, columns = window
        first, end = (rows.start, columns.start), (rows.stop, columns.stop)
        inside: BoolArray = np.all((self.points >= first) & (self.points < end), axis=1)
        return max(runs(inside, closed=self.closed), key=len, default=np.arange(0))


def locate_edges(
    light: Float32Array, contour: FloatArray, *, reach: float, spacing: float
) -> SubpixelOutline:
    """Locate the edge within `reach` of each point of a rough contour, (row, column), px.

    The profile along each normal is, in each channel of `opponent_light`, a blurred edge between a backdrop
    that changes evenly and a rounded body that brightens as the square root of the depth from its limb; the
    position is that of least squares over all channels, with one blur.
    """
    closed = bool(np.linalg.norm(contour[0] - contour[-1]) < 3 * np.linalg.norm(contour[1] - contour[0]) + 2)
    points = evenly_spaced(contour, spacing, closed=closed, min_count=8)
    normals = outward_normals(points, closed=closed)
    offsets = _even(reach + _BEYOND_PX, 1 / _DENSITY)
    spots = points[:, None] + offsets[:, None] * normals[:, None]
    samples = sample(light, spots[..., ::-1]).reshape(*spots.shape[:2], -1).astype(np.float64)
    # The outline is smooth over a few pixels: neighbours share their noise.
    profiles = gaussian_filter1d(samples, _ALONG_PX / spacing, axis=0, mode="wrap" if closed else "nearest")
    places, ratio, blur = _fit_edges(profiles, reach)
    found = np.isfinite(places) & (ratio > _MIN_STEP_RATIO)
    moved = points + np.where(found, places, 0.0)[:, None] * normals
    return SubpixelOutline(moved, found, blur, ratio, closed)


def _residual_squares(profiles: FloatArray, blur: float, reach: float) -> tuple[FloatArray, FloatArray]:
    """Return the squares that the model of one channel leaves with the edge at each place, and its step²."""
    basis, across = _edge_bases(blur, reach)
    parts = np.einsum("no,toj->tnj", profiles, basis, optimize=True)
    left = np.sum(profiles**2, axis=1) - np.sum(parts**2, axis=2)
    return np.asarray(left), np.asarray((parts @ across)[..., 0] ** 2)


@lru_cache(maxsize=32)
def _edge_bases(blur: float, reach: float) -> tuple[FloatArray, FloatArray]:
    """Return orthonormal terms of the model with the edge at each place, and what its step has of each."""
    tries, offsets = _even(reach, _TRIAL_STEP), _even(reach + _BEYOND_PX, 1 / _DENSITY)
    basis, triangle = np.linalg.qr(_model(tries[:, None] - offsets, offsets, blur))
    # Levels of the model just inside and just outside.
    ends = np.column_stack(
        [np.ones_like(tries), np.full_like(tries, math.sqrt(2 * blur + 1)), -np.ones_like(tries), -tries]
    )
    return basis, np.linalg.solve(np.swapaxes(triangle, 1, 2), ends[..., None])


def _even(half: float, step: float) -> FloatArray:
    """Return offsets along a normal from minus half to half of it, px."""
    return np.arange(-half, half + step / 2, step)


def _fit_edges(profiles: FloatArray, reach: float) -> tuple[FloatArray, FloatArray, float]:
    """Return each profile's edge, NaN at the end of the reach, and its step over what its model leaves.

    With them comes the blur of the first channel.
    """
    count, samples, channels = profiles.shape
    some = profiles[:: max(1, count // 150)]
    blurs, left, steps = [], np.zeros(()), np.zeros(())
    for k in range(channels):
        tried = [np.mean(_residual_squares(some[..., k], blur, reach)[0].min(axis=0)) for blur in _BLURS]
        blurs.append(float(_BLURS[int(np.argmin(tried))]))
        # A channel counts by the variance that its own best model leaves. Rounding to 256 levels is the
        # least noise there is.
        weight = 1 / (min(tried) / (samples - 5) + _MIN_VARIANCE)
        squares, step = _residual_squares(profiles[..., k], blurs[k], reach)
        left, steps = left + weight * squares, steps + weight * step
    tries = _even(reach, _TRIAL_STEP)
    best = np.clip(left.argmin(axis=0), 1, len(tries) - 2)
    which = np.arange(count)
    before, here, after = left[best - 1, which], left[best, which], left[best + 1, which]
    bend = before - 2 * here + after
    with np.errstate(divide="ignore", invalid="ignore"):
        shift = np.where(bend > 0, 0.5 * (before - after) / bend, np.nan)
        places = np.where(np.abs(shift) <= 1, tries[best] + shift * _TRIAL_STEP, np.nan)
        ratio = np.sqrt(steps[best, which] / np.maximum(here / (channels * (samples - 4) - 1), 1e-12))
    return places, ratio, blurs[0]


def _model(depths: FloatArray, offsets: FloatArray, blur: float) -> FloatArray:
    """Return the terms of an edge's profile: skin, its limb's brightening, backdrop, backdrop's slope."""
    skin = ndtr(depths / blur)
    fine = np.linspace(-4, 4, 41)
    weights = np.exp(-0.5 * fine**2)
    limb = np.sqrt(np.maximum(depths[..., None] + blur * fine, 0)) @ (weights / weights.sum())
    return np.stack([skin, limb, 1 - skin, offsets * (1 - skin)], axis=-1)
