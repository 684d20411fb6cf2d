"""Pages of TIFF files as levels: tifffile decodes every sample with imagecodecs, or it is refused by name."""

import logging
import math
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from logging.handlers import BufferingHandler
from pathlib import Path
from typing import Any, Final

import imagecodecs
import numpy as np
import numpy.typing as npt
from PIL import Image, ImageOps
from tifffile import COMPRESSION, PHOTOMETRIC

from fingerpad.exceptions import ImageError
from fingerpad.image.levels import (
    Pixels,
    apply_orientation,
    check_memory,
    levels_of_image,
    on_white,
    storable,
)

_WAY_OUT: Final = "convert the picture to PNG, or to TIFF with LZW or no compression"
# None, LZW, Deflate by both its numbers, PackBits: imagecodecs stops at the size that the tags promise.
_STREAMS: Final = (1, 5, 8, 32946, 32773)
_PACKERS: Final[dict[int, tuple[Callable[..., Any], Callable[..., Any]]]] = {
    8: (imagecodecs.deflate_decode, imagecodecs.deflate_encode),
    32946: (imagecodecs.deflate_decode, imagecodecs.deflate_encode),
    32773: (imagecodecs.packbits_decode, imagecodecs.packbits_encode),
}
# Fax and JPEG state a size of their own. Pillow decodes them, and other colours than RGB, at 8 bits or 1 bit:
# its libtiff refuses a size that the tags do not promise, imagecodecs decodes it whatever memory it takes.
_BY_PILLOW: Final = (2, 3, 4, 7)
_PLAIN: Final = (PHOTOMETRIC.MINISWHITE, PHOTOMETRIC.MINISBLACK, PHOTOMETRIC.RGB, PHOTOMETRIC.PALETTE)
_PILLOW_PHOTOMETRIC: Final = (*_PLAIN, PHOTOMETRIC.SEPARATED, PHOTOMETRIC.YCBCR)
_PILLOW_MODES: Final = ("1", "L", "LA", "RGB", "RGBA", "RGBX", "CMYK", "YCbCr")
_ASSOCIATED_ALPHA, _UNASSOCIATED_ALPHA = (1,), (2,)
# Bytes of packed samples read at a time.
_BUFFER: Final = 2**24


def levels_of_page(path: Path, index: int, page: Any, memory_limit: int) -> Pixels:
    """Return the levels of a page, a `tifffile.TiffPage`, upright, (rows, columns) or (rows, columns, 3)."""
    # Tiles may be larger than their picture.
    columns, rows = page.imagewidth, page.imagelength
    sample_bytes = -(-int(np.max(page.bitspersample)) // 8)
    for size in ((columns, rows), (max(columns, page.tilewidth), max(rows, page.tilelength))):
        check_memory(path, size, memory_limit, channels=page.samplesperpixel, sample_bytes=sample_bytes)
    packed = max(page.databytecounts, default=0)
    if packed > memory_limit:
        raise ImageError(f"a strip or tile of {packed / 1e9:.2g} GB: the file is damaged, copy it again")
    photometric = int(page.tags.valueof("PhotometricInterpretation", default=PHOTOMETRIC.MINISBLACK))
    _check_kind(page, photometric)
    if page.compression in _BY_PILLOW or photometric not in _PLAIN:
        with Image.open(path, formats=["TIFF"]) as image:
            image.seek(index)
            if image.mode not in _PILLOW_MODES:
                raise ImageError(f"a picture of mode {image.mode} is not read: {_WAY_OUT}")
            return levels_of_image(ImageOps.exif_transpose(image))
    # tifffile would fill in missing strips or tiles silently.
    count = math.prod(page.chunked)
    places = list(zip(page.dataoffsets, page.databytecounts, strict=False))[:count]
    held = sum(offset > 0 and size > 0 for offset, size in places)
    if held < count:
        raise ImageError(f"the file is cut short, it has {held} of {count} strips or tiles: copy it again")
    if page.compression in _PACKERS and page.fillorder == 1 and not page.is_tiled:
        page.decode = _decode_padded(page)
    # Planes, slices, rows, columns, samples side by side.
    stored = page.asarray(squeeze=False, maxworkers=1, buffersize=_BUFFER)[:, 0]
    samples = stored[0] if len(stored) == 1 else np.moveaxis(stored[..., 0], 0, -1)
    levels = _levels(samples, page, photometric)
    return apply_orientation(levels, page.tags.valueof("Orientation", default=1))


def _check_kind(page: Any, photometric: int) -> None:
    """Refuse by name what would not be decoded truly."""
    compression, bits, samples = page.compression, page.bitspersample, page.samplesperpixel
    kind = "" if page.dtype is None else page.dtype.kind.replace("b", "u")
    if compression not in _STREAMS + _BY_PILLOW:
        raise ImageError(f"TIFF compression {_name(COMPRESSION, compression)} is not read: {_WAY_OUT}")
    if photometric not in _PILLOW_PHOTOMETRIC:
        raise ImageError(f"TIFF colour space {_name(PHOTOMETRIC, photometric)} is not read: {_WAY_OUT}")
    if page.imagedepth != 1 or page.tiledepth != 1:
        raise ImageError("it is a volume: save its slices as pages")
    if compression in _BY_PILLOW or photometric not in _PLAIN:
        if bits not in (1, 8) or page.planarconfig != 1 or kind != "u" or samples > 4:
            raise ImageError(
                f"{samples} × {bits} bits in TIFF as {_name(PHOTOMETRIC, photometric)} with "
                f"compression {_name(COMPRESSION, compression)} are not read: {_WAY_OUT}"
            )
        return
    few = bits in (1, 2, 4) and kind == "u" and samples == 1
    if not (few or (bits in (8, 16, 32, 64) and kind in tuple("uif"))):
        raise ImageError(
            f"samples of {samples} × {bits} bits in format {int(page.sampleformat)} "
            f"are not read: {_WAY_OUT} and 8 or 16 bits"
        )
    if page.predictor not in ((1,) if few else (1, 2, 3) if kind == "f" else (1, 2)):
        raise ImageError(f"predictor {page.predictor} of these samples is not read: {_WAY_OUT}")
    if photometric == PHOTOMETRIC.MINISWHITE and kind != "u":
        raise ImageError(f"signed or floating levels with the least as white are not read: {_WAY_OUT}")
    if photometric == PHOTOMETRIC.PALETTE and (kind != "u" or bits > 8):
        raise ImageError(f"a palette of {bits}-bit levels is not read: {_WAY_OUT}")
    if photometric == PHOTOMETRIC.RGB and samples < 3:
        raise ImageError(f"RGB of {samples} samples")


def _name(kinds: Any, value: int) -> str:
    return f"{kinds(value).name}" if value in kinds.__members__.values() else f"number {value}"


def _decode_padded(page: Any) -> Callable[..., Any]:
    """Return the decoder of a page's strips, which drops what follows a strip's last row.

    Many programs pad the last strip, which imagecodecs takes for damage. What holds more than another strip
    more has other rows than its tags say.
    """
    decode, (unpack, pack) = page.decode, _PACKERS[page.compression]
    height = page.tags.valueof("RowsPerStrip", default=page.rowsperstrip)

    def decode_padded(data: Any, index: int, **options: Any) -> Any:
        try:
            return decode(data, index, **options)
        except RuntimeError:  # of imagecodecs
            shape = decode(None, index)[2]
            row_bytes = -(-page.bitspersample * shape[2] * shape[3] // 8)
            size = shape[1] * row_bytes
            held = unpack(data, out=size + min(height * row_bytes, max(size, _BUFFER)))
            return decode(pack(held[:size]), index, **options)

    return decode_padded


def _levels(samples: npt.NDArray[Any], page: Any, photometric: int) -> Pixels:
    """Return what the samples of a page, (rows, columns, samples), mean."""
    bits, channels = page.bitspersample, 3 if photometric == PHOTOMETRIC.RGB else 1
    colour = samples[..., :channels] if channels == 3 else samples[..., 0]
    if photometric == PHOTOMETRIC.PALETTE:
        table = np.asarray(page.tags.valueof("ColorMap"), dtype=np.uint16).reshape(3, -1)
        return np.asarray((table.T >> 8).astype(np.uint8)[colour.astype(np.uint8)], dtype=np.uint8)
    if bits < 8:
        colour = colour.astype(np.uint8) * np.uint8(255 // (2**bits - 1))
    if photometric == PHOTOMETRIC.MINISWHITE:
        colour = np.iinfo(colour.dtype).max - colour
    extra = tuple(page.extrasamples[:1])
    if samples.shape[2] > channels and extra in (_ASSOCIATED_ALPHA, _UNASSOCIATED_ALPHA):
        if samples.dtype.kind == "i" or (samples.dtype.kind == "u" and bits > 16):
            raise ImageError(f"transparency of {bits}-bit integers is not read: {_WAY_OUT}")
        return on_white(colour, samples[..., channels], premultiplied=extra == _ASSOCIATED_ALPHA)
    return storable(np.ascontiguousarray(colour))


@contextmanager
def tifffile_warnings() -> Iterator[list[logging.LogRecord]]:
    """Collect what tifffile only logs, such as a broken chain of pages, and keep it from printing."""
    logger, handler = logging.getLogger("tifffile"), BufferingHandler(sys.maxsize)
    handler.setLevel(logging.WARNING)
    before = logger.propagate
    logger.addHandler(handler)
    logger.propagate = False
    try:
        yield handler.buffer
    finally:
        logger.removeHandler(handler)
        logger.propagate = before
