"""One task: what it measures, the key of everything it depends on, its limits, and its result."""

import errno
import hashlib
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from importlib import import_module, resources
from importlib.resources.abc import Traversable
from pathlib import Path
from tempfile import TemporaryDirectory, gettempdir
from time import perf_counter
from typing import Any, Final, Literal, NamedTuple, TypeAlias

from fingerpad._records import to_record
from fingerpad.exceptions import StoreError, reason_of

Record: TypeAlias = dict[str, Any]
# Measures something of the study folder, draws into another, and returns what it found: a dataclass, or a
# mapping of dataclasses, arrays and plain values.
Work: TypeAlias = Callable[[Path, Path], Any]

# The reason of an item whose input is not what it was when the run began.
CHANGED: Final = "{}: changed while it was being measured: run again"


def in_study(words: object, folder: Path) -> str:
    """Return a message without the place of the study's folder on this machine."""
    return str(words).replace(f"{folder}{os.sep}", "")


class ChangedError(Exception):
    """A result is missing because its input changed after its key was made."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """What measuring may take; a picture that needs more fails with its reason."""

    seconds: float = 300.0  # for one picture
    memory_gb: float = 4.0  # beyond an idle process, 10⁹ bytes; enforced on Linux

    def exceed(self, other: "Limits") -> bool:
        """Tell whether something that `other` stopped may fit into these."""
        return self.seconds > other.seconds or self.memory_gb > other.memory_gb


DEFAULT_LIMITS: Final = Limits()


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """One thing to measure: a picture, or a piece of a sequence."""

    name: str
    item: str  # to which it belongs
    file: str
    key: str  # digest of inputs, parameters and measuring code
    work: Work
    inputs: tuple[str, ...]  # files and folders that it reads
    pictures: int = 0  # or frames by which it advances the run
    reads: int = 1  # pictures or frames: the time limit holds for each


class TaskResult(NamedTuple):
    """What came of a task."""

    record: Record  # or the `reason` why there is none
    drawn: dict[str, bytes]  # by name
    seconds: float
    limits: Limits | None = None  # that stopped it


def perform(work: Work, file: str, folder: Path, limits: Limits) -> TaskResult:
    """Do the work of a task; whatever goes wrong fails this task only, and becomes its reason."""
    import cv2

    start = perf_counter()
    stopped_by = None
    with TemporaryDirectory(prefix="fingerpad-") as drawing:
        try:
            record = to_record(work(folder, Path(drawing)))
        except StoreError:
            raise
        # Files from anywhere can be damaged in unforeseen ways.
        except Exception as error:
            if any(isinstance(one, OSError) and one.errno == errno.ENOSPC for one in _causes(error)):
                raise StoreError(
                    f"{gettempdir()}: the disk is full: make room and run again to go on"
                ) from error
            if any(
                isinstance(one, MemoryError)
                or (isinstance(one, cv2.error) and one.code == cv2.Error.StsNoMem)
                for one in _causes(error)
            ):
                stopped_by = limits
                reason = (
                    f"{file}: measuring it takes more than {limits.memory_gb:g} GB of memory: crop or shrink "
                    "it, or raise the limit (fingerpad run --memory-gb)"
                )
            else:
                reason = in_study(reason_of(error, f"{file}: cannot be measured"), folder)
            record = {"reason": reason}
        drawn = {
            path.relative_to(drawing).as_posix(): path.read_bytes()
            for path in sorted(Path(drawing).rglob("*"))
            if path.is_file()
        }
    return TaskResult(record, drawn, perf_counter() - start, stopped_by)


def _causes(error: BaseException | None) -> Iterator[BaseException]:
    """Yield an error, and the errors from which it was raised."""
    while error is not None:
        yield error
        error = error.__cause__


def working_code() -> str:
    """Return the digest of all code that a task may use: workers with other code could give other numbers."""
    return code_digest("_records.py", "contact", "geometry", "image", "loading", "study", "uncertainty")


@cache
def code_digest(*parts: str) -> str:
    """Return the digest of some of the package's folders and files, by content alone."""
    digest = hashlib.sha256()

    def add(item: Traversable) -> None:
        if item.is_dir():
            for inner in sorted(item.iterdir(), key=lambda inner: inner.name):
                add(inner)
        elif item.name.endswith((".py", ".csv", ".css", ".jinja", ".sql", ".toml")):
            digest.update(item.name.encode() + b"\0" + item.read_bytes())

    for part in parts:
        add(resources.files("fingerpad") / part)
    return digest.hexdigest()


# Raise a version with every change that alters a number, or a name that is stored with it.
# tests/study/test_versions.py pins the numbers of each version, so that a change of code without a change of
# numbers measures nothing again.
MEASUREMENT_VERSIONS: Final = {"image": 52, "loading": 22, "uncertainty": 11}


def library_versions() -> dict[str, str]:
    """Return the versions of the libraries that results are computed with, of whatever distribution."""
    modules = ("imagecodecs", "numpy", "cv2", "PIL", "scipy", "tifffile")
    names = {"cv2": "opencv", "PIL": "pillow"}
    return {names.get(module, module): import_module(module).__version__ for module in modules}


def versions_of(*measurements: Literal["image", "loading", "uncertainty"]) -> list[object]:
    """Return what belongs into the cache key of results of some kinds of measurement."""
    libraries = library_versions()
    # It only unpacks TIFF without loss: what another release reads otherwise, it refuses.
    libraries.pop("imagecodecs", None)
    return [{kind: MEASUREMENT_VERSIONS[kind] for kind in measurements}, libraries]
