"""Read a picture file into a plain two-dimensional grey array."""

import math
import warnings
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt
import tifffile
from PIL import Image, ImageOps, UnidentifiedImageError

from fingerpad.exceptions import ImageError

Pixels: TypeAlias = npt.NDArray[np.uint8] | npt.NDArray[np.uint16] | npt.NDArray[np.float32]

FORMATS = ("PNG", "TIFF", "JPEG", "BMP", "PPM")
PIXEL_LIMIT = 100_000_000
_READABLE = "PNG, TIFF, JPEG, BMP or PGM"
_LUMA = np.array([0.299, 0.587, 0.114], dtype=np.float32)
# Files without a true resolution carry 0 or 1 here.
_LEAST_PPI = 10.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Picture:
    """A grey picture and what its file says of its scale.

    Attributes
    ----------
    pixels : ndarray, (rows, columns)
        Grey levels, uint8, uint16 or float32 as the file had them.
    dots_per_inch : float or None
        Resolution written in the file, None where it has none or differs between the two directions.
        Cameras and editors write 72 or 96 without meaning it.
    """

    pixels: Pixels
    dots_per_inch: float | None


def read_image(path: str | PathLike[str], *, pixel_limit: int = PIXEL_LIMIT) -> Picture:
    """Read one grey picture from a PNG, TIFF, JPEG, BMP or PGM file.

    Colour becomes luma (ITU-R BT.601), transparency is laid on white, and a camera's rotation tag is obeyed.
    Colour of 16 bits is brought to 8.

    Parameters
    ----------
    path : path-like
        The file.
    pixel_limit : int
        The most pixels to accept, checked in the header before anything is decoded.

    Returns
    -------
    Picture

    Raises
    ------
    ImageError
        If the file is missing, empty, cut short, too large, not a picture, or holds NaN or infinity.

    Examples
    --------
    >>> read_image("no_such_print.png")
    Traceback (most recent call last):
    fingerpad.exceptions.ImageError: no_such_print.png: no such file: check the path
    """
    path = Path(path)
    _check_file(path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            pixels, resolution = _decode(path, pixel_limit)
        except UnidentifiedImageError:
            pixels, resolution = _decode_tiff(path, pixel_limit), None
        except (Image.DecompressionBombError, MemoryError) as error:
            raise ImageError(f"{path}: far too many pixels: crop or shrink the picture") from error
        except (OSError, SyntaxError, ValueError, EOFError, TypeError, IndexError) as error:
            raise ImageError(
                f"{path}: cannot be decoded, the file is cut short or damaged ({error}): copy it again"
            ) from error
    if not np.isfinite(pixels).all():
        bad = int(np.count_nonzero(~np.isfinite(pixels)))
        raise ImageError(f"{path}: {bad} pixels are NaN or infinite: fill them before measuring")
    return Picture(pixels=pixels, dots_per_inch=resolution)


def _check_file(path: Path) -> None:
    try:
        if path.is_dir():
            raise ImageError(f"{path}: is a folder: name one picture in it")
        if not path.exists():
            raise ImageError(f"{path}: no such file: check the path")
        with path.open("rb") as file:
            first = file.read(1)
    except (OSError, ValueError) as error:
        raise ImageError(f"{path}: cannot be opened ({error}): check the path and its permissions") from error
    if not first:
        raise ImageError(f"{path}: the file is empty: copy it again")


def _check_size(path: Path, columns: int, rows: int, pixel_limit: int) -> None:
    if columns * rows > pixel_limit:
        raise ImageError(
            f"{path}: {columns} × {rows} pixels are more than the limit of {pixel_limit}: "
            "crop or shrink the picture, or raise pixel_limit"
        )


def _decode(path: Path, pixel_limit: int) -> tuple[Pixels, float | None]:
    """Decode by Pillow, after its header has passed the size check."""
    with Image.open(path, formats=FORMATS) as image:
        _check_size(path, *image.size, pixel_limit)
        frames = getattr(image, "n_frames", 1)
        if frames > 1:
            raise ImageError(f"{path}: holds {frames} pictures: save the one to measure in its own file")
        resolution = _resolution(image.info)
        return _grey(ImageOps.exif_transpose(image)), resolution


def _resolution(info: dict[Any, Any]) -> float | None:
    try:
        across, down = (float(value) for value in info["dpi"])
    except (KeyError, TypeError, ValueError, ZeroDivisionError):
        return None
    if not (math.isfinite(across) and across >= _LEAST_PPI) or not math.isclose(across, down, rel_tol=0.01):
        return None
    # PNG and BMP keep whole pixels per metre: 500 ppi comes back as 499.999.
    return round(across) if abs(across - round(across)) < 0.02 else across


def _grey(image: Image.Image) -> Pixels:
    """Return the grey levels of a Pillow image of any mode."""
    if image.mode == "F":
        return np.asarray(image, dtype=np.float32)
    if image.mode.startswith("I"):
        return np.asarray(image).clip(0, 65535).astype(np.uint16)
    if image.mode not in {"1", "L"}:
        image = image.convert("RGBA")
        white = Image.new("RGBA", image.size, "white")
        image = Image.alpha_composite(white, image)
    return np.asarray(image.convert("L"), dtype=np.uint8)


def _decode_tiff(path: Path, pixel_limit: int) -> Pixels:
    """Decode the TIFF kinds that Pillow refuses: 16-bit and float colour, doubles."""
    try:
        with tifffile.TiffFile(path) as tiff:
            page = tiff.pages[0]
            _check_size(path, int(page.shape[1]), int(page.shape[0]), pixel_limit)
            array = page.asarray()
    except ImageError:
        raise
    # tifffile lets errors of any kind out of a damaged file.
    except Exception as error:
        raise ImageError(f"{path}: is not a picture this library reads: save it as {_READABLE}") from error
    if array.ndim == 2 and array.dtype in (np.uint8, np.uint16):
        return np.asarray(array)
    if array.ndim == 2 and array.dtype.kind in "fui":
        return array.astype(np.float32)
    if array.ndim == 3 and array.shape[2] in (3, 4) and array.dtype.kind in "fu":
        return _grey_of_colour(array)
    raise ImageError(
        f"{path}: a TIFF of shape {array.shape} and type {array.dtype} is not a picture: save as grey"
    )


def _grey_of_colour(array: npt.NDArray[Any]) -> Pixels:
    top = float(np.iinfo(array.dtype).max) if array.dtype.kind == "u" else 1.0
    grey = array[..., :3].astype(np.float32) @ _LUMA
    if array.shape[2] == 4:
        alpha = array[..., 3].astype(np.float32) / top
        grey = alpha * grey + (1 - alpha) * top
    return grey.round().astype(array.dtype) if array.dtype in (np.uint8, np.uint16) else grey
