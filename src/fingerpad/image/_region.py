"""From ridges to contact patches: closing at the ridges' scale, cutting at necks, dropping appendages."""

import math

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray

# Radii in ridge periods.
CLOSING_RADIUS = 1.1
_OPENING_RADIUS = 0.8
_LEAST_NOTCH = 1.0
# A neck is narrower than this share of the narrower of the widths on its two sides.
_NECK_RATIO = 0.78
_LEAST_PART = 0.03
# Parts narrower than this share of the patch's width are not finger.
_APPENDAGE_RATIO = 0.35


def closed(mask: BoolArray, radius: float) -> BoolArray:
    """Close a mask with a true disk."""
    pad = math.ceil(radius) + 2
    padded = np.pad(mask, pad)
    grown = _distance_to(padded) <= radius
    return (_distance_to(~grown) > radius)[pad:-pad, pad:-pad]


def opened(mask: BoolArray, radius: float) -> BoolArray:
    """Open a mask with a true disk; the frame counts as mask, so that a cut patch keeps its corners."""
    pad = math.ceil(radius) + 2
    padded = np.pad(mask, pad, mode="edge")
    return (_distance_to(_distance_to(~padded) > radius) <= radius)[pad:-pad, pad:-pad]


def _distance_to(mask: BoolArray) -> npt.NDArray[np.float32]:
    """Return the distance of each pixel from the nearest set one."""
    if not mask.any():
        return np.full(mask.shape, np.inf, dtype=np.float32)
    distance = cv2.distanceTransform((~mask).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    return np.asarray(distance, dtype=np.float32)


def shifted(mask: BoolArray, outward: float) -> BoolArray:
    """Move the edge of a mask outward by a distance in px, not past the frame."""
    return np.asarray(_distance_to(mask) - 0.5 <= outward) | mask


def filled(mask: BoolArray) -> BoolArray:
    """Fill the holes."""
    contours, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    canvas = np.zeros(mask.shape, dtype=np.uint8)
    cv2.drawContours(canvas, contours, -1, 1, cv2.FILLED)
    return canvas > 0


def without_specks(mask: BoolArray, least_area: float) -> BoolArray:
    """Drop connected pieces smaller than `least_area` px."""
    _, labels, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=8)
    keep = stats[:, cv2.CC_STAT_AREA] >= least_area
    keep[0] = False
    return np.asarray(keep[labels])


def contact_mask(ridges: BoolArray, period: float) -> BoolArray:
    """Return the gross contact: ridges closed over valleys, holes filled, specks and whiskers dropped."""
    mask = without_specks(ridges, (0.25 * period) ** 2)
    if not mask.any():
        return mask
    box = box_of(mask, margin=0)
    gross = np.zeros_like(mask)
    gross[box] = opened(filled(closed(mask[box], CLOSING_RADIUS * period)), _OPENING_RADIUS * period)
    return gross


def patches_of(mask: BoolArray, period: float) -> list[BoolArray]:
    """Return the patches of contact that matter, cut at necks, largest first."""
    patches: list[BoolArray] = []
    for piece in _pieces(mask, (3 * period) ** 2, share=0.1):
        box = box_of(piece, margin=2)
        for part in _split_at_necks(piece[box], period):
            whole = np.zeros_like(mask)
            whole[box] = part
            patches.append(whole)
    return sorted(patches, key=np.count_nonzero, reverse=True)


def box_of(mask: BoolArray, margin: int) -> tuple[slice, slice]:
    """Return the box round a mask with a margin, inside the picture."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    return (
        slice(max(0, int(rows[0]) - margin), int(rows[-1]) + margin + 1),
        slice(max(0, int(columns[0]) - margin), int(columns[-1]) + margin + 1),
    )


def without_appendages(patch: BoolArray, period: float) -> BoolArray:
    """Drop what is much narrower than the patch: letters, pen marks, stubs of the next phalanx."""
    box = box_of(patch, margin=2)
    part = patch[box]
    inradius = float(_distance_to(~np.pad(part, 1)).max())
    core = opened(part, max(_APPENDAGE_RATIO * inradius, _OPENING_RADIUS * period))
    plain = np.zeros_like(patch)
    plain[box] = largest(part & (_distance_to(core) <= period))
    return plain


def largest(mask: BoolArray) -> BoolArray:
    """Return the largest connected piece."""
    _, labels, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=4)
    return np.asarray(labels == 1 + int(stats[1:, cv2.CC_STAT_AREA].argmax())) if len(stats) > 1 else mask


def _pieces(mask: BoolArray, least_area: float, share: float) -> list[BoolArray]:
    """Return the connected pieces that are not much smaller than the largest."""
    count, labels, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=4)
    areas = stats[1:, cv2.CC_STAT_AREA]
    least = max(least_area, share * areas.max(initial=0))
    return [labels == k for k in range(1, count) if areas[k - 1] >= least]


def _split_at_necks(patch: BoolArray, period: float, depth: int = 4) -> list[BoolArray]:
    """Cut a patch where it narrows between two wider parts, as at the crease of a joint."""
    cut = _neck(patch, period) if depth else None
    if cut is None:
        return [patch]
    canvas = patch.astype(np.uint8)
    cv2.line(canvas, cut[0], cut[1], 0, 2)
    parts = _pieces(canvas > 0, 0, share=_LEAST_PART)
    if len(parts) < 2:
        return [patch]
    return [piece for part in parts for piece in _split_at_necks(part, period, depth - 1)]


def _neck(patch: BoolArray, period: float) -> tuple[tuple[int, int], tuple[int, int]] | None:
    """Return the ends (x, y) of the best cut across a neck, None where there is none."""
    points = outline(patch)
    notches, depths = _notches(points)
    deep = depths > _LEAST_NOTCH * period
    notches, depths = notches[deep], depths[deep]
    best, best_ratio = None, _NECK_RATIO
    for start, depth in zip(notches, depths, strict=True):
        for end in _opposite(points, int(start), notches, float(depth), period):
            ratio = _narrowness(points, int(start), int(end))
            if ratio < best_ratio:
                best_ratio = ratio
                (x0, y0), (x1, y1) = points[start].astype(int), points[end].astype(int)
                best = ((int(x0), int(y0)), (int(x1), int(y1)))
    return best


def outline(patch: BoolArray) -> npt.NDArray[np.float64]:
    """Return the pixels (x, y) of the longest outer contour, in order."""
    contours, _ = cv2.findContours(patch.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    return max(contours, key=len).reshape(-1, 2).astype(np.float64)


def _notches(points: npt.NDArray[np.float64]) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.float64]]:
    """Return the deepest point under each side of the convex hull, and its depth."""
    hull = np.sort(cv2.convexHull(points.astype(np.float32), returnPoints=False).ravel())
    deepest, depths = [], []
    for start, end in zip(hull, np.append(hull[1:], hull[0] + len(points)), strict=True):
        between = np.arange(start, end + 1) % len(points)
        side = points[between[-1]] - points[between[0]]
        off = points[between] - points[between[0]]
        depth = np.abs(side[0] * off[:, 1] - side[1] * off[:, 0]) / max(float(np.hypot(*side)), 1e-9)
        deepest.append(between[depth.argmax()])
        depths.append(depth.max())
    return np.asarray(deepest, dtype=np.intp), np.asarray(depths, dtype=np.float64)


def _opposite(
    points: npt.NDArray[np.float64], start: int, notches: npt.NDArray[np.intp], depth: float, period: float
) -> list[int]:
    """Return the ends that a cut from a notch may have: other notches, or for a deep one the far side."""
    ends = [int(k) for k in notches if k != start]
    count = len(points)
    if depth > 4 * period:
        away = np.abs((np.arange(count) - start + count // 2) % count - count // 2)
        distance = np.linalg.norm(points - points[start], axis=1)
        distance[away < count // 6] = np.inf
        ends.append(int(distance.argmin()))
    return ends


def _narrowness(points: npt.NDArray[np.float64], start: int, end: int) -> float:
    """Return the length of a cut over the lesser width, along the cut, of the two parts it makes."""
    chord = points[end] - points[start]
    length = float(np.linalg.norm(chord))
    if length == 0:
        return math.inf
    low, high = sorted((start, end))
    along = points @ (chord / length)
    parts = (along[low : high + 1], np.concatenate([along[high:], along[: low + 1]]))
    return length / min(float(np.ptp(part)) for part in parts)
