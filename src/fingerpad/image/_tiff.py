"""Pages of TIFF files as levels: tifffile parses the header, every sample is decoded or refused by name."""

import io
import logging
import math
import struct
import sys
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from logging.handlers import BufferingHandler
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageOps
from tifffile import COMPRESSION, PHOTOMETRIC

from fingerpad.exceptions import ImageError
from fingerpad.image._levels import Pixels, apply_orientation, levels_of_image, on_white, storable
from fingerpad.image._memory import check_memory

_WAY_OUT: Final = "convert the picture to PNG, or to TIFF with LZW or no compression"
_DEFLATE: Final = (COMPRESSION.ADOBE_DEFLATE, COMPRESSION.DEFLATE)
_STREAMS: Final = (COMPRESSION.NONE, COMPRESSION.LZW, COMPRESSION.PACKBITS, *_DEFLATE)
# Kinds of which Pillow decodes the samples and their meaning, at 8 bits or 1 bit.
_BY_PILLOW: Final = (
    COMPRESSION.JPEG,
    COMPRESSION.CCITTRLE,
    COMPRESSION(3),  # fax of groups 3 and 4, whose names differ between releases
    COMPRESSION(4),
)
_PLAIN: Final = (PHOTOMETRIC.MINISWHITE, PHOTOMETRIC.MINISBLACK, PHOTOMETRIC.RGB, PHOTOMETRIC.PALETTE)
_PILLOW_PHOTOMETRIC: Final = (*_PLAIN, PHOTOMETRIC.SEPARATED, PHOTOMETRIC.YCBCR)
_PILLOW_MODES: Final = ("1", "L", "LA", "RGB", "RGBA", "RGBX", "CMYK", "YCbCr")
_SAMPLE_KINDS: Final = {1: "u", 2: "i", 3: "f", 4: "u"}
_NUMBER_BITS: Final = {"u": (8, 16, 32, 64), "i": (8, 16, 32, 64), "f": (16, 32, 64)}
_ASSOCIATED_ALPHA, _UNASSOCIATED_ALPHA = 1, 2


@dataclass(frozen=True, slots=True, kw_only=True)
class _Layout:
    """Layout of a page's samples, from its tags.

    Attributes
    ----------
    size : (int, int)
        Columns and rows.
    segment : (int, int)
        Columns and rows of a tile, or of a strip.
    planes, contiguous : int
        Planes that are stored apart, and samples of one pixel side by side.
    bits, kind : int, str
        Bits of a sample, and numpy's letter for its kind.
    """

    size: tuple[int, int]
    segment: tuple[int, int]
    tiled: bool
    planes: int
    contiguous: int
    bits: int
    kind: str
    photometric: int
    compression: int
    predictor: int

    @property
    def samples(self) -> int:
        """Samples of one pixel."""
        return self.planes * self.contiguous

    @property
    def row_bytes(self) -> int:
        """Bytes in a row of a segment, decompressed."""
        return (self.segment[0] * self.contiguous * self.bits + 7) // 8

    @classmethod
    def of(cls, page: Any) -> "_Layout":
        columns, rows = _tag(page, "ImageWidth"), _tag(page, "ImageLength")
        samples, planar = _tag(page, "SamplesPerPixel", 1), _tag(page, "PlanarConfiguration", 1)
        tiled = "TileWidth" in page.tags
        segment = (
            (_tag(page, "TileWidth"), _tag(page, "TileLength"))
            if tiled
            else (columns, min(rows, _tag(page, "RowsPerStrip", rows)))
        )
        kind = _SAMPLE_KINDS.get(_tag(page, "SampleFormat", 1), "c")
        if min(*segment, samples) < 1:
            raise ImageError(f"its tags give segments of {segment} pixels and {samples} samples")
        return cls(
            size=(columns, rows),
            segment=segment,
            tiled=tiled,
            planes=samples if planar == 2 else 1,
            contiguous=1 if planar == 2 else samples,
            bits=_tag(page, "BitsPerSample", 1),
            kind=kind,
            photometric=_tag(page, "PhotometricInterpretation", PHOTOMETRIC.MINISBLACK),
            compression=_tag(page, "Compression", COMPRESSION.NONE),
            predictor=_tag(page, "Predictor", 1),
        )


def _tag(page: Any, name: str, default: int | None = None) -> int:
    """Return the one number of a tag."""
    tag = page.tags.get(name)
    if tag is None and default is not None:
        return int(default)
    value = None if tag is None else tag.value
    values = set(value) if isinstance(value, tuple) and value else {value}
    if len(values) > 1 or not isinstance(first := values.pop(), int):
        raise ImageError(f"its tag {name} is {value!r:.80}, not one number")
    return int(first)


def levels_of_page(path: Path, index: int, page: Any, memory_limit: int) -> Pixels:
    """Return the levels of a page, a `tifffile.TiffPage`, upright, (rows, columns) or (rows, columns, 3).

    Raises
    ------
    ImageError
        If it is too large, or of a kind that is not decoded. Damage raises other errors as well.
    """
    layout = _Layout.of(page)
    # Segments may be larger than the picture.
    reach = (max(layout.size[0], layout.segment[0]), max(layout.size[1], layout.segment[1]))
    check_memory(path, layout.size, memory_limit, channels=layout.samples, sample_bytes=-(-layout.bits // 8))
    check_memory(path, reach, memory_limit, channels=layout.samples, sample_bytes=-(-layout.bits // 8))
    _check_kind(layout, page)
    if layout.compression in _BY_PILLOW or layout.photometric not in _PLAIN:
        return _decode_by_pillow(path, index)
    levels = _levels(_samples_of(page, layout), layout, page)
    return apply_orientation(levels, _tag(page, "Orientation", 1))


def _check_kind(layout: _Layout, page: Any) -> None:
    """Refuse by name what would not be decoded truly."""
    compression, photometric = layout.compression, layout.photometric
    if compression not in _STREAMS + _BY_PILLOW:
        raise ImageError(f"TIFF compression {_name(COMPRESSION, compression)} is not read: {_WAY_OUT}")
    if photometric not in _PILLOW_PHOTOMETRIC:
        raise ImageError(f"TIFF colour space {_name(PHOTOMETRIC, photometric)} is not read: {_WAY_OUT}")
    if _tag(page, "ImageDepth", 1) != 1 or _tag(page, "TileDepth", 1) != 1:
        raise ImageError("it is a volume: save its slices as pages")
    if compression in _BY_PILLOW or photometric not in _PLAIN:
        if layout.bits not in (1, 8) or layout.planes > 1 or layout.kind != "u" or layout.samples > 4:
            raise ImageError(
                f"{layout.samples} × {layout.bits} bits in TIFF as {_name(PHOTOMETRIC, photometric)} with "
                f"compression {_name(COMPRESSION, compression)} are not read: {_WAY_OUT}"
            )
        return
    few = layout.bits in (1, 2, 4) and layout.kind == "u" and layout.samples == 1
    if not (few or layout.bits in _NUMBER_BITS.get(layout.kind, ())):
        raise ImageError(
            f"samples of {layout.samples} × {layout.bits} bits in format {_tag(page, 'SampleFormat', 1)} "
            f"are not read: {_WAY_OUT} and 8 or 16 bits"
        )
    if _tag(page, "FillOrder", 1) != 1:
        raise ImageError(f"bits in reversed order (FillOrder) are not read: {_WAY_OUT}")
    if layout.predictor not in ((1,) if few else (1, 2, 3) if layout.kind == "f" else (1, 2)):
        raise ImageError(f"predictor {layout.predictor} of these samples is not read: {_WAY_OUT}")
    if photometric == PHOTOMETRIC.MINISWHITE and layout.kind != "u":
        raise ImageError(f"signed or floating levels with the least as white are not read: {_WAY_OUT}")
    if photometric == PHOTOMETRIC.PALETTE and (layout.kind != "u" or layout.bits > 8):
        raise ImageError(f"a palette of {layout.bits}-bit levels is not read: {_WAY_OUT}")


def _name(kinds: Any, value: int) -> str:
    return f"{kinds(value).name}" if value in kinds.__members__.values() else f"number {value}"


def _samples_of(page: Any, layout: _Layout) -> npt.NDArray[Any]:
    """Return all samples of a page, (rows, columns, samples)."""
    (columns, rows), (width, height) = layout.size, layout.segment
    across, down = math.ceil(columns / width), math.ceil(rows / height)
    places = list(zip(page.dataoffsets, page.databytecounts, strict=False))
    if len(places) < layout.planes * across * down:
        raise ImageError(f"it has {len(places)} of {layout.planes * across * down} strips or tiles")
    dtype = np.dtype(np.uint8) if layout.bits < 8 else np.dtype(f"{layout.kind}{layout.bits // 8}")
    samples = np.empty((rows, columns, layout.samples), dtype)
    file = page.parent.filehandle
    for number, (offset, count) in enumerate(places[: layout.planes * across * down]):
        plane, place = divmod(number, across * down)
        top, left = place // across * height, place % across * width
        held = height if layout.tiled else min(height, rows - top)
        file.seek(offset)
        # The most bytes that the samples take in the worst case of each compression.
        packed = file.read(min(count, 2 * held * layout.row_bytes + 1024))
        part = _segment(packed, held, layout, page.parent.byteorder)
        into = samples[top : top + held, left : left + width, plane : plane + layout.contiguous]
        into[...] = part[: into.shape[0], : into.shape[1]]
    return samples


def _segment(packed: bytes, rows: int, layout: _Layout, order: Literal["<", ">"]) -> npt.NDArray[Any]:
    """Return the samples of a strip or tile, (rows, columns, samples)."""
    data = _unpack_rows(packed, rows, layout)
    if len(data) < rows * layout.row_bytes:
        raise ImageError("a strip or tile is cut short: copy the file again")
    lines = np.frombuffer(data, np.uint8, rows * layout.row_bytes).reshape(rows, layout.row_bytes)
    width, count = layout.segment[0], layout.contiguous
    if layout.bits < 8:
        shifts = np.arange(8 - layout.bits, -1, -layout.bits, dtype=np.uint8)
        mask = np.uint8(2**layout.bits - 1)
        return ((lines[..., None] >> shifts) & mask).reshape(rows, -1)[:, :width, None]
    number = np.dtype(f"{layout.kind}{layout.bits // 8}")
    if layout.predictor == 3:  # bytes of equal weight side by side, the highest first, then differences
        whole = np.cumsum(lines.reshape(rows, -1, count), axis=1, dtype=np.uint8)
        whole = np.ascontiguousarray(whole.reshape(rows, number.itemsize, -1).swapaxes(1, 2))
        return whole.view(number.newbyteorder(">")).reshape(rows, width, count)
    if layout.predictor == 2:  # differences of whole numbers, even of floating point
        bits = np.dtype(f"u{number.itemsize}")
        steps = lines.view(bits.newbyteorder(order)).reshape(rows, width, count)
        return np.cumsum(steps, axis=1, dtype=bits).view(number)
    return lines.view(number.newbyteorder(order)).reshape(rows, width, count)


def _unpack_rows(packed: bytes, rows: int, layout: _Layout) -> bytes:
    if layout.compression == COMPRESSION.NONE:
        return packed
    if layout.compression in _DEFLATE:
        return zlib.decompressobj().decompress(packed, rows * layout.row_bytes)
    # Pillow's libtiff decodes the stream as a grey picture of bytes.
    tags = {
        256: layout.row_bytes,
        257: rows,
        258: 8,
        259: layout.compression,
        262: 1,
        273: 8 + 2 + 8 * 12 + 4,
        278: rows,
        279: len(packed),
    }
    entries = b"".join(struct.pack("<HHII", tag, 4, 1, value) for tag, value in tags.items())
    head = b"II*\0" + struct.pack("<IH", 8, len(tags)) + entries + bytes(4)
    with Image.open(io.BytesIO(head + packed), formats=["TIFF"]) as image:
        return image.tobytes()


def _levels(samples: npt.NDArray[Any], layout: _Layout, page: Any) -> Pixels:
    """Return what the samples of a page mean."""
    channels = 3 if layout.photometric == PHOTOMETRIC.RGB else 1
    if samples.shape[2] < channels:
        raise ImageError(f"RGB of {samples.shape[2]} samples")
    colour = samples[..., :channels] if channels == 3 else samples[..., 0]
    if layout.photometric == PHOTOMETRIC.PALETTE:
        table = np.asarray(page.tags.valueof("ColorMap"), dtype=np.uint16).reshape(3, -1)
        return np.asarray((table.T >> 8).astype(np.uint8)[colour], dtype=np.uint8)
    if layout.bits < 8:
        colour = colour * np.uint8(255 // (2**layout.bits - 1))
    if layout.photometric == PHOTOMETRIC.MINISWHITE:
        colour = np.iinfo(colour.dtype).max - colour
    extra = page.tags.valueof("ExtraSamples", default=())
    first = (extra if isinstance(extra, tuple) else (extra,))[:1]
    if samples.shape[2] > channels and first and int(first[0]) in (_ASSOCIATED_ALPHA, _UNASSOCIATED_ALPHA):
        if layout.kind == "i" or (layout.bits > 16 and layout.kind == "u"):
            raise ImageError(f"transparency of {layout.bits}-bit integers is not read: {_WAY_OUT}")
        return on_white(colour, samples[..., channels], premultiplied=int(first[0]) == _ASSOCIATED_ALPHA)
    return storable(np.ascontiguousarray(colour))


def _decode_by_pillow(path: Path, index: int) -> Pixels:
    with Image.open(path, formats=["TIFF"]) as image:
        image.seek(index)
        if image.mode not in _PILLOW_MODES:
            raise ImageError(f"a picture of mode {image.mode} is not read: {_WAY_OUT}")
        return levels_of_image(ImageOps.exif_transpose(image))


def is_reduced_copy(page: Any) -> bool:
    """Return whether a page is a smaller copy of another."""
    return bool(_tag(page, "NewSubfileType", 0) & 1)


def resolution_of_page(page: Any) -> tuple[float, float] | None:
    """Return the pixels per inch of a page, across and down, None where the file names no unit."""
    unit = {2: 1.0, 3: 2.54}.get(_tag(page, "ResolutionUnit", 2))
    pair = raw_resolution(page)
    return None if unit is None or pair is None else (pair[0] * unit, pair[1] * unit)


def raw_resolution(page: Any) -> tuple[float, float] | None:
    """Return the pixels per unit of a page, whatever the unit."""
    found = [page.tags.valueof(name) for name in ("XResolution", "YResolution")]
    try:
        across, down = (float(value[0]) / float(value[1]) for value in found)
    except (TypeError, ValueError, IndexError, ZeroDivisionError, OverflowError):
        return None
    return across, down


def description_of_page(page: Any) -> str:
    """Return the text that a page carries."""
    return str(page.tags.valueof("ImageDescription", default=""))


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
