"""What there is to measure in a study, each task keyed by all that its result depends on."""

import errno
import hashlib
import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache, partial
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from tempfile import TemporaryDirectory, gettempdir
from time import perf_counter
from typing import Any, Final, NamedTuple, TypeAlias

from pydantic import BaseModel

from fingerpad.exceptions import FingerpadError, StoreError
from fingerpad.study.fingers import face_record
from fingerpad.study.manifest import CoinScale, Finger, Observation, Study
from fingerpad.study.measure import ODDITIES, measure_observation
from fingerpad.study.records import measurement_record
from fingerpad.study.scales import FoundScale
from fingerpad.study.words import in_study

Record: TypeAlias = dict[str, Any]
# Measures something of the study folder, draws into another, and returns what it found.
Work: TypeAlias = Callable[[Path, Path], Record]
Scales: TypeAlias = Mapping[str, FoundScale | str]

# Said of what is not what it was when the run began.
CHANGED: Final = "{}: changed while it was being measured: run again"

# What of a contact's table changes nothing in what is measured on its picture.
_NOT_MEASURED: Final = frozenset(
    ("finger", "wedge_angle_deg", "roll_angle_deg", "load_N", "notes", "scale", "pool_from_N")
)
_FILES: Final = ("image", "background", "path", "force", "times")


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


def _raise_if_full(error: BaseException | None) -> None:
    if isinstance(error, OSError) and error.errno == errno.ENOSPC:
        raise StoreError(f"{gettempdir()}: the disk is full: make room and run again to go on") from error


@dataclass(frozen=True, slots=True, kw_only=True)
class Keys:
    """Keys of a study's tasks.

    Attributes
    ----------
    study : Study
        The manifest.
    folder : Path
        The study folder.
    digest : callable
        That of a file or folder.
    """

    study: Study
    folder: Path
    digest: Callable[[Path], str]

    def of(self, table: BaseModel, *more: object, leave_out: frozenset[str] = frozenset()) -> str:
        """Return the key of what the manifest says in a table.

        Parameters
        ----------
        table : BaseModel
            Of an observation, a sequence or a photograph.
        *more
            Further parameters of the result.
        leave_out : frozenset of str
            Keys of the table that do not bear on it.
        """
        parameters = table.model_dump(mode="json", exclude=set(_NOT_MEASURED | leave_out))
        name = getattr(table, "scale", None)
        scale = self.study.scales[name].model_dump(mode="json") if isinstance(name, str) else None
        if scale is None and isinstance(name, BaseModel):
            scale = name.model_dump(mode="json")
        digests = {file: self.digest(self.folder / file) for file in self.inputs_of(table, leave_out)}
        return chained(parameters, name if isinstance(name, str) else None, scale, digests, *more)

    def inputs_of(self, table: BaseModel, leave_out: frozenset[str] = frozenset()) -> tuple[str, ...]:
        """Return the files and folders that a table names, but for those of some keys."""
        scale = getattr(table, "scale", None)
        scale = self.study.scales[scale] if isinstance(scale, str) else scale
        coin = (scale.coin,) if isinstance(scale, CoinScale) else ()
        names = (name for name in _FILES if name not in leave_out)
        return (*(file for name in names if (file := getattr(table, name, None))), *coin)


def chained(*parts: object) -> str:
    """Return a digest of some parameters and of the code that measures."""
    return hashlib.sha256(json.dumps([*parts, measuring_code()], sort_keys=True).encode()).hexdigest()


def observation_tasks(keys: Keys, scales: Scales) -> Iterator[Task]:
    """Yield a task for each observation."""
    for observation in keys.study.observations:
        yield Task(
            name=observation.name,
            item=observation.name,
            file=observation.image or "",
            key=keys.of(observation),
            work=partial(_observed, observation, scales),
            inputs=keys.inputs_of(observation),
        )


def _observed(observation: Observation, scales: Scales, folder: Path, out: Path) -> Record:
    return measurement_record(measure_observation(observation, scales, folder, out))


def photograph_tasks(keys: Keys, scales: Scales) -> Iterator[Task]:
    """Yield a task for each photograph of a finger."""
    for finger in keys.study.fingers:
        for number, photograph in enumerate(finger.photographs):
            if photograph.image is not None:
                overlay = f"overlays/finger_{finger.name}_{number + 1}_{photograph.face}.png"
                yield Task(
                    name=photograph_item(finger, number),
                    item=photograph_item(finger, number),
                    file=photograph.image,
                    key=keys.of(photograph, number),
                    work=partial(face_record, photograph, overlay, scales),
                    inputs=keys.inputs_of(photograph),
                )


def photograph_item(finger: Finger, number: int) -> str:
    """Return the name of a finger's photograph: its finger and its image."""
    return f"{finger.name}/{finger.photographs[number].image}"


@cache
def measuring_code() -> str:
    """Return the digest of all code that measures pictures: a change of it makes every result stale."""
    digest = hashlib.sha256()

    def add(item: Traversable) -> None:
        if item.is_dir():
            for inner in sorted(item.iterdir(), key=lambda inner: inner.name):
                add(inner)
        elif item.name.endswith(".py"):
            digest.update(item.name.encode() + b"\0" + item.read_bytes())

    package = resources.files("fingerpad")
    add(package / "image")
    for name in ("corrected.py", "fingers.py", "footage.py", "measure.py", "scales.py"):
        add(package / "study" / name)
    return digest.hexdigest()
