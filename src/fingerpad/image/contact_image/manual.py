"""Manual corrections of a contact region: brush strokes, polygons and ellipses."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal, TypeAlias

import cv2
import numpy as np
from scipy.spatial import cKDTree

from fingerpad._arrays import FloatArray, as_float_array, positive_number, real_array, set_fields
from fingerpad._display import Displayed
from fingerpad.exceptions import ImageError
from fingerpad.image._masks import BITS, UInt8, fill_holes, filled_polygon, outer_contours, to_fixed_point
from fingerpad.image.contact_image.edge import Edge, even_edge, point_spacings, running_mean, smooth_normals
from fingerpad.image.contact_image.region import OTHER_REGION, Region
from fingerpad.image.contact_image.view import View
from fingerpad.image.ellipse import ImageEllipse, evenly_spaced, nearest_on_sides

_FINE: Final = 4  # strokes are drawn on a canvas so many times finer than the working copy
# Nearer than this, px of the copy, a point of the edited outline is one of the automatic outline.
_SAME: Final = 0.6
_FAR: Final = 2e4  # no farther than this OpenCV draws, px
_MAX_REACH: Final = 10  # strokes that reach beyond so many pictures are refused


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class BrushStroke(Displayed):
    """A stroke of a round brush."""

    action: Literal["add", "remove"]
    points: Sequence[tuple[float, float]]  # (row, column) along the stroke, px; one point is a disk
    radius: float  # of the brush, px

    def __post_init__(self) -> None:
        _check_drawn("a stroke", self.action, ("add", "remove"), self.points, least=1)
        set_fields(self, radius=positive_number(self.radius, "radius of a stroke", ImageError))


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class RegionPolygon(Displayed):
    """An area that a person drew around; ``replace`` makes it the region in place of what was before."""

    action: Literal["add", "remove", "replace"]
    points: Sequence[tuple[float, float]]  # (row, column) of three or more corners, px

    def __post_init__(self) -> None:
        _check_drawn("a polygon", self.action, ("add", "remove", "replace"), self.points, least=3)


RegionEdit: TypeAlias = BrushStroke | RegionPolygon


def region_of_ellipse(ellipse: ImageEllipse, view: View) -> tuple[Region, Edge]:
    """Return the region and the edge of an ellipse placed manually."""
    major, shape = ellipse.semi_axes[0], view.part.shape
    _require_near("ellipse", as_float_array([ellipse.centre]), 0.0, major, shape)
    count = max(64, math.ceil(2 * math.pi * major / min(view.steps)))
    points = view.to_copy(ellipse.points(count)[:, ::-1])
    patch = _filled(points, view.contact.shape) > 0
    return Region(patch=patch, several=False), even_edge(points, view, drawn=True)


def region_after_strokes(
    before: tuple[Region, Edge] | None, strokes: Sequence[RegionEdit], view: View
) -> tuple[Region, Edge]:
    """Return the region and the edge after strokes over the automatic ones, if there are any.

    Their rim becomes the edge; elsewhere the automatic edge is kept, unless a polygon replaces the region.
    """
    shape = view.contact.shape
    replaced = max((k for k, edit in enumerate(strokes) if edit.action == "replace"), default=None)
    if replaced is not None:
        before, strokes = None, strokes[replaced:]
    patch = np.zeros(shape, np.uint8) if before is None else before[0].patch.astype(np.uint8)
    fine = np.zeros((_FINE * shape[0], _FINE * shape[1]), dtype=np.uint8)
    if before is not None:
        fine = _filled(_to_fine_canvas(before[1].points), fine.shape)
    for stroke in strokes:
        points, radius = _check_edit(stroke, view)
        level = int(stroke.action != "remove")
        _draw(patch, points, radius, level)
        _draw(fine, _to_fine_canvas(points), radius and _FINE * radius, level)
    contours = outer_contours(fine)
    areas = [cv2.contourArea(contour) for contour in contours]
    if not max(areas, default=0.0) > (_FINE * view.period) ** 2:
        raise ImageError("the strokes leave no contact: add to the region, or undo some of them")
    chosen = int(np.argmax(areas))
    rough = (contours[chosen].reshape(-1, 2) + 0.5) / _FINE - 0.5
    other = max((area for k, area in enumerate(areas) if k != chosen), default=0.0) / areas[chosen]
    region = Region(
        patch=(patch & _filled(rough, shape)) > 0,
        several=other > OTHER_REGION or (before is not None and before[0].several),
    )
    outline = evenly_spaced(running_mean(rough, _FINE))
    return region, even_edge(outline, view, drawn=True) if before is None else _restored_edge(
        outline, before[1]
    )


def _restored_edge(outline: FloatArray, edge: Edge) -> Edge:
    """Return an edited outline, on the automatic edge wherever it follows that."""
    nearest = cKDTree(edge.points).query(outline)[1]
    beside = edge.points[(nearest + np.array([[-1], [1]])) % len(edge.points)]
    on_sides = nearest_on_sides(outline, edge.points[nearest], beside)
    before, after = np.linalg.norm(outline - on_sides, axis=2)
    same = np.minimum(before, after) < _SAME
    on_edge = np.where((after < before)[:, None], on_sides[1], on_sides[0])
    points = np.where(same[:, None], on_edge, outline)
    return replace(
        edge,
        points=points,
        normals=smooth_normals(points, edge.period),
        steps=point_spacings(points),
        manual=~same | edge.manual[nearest],
        differs=np.where(same, edge.differs[nearest], 0.0),
    )


def _check_drawn(
    what: str, action: str, actions: tuple[str, ...], points: Sequence[tuple[float, float]], *, least: int
) -> None:
    if action not in actions:
        raise ImageError(f"{what} must {' or '.join(actions)}, found {action!r}")
    places = real_array(points, f"points of {what}", ImageError)
    if places.ndim != 2 or places.shape[1] != 2 or len(places) < least or not np.isfinite(places).all():
        raise ImageError(
            f"{what} needs finite points (row, column), {least} or more, found shape {places.shape}"
        )


def _check_edit(edit: RegionEdit, view: View) -> tuple[FloatArray, float | None]:
    """Return an edit's points (x, y) and, of a stroke, its radius in px of the copy."""
    points = as_float_array(edit.points)
    radius = edit.radius if isinstance(edit, BrushStroke) else None
    what = "a polygon" if radius is None else "a stroke"
    if radius is not None and radius > max(view.part.shape):
        raise ImageError(
            f"a stroke's radius must be no more than the picture's {max(view.part.shape)} px, found {radius}"
        )
    # A polygon may lie around the whole picture.
    around = 0.0 if radius is not None else float(np.ptp(points, axis=0).max())
    _require_near(what, points, around + (radius or 0.0), float(np.abs(points).max()), view.part.shape)
    return view.to_copy(points[:, ::-1]), radius and radius / view.step


def _require_near(what: str, points: FloatArray, margin: float, reach: float, shape: tuple[int, int]) -> None:
    """Refuse places of which none is within a margin of the picture, and what reaches far beyond it."""
    inside = ((points > -0.5 - margin) & (points < np.array(shape) - 0.5 + margin)).all(axis=1)
    row, column = points[0]
    size = f"the picture of {shape[0]} rows and {shape[1]} columns"
    if not inside.any():
        raise ImageError(f"{what} at row {row:g}, column {column:g} lies outside {size}")
    if reach > _MAX_REACH * max(shape):
        raise ImageError(f"{what} must not reach {reach:g} px: that is far beyond {size}")


def _draw(canvas: UInt8, points: FloatArray, radius: float | None, level: int) -> None:
    """Paint a stroke, or fill a polygon; OpenCV rounds the ends and joints of a thick line."""
    if radius is None:
        # A hand crosses its own line: everything inside the outermost line counts.
        canvas[fill_holes(_filled(points, canvas.shape) > 0)] = level
        return
    fixed = to_fixed_point(points.clip(-_FAR, _FAR))
    if len(points) > 1:
        cv2.polylines(canvas, [fixed], False, level, max(1, round(2 * radius)), cv2.LINE_8, BITS)
    else:
        x, y = map(int, fixed[0])
        cv2.circle(canvas, (x, y), round(radius * 2**BITS), level, cv2.FILLED, cv2.LINE_8, BITS)


def _to_fine_canvas(points: FloatArray) -> FloatArray:
    """Return places on the fine canvas; pixel centres are whole numbers on both."""
    return np.asarray((points + 0.5) * _FINE - 0.5)


def _filled(points: FloatArray, shape: tuple[int, ...]) -> UInt8:
    return filled_polygon(points.clip(-_FAR, _FAR), shape)
