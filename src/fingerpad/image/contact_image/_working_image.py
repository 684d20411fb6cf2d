"""The reduced copy of an image, in which a ridge period is 4.5 px."""

import math
from dataclasses import dataclass
from typing import Any, Self

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, Float32Array, FloatArray
from fingerpad.image.contact_image._background_border import content_mask
from fingerpad.image.contact_image._cropping import CroppedImage, Pixels
from fingerpad.image.contact_image._region import disk

WORKING_PERIOD_PX = 4.5


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class WorkingImage:
    """A picture reduced by area means, which keep the place of an edge in their grey levels.

    Attributes
    ----------
    picture : ndarray of uint8 or float32, (rows, columns)
        What was reduced.
    values : ndarray of float32, (rows, columns)
    card : ndarray of bool, (rows, columns)
        Where the picture shows anything: all but an added even border.
    inside : ndarray of bool, (rows, columns)
        Where the caller lets it count.
    cut : (bool, bool, bool, bool)
        Whether the top, left, bottom and right side are the caller's, not the picture's own.
    period : float
        Ridge period, px of the copy.
    steps : (float, float)
        Pixels of the picture in one of the copy, along rows and columns.
    corner : (int, int)
        (row, column) in the picture of the copy's first corner.
    shape : (int, int)
        Of the whole picture.
    """

    picture: Pixels
    values: Float32Array
    card: BoolArray
    inside: BoolArray
    cut: tuple[bool, bool, bool, bool]
    period: float
    steps: tuple[float, float]
    corner: tuple[int, int]
    shape: tuple[int, int]

    @classmethod
    def of(cls, frame: CroppedImage, period: float) -> Self:
        """Reduce a picture whose ridge period is known, px."""
        pixels, reduction = frame.pixels, max(1.0, period / WORKING_PERIOD_PX)
        rows, columns = (max(8, round(n / reduction)) for n in pixels.shape)
        small = _reduce(pixels, rows, columns)
        inside = np.ones(small.shape, dtype=bool)
        if frame.inside is not None:
            share = cv2.resize(frame.inside.astype(np.float32), (columns, rows), interpolation=cv2.INTER_AREA)
            inside = share > 0.5
        steps = (pixels.shape[0] / rows, pixels.shape[1] / columns)
        row, column = frame.corner
        return cls(
            picture=pixels,
            values=small.astype(np.float32),
            card=content_mask(pixels, small.shape),
            inside=inside,
            cut=(
                row > 0,
                column > 0,
                row + pixels.shape[0] < frame.shape[0],
                column + pixels.shape[1] < frame.shape[1],
            ),
            period=period / float(np.sqrt(steps[0] * steps[1])),
            steps=steps,
            corner=frame.corner,
            shape=frame.shape,
        )

    def to_picture(self, points: FloatArray) -> FloatArray:
        """Return points (x, y) of the copy as points (x, y) of the picture."""
        return np.asarray((points + 0.5) * self.steps[::-1] - 0.5 + np.array(self.corner[::-1]))

    def to_copy(self, points: FloatArray) -> FloatArray:
        """Return points (x, y) of the picture as points (x, y) of the copy."""
        return np.asarray((points + 0.5 - np.array(self.corner[::-1])) / self.steps[::-1] - 0.5)

    def to_copy_pixel(self, row: float, column: float) -> tuple[int, int] | None:
        """Return the pixel of the copy that shows a place of the picture, None where it shows none."""
        y = int((row + 0.5 - self.corner[0]) // self.steps[0])
        x = int((column + 0.5 - self.corner[1]) // self.steps[1])
        return (y, x) if 0 <= y < self.values.shape[0] and 0 <= x < self.values.shape[1] else None

    def touches_border(self, points: FloatArray, steps: FloatArray) -> bool:
        """Return whether an outline reaches the picture's frame or an added border, or runs along one.

        Scanners leave a blank margin of a few px: ten periods of outline within one of it are a cut too.
        """
        on_edge = self._length_near(points, steps, self.card, margin=1.5, own=False, border=0.5 * self.period)
        near = self._length_near(points, steps, self.card, margin=self.period, own=False, border=self.period)
        return on_edge > 2 * self.period or near > 10 * self.period

    def cut_by_mask(self, points: FloatArray, steps: FloatArray) -> bool:
        """Return whether an outline reaches the edge of the caller's mask."""
        near = self._length_near(points, steps, self.inside, margin=1.5, own=True, border=2.0)
        return near > 2 * self.period

    def _length_near(
        self,
        points: FloatArray,
        steps: FloatArray,
        mask: BoolArray,
        *,
        margin: float,
        own: bool,
        border: float,
    ) -> float:
        """Return the length of outline this near to the outside of a mask, or to the sides of one kind."""
        rows, columns = mask.shape
        x, y = points.T
        off = np.stack([y + 0.5, x + 0.5, rows - 0.5 - y, columns - 0.5 - x])
        of_kind = np.array([cut is own for cut in self.cut])
        near = (off[of_kind] < margin).any(axis=0)
        if not mask.all():
            plain = cv2.erode(mask.astype(np.uint8), disk(max(1.0, border)))
            place = np.rint(y).astype(int).clip(0, rows - 1), np.rint(x).astype(int).clip(0, columns - 1)
            near |= plain[place] == 0
        return float(steps[near].sum())


def _reduce(pixels: Pixels, rows: int, columns: int) -> npt.NDArray[Any]:
    """Return area means at a smaller size.

    Means over whole numbers of pixels are many times faster: linear interpolation first brings the picture,
    near its own size, to a multiple of the wanted one.
    """
    whole = math.ceil(pixels.shape[0] / rows - 0.25)
    multiple = cv2.resize(pixels, (columns * whole, rows * whole), interpolation=cv2.INTER_LINEAR)
    return cv2.resize(multiple, (columns, rows), interpolation=cv2.INTER_AREA)
