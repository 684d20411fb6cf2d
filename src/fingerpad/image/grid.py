"""A checkerboard or a grid of dots: the scale of a plane, and its pictures without perspective."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final, Literal, TypeAlias, get_args

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import (
    FloatArray,
    as_float_array,
    non_negative_number,
    positive_number,
    real_array,
    set_fields,
)
from fingerpad._display import Displayed
from fingerpad.exceptions import CalibrationError
from fingerpad.image.levels import checked_picture, picture_levels
from fingerpad.image.read import ImageLike, levels_of
from fingerpad.image.scale import Scale

Pattern: TypeAlias = Literal["checkerboard", "dots"]

# Lengths that differ by more show a curved grid or a lens that bends lines.
_BENT: Final = 0.005
# Side lengths of pixels that differ by more show a tilt that one scale for all cannot describe.
_TILTED: Final = 0.01
_MIN_POINTS: Final = 3


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Grid(Displayed):
    """A flat grid of known spacing in a picture.

    Attributes
    ----------
    points : ndarray, shape (rows, columns, 2)
        Corners between squares, or centres of dots, (row, column), px.
    spacing_mm, spacing_mm_std : float
        Distance of neighbours, mm.
    homography : ndarray, shape (3, 3)
        Takes homogeneous (x, y), in spacings from the first point along rows and columns, to px.

    Raises
    ------
    CalibrationError
        If the points are too few or not finite, the spacing is not positive, or the homography has no
        inverse.
    """

    points: FloatArray
    spacing_mm: float
    spacing_mm_std: float
    homography: FloatArray

    def __post_init__(self) -> None:
        points = real_array(self.points, "points", CalibrationError)
        shape = points.shape
        if len(shape) != 3 or shape[2] != 2 or min(shape[:2]) < _MIN_POINTS or not np.isfinite(points).all():
            raise CalibrationError(
                f"points must be finite, {_MIN_POINTS} or more each way, of shape (rows, columns, 2), "
                f"found shape {shape}"
            )
        homography = real_array(self.homography, "homography", CalibrationError)
        if homography.shape != (3, 3) or not abs(np.linalg.det(homography)) > 0:
            raise CalibrationError(f"homography must be an invertible (3, 3) matrix, found {homography}")
        set_fields(
            self,
            points=points,
            spacing_mm=positive_number(self.spacing_mm, "spacing_mm", CalibrationError),
            spacing_mm_std=non_negative_number(self.spacing_mm_std, "spacing_mm_std", CalibrationError),
            homography=homography,
        )

    @property
    def residual(self) -> float:
        """Root mean square distance of the points from those of the fitted plane, px, per coordinate."""
        seen = _plane(*self.points.shape[:2]) @ self.homography.T
        off = (seen[..., 1::-1] / seen[..., 2:] - self.points).ravel()
        return math.sqrt(float(off @ off) / max(off.size - 8, 1))

    @property
    def anisotropy(self) -> float:
        """By how much the longer side of a pixel on the plane exceeds the shorter, at most on the grid."""
        return float((self._sides[..., 0] / self._sides[..., 1]).max() - 1)

    @property
    def variation(self) -> float:
        """Greatest relative difference of the scale on the grid from that of its middle."""
        return float(np.abs(self._local_mm_per_px / self._mm_per_px - 1).max())

    @property
    def unevenness(self) -> float:
        """By how much lengths of a third of the grid are wrong in the rectified picture, at most; relative.

        A lens that bends lines, or a grid that is not flat, shows here.
        """
        rows, columns = self.points.shape[:2]
        place = np.ascontiguousarray(self.points[..., ::-1]).reshape(1, -1, 2)
        flat = cv2.perspectiveTransform(place, np.linalg.inv(self.homography)).reshape(rows, columns, 2)
        found = []
        for along in (flat, flat.transpose(1, 0, 2)):
            third, beside = along.shape[0] // 3, -(-along.shape[1] // 3)
            lengths = np.linalg.norm(along[third:] - along[:-third], axis=-1) / third
            means = np.lib.stride_tricks.sliding_window_view(lengths, beside, axis=1).mean(axis=-1)
            found.append(float(np.abs(means - 1).max()))
        return max(found)

    @property
    def flags(self) -> tuple[str, ...]:
        """Doubts: ``grid_tilted`` where pixels are not square, ``grid_bent`` where it is not flat."""
        tilted = max(self.anisotropy, self.variation) > _TILTED
        doubts = {"grid_tilted": tilted, "grid_bent": self.unevenness > _BENT}
        return tuple(flag for flag, doubted in doubts.items() if doubted)

    @property
    def scale(self) -> Scale:
        """One scale for pictures that are not rectified: that of the middle of the grid.

        Its uncertainty holds that of the spacing, the unevenness, and what sides of pixels differ by with
        direction and place, uniformly distributed: it is large where the plane is tilted.
        """
        off = float(np.abs(np.log(self._sides * self._mm_per_px / self.spacing_mm)).max())
        return self._scale(off / math.sqrt(3))

    @property
    def rectified_scale(self) -> Scale:
        """That of rectified pictures: uncertain by the spacing and the unevenness."""
        return self._scale()

    @cached_property
    def _sides(self) -> FloatArray:
        """Longer and shorter side, px, of a square of one spacing at each point, (rows, columns, 2)."""
        seen = _plane(*self.points.shape[:2]) @ self.homography.T
        slopes = self.homography[:2, :2] - (seen[..., :2] / seen[..., 2:])[..., None] * self.homography[2, :2]
        return as_float_array(np.linalg.svd(slopes / seen[..., 2, None, None], compute_uv=False))

    @cached_property
    def _local_mm_per_px(self) -> FloatArray:
        """Scale at each point, by the side of a square as large as a pixel, (rows, columns)."""
        return as_float_array(self.spacing_mm / np.sqrt(self._sides.prod(axis=-1)))

    @cached_property
    def _mm_per_px(self) -> float:
        """Scale in the middle of the grid."""
        rows, columns = self.points.shape[:2]
        middle = np.s_[(rows - 1) // 2 : rows // 2 + 1, (columns - 1) // 2 : columns // 2 + 1]
        return math.exp(np.log(self._local_mm_per_px[middle]).mean())

    def _scale(self, more_std: float = 0.0) -> Scale:
        # The middle may be wrong by as much as lengths are.
        relative = math.hypot(self.spacing_mm_std / self.spacing_mm, self.unevenness, more_std)
        return Scale(self._mm_per_px, self._mm_per_px * relative)

    def rectified(self, pixels: npt.NDArray[Any]) -> tuple[npt.NDArray[Any], Scale]:
        """Return a picture of the same camera as if seen straight on, and its scale.

        Parameters
        ----------
        pixels : ndarray, shape (rows, columns) or (rows, columns, channels)
            A picture of the plane in which the grid lay, such as a contact image: a finger seen at a slant
            stays so. What its far parts would show beyond four times the picture's size is cut off.

        Returns
        -------
        pixels : ndarray
            With square pixels that are as large as those of the picture in the middle of the grid; black
            beyond the picture.
        scale : Scale
            That of `rectified_scale`.
        """
        pixels = checked_picture(pixels, "pixels", CalibrationError, colour=True)
        rows, columns = pixels.shape[:2]
        pitch = self._mm_per_px / self.spacing_mm  # spacings per px
        inverse = np.linalg.inv(self.homography)
        edge = np.array([[0, 0], [columns, 0], [columns, rows], [0, rows]], dtype=np.float64) - 0.5
        corners = cv2.perspectiveTransform(edge[None], inverse)[0] / pitch
        centre = np.array([self.points.shape[1] - 1, self.points.shape[0] - 1]) / 2 / pitch
        low, high = corners.min(axis=0), corners.max(axis=0)
        reach = 2 * np.array([columns, rows])
        low, high = np.maximum(low, centre - reach), np.minimum(high, centre + reach)
        size = tuple(np.ceil(high - low).astype(int).tolist())
        move = np.array([[pitch, 0, pitch * (low[0] + 0.5)], [0, pitch, pitch * (low[1] + 0.5)], [0, 0, 1]])
        seen = cv2.warpPerspective(
            pixels, self.homography @ move, size, flags=cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP
        )
        return np.asarray(seen), self.rectified_scale


def _plane(rows: int, columns: int) -> FloatArray:
    """Return the grid's points in its plane, (x, y, 1) in spacings, (rows, columns, 3)."""
    x, y = np.meshgrid(np.arange(columns, dtype=np.float64), np.arange(rows, dtype=np.float64))
    return np.stack([x, y, np.ones_like(x)], axis=-1)


def measure_grid(
    image: ImageLike,
    points: tuple[int, int],
    spacing_mm: float,
    *,
    spacing_mm_std: float = 0.0,
    pattern: Pattern = "checkerboard",
) -> Grid:
    """Find a checkerboard or a grid of dots in a picture, and fit the plane in which it lies.

    A pinhole camera shows a plane by a homography, whatever its tilt; so does a flat face of a prism, nearly.

    Parameters
    ----------
    image : array_like or path
        The picture; dark squares or dots on light ground, with a light margin round them.
    points : (int, int)
        Inner corners of the checkerboard, or dots, down the rows and along them; at least 3 each.
    spacing_mm, spacing_mm_std : float
        Distance of neighbouring points and its standard uncertainty, mm.
    pattern : {"checkerboard", "dots"}
        What the grid consists of.

    Returns
    -------
    Grid

    Raises
    ------
    CalibrationError
        If the grid is not found, or a number is not as described.
    ImageError
        If the picture cannot be read.

    Examples
    --------
    >>> dark = np.indices((8, 10)).sum(axis=0) % 2 == 0
    >>> board = np.full((200, 240), 230, dtype=np.uint8)
    >>> board[20:180, 20:220][np.kron(dark, np.ones((20, 20), bool))] = 30
    >>> grid = measure_grid(board, (7, 9), 1.0)
    >>> print(f"{grid.scale.mm_per_px:.4f} mm/px, residual {grid.residual:.2f} px, flags {grid.flags}")
    0.0500 mm/px, residual 0.00 px, flags ()
    >>> seen, scale = grid.rectified(board)
    >>> round(scale.mm_per_px, 4)
    0.05
    """
    if pattern not in get_args(Pattern):
        raise CalibrationError(f"pattern must be one of {', '.join(get_args(Pattern))}, found {pattern!r}")
    counts = real_array(points, "points", CalibrationError)
    if counts.shape != (2,) or not (counts >= _MIN_POINTS).all() or (counts != np.rint(counts)).any():
        raise CalibrationError(
            f"points must be two whole numbers, {_MIN_POINTS} or more each way, found {points}"
        )
    rows, columns = points = (int(counts[0]), int(counts[1]))
    positive_number(spacing_mm, "spacing_mm", CalibrationError)  # before the picture is read
    non_negative_number(spacing_mm_std, "spacing_mm_std", CalibrationError)
    grey = picture_levels(levels_of(image), "image", CalibrationError).astype(np.float32)
    low, high = float(grey.min()), float(grey.max())
    levels = np.rint((grey - low) * (255 / max(high - low, 1e-9))).astype(np.uint8)
    places = _find_points(levels, points, pattern)
    if places is None:
        what = "dots" if pattern == "dots" else "inner corners"
        raise CalibrationError(
            f"no grid of {rows} × {columns} {what} found: count them down and along, and show all of them on "
            "a light margin"
        )
    seen = _upright(places.reshape(rows, columns, 2).astype(np.float64))
    plane = _plane(*seen.shape[:2])[..., :2].reshape(-1, 2)
    homography, _ = cv2.findHomography(plane, seen.reshape(-1, 2), 0)
    if homography is None:
        raise CalibrationError("the points of the grid lie on one line: count them down and along")
    return Grid(
        points=seen[..., ::-1],
        spacing_mm=spacing_mm,
        spacing_mm_std=spacing_mm_std,
        homography=np.asarray(homography, dtype=np.float64),
    )


def _upright(points: FloatArray) -> FloatArray:
    """Return points (x, y), which may begin at any corner, with rows down the picture and columns right."""
    along, down = (np.ptp(points.mean(axis=axis)[[0, -1]], axis=0) for axis in (0, 1))
    if along[0] + down[1] < along[1] + down[0]:
        points = points.swapaxes(0, 1)
    points = points if points[:, -1, 0].mean() > points[:, 0, 0].mean() else points[:, ::-1]
    return points if points[-1, :, 1].mean() > points[0, :, 1].mean() else points[::-1]


def _find_points(
    levels: npt.NDArray[np.uint8], points: tuple[int, int], pattern: Pattern
) -> npt.NDArray[np.float32] | None:
    """Return the inner corners of a checkerboard, or the centres of dots, (x, y), row by row."""
    size = (points[1], points[0])
    if pattern == "dots":
        found, dots = cv2.findCirclesGrid(levels, size, flags=cv2.CALIB_CB_SYMMETRIC_GRID)
        return np.asarray(dots, dtype=np.float32) if found else None
    flags = cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_EXHAUSTIVE | cv2.CALIB_CB_ACCURACY
    found, corners = cv2.findChessboardCornersSB(levels, size, flags=flags)
    if not found:
        return None
    rough = np.asarray(corners, dtype=np.float32).reshape(*points, 2)
    apart = min(float(np.linalg.norm(np.diff(rough, axis=axis), axis=-1).min()) for axis in (0, 1))
    window = max(2, round(apart / 4))
    stop = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 60, 1e-4)
    return np.asarray(cv2.cornerSubPix(levels, rough.reshape(-1, 1, 2), (window, window), (-1, -1), stop))
