"""Read a picture file into a plain two-dimensional grey array."""

import math
import re
import warnings
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, Final

import cv2
import numpy as np
import numpy.typing as npt
import tifffile
from PIL import Image, ImageOps, UnidentifiedImageError

from fingerpad.exceptions import ImageError
from fingerpad.image._grayscale import Pixels, grey_of_array, upright
from fingerpad.image._tiff import ORIENTATION_TAG, grey_of_page, resolution_of_page, size_of_page

FORMATS = ("PNG", "TIFF", "JPEG", "BMP", "PPM")
PIXEL_LIMIT = 100_000_000
_READABLE = "PNG, TIFF, JPEG, BMP or PGM"
# Files without a true resolution carry 0 or 1 here.
_LEAST_PPI = 10.0
# ImageJ keeps its scale as pixels per unit, and the unit in the description.
_IMAGEJ_UNITS: Final = {"inch": 1.0, "cm": 2.54, "mm": 25.4, "um": 25400.0, "micron": 25400.0}
_BITS_TAG, _SUBFILE_TAG, _DESCRIPTION_TAG, _RESOLUTION_TAGS = 258, 254, 270, (282, 283)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Picture:
    """A grey picture and what its file says of its scale.

    Attributes
    ----------
    pixels : ndarray, (rows, columns)
        Grey levels, uint8, uint16 or float32 as the file had them.
    dots_per_inch : float or None
        Resolution written in the file (JFIF, PNG's pHYs, TIFF's tags, ImageJ's calibration of a TIFF), None
        where it has none, no unit, or differs between the two directions. Cameras and editors write 72 or
        96 without meaning it: `Scale.of_picture` refuses those.
    """

    pixels: Pixels
    dots_per_inch: float | None


def read_image(path: str | PathLike[str], *, pixel_limit: int = PIXEL_LIMIT) -> Picture:
    """Read one grey picture from a PNG, TIFF, JPEG, BMP or PGM file.

    Colour becomes luma (ITU-R BT.601) of the file's own depth, transparency is laid on white, and a camera's
    rotation tag is obeyed. A file of several pictures (a TIFF of many pages, an animation) is refused: to
    measure its first page in silence would be to guess. Reduced copies that a TIFF carries beside its
    picture do not count. `open_frames` reads such files page by page.

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
            pixels, resolution = _decode_tiff(path, pixel_limit)
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


def check_size(path: Path, columns: int, rows: int, pixel_limit: int) -> None:
    """Refuse a picture that its header says is too large to decode."""
    if columns * rows > pixel_limit:
        raise ImageError(
            f"{path}: {columns} × {rows} pixels are more than the limit of {pixel_limit}: "
            "crop or shrink the picture, or raise pixel_limit"
        )


def _decode(path: Path, pixel_limit: int) -> tuple[Pixels, float | None]:
    """Decode by Pillow, or by others the deep colour it would cut; the header passes the size check first."""
    with Image.open(path, formats=FORMATS) as image:
        check_size(path, *image.size, pixel_limit)
        if _is_several(image):
            raise ImageError(
                f"{path}: holds {getattr(image, 'n_frames', 1)} pictures: "
                "save the one to measure in its own file, or measure them all as a sequence"
            )
        resolution = _resolution(image)
        if not _is_deep_colour(image):
            return grey_of_image(ImageOps.exif_transpose(image)), resolution
        tag = image.getexif().get(ORIENTATION_TAG, 1)
        if image.format == "TIFF":
            return _decode_tiff(path, pixel_limit)[0], resolution
    return grey_of_array(upright(_decode_by_opencv(path), int(tag))), resolution


def _is_several(image: Image.Image) -> bool:
    """Tell whether a file holds more than one picture, reduced copies of it left aside."""
    count = getattr(image, "n_frames", 1)
    if image.format == "MPO":  # a telephone's JPEG, followed by a preview
        return False
    if count == 1 or image.format != "TIFF":
        return count > 1
    try:
        for number in range(1, count):
            image.seek(number)
            if not image.getexif().get(_SUBFILE_TAG, 0) & 1:
                return True
    finally:
        image.seek(0)
    return False


def _is_deep_colour(image: Image.Image) -> bool:
    """Tell whether a file holds colour of more than 8 bits, which Pillow would cut to 8."""
    if image.mode not in {"RGB", "RGBA", "RGBX", "LA"}:
        return False
    if image.format == "TIFF":
        return int(np.max(image.getexif().get(_BITS_TAG, 8))) > 8
    # Pillow's name for the layout of the file's samples, or for PPM their largest value.
    layouts = [str(tile[3]) for tile in getattr(image, "tile", ())]
    return any(";16" in layout or "65535" in layout for layout in layouts)


def _decode_by_opencv(path: Path) -> npt.NDArray[Any]:
    """Decode at full depth, as (rows, columns, RGB or RGBA), without turning."""
    array = cv2.imdecode(np.fromfile(path, np.uint8), cv2.IMREAD_UNCHANGED)
    if array is None:
        raise OSError("the picture ends early")
    return array[..., [2, 1, 0, 3][: array.shape[2]]] if array.ndim == 3 else array


def _resolution(image: Image.Image) -> float | None:
    if image.format == "TIFF" and (per_inch := _imagej_resolution(image)) is not None:
        return per_inch
    return _plausible_resolution(image.info.get("dpi"))


def _imagej_resolution(image: Image.Image) -> float | None:
    """Return the calibration that ImageJ writes: pixels per unit without TIFF's unit, None without one."""
    tags = image.getexif()
    text = str(tags.get(_DESCRIPTION_TAG, ""))
    unit = re.search(r"^unit=(.+)$", text, re.MULTILINE) if text.startswith("ImageJ=") else None
    if unit is None:
        return None
    name = unit[1].strip().replace(r"\u00B5", "u").replace("µ", "u")
    per_inch = _IMAGEJ_UNITS.get(name)
    across, down = (float(tags.get(tag, 0)) for tag in _RESOLUTION_TAGS)
    return None if per_inch is None else _plausible_resolution((across * per_inch, down * per_inch))


def _plausible_resolution(pair: Any) -> float | None:
    """Return a resolution that could be one: finite, not nearly zero, and the same in both directions."""
    try:
        across, down = (float(value) for value in pair)
    except (TypeError, ValueError, ZeroDivisionError):
        return None
    if not (math.isfinite(across) and across >= _LEAST_PPI) or not math.isclose(across, down, rel_tol=0.01):
        return None
    # PNG and BMP keep whole pixels per metre: 500 ppi comes back as 499.999.
    return round(across) if abs(across - round(across)) < 0.02 else across


def grey_of_image(image: Image.Image) -> Pixels:
    """Return the grey levels of a Pillow image of any mode."""
    if image.mode == "F":
        return np.asarray(image, dtype=np.float32)
    if image.mode.startswith("I"):
        levels = np.asarray(image)
        deep = levels.min() < 0 or levels.max() > np.iinfo(np.uint16).max
        return levels.astype(np.float32) if deep else levels.astype(np.uint16)
    if image.mode not in {"1", "L"}:
        image = image.convert("RGBA")
        white = Image.new("RGBA", image.size, "white")
        image = Image.alpha_composite(white, image)
    return np.asarray(image.convert("L"), dtype=np.uint8)


def _decode_tiff(path: Path, pixel_limit: int) -> tuple[Pixels, float | None]:
    """Decode the TIFF kinds that Pillow refuses or flattens: 16-bit and float colour, doubles."""
    try:
        with tifffile.TiffFile(path) as tiff:
            page = _only_page(path, tiff)
            check_size(path, *size_of_page(page), pixel_limit)
            resolution = _plausible_resolution(resolution_of_page(page))
            pixels = _pixels_of_page(path, page)
    except ImageError:
        raise
    # tifffile lets errors of any kind out of a damaged file.
    except Exception as error:
        raise ImageError(f"{path}: is not a picture this library reads: save it as {_READABLE}") from error
    return pixels, resolution


def _only_page(path: Path, tiff: tifffile.TiffFile) -> Any:
    if len(tiff.pages) > 1:
        raise ImageError(f"{path}: holds {len(tiff.pages)} pictures: measure them all as a sequence")
    return tiff.pages[0]


def _pixels_of_page(path: Path, page: Any) -> Pixels:
    try:
        return grey_of_page(page)
    except ImageError as error:
        raise ImageError(f"{path}: {error}") from error
    except ValueError:
        # A compression that tifffile lacks; OpenCV turns a TIFF upright by itself.
        return grey_of_array(_decode_by_opencv(path))
