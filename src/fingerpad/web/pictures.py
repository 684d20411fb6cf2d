"""Previews and thumbnails of images of any depth, made on request and cached."""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from threading import Event, Lock, RLock
from typing import Final, Generic, TypeVar

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad.exceptions import ImageError
from fingerpad.image import open_frames, read_colour_image, read_image
from fingerpad.image.levels import reduced, stretched
from fingerpad.image.read import Picture
from fingerpad.image.sequence.frames import TIFF_SUFFIXES, VIDEO_SUFFIXES, frame_files
from fingerpad.web.errors import RequestError

THUMBNAIL_PX: Final = 192
PREVIEW_PX: Final = 2048
_DECODED_BYTES: Final = 400_000_000
_ENCODED_BYTES: Final = 100_000_000
_SEQUENCE_SUFFIXES: Final = VIDEO_SUFFIXES | TIFF_SUFFIXES
_JPEG: Final = [cv2.IMWRITE_JPEG_QUALITY, 90]
_WEBP: Final = [cv2.IMWRITE_WEBP_QUALITY, 75]
_PNG: Final = [cv2.IMWRITE_PNG_COMPRESSION, 1]

Kept = TypeVar("Kept")


@dataclass(frozen=True, slots=True)
class ImageLocation:
    """Location of an image: a file, or a frame of a sequence (a file or folder)."""

    path: Path
    frame: int | None = None
    colour: bool = False  # whether it matters: of photographs, and of files of which nothing is known

    @property
    def stamp(self) -> Hashable:
        """A stamp that changes with the file, or with the frame's own file in a folder."""
        path = self.path
        try:
            if self.frame is not None and path.is_dir():
                files = _frame_files(path, path.stat().st_mtime_ns)
                path = files[self.frame] if self.frame < len(files) else path
            status = path.stat()
        except OSError as error:
            raise RequestError.not_there(f"{self.path.name}: the file is no longer there") from error
        return str(path), self.frame, status.st_size, status.st_mtime_ns, status.st_ino


@lru_cache(maxsize=8)
def _frame_files(folder: Path, _changed_ns: int) -> list[Path]:
    """Return the frames of a folder, listed again when it has changed."""
    return frame_files(folder)


class Cache(Generic[Kept]):
    """A cache of the values used last, up to a total size; concurrent requests make a value once."""

    def __init__(self, limit: int, size: Callable[[Kept], int]) -> None:
        self._limit, self._size = limit, size
        self._kept: OrderedDict[Hashable, Kept] = OrderedDict()
        self._making: dict[Hashable, Event] = {}
        self._total, self._lock = 0, Lock()

    def get(self, key: Hashable, make: Callable[[], Kept]) -> Kept:
        """Return the value of `key`, made now unless it is cached."""
        while True:
            with self._lock:
                if key in self._kept:
                    self._kept.move_to_end(key)
                    return self._kept[key]
                made = self._making.get(key)
                if made is None:  # this thread makes it
                    made = self._making[key] = Event()
                    break
            made.wait()  # another makes it, or fails
        try:
            value = make()
            with self._lock:
                self._kept[key] = value
                self._total += self._size(value)
                while self._total > self._limit and len(self._kept) > 1:
                    self._total -= self._size(self._kept.popitem(last=False)[1])
            return value
        finally:
            with self._lock:
                del self._making[key]
            made.set()


class Pictures:
    """The images of the open study."""

    def __init__(self, memory_limit: int) -> None:
        self._memory_limit = memory_limit
        self._decoded: Cache[Picture] = Cache(_DECODED_BYTES, lambda picture: picture.pixels.nbytes)
        self._colours: Cache[npt.NDArray[np.uint8]] = Cache(_DECODED_BYTES, lambda pixels: pixels.nbytes)
        self._encoded: Cache[bytes] = Cache(_ENCODED_BYTES, len)
        # One at a time: together they could take more than the limit of each.
        self._decoding = RLock()

    def grey(self, place: ImageLocation) -> Picture:
        """Return an image in grey levels, as for contact images."""
        with self._decoding:
            return self._decoded.get(place.stamp, lambda: self._read(place))

    def colour(self, place: ImageLocation) -> npt.NDArray[np.uint8]:
        """Return an image in colour, as for photographs."""
        with self._decoding:
            return self._colours.get(
                place.stamp, lambda: read_colour_image(place.path, memory_limit=self._memory_limit)
            )

    def _read(self, place: ImageLocation) -> Picture:
        if place.frame is None:
            return read_image(place.path, memory_limit=self._memory_limit)
        frame = open_frames(place.path, memory_limit=self._memory_limit).at(place.frame)
        if frame.pixels is None:
            raise ImageError(frame.reason or f"frame {place.frame} cannot be read")
        return Picture(pixels=frame.pixels, dots_per_inch=None)

    def shown(self, place: ImageLocation) -> npt.NDArray[np.uint8]:
        """Return an image in 8 bits, in colour where that matters."""
        if place.colour and not is_sequence(place.path):
            return self.colour(place)
        if place.colour:
            place = ImageLocation(place.path, frame=0)
        return stretched(self.grey(place).pixels)

    def preview(self, place: ImageLocation, longest_px: int) -> tuple[bytes, str]:
        """Return a preview and its media type: photographs as JPEG, other images as PNG."""
        kind, ending, options = ("image/jpeg", ".jpg", _JPEG) if place.colour else ("image/png", ".png", _PNG)
        return self._drawn(place, longest_px, ending, options), kind

    def thumbnail(self, place: ImageLocation) -> bytes:
        """Return a thumbnail as WebP."""
        return self._drawn(place, THUMBNAIL_PX, ".webp", _WEBP)

    def _drawn(self, place: ImageLocation, longest_px: int, ending: str, options: list[int]) -> bytes:
        def draw() -> bytes:
            pixels = reduced(self.shown(place), longest_px)
            done, drawn = cv2.imencode(ending, pixels[..., ::-1] if pixels.ndim == 3 else pixels, options)
            if not done:
                raise ImageError(f"{place.path.name}: cannot be encoded")
            return drawn.tobytes()

        return self._encoded.get((place.stamp, longest_px, ending), draw)


def is_sequence(path: Path) -> bool:
    """Tell whether a file may hold many frames, by its name."""
    return path.is_dir() or path.suffix.lower() in _SEQUENCE_SUFFIXES
