"""Frames of a sequence, decoded one at a time: a folder of pictures, a TIFF of many pages, or a video."""

from __future__ import annotations

import hashlib
import math
import re
from collections import Counter
from collections.abc import Generator, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing, contextmanager
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import Any, Final, Literal, TypeAlias

import cv2
import numpy as np
import tifffile

from fingerpad._display import Displayed
from fingerpad._words import counted, joined
from fingerpad.exceptions import ImageError
from fingerpad.image.levels import MEMORY_LIMIT, Pixels, check_finite, check_memory, luma, top_level
from fingerpad.image.read import SQUARE, check_regular, decoding, read_levels, read_start, resolution_of_page
from fingerpad.image.tiff import levels_of_page, tifffile_warnings

FramesLike: TypeAlias = "Iterable[Frame] | str | PathLike[str]"
Kind: TypeAlias = Literal["folder", "tiff", "video"]

PICTURE_SUFFIXES: Final = frozenset({".png", ".tif", ".tiff", ".jpg", ".jpeg", ".bmp", ".pgm", ".ppm"})
VIDEO_SUFFIXES: Final = frozenset({".avi", ".mp4", ".mov", ".mkv"})
TIFF_SUFFIXES: Final = frozenset({".tif", ".tiff"})
_ENDS_IN_NUMBER: Final = re.compile(r"(.*?)([0-9]{1,15})")
_MOST_ALIKE: Final = 0.9  # of a folder's names or more; the others are odd
_NEUTRAL: Final = 0.015  # of white; compression makes grey pixels coloured by as much
_LEAST_NUMBERED: Final = 6  # fewer names do not tell the usual step of their numbers


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Frame(Displayed):
    """One frame of a sequence.

    Attributes
    ----------
    index : int
        Its number, from zero.
    pixels : ndarray or None, shape (rows, columns) or (rows, columns, 3)
        Grey levels, or red, green and blue; None where it could not be read.
    reason : str or None
        Why it could not be read.

    Examples
    --------
    >>> Frame(index=0, pixels=np.zeros((2, 3), np.uint8)).digest[:8]
    'e78a34c8'
    """

    index: int
    pixels: Pixels | None
    reason: str | None = None

    @property
    def digest(self) -> str:
        """SHA-256 of its shape, type and pixels; empty where it could not be read."""
        if self.pixels is None:
            return ""
        digest = hashlib.sha256(f"{self.pixels.dtype.str} {self.pixels.shape}".encode())
        digest.update(np.ascontiguousarray(self.pixels).data)
        return digest.hexdigest()


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Frames(Displayed):
    """A sequence of frames, iterable again and again; a frame is in memory, and the next being decoded.

    Attributes
    ----------
    path : Path
        The folder or file.
    kind : {"folder", "tiff", "video"}
        Its kind.
    count : int
        Number of frames. For a video it is what the header states.
    frames_per_second : float or None
        Rate at which a video plays, None for pictures. A high-speed recording plays slower than it was taken.
    memory_limit : int
        The most bytes that one frame may take, as for `read_image`.
    colour : bool
        Whether frames keep the colours that they have, which show the contacts of gels; else they are grey.
    """

    path: Path
    kind: Kind
    count: int
    frames_per_second: float | None
    memory_limit: int
    colour: bool = False

    def __len__(self) -> int:
        return self.count

    def __iter__(self) -> Iterator[Frame]:
        """Go through all frames; one that is damaged, or of another size than the first, has a reason."""
        return self.between(0, self.count)

    def between(self, start: int, stop: int) -> Generator[Frame, None, None]:
        """Yield the frames from `start` up to `stop`, excluded, in order.

        A folder or a TIFF is entered at `start`; a video must be decoded up to there.
        """
        shape = None
        if start:
            with closing(self._decode(0, self.count)) as frames:
                shape = next((frame.pixels.shape[:2] for frame in frames if frame.pixels is not None), None)
        for frame in _decoded_ahead(self._decode(start, min(stop, self.count))):
            if frame.pixels is not None and shape is None:
                shape = frame.pixels.shape[:2]
            if frame.pixels is not None and frame.pixels.shape[:2] != shape:
                reason = f"has {_size(frame.pixels.shape[:2])} pixels, the first frame {_size(shape)}"
                yield Frame(index=frame.index, pixels=None, reason=reason)
            else:
                yield frame

    def at(self, index: int) -> Frame:
        """Decode the frame of a number, counted from zero; one that is not there is an `ImageError`."""
        if not 0 <= index < self.count:
            raise ImageError(f"{self.path}: has no frame {index}: there are {self.count}, counted from 0")
        with closing(self._decode(index, index + 1)) as frames:
            return next(frames)

    @property
    def numbers(self) -> tuple[int, ...] | None:
        """Place of each frame on the camera's count, where the file names of a folder skip some; else None.

        The names differ in the number that they end in, and most of these grow by one step, which may be
        more than one.
        """
        names = [_ENDS_IN_NUMBER.fullmatch(path.stem) for path in self._files]
        number = np.array([int(name[2]) for name in names if name])
        if not len(names) == len(number) >= _LEAST_NUMBERED or len({name and name[1] for name in names}) > 1:
            return None
        steps = np.diff(number)
        usual = int(steps.min())
        if usual <= 0 or (steps % usual).any() or not 0.5 < np.mean(steps == usual) < 1:
            return None
        return tuple(((number - number[0]) // usual).tolist())

    @property
    def skipped(self) -> str | None:
        """What file names say of frames that are missing; None where they skip none."""
        if (numbers := self.numbers) is None:
            return None
        missing, files = np.diff(numbers) - 1, self._files
        at = int(np.argmax(missing > 0))
        places = np.count_nonzero(missing)
        where = f"in {places} places, the first " if places > 1 else ""
        return (
            f"file names skip {counted(int(missing.sum()), 'frame')} {where}between {files[at].name} and "
            f"{files[at + 1].name}: times follow the numbers"
        )

    @property
    def odd_names(self) -> str | None:
        """What to say of a folder's pictures that are not named as nearly all others; None without any."""
        names = {path.name: _ENDS_IN_NUMBER.fullmatch(path.stem) for path in self._files}
        starts = {name: found and found[1] for name, found in names.items()}
        usual, count = next(iter(Counter(starts.values()).most_common(1)), (None, 0))
        if usual is None or not _MOST_ALIKE * len(starts) <= count < len(starts):
            return None
        odd = [name for name, start in starts.items() if start != usual]
        return (
            f"{joined(odd, 3)} among the frames, named unlike the others: what is no frame of the sequence "
            "belongs in another folder, since it delays the frames that follow"
        )

    @property
    def _files(self) -> list[Path]:
        return frame_files(self.path) if self.kind == "folder" else []

    def _decode(self, start: int, stop: int) -> Generator[Frame, None, None]:
        decoders = {"folder": _folder_frames, "tiff": _tiff_frames, "video": _video_frames}
        return decoders[self.kind](self, start, stop)


def _decoded_ahead(frames: Generator[Frame, None, None]) -> Iterator[Frame]:
    """Yield frames while a thread decodes the next one, so that it need not be waited for."""
    # Closed last, and whatever happens: an error that is kept would keep the file open.
    with closing(frames), ThreadPoolExecutor(1) as decoder:
        following = decoder.submit(next, frames, None)
        while (frame := following.result()) is not None:
            following = decoder.submit(next, frames, None)
            yield frame


def played_rate(frames: Frames) -> str:
    """Return the note on a rate that was not stated: the one at which a video plays."""
    return (
        f"{frames.path.name} plays at {frames.frames_per_second:g} frames per second, taken for the camera's "
        "rate: state frames_per_second if it took them at another"
    )


def open_frames(
    path: str | PathLike[str], *, colour: bool = False, memory_limit: int = MEMORY_LIMIT
) -> Frames:
    """Open a folder of pictures, a TIFF file of many pages, or a video.

    The pictures of a folder come in natural order: ``frame2.png`` before ``frame10.png``.

    Parameters
    ----------
    path : path-like
        The folder or file.
    colour : bool
        Keep the colours of frames that have any.
    memory_limit : int
        The most bytes that one frame may take, checked before it is decoded, as for `read_image`.

    Returns
    -------
    Frames
        To be iterated over; nothing is decoded yet.

    Raises
    ------
    ImageError
        If there is nothing, or the folder holds no picture, or the file is neither TIFF nor video.

    Examples
    --------
    >>> import tempfile
    >>> import tifffile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     tifffile.imwrite(f"{folder}/press.tif", np.zeros((3, 40, 30), np.uint8), photometric="minisblack")
    ...     frames = open_frames(f"{folder}/press.tif")
    ...     frames.kind, frames.count, frames.at(1).pixels.shape
    ('tiff', 3, (40, 30))
    """
    path = Path(path)
    check_regular(path)
    rate = None
    if path.is_dir():
        kind: Kind = "folder"
        count = len(frame_files(path))
        if not count:
            raise ImageError(f"{path}: holds no picture (PNG, TIFF, JPEG, BMP or PGM)")
    elif path.suffix.lower() in TIFF_SUFFIXES:
        tiff, pages, broken = _open_tiff(path)
        tiff.close()
        # Where the chain of pages is broken, one more stands for what is lost.
        kind, count = "tiff", pages + (broken is not None)
    elif path.suffix.lower() in PICTURE_SUFFIXES:
        raise ImageError(f"{path}: is one picture: name the folder that holds the sequence")
    else:
        kind = "video"
        with _video(path, memory_limit) as video:
            stated, plays = (video.get(key) for key in (cv2.CAP_PROP_FRAME_COUNT, cv2.CAP_PROP_FPS))
        # A damaged header may give any number; no format stores a frame in fewer than 8 bytes.
        count = int(min(stated, path.stat().st_size / 8)) if stated > 0 else 0
        rate = plays if plays > 0 and np.isfinite(plays) else None
    return Frames(
        path=path, kind=kind, count=count, frames_per_second=rate, memory_limit=memory_limit, colour=colour
    )


def as_frames(frames: FramesLike, *, colour: bool = False) -> Iterable[Frame]:
    """Return frames, opened if they are a path; files' own colours are kept if they are wanted."""
    if isinstance(frames, str | PathLike):
        return open_frames(frames, colour=colour)
    if isinstance(frames, Frames):
        return replace(frames, colour=colour)
    kept = frames if isinstance(frames, list | tuple | np.ndarray) else ()  # what can be looked at at no cost
    if not hasattr(frames, "__iter__") or not all(isinstance(one, Frame) for one in kept):
        raise ImageError(
            f"frames must be a path, or Frame(index=…, pixels=…) one after the other, found "
            f"{type(frames).__name__}"
        )
    return frames


def _size(shape: tuple[int, ...] | None) -> str:
    return " × ".join(map(str, (shape or ())[::-1]))


def frame_files(folder: Path) -> list[Path]:
    """Return the picture files of a folder in natural order: ``frame2.png`` before ``frame10.png``."""
    try:
        files = list(folder.iterdir())
    except OSError as error:
        raise ImageError(
            f"{folder}: cannot be listed ({error}): check the folder and its permissions"
        ) from error

    def natural(path: Path) -> list[tuple[int, int, str]]:
        parts = re.split(r"(\d+)", path.name.lower())
        return [(0, int(part), part) if part.isdecimal() else (1, 0, part) for part in parts]

    pictures = (p for p in files if p.suffix.lower() in PICTURE_SUFFIXES and p.name[0] != ".")
    return sorted(pictures, key=natural)


def _folder_frames(frames: Frames, start: int, stop: int) -> Generator[Frame, None, None]:
    for index, picture in enumerate(frames._files[start:stop], start):
        try:
            frame = Frame(index=index, pixels=_seen(read_levels(picture, frames.memory_limit)[0], frames))
        except ImageError as error:
            frame = Frame(index=index, pixels=None, reason=str(error))
        yield frame


def _seen(levels: Pixels, frames: Frames) -> Pixels:
    """Return levels with the colours that they have if these are wanted, else grey."""
    if not frames.colour or levels.ndim == 2:
        return luma(levels)
    apart = (levels.max(axis=2) - levels.min(axis=2)).max()
    white = top_level(levels) if levels.dtype.kind == "u" else levels.max()
    return levels if apart > _NEUTRAL * white else luma(levels)


def _open_tiff(path: Path) -> tuple[tifffile.TiffFile, int, str | None]:
    """Open a TIFF file, with the number of pages that can be reached and what breaks their chain, if any."""
    with decoding(path):
        tiff = tifffile.TiffFile(path)
        with tifffile_warnings() as heard:
            count = len(tiff.pages)
    return tiff, count, heard[0].getMessage() if heard else None


def _tiff_frames(frames: Frames, start: int, stop: int) -> Generator[Frame, None, None]:
    # Reading one IFD at a time: a list of all pages would grow with the sequence.
    path = frames.path
    tiff, count, broken = _open_tiff(path)
    with tiff:
        for index in range(start, min(stop, count)):
            try:
                with decoding(path, f": page {index}"):
                    page = tiff.pages[index]
                    resolution_of_page(page)  # which refuses pixels that are not square
                    pixels = _seen(levels_of_page(path, index, page, frames.memory_limit), frames)
                    check_finite(pixels, f"{path}: page {index}")
                frame = Frame(index=index, pixels=pixels)
            except ImageError as error:
                frame = Frame(index=index, pixels=None, reason=str(error))
            yield frame
        if broken is not None and stop > count:
            reason = f"{path}: damaged after {count} pages, those that follow are lost ({broken})"
            yield Frame(index=count, pixels=None, reason=reason)


@contextmanager
def _video(path: Path, memory_limit: int) -> Iterator[Any]:
    """Open a video whose frames are not too large, and whose pixels are square as far as it states."""
    read_start(path)
    capture = cv2.VideoCapture(str(path))
    if not capture.isOpened():
        raise ImageError(f"{path}: cannot be opened as a video: convert it to AVI or MP4, or to pictures")
    columns, rows = (int(capture.get(key)) for key in (cv2.CAP_PROP_FRAME_WIDTH, cv2.CAP_PROP_FRAME_HEIGHT))
    check_memory(path, (columns, rows), memory_limit, channels=3, sample_bytes=1)
    width, height = (capture.get(key) for key in (cv2.CAP_PROP_SAR_NUM, cv2.CAP_PROP_SAR_DEN))
    if width > 0 and height > 0 and not math.isclose(width, height, rel_tol=SQUARE):
        raise ImageError(
            f"{path}: states pixels of {width:g} : {height:g}, width to height: they are not square, and "
            "lengths in it would be wrong: resample it to square pixels, or state 1 : 1 if what it states is "
            "wrong"
        )
    try:
        yield capture
    finally:
        capture.release()


def _video_frames(frames: Frames, start: int, stop: int) -> Generator[Frame, None, None]:
    index, path, count = 0, frames.path, frames.count
    with _video(path, frames.memory_limit) as video:
        # Seeking lands on the wrong frame in some codecs; going through all of them never does.
        while index < start and video.grab():
            index += 1
        while index < stop or stop == count:  # headers may count too few
            good, levels = video.read()
            if not good:
                break
            pixels = (
                _seen(levels[..., ::-1], frames)
                if frames.colour
                else cv2.cvtColor(levels, cv2.COLOR_BGR2GRAY)
            )
            yield Frame(index=index, pixels=np.ascontiguousarray(pixels, np.uint8))
            index += 1
    reason = f"{path}: the video ends after {index} of {count} frames"
    for missing in range(max(index, start), stop):
        yield Frame(index=missing, pixels=None, reason=reason)
