"""Light and the numbers in a picture's file: the sRGB curve (IEC 61966-2-1) both ways."""

from typing import Any

import numpy as np
import numpy.typing as npt

# ITU-R BT.601, as in JPEG.
_LUMA = np.array([0.299, 0.587, 0.114], dtype=np.float32)


def linear_light(pixels: npt.NDArray[Any]) -> npt.NDArray[np.float32]:
    """Return the light that sRGB levels stand for, 1 at the top of the type's range.

    A blurred edge lies where half the light is, not half the level. Levels of floating point are taken as
    shares of the largest, or of 1 if none is larger.
    """
    if pixels.dtype.kind in "ui":
        top = np.iinfo(pixels.dtype).max
        if top <= 0xFFFF:
            return np.asarray(_decoded(np.arange(top + 1) / top)[np.maximum(pixels, 0)], dtype=np.float32)
        return _decoded(np.maximum(pixels, 0) / top)
    return _decoded(np.maximum(pixels, 0) / max(1.0, float(pixels.max())))


def opponent_light(pixels: npt.NDArray[Any]) -> npt.NDArray[np.float32]:
    """Return luma as light, then red and blue beyond it; luma alone for a grey picture.

    Cameras' files keep luma sharp and colour at half the resolution: apart, each is trusted as it deserves.
    """
    if pixels.ndim == 2:
        return linear_light(pixels)[..., None]
    light = linear_light(pixels[..., :3])
    luma = light @ _LUMA
    np.subtract(light[..., 0], luma, out=light[..., 1])
    light[..., 2] -= luma
    light[..., 0] = luma
    return light


def encoded(light: npt.NDArray[Any]) -> npt.NDArray[np.float32]:
    """Return the sRGB levels of light, 0 to 255, not rounded."""
    light = np.clip(light, 0, 1)
    level = np.where(light <= 0.0031308, 12.92 * light, 1.055 * np.maximum(light, 1e-9) ** (1 / 2.4) - 0.055)
    return np.asarray(255 * level, dtype=np.float32)


def _decoded(level: npt.NDArray[Any]) -> npt.NDArray[np.float32]:
    light = np.where(level <= 0.04045, level / 12.92, ((level + 0.055) / 1.055) ** 2.4)
    return np.asarray(light, dtype=np.float32)
