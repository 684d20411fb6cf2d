"""Read a picture file into a plain array of grey levels or colours."""

from __future__ import annotations

import math
import re
import stat
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, Final, TypeAlias

import cv2
import numpy as np
import numpy.typing as npt
import tifffile
from PIL import Image, UnidentifiedImageError

from fingerpad._arrays import positive_number, set_fields
from fingerpad._display import Displayed
from fingerpad.exceptions import CalibrationError, ImageError
from fingerpad.image.levels import (
    MEMORY_LIMIT,
    Pixels,
    apply_orientation,
    check_finite,
    check_memory,
    checked_picture,
    eight_bit,
    levels_of_image,
    luma,
    on_white,
    storable,
)
from fingerpad.image.tiff import levels_of_page, tifffile_warnings

_FORMATS: Final = ("PNG", "JPEG", "BMP", "PPM")
_READABLE = "PNG, TIFF, JPEG, BMP or PGM"
_SEVERAL: Final = (
    "holds {} pictures: save the one to measure in its own file, or measure them all as a sequence"
)
_TIFF_STARTS: Final = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")
_ORIENTATION_TAG: Final = 274
_COLOURS: Final = ("RGB", "RGBA", "RGBX", "LA")  # modes that Pillow has for 8 bits alone
# Files without a true resolution carry 0 or 1 here.
_MIN_PPI = 10.0
# Resolutions across and down that differ by more are those of pixels that are not square.
SQUARE: Final = 0.01
# ImageJ keeps its scale as pixels per unit, and the unit in the description.
_IMAGEJ_UNITS: Final = {"inch": 1.0, "cm": 2.54, "mm": 25.4, "um": 25400.0, "micron": 25400.0}


# An array, the path of a file, or a picture that was read before. A string is a path.
ImageLike: TypeAlias = "npt.ArrayLike | PathLike[str] | Picture"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Picture(Displayed):
    """A picture and the resolution stated in its file.

    Attributes
    ----------
    pixels : ndarray, shape (rows, columns) or (rows, columns, 3)
        Grey levels, or red, green and blue; uint8, uint16 or float32 as the file had them.
    dots_per_inch : float or None
        As the file states it; None where it states none, or no unit. Cameras and editors write 72 or 96
        without meaning it: `Scale.of_picture` refuses those.
    """

    pixels: Pixels
    dots_per_inch: float | None

    def __post_init__(self) -> None:
        # No copy: a picture may take much of the memory allowed.
        object.__setattr__(self, "pixels", checked_picture(self.pixels, "pixels", colour=True))
        if self.dots_per_inch is not None:
            resolution = positive_number(self.dots_per_inch, "dots_per_inch", CalibrationError)
            set_fields(self, dots_per_inch=resolution)


def read_image(
    path: str | PathLike[str], *, colour: bool = False, memory_limit: int = MEMORY_LIMIT
) -> Picture:
    """Read one picture from a PNG, TIFF, JPEG, BMP or PGM file.

    Colour becomes luma (ITU-R BT.601) of the file's own depth unless it is kept, transparency is blended with
    white, and a camera's rotation tag is obeyed. A file of several pictures (a TIFF of many pages, an
    animation) is refused; `open_frames` reads it page by page. Reduced copies that a TIFF carries beside its
    picture do not count.

    Of TIFF, levels of 1 to 64 bits are read uncompressed or compressed by LZW, Deflate or PackBits, and those
    of 8 bits or 1 bit by JPEG or CCITT. Other compressions are refused by name.

    Parameters
    ----------
    path : path-like
        The file.
    colour : bool
        Keep the colours of a file that has any, as photographs and contacts without ridges need them.
    memory_limit : int
        The most bytes that reading and measuring the picture may take, by its header, before anything is
        decoded: for each pixel 24, and twice those of its samples. 2 GB are 76 million pixels of 8-bit grey,
        and 66 million of 8-bit colour.

    Returns
    -------
    Picture

    Raises
    ------
    ImageError
        If the file is missing, empty, cut short, too large, not a picture, holds NaN or infinity, or states a
        resolution across that is not that down.

    Examples
    --------
    >>> read_image("no_such_print.png")
    Traceback (most recent call last):
    fingerpad.exceptions.ImageError: no_such_print.png: no such file or folder: check the path
    """
    levels, resolution = read_levels(path, memory_limit)
    return Picture(pixels=levels if colour else luma(levels), dots_per_inch=resolution)


def in_colour(levels: Pixels) -> npt.NDArray[np.uint8]:
    """Return levels of a picture as red, green, blue of 8 bits."""
    eight = eight_bit(levels)
    return np.repeat(eight[..., None], 3, axis=2) if eight.ndim == 2 else eight


def levels_of(image: ImageLike, *, colour: bool = False) -> npt.ArrayLike:
    """Return the levels of a picture, read if it is a path, then with its colours if they are wanted."""
    if isinstance(image, str | PathLike):
        image = read_image(image, colour=colour)
    return image.pixels if isinstance(image, Picture) else image


def read_levels(path: str | PathLike[str], memory_limit: int) -> tuple[Pixels, float | None]:
    """Return levels of a picture, upright and on white, and the dots per inch that its file states.

    They are uint8, uint16 or float32, (rows, columns) or (rows, columns, 3).
    """
    path = Path(path)
    start = read_start(path)
    with decoding(path):
        levels, resolution = (_tiff if start in _TIFF_STARTS else _decode)(path, memory_limit)
        check_finite(levels, path)
    return levels, resolution


@contextmanager
def decoding(path: Path, page: str = "") -> Iterator[None]:
    """Refuse a file, or its page, by name, whatever is wrong with it, and keep warnings from printing."""
    with warnings.catch_warnings(), tifffile_warnings():
        warnings.simplefilter("ignore")
        try:
            yield
        except UnidentifiedImageError as error:
            raise ImageError(
                f"{path}: is not a picture this library reads: save it as {_READABLE}"
            ) from error
        except ImageError as error:
            raise error if str(path) in str(error) else ImageError(f"{path}{page}: {error}") from error
        except (Image.DecompressionBombError, MemoryError) as error:
            raise ImageError(f"{path}{page}: far too many pixels: crop or shrink the picture") from error
        # The libraries let errors of any kind out of a damaged file.
        except Exception as error:
            raise ImageError(
                f"{path}{page}: cannot be decoded, the file is cut short or damaged ({error}): copy it again"
            ) from error


def check_regular(path: Path) -> None:
    """Refuse what is neither a file nor a folder: reading a pipe would wait without end."""
    try:
        kind = path.stat().st_mode
    except FileNotFoundError as error:
        raise ImageError(f"{path}: no such file or folder: check the path") from error
    except (OSError, ValueError) as error:
        raise ImageError(f"{path}: cannot be opened ({error}): check the path and its permissions") from error
    if not (stat.S_ISREG(kind) or stat.S_ISDIR(kind)):
        raise ImageError(f"{path}: is a pipe or a device: save the pictures as a file")


def read_start(path: Path) -> bytes:
    """Return the first bytes of a file that can be opened."""
    check_regular(path)
    if path.is_dir():
        raise ImageError(f"{path}: is a folder: name one picture in it")
    try:
        with path.open("rb") as file:
            first = file.read(4)
    except OSError as error:
        raise ImageError(f"{path}: cannot be opened ({error}): check the path and its permissions") from error
    if not first:
        raise ImageError(f"{path}: the file is empty: copy it again")
    return first


def _tiff(path: Path, memory_limit: int) -> tuple[Pixels, float | None]:
    with tifffile.TiffFile(path) as tiff:
        pages: Any = tiff.pages
        # Reduced copies beside the picture have the first bit set.
        if not all(pages[number].subfiletype & 1 for number in range(1, len(pages))):
            raise ImageError(_SEVERAL.format(len(pages)))
        return levels_of_page(path, 0, pages[0], memory_limit), resolution_of_page(pages[0])


def _decode(path: Path, memory_limit: int) -> tuple[Pixels, float | None]:
    """Decode by Pillow, or by OpenCV the deep colour it would cut; the header passes the check first."""
    with Image.open(path, formats=_FORMATS) as image:
        # The layout of the file's samples, or the largest of a PPM, tells what Pillow cuts to 8 bits.
        layouts = [str(tile[3]) for tile in getattr(image, "tile", ())]
        deep = image.mode in _COLOURS and any(";16" in each or "65535" in each for each in layouts)
        sample_bytes = 2 if deep else {"I": 4, "F": 4}.get(image.mode[:1], 1)
        channels = len(image.getbands())
        check_memory(path, image.size, memory_limit, channels=channels, sample_bytes=sample_bytes)
        count = getattr(image, "n_frames", 1)
        if count > 1 and image.format != "MPO":  # a telephone's JPEG, followed by a preview
            raise ImageError(_SEVERAL.format(count))
        resolution = _resolution_of_image(image)
        image.load()  # what is cut short or damaged is refused here
        levels = _decode_by_opencv(path) if deep else levels_of_image(image)
        return apply_orientation(levels, image.getexif().get(_ORIENTATION_TAG, 1)), resolution


def _resolution_of_image(image: Image.Image) -> float | None:
    # Without a unit JPEG and PNG state the shape of a pixel alone.
    shape = image.info.get("aspect") or image.info.get("jfif_density")
    return plausible_resolution(image.info.get("dpi") or shape, 1.0 if "dpi" in image.info else None)


def read_resolution(path: Path) -> float | None:
    """Return the dots per inch that a picture's header states, None where it states none or is damaged."""
    with suppress(ImageError), decoding(path):  # `read_levels` says what is wrong
        if read_start(path) in _TIFF_STARTS:
            with tifffile.TiffFile(path) as tiff:
                return resolution_of_page(tiff.pages[0])
        with Image.open(path, formats=_FORMATS) as image:
            return _resolution_of_image(image)
    return None


def _decode_by_opencv(path: Path) -> Pixels:
    """Decode at full depth, without turning."""
    array: npt.NDArray[Any] | None = cv2.imdecode(np.fromfile(path, np.uint8), cv2.IMREAD_UNCHANGED)
    if array is None:
        raise ImageError("OpenCV cannot decode it: copy it again, or save it with 8 bits")
    if array.ndim == 2:
        return storable(array)
    colour = array[..., 2::-1]
    return on_white(colour, array[..., 3]) if array.shape[2] == 4 else storable(np.ascontiguousarray(colour))


def plausible_resolution(pair: Any, per_inch: float | None = 1.0) -> float | None:
    """Return the dots per inch of what a file states across and down, None where it cannot be that.

    A file whose pixels are not square is refused, whatever its unit: no scale of it is right for both axes.
    """
    try:
        across, down = (float(value) for value in pair)
    except (TypeError, ValueError, ZeroDivisionError):
        return None
    if not (0 < across < math.inf and 0 < down < math.inf):
        return None
    if not math.isclose(across, down, rel_tol=SQUARE):
        raise ImageError(
            f"states a resolution of {across:.5g} across and {down:.5g} down: its pixels are not square, and "
            "lengths in it would be wrong: resample it to square pixels, or save it without a resolution if "
            "what it states is wrong"
        )
    if per_inch is None or across * per_inch < _MIN_PPI:
        return None
    # PNG and BMP keep whole pixels per metre: 500 ppi comes back as 499.999.
    ppi = across * per_inch
    return round(ppi) if abs(ppi - round(ppi)) < 0.02 else ppi


def resolution_of_page(page: Any) -> float | None:
    """Return the calibration of a TIFF: ImageJ writes pixels per unit, without TIFF's unit."""
    text = str(page.description)
    unit = re.search(r"^unit=(.+)$", text, re.MULTILINE) if text.startswith("ImageJ=") else None
    if unit is None:
        per_inch = {2: 1.0, 3: 2.54}.get(page.tags.valueof("ResolutionUnit", default=2))
    else:
        per_inch = _IMAGEJ_UNITS.get(unit[1].strip().replace(r"\u00B5", "u").replace("µ", "u"))
    found = [page.tags.valueof(name) for name in ("XResolution", "YResolution")]
    try:
        pair = [float(value[0]) / float(value[1]) for value in found]
    except (TypeError, ValueError, IndexError, ZeroDivisionError, OverflowError):
        return None
    return plausible_resolution(pair, per_inch)
