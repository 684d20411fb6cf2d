"""The sRGB transfer curve (IEC 61966-2-1): from grey levels to linear light and back."""

from typing import Any

import numpy as np
import numpy.typing as npt


def linear_light(pixels: npt.NDArray[Any]) -> npt.NDArray[np.float32]:
    """Return the light that sRGB levels stand for, 1 at the top of the type's range.

    A blurred edge lies where half the light is, not half the level. Levels of floating point are taken as
    shares of the largest, or of 1 if none is larger.
    """
    if pixels.dtype.kind in "ui":
        top = np.iinfo(pixels.dtype).max
        if top <= 0xFFFF:
            return np.asarray(_decode(np.arange(top + 1) / top)[np.maximum(pixels, 0)], dtype=np.float32)
        return _decode(np.maximum(pixels, 0) / top)
    return _decode(np.maximum(pixels, 0) / max(1.0, float(pixels.max())))


def srgb_levels(light: npt.NDArray[Any]) -> npt.NDArray[np.float32]:
    """Return the sRGB levels of light, 0 to 255, not rounded."""
    light = np.clip(light, 0, 1)
    level = np.where(light <= 0.0031308, 12.92 * light, 1.055 * np.maximum(light, 1e-9) ** (1 / 2.4) - 0.055)
    return np.asarray(255 * level, dtype=np.float32)


def _decode(level: npt.NDArray[Any]) -> npt.NDArray[np.float32]:
    light = np.where(level <= 0.04045, level / 12.92, ((level + 0.055) / 1.055) ** 2.4)
    return np.asarray(light, dtype=np.float32)
