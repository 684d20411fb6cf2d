"""Where ridges touch, at the resolution of the picture."""

import math
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, FloatArray, as_float32
from fingerpad.image.contact_image._region import filled_polygon
from fingerpad.image.contact_image._ridges import Signal, ridge_amount
from fingerpad.image.contact_image._working_image import WORKING_PERIOD_PX, Points, WorkingImage

# More pixels to a ridge period than this tell nothing more.
_MOST_PER_PERIOD = 12


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RidgeMap:
    """Ridges in the box round a contact.

    Attributes
    ----------
    is_ridge : ndarray of bool, (rows, columns)
    corner : (int, int)
        (row, column) of the box in the picture.
    step : int
        Pixels of the picture in one of the map.
    """

    is_ridge: BoolArray
    corner: tuple[int, int]
    step: int

    def in_picture(self, shape: tuple[int, int]) -> BoolArray:
        """Return the ridges in a picture of this shape, none outside the box."""
        whole = np.zeros(shape, dtype=bool)
        fine = self.is_ridge.repeat(self.step, axis=0).repeat(self.step, axis=1)
        row, column = self.corner
        part = whole[row : row + fine.shape[0], column : column + fine.shape[1]]
        part[:] = fine[: part.shape[0], : part.shape[1]]
        return whole

    def area_within(self, outline: FloatArray, half: BoolArray) -> tuple[float, float]:
        """Return the ridges' area inside an outline (x, y) of the picture, and that of unresolved parts, px.

        `half` are the unresolved parts, as an image of the map's box: half of them counts as ridge.
        """
        places = (outline + 0.5 - self.corner[::-1]) / self.step - 0.5
        inside = filled_polygon(places, self.is_ridge.shape) > 0
        unknown = np.count_nonzero(half & inside)
        known = np.count_nonzero(self.is_ridge & ~half & inside)
        return (known + unknown / 2) * float(self.step**2), unknown * float(self.step**2)

    def sampled(self, mask: BoolArray, view: WorkingImage) -> BoolArray:
        """Return a mask of the working copy as an image of the map's box."""
        turn = _to_copy(self.corner, self.step, view)
        size = self.is_ridge.shape[::-1]
        return _warped(mask.astype(np.uint8), turn, size, cv2.INTER_NEAREST) > 0


def _to_copy(corner: tuple[int, int], step: int, view: WorkingImage) -> FloatArray:
    """Return the affine map from the map's pixels (x, y) to those of the working copy."""
    along = step / np.array(view.steps[::-1])
    start = (np.array(corner[::-1]) - view.corner[::-1] + step / 2) / view.steps[::-1] - 0.5
    return np.array([[along[0], 0, start[0]], [0, along[1], start[1]]])


def _warped(
    image: npt.NDArray[Any], turn: FloatArray, size: tuple[int, ...], interpolation: int
) -> npt.NDArray[Any]:
    return cv2.warpAffine(
        image, turn, size, flags=interpolation | cv2.WARP_INVERSE_MAP, borderMode=cv2.BORDER_REPLICATE
    )


def ridge_map(view: WorkingImage, signal: Signal, edge: Points, threshold: float | None) -> RidgeMap:
    """Find the ridges inside an outline (x, y) of the working copy, above half their local contrast.

    At the resolution of the working copy, narrow ridges and narrow valleys blur into one another.
    """
    scale = math.sqrt(view.steps[0] * view.steps[1])
    step = max(1, int(view.period * scale // _MOST_PER_PERIOD))
    margin = view.period * scale
    outline = view.to_picture(edge) - view.corner[::-1]
    low = np.maximum(np.floor(outline.min(axis=0) - margin), 0).astype(int)
    high = np.minimum(np.ceil(outline.max(axis=0) + margin) + 1, view.picture.shape[::-1]).astype(int)
    columns, rows = ((high - low) // step * step).tolist()
    box = as_float32(view.picture[low[1] : low[1] + rows, low[0] : low[0] + columns])
    if step > 1:
        box = as_float32(cv2.resize(box, (columns // step, rows // step), interpolation=cv2.INTER_AREA))
    sign = -1.0 if signal.dark_on_light else 1.0
    ground = as_float32(sign * view.values - signal.values)
    row, column = (int(k) for k in low[::-1] + view.corner)
    ground = _warped(ground, _to_copy((row, column), step, view), box.shape[::-1], cv2.INTER_LINEAR)
    period = view.period * scale / step
    every = max(1, round(period / WORKING_PERIOD_PX))
    amount, _ = ridge_amount(as_float32(sign * box - ground), signal.contrast, period, threshold, step=every)
    return RidgeMap(is_ridge=np.asarray(amount >= 128), corner=(row, column), step=step)
