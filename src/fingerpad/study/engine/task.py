"""One task: what it measures, the key of all that it depends on, and the doing of it."""

import ctypes
import errno
import hashlib
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from tempfile import TemporaryDirectory, gettempdir
from time import perf_counter
from typing import Any, Final, NamedTuple, TypeAlias

import cv2

from fingerpad.exceptions import FingerpadError, StoreError
from fingerpad.study.words import ODDITIES, in_study

Record: TypeAlias = dict[str, Any]
# Measures something of the study folder, draws into another, and returns what it found.
Work: TypeAlias = Callable[[Path, Path], Record]

# Said of what is not what it was when the run began.
CHANGED: Final = "{}: changed while it was being measured: run again"

# Of glibc's malloc.h.
_M_TRIM_THRESHOLD, _M_MMAP_THRESHOLD = -1, -3


class ChangedError(Exception):
    """A result is not there, since its input changed after its key was made."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """One thing to measure: a picture, or a piece of a film.

    Attributes
    ----------
    name : str
        Its name in the store.
    item : str
        Observation, photograph or sequence of which it is.
    file : str
        The file at work.
    key : str
        Digest of inputs, parameters and measuring code.
    work : Work
        The measuring itself.
    inputs : tuple of str
        Files and folders that it reads, relative to the study folder.
    pictures : int
        Number of pictures or frames that it deals with.
    """

    name: str
    item: str
    file: str
    key: str
    work: Work
    inputs: tuple[str, ...]
    pictures: int = 1


class Done(NamedTuple):
    """What a task gave: its record, the pictures drawn by their names, and what it cost."""

    record: Record
    pictures: dict[str, bytes]
    seconds: float


def perform(work: Work, file: str, folder: Path) -> Done:
    """Do the work of a task: whatever goes wrong costs this task only, and becomes its reason.

    Pictures are drawn aside, for the one process that writes results to keep.

    Raises
    ------
    StoreError
        If there is no room to draw.
    """
    start = perf_counter()
    with TemporaryDirectory(prefix="fingerpad-") as aside:
        try:
            record = work(folder, Path(aside))
        except FingerpadError as error:
            _raise_if_full(error.__cause__)
            record = {"reason": in_study(error, folder)}
        except ODDITIES as error:
            _raise_if_full(error)
            record = {"reason": f"{file}: cannot be measured ({type(error).__name__}: {error})"}
        drawn = {
            path.relative_to(aside).as_posix(): path.read_bytes()
            for path in sorted(Path(aside).rglob("*"))
            if path.is_file()
        }
    return Done(record, drawn, perf_counter() - start)


def settle_worker() -> None:
    """Settle a process that does nothing but tasks: one core, and the memory of one frame serves the next.

    By default glibc gives freed memory back and asks for it anew, page by page, a thousand times a frame.
    """
    cv2.setNumThreads(1)
    with suppress(OSError, AttributeError):  # another C library has no such settings
        settings = ctypes.CDLL("libc.so.6").mallopt
        settings(_M_TRIM_THRESHOLD, 256 << 20)
        settings(_M_MMAP_THRESHOLD, 32 << 20)


def _raise_if_full(error: BaseException | None) -> None:
    if isinstance(error, OSError) and error.errno == errno.ENOSPC:
        raise StoreError(f"{gettempdir()}: the disk is full: make room and run again to go on") from error


def measuring_code() -> str:
    """Return the digest of all code that measures pictures: a change of it makes every result stale."""
    return code_digest("image", "study/corrections", "study/measuring")


def working_code() -> str:
    """Return the digest of all code that a task may use: workers with other code could give other numbers."""
    return code_digest("contact", "geometry", "image", "loading", "study", "uncertainty")


@cache
def code_digest(*rooms: str) -> str:
    """Return the digest of some of the package's folders and files, of what it is made of alone."""
    digest = hashlib.sha256()

    def add(item: Traversable) -> None:
        if item.is_dir():
            for inner in sorted(item.iterdir(), key=lambda inner: inner.name):
                add(inner)
        elif item.name.endswith((".py", ".jinja", ".css")):
            digest.update(item.name.encode() + b"\0" + item.read_bytes())

    for room in rooms:
        add(resources.files("fingerpad") / room)
    return digest.hexdigest()
