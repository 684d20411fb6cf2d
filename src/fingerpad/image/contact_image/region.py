"""The region of a contact: a patch of closed ridges, cut at necks and freed of appendages."""

import math
from dataclasses import dataclass
from typing import Final

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, FloatArray
from fingerpad.exceptions import ImageError
from fingerpad.image._masks import (
    UInt8,
    bounding_box,
    disk,
    distance_to,
    fill_holes,
    filled_contours,
    largest_piece,
    longest_contour,
    outer_contours,
)
from fingerpad.image.contact_image.ridges import HALF, Ridges
from fingerpad.image.contact_image.view import View
from fingerpad.image.ellipse import polygon_moments

_OPENING_RADIUS: Final = 0.8  # radius of the disk that opens patches, ridge periods
_MIN_NOTCH: Final = 1.0  # ridge periods; a notch is deeper
_DEEP_NOTCH: Final = 4.0  # ridge periods; one that is deeper may be cut across to the far side
_NECK_RATIO: Final = 0.78  # a neck is narrower than this share of the lesser of the widths beside it
_MOST_NECKS: Final = 4
_MIN_PART: Final = 0.03
_MIN_SHARE: Final = 0.1  # of the largest patch; smaller ones do not matter
_MIN_WIDTH: Final = 3  # ridge periods; nor do narrower ones
_APPENDAGE_RATIO: Final = 0.35  # parts narrower than this share of the patch's width are not finger
_WIDTH_STEP: Final = 3  # every third pixel shows widths
_OFF_CENTRE: Final = 0.7  # a patch wins by its area, less so the further off the centre
OTHER_REGION: Final = 0.2  # beside other patches of this share of the contact's area there are several
OTHER_RIDGED: Final = 0.1  # beside patches with ridges, less
_RIDGED_STD: Final = 85  # their amounts of ridge have a greater standard deviation


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Region:
    """A contact in the copy."""

    patch: BoolArray  # (rows, columns); where it is, without holes
    several: bool  # whether there are other patches of some size

    @property
    def roundness(self) -> float:
        """Intersection over union of the patch and its ellipse."""
        outline = longest_contour(self.patch).reshape(-1, 2).astype(np.float64)
        return polygon_moments(outline).overlap(outline)


def find_region(view: View, ridges: Ridges, seed: tuple[float, float] | None) -> Region:
    """Find the contact among the closed ridges."""
    patches = _contact_patches(ridges.closed, view.period)
    if not patches:
        raise ImageError(
            "no contact found: nothing is as large as three ridge periods: check scale and polarity"
        )
    chosen = _chosen(patches, seed, view)
    contact = patches.pop(chosen)
    least = OTHER_REGION
    if view.resolved:  # then smears and dirt are not of the same print
        patches = [patch for patch in patches if ridges.amount[patch].std() > _RIDGED_STD]
        least = OTHER_RIDGED
    return Region(
        patch=_without_appendages(contact, view.period),
        several=bool(sum(map(np.count_nonzero, patches)) > least * np.count_nonzero(contact)),
    )


def _chosen(patches: list[BoolArray], seed: tuple[float, float] | None, view: View) -> int:
    """Return the number of the wanted patch: at the seed, or the largest with preference for the centre."""
    if seed is None:
        return int(np.argmax([_prominence(patch) for patch in patches])) if len(patches) > 1 else 0
    place = view.to_copy_pixel(*seed)
    for k, patch in enumerate(patches):
        if place is not None and patch[place]:
            return k
    raise ImageError(f"no contact found at seed {seed}: give a (row, column) within the print")


def _prominence(patch: BoolArray) -> float:
    moments = cv2.moments(longest_contour(patch))
    if not moments["m00"] > 0:
        return 0.0
    row, column = moments["m01"] / moments["m00"], moments["m10"] / moments["m00"]
    off = math.hypot(row / patch.shape[0] - 0.5, column / patch.shape[1] - 0.5)
    return float(moments["m00"]) * (1 - _OFF_CENTRE * off)


def _contact_patches(closed: UInt8, period: float) -> list[BoolArray]:
    """Return the patches of contact that matter, without holes and whiskers, cut at necks, largest first."""
    plain = fill_holes(closed >= HALF).astype(np.uint8)
    # The frame counts as contact, so that a cut patch keeps its corners.
    pad = math.ceil(_OPENING_RADIUS * period) + 1
    padded = cv2.copyMakeBorder(plain, pad, pad, pad, pad, cv2.BORDER_REPLICATE)
    opened = cv2.morphologyEx(padded, cv2.MORPH_OPEN, disk(_OPENING_RADIUS * period))[pad:-pad, pad:-pad] > 0
    patches: list[BoolArray] = []
    contours = outer_contours(opened)
    areas = [cv2.contourArea(contour) for contour in contours]
    least = max((_MIN_WIDTH * period) ** 2, _MIN_SHARE * max(areas, default=0.0))
    for contour, area in zip(contours, areas, strict=True):
        if area < least:
            continue
        x, y, columns, rows = cv2.boundingRect(contour)
        piece = filled_contours([contour - (x, y)], (rows, columns))
        for part in _split_at_necks(piece, period):
            whole = np.zeros(closed.shape, dtype=bool)
            whole[y : y + rows, x : x + columns] = part
            patches.append(whole)
    return sorted(patches, key=np.count_nonzero, reverse=True)


def _without_appendages(patch: BoolArray, period: float) -> BoolArray:
    """Drop what is much narrower than the patch: letters, pen marks, stubs of the next phalanx."""
    box = bounding_box(patch, margin=2)
    whole = patch[box].view(np.uint8)
    part, period = np.ascontiguousarray(whole[::_WIDTH_STEP, ::_WIDTH_STEP]), period / _WIDTH_STEP
    inradius = float(distance_to(cv2.copyMakeBorder(part, 1, 1, 1, 1, cv2.BORDER_CONSTANT) == 0).max())
    radius = max(_APPENDAGE_RATIO * inradius, _OPENING_RADIUS * period)
    # The frame counts as patch, so that a cut patch keeps its corners.
    pad = math.ceil(radius) + 2
    padded = cv2.copyMakeBorder(part, pad, pad, pad, pad, cv2.BORDER_REPLICATE)
    core = distance_to(padded == 0) > radius
    near = (distance_to(core) <= radius + period)[pad:-pad, pad:-pad].astype(np.uint8)
    finger = cv2.resize(near, whole.shape[::-1], interpolation=cv2.INTER_NEAREST) > 0
    plain = np.zeros_like(patch)
    plain[box] = largest_piece(patch[box] & finger)
    return plain


def _split_at_necks(patch: BoolArray, period: float, depth: int = _MOST_NECKS) -> list[BoolArray]:
    """Cut a patch where it narrows between two wider parts, as at the crease of a joint."""
    cut = _neck(patch, period) if depth else None
    if cut is None:
        return [patch]
    canvas = patch.astype(np.uint8)
    cv2.polylines(canvas, [cut], False, 0, 1, cv2.LINE_4)
    count, labels, stats, _ = cv2.connectedComponentsWithStats(canvas, connectivity=4)
    areas = stats[:, cv2.CC_STAT_AREA]
    least = _MIN_PART * areas[1:].max(initial=0)
    parts = [labels == k for k in range(1, count) if areas[k] >= least]
    if len(parts) < 2:
        return [patch]
    return [piece for part in parts for piece in _split_at_necks(part, period, depth - 1)]


def _neck(patch: BoolArray, period: float) -> npt.NDArray[np.int32] | None:
    """Return the ends (x, y) of the best cut across a neck, None where there is none."""
    contour = longest_contour(patch)
    hull = np.sort(cv2.convexHull(contour, returnPoints=False).ravel())
    defects = cv2.convexityDefects(contour, hull) if len(hull) > 3 else None
    if defects is None:
        return None
    # The deepest point under each side of the hull, and its depth in 1/256 px.
    _, _, deepest, depths = defects.reshape(-1, 4).T
    notches = {
        start: depth / 256 / period
        for start, depth in zip(deepest.tolist(), depths.tolist(), strict=True)
        if depth / 256 > _MIN_NOTCH * period
    }
    points = contour.reshape(-1, 2).astype(np.float64)
    ratios: dict[tuple[int, int], float] = {}
    for start, depth in notches.items():
        ends = [end for end in notches if end != start]
        ends += [_far_side(points, start)] if depth > _DEEP_NOTCH else []
        ratios |= {(start, end): _narrowness(points, start, end) for end in ends}
    best = min(ratios, key=lambda ends: ratios[ends], default=None)
    return None if best is None or ratios[best] >= _NECK_RATIO else contour[list(best)]


def _far_side(points: FloatArray, start: int) -> int:
    """Return the nearest point of a closed outline that is a sixth of it away or more."""
    count = len(points)
    away = np.abs((np.arange(count) - start + count // 2) % count - count // 2)
    distance = np.linalg.norm(points - points[start], axis=1)
    distance[away < count // 6] = np.inf
    return int(distance.argmin())


def _narrowness(points: FloatArray, start: int, end: int) -> float:
    """Return the length of a cut over the lesser width, along the cut, of the two parts it makes."""
    chord = points[end] - points[start]
    length = float(np.linalg.norm(chord))
    if length == 0:
        return math.inf
    low, high = sorted((start, end))
    along = points @ (chord / length)
    parts = (along[low : high + 1], np.concatenate([along[high:], along[: low + 1]]))
    return length / min(float(np.ptp(part)) for part in parts)
