"""Pixels, previews and thumbnails of images of any depth, made on request and cached."""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from threading import Event, Lock, RLock
from typing import Any, Final, Generic, TypeVar

import cv2
import numpy.typing as npt

from fingerpad.exceptions import ImageError
from fingerpad.image import open_frames, read_image
from fingerpad.image.levels import reduced, stretched
from fingerpad.image.sequence.frames import TIFF_SUFFIXES, VIDEO_SUFFIXES, frame_files
from fingerpad.web.answers import RequestError

_DECODED_BYTES: Final = 800_000_000
_ENCODED_BYTES: Final = 100_000_000
# By media type, the ending of a file of that type, and how it is encoded.
_ENCODINGS: Final = {
    "image/jpeg": (".jpg", [cv2.IMWRITE_JPEG_QUALITY, 90]),
    "image/webp": (".webp", [cv2.IMWRITE_WEBP_QUALITY, 75]),
    "image/png": (".png", [cv2.IMWRITE_PNG_COMPRESSION, 1]),
}

Kept = TypeVar("Kept")


@dataclass(frozen=True, slots=True)
class ImageLocation:
    """Location of an image: a file, or a frame of a sequence (a file or folder)."""

    path: Path
    frame: int | None = None
    # Whether it matters: of photographs, contacts without ridges, and files of which nothing is known.
    colour: bool = False

    @property
    def stamp(self) -> Hashable:
        """A stamp that changes with the file, or the frame's own in a folder, and with how it is read."""
        path = self.path
        try:
            if self.frame is not None and path.is_dir():
                files = _frame_files(path, path.stat().st_mtime_ns)
                path = files[self.frame] if self.frame < len(files) else path
            status = path.stat()
        except OSError as error:
            raise RequestError.not_there(f"{self.path.name}: the file is no longer there") from error
        return str(path), self.frame, self.colour, status.st_size, status.st_mtime_ns, status.st_ino

    @property
    def shown(self) -> "ImageLocation":
        """What is shown of it: of a file that may be a sequence the first frame."""
        of_sequence = self.frame is None and self.colour and is_sequence(self.path)
        return replace(self, frame=0) if of_sequence else self


@lru_cache(maxsize=8)
def _frame_files(folder: Path, _changed_ns: int) -> list[Path]:
    """Return the frames of a folder, listed again when it has changed."""
    return frame_files(folder)


class Cache(Generic[Kept]):
    """A cache of the values used last, up to a total size; concurrent requests make a value once."""

    def __init__(self, limit: int, size: Callable[[Kept], int] = lambda _: 1) -> None:
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
    """The images of all studies.

    `memory_limit` is the most bytes that reading and measuring one may take, as for `read_image`.
    """

    def __init__(self, memory_limit: int) -> None:
        self.memory_limit = memory_limit
        self._decoded: Cache[npt.NDArray[Any]] = Cache(_DECODED_BYTES, lambda pixels: pixels.nbytes)
        self._encoded: Cache[bytes] = Cache(_ENCODED_BYTES, len)
        # One at a time: together they could take more than the limit of each.
        self._decoding = RLock()

    def pixels(self, place: ImageLocation) -> npt.NDArray[Any]:
        """Return an image as it is measured, in colour where that matters, or else in grey levels."""
        with self._decoding:
            return self._decoded.get(place.stamp, lambda: self._read(place))

    def grey(self, place: ImageLocation) -> npt.NDArray[Any]:
        """Return an image in grey levels, as for contact images."""
        return self.pixels(replace(place, colour=False))

    def _read(self, place: ImageLocation) -> npt.NDArray[Any]:
        if place.frame is None:
            return read_image(place.path, colour=place.colour, memory_limit=self.memory_limit).pixels
        frames = open_frames(place.path, colour=place.colour, memory_limit=self.memory_limit)
        frame = frames.at(place.frame)
        if frame.pixels is None:
            raise ImageError(frame.reason or f"frame {place.frame} cannot be read")
        return frame.pixels

    def encoded(self, place: ImageLocation, media_type: str, longest_px: int) -> bytes:
        """Return an image as it is shown, of at most `longest_px` on its longer side."""
        ending, options = _ENCODINGS[media_type]

        def encode() -> bytes:
            pixels = reduced(stretched(self.pixels(place.shown)), longest_px)
            done, encoded = cv2.imencode(ending, pixels[..., ::-1] if pixels.ndim == 3 else pixels, options)
            if not done:
                raise ImageError(f"{place.path.name}: cannot be encoded")
            return encoded.tobytes()

        return self._encoded.get((place.stamp, media_type, longest_px), encode)


def is_sequence(path: Path) -> bool:
    """Tell whether a file may hold many frames, by its name."""
    return path.is_dir() or path.suffix.lower() in VIDEO_SUFFIXES | TIFF_SUFFIXES
