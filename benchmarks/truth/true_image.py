"""What images of contacts of known truth have in common."""

from dataclasses import dataclass

import cv2
import numpy as np

from benchmarks.arrays import Array, Pixels


@dataclass(frozen=True, eq=False)
class TrueImage:
    """Contact image with its true gross area and ridge area, mm², and semi-axes, mm."""

    pixels: Array
    mm_per_px: float
    gross_area: float
    ridge_area: float
    semi_axes: tuple[float, float]


def eight_bit(grey: Array, jpeg_quality: int = 0) -> Pixels:
    """Round a picture from 0 to 1 to grey levels, and compress it by JPEG unless its quality is 0."""
    pixels = np.asarray(np.rint(255 * np.clip(grey, 0, 1)), np.uint8)
    if not jpeg_quality:
        return pixels
    _, encoded = cv2.imencode(".jpg", pixels, [cv2.IMWRITE_JPEG_QUALITY, jpeg_quality])
    return np.asarray(cv2.imdecode(encoded, cv2.IMREAD_GRAYSCALE), np.uint8)
