"""Arguments of measuring a photograph: picture, region of interest and marks."""

import math
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array, real_array
from fingerpad.exceptions import ImageError
from fingerpad.image.levels import LUMA, linear_light, picture_array
from fingerpad.image.photograph._edges import SubpixelOutline
from fingerpad.image.photograph._silhouette import Silhouette
from fingerpad.image.photograph.orientation import Direction, Face

Window: TypeAlias = tuple[slice, slice]
IndexArray: TypeAlias = npt.NDArray[np.intp]

# How far a mark may be off the outline, in widths of the finger.
_MARK_REACH = 0.1


def opponent_light(pixels: npt.NDArray[Any]) -> npt.NDArray[np.float32]:
    """Return luma as light, then red and blue beyond it; luma alone for a grey picture.

    Cameras' files keep luma sharp and colour at half the resolution: apart, each is trusted as it deserves.
    """
    if pixels.ndim == 2:
        return linear_light(pixels)[..., None]
    light = linear_light(pixels[..., :3])
    luma = light @ LUMA
    np.subtract(light[..., 0], luma, out=light[..., 1])
    light[..., 2] -= luma
    light[..., 0] = luma
    return light


def between(edges: SubpixelOutline, marks: FloatArray) -> IndexArray:
    """Return the indices of the outline's points from the first to the last mark, by way of all."""
    away = np.linalg.norm(edges.points[:, None] - marks, axis=2)
    nearest = np.sort(away.argmin(axis=0))
    reach = _MARK_REACH * float(np.ptp(edges.points, axis=0).min())
    worst = int(away.min(axis=0).argmax())
    if away.min(axis=0)[worst] > reach:
        row, column = marks[worst]
        raise ImageError(
            f"points: the mark at row {row:g}, column {column:g} is {away.min(axis=0)[worst]:.0f} px off "
            "the finger's outline: put marks on the edge of the pad"
        )
    count = len(edges.points)
    if edges.closed:
        # The arc leaves out the widest gap between marks.
        gaps = np.diff(np.append(nearest, nearest[0] + count))
        first = int((np.argmax(gaps) + 1) % len(nearest))
        return np.asarray((nearest[first] + np.arange(count - int(gaps.max()) + 1)) % count, dtype=np.intp)
    return np.arange(nearest[0], nearest[-1] + 1)


def within(edges: SubpixelOutline, window: Window) -> IndexArray:
    """Return the indices of the outline's points in the longest piece inside the region of interest."""
    rows, columns = window
    row, column = edges.points.T
    inside = (row >= rows.start) & (row < rows.stop) & (column >= columns.start) & (column < columns.stop)
    if inside.all():
        return np.arange(len(inside))
    start = int(np.argmin(inside)) if edges.closed else 0
    order = np.roll(np.arange(len(inside)), -start)
    pieces = np.split(order, np.flatnonzero(np.diff(inside[order].astype(int))) + 1)
    longest: IndexArray = max((piece for piece in pieces if inside[piece[0]]), key=len, default=order[:0])
    return longest


def pad_sides(face: Face, tip: Direction, palmar: Direction) -> tuple[Direction, ...]:
    """Return the sides of the frame that the pad faces, where it must not be cut."""
    return {"palmar": (tip,), "distal": (palmar,)}.get(face, (tip, palmar))


def check_not_cut(silhouette: Silhouette, sides: tuple[Direction, ...], tip: Direction) -> None:
    """Refuse a finger whose pad lies on the frame."""
    rows, columns = np.nonzero(silhouette.mask)
    cuts = silhouette.cut_sides()
    for side in sides:
        if side not in cuts:
            continue
        along = rows if tip in ("up", "down") else columns
        low, high = float(along.min()) * silhouette.reduction, float(along.max()) * silhouette.reduction
        first, last = cuts[side]
        # A tilted finger may leave through a side; its half at the tip may not.
        depth = {"up": (first - low), "left": (first - low), "down": (high - last), "right": (high - last)}[
            tip
        ]
        if side == tip or len(sides) == 1 or depth < (high - low) / 2:
            raise ImageError(
                f"the frame cuts the finger on its {side} side, where the pad is: leave a margin there, give "
                "region_of_interest or points for the part that shows, or check tip and palmar"
            )


def check_image(pixels: npt.ArrayLike) -> npt.NDArray[Any]:
    """Return the picture, validated."""
    values = picture_array(pixels, "pixels")
    if not (values.ndim == 2 or (values.ndim == 3 and values.shape[2] in (3, 4))) or not values.size:
        raise ImageError(
            f"pixels must be grey (rows, columns) or colour (rows, columns, 3), found shape {values.shape}"
        )
    if values.dtype.kind not in "uif":
        raise ImageError(f"pixels must be numbers, found {values.dtype}: read the picture as grey or colour")
    if values.dtype.kind == "f" and not np.isfinite(values).all():
        raise ImageError("pixels must be finite: fill NaN and infinite ones before measuring")
    return values


def check_window(region: tuple[float, float, float, float], size: tuple[int, int]) -> Window:
    """Return the region of interest as slices."""
    edges = real_array(region, "region_of_interest", ImageError)
    if edges.shape != (4,) or not np.isfinite(edges).all():
        raise ImageError(f"region_of_interest must be four numbers, row, column, row, column, found {region}")
    first_row, first_column, last_row, last_column = edges.tolist()
    rows = slice(max(0, math.floor(first_row)), min(size[0], math.ceil(last_row)))
    columns = slice(max(0, math.floor(first_column)), min(size[1], math.ceil(last_column)))
    if rows.stop <= rows.start or columns.stop <= columns.start:
        raise ImageError(
            f"region_of_interest {region} is empty or outside the picture of {size[0]} rows and {size[1]} "
            "columns: give first row, first column, last row, last column"
        )
    return rows, columns


def check_marks(points: ArrayLike, size: tuple[int, int]) -> FloatArray:
    """Return the marks, checked."""
    marks = real_array(points, "points", ImageError)
    if marks.ndim != 2 or marks.shape[1] != 2 or len(np.unique(marks, axis=0)) < 2:
        raise ImageError(
            f"points must be two or more different marks (row, column), found shape {marks.shape}"
        )
    inside = (
        np.isfinite(marks).all(axis=1)
        & (marks >= 0).all(axis=1)
        & (marks <= as_float_array(size) - 1).all(axis=1)
    )
    if not inside.all():
        row, column = marks[int(np.argmin(inside))]
        raise ImageError(
            f"points: row {row:g}, column {column:g} is outside the picture of {size[0]} rows and {size[1]} "
            "columns: give marks as (row, column)"
        )
    return marks
