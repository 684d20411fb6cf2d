"""What there is to measure in a study, each task keyed by all that its result depends on."""

import errno
import hashlib
import json
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache, partial
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from tempfile import TemporaryDirectory, gettempdir
from time import perf_counter
from typing import Any, Final, NamedTuple, TypeAlias

from pydantic import BaseModel

from fingerpad.exceptions import FingerpadError, StoreError
from fingerpad.study.changes import ContactCorrection
from fingerpad.study.decisions import Ruling
from fingerpad.study.fingers import face_record, is_rejected, photograph_item
from fingerpad.study.manifest import CoinScale, Finger, Observation, Photograph, Study
from fingerpad.study.measure import ODDITIES, contact_correction, measure_observation
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
    rulings : mapping
        What people corrected, by item.
    """

    study: Study
    folder: Path
    digest: Callable[[Path], str]
    rulings: Mapping[str, Ruling] = field(default_factory=dict)

    def edits(self, item: str) -> dict[str, Any]:
        """Return what a person changed in the measurement of an item."""
        ruling = self.rulings.get(item)
        return {} if ruling is None else ruling.change.edits

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
        correction = contact_correction(keys.rulings.get(observation.name))
        yield Task(
            name=observation.name,
            item=observation.name,
            file=observation.image or "",
            key=item_key(keys, observation.name, observation),
            work=partial(_observed, observation, scales, correction),
            inputs=keys.inputs_of(observation),
        )


def _observed(
    observation: Observation, scales: Scales, correction: ContactCorrection, folder: Path, out: Path
) -> Record:
    return measurement_record(measure_observation(observation, scales, folder, out, correction))


def photograph_tasks(keys: Keys, scales: Scales) -> Iterator[Task]:
    """Yield a task for each photograph of a finger that nobody rejected."""
    for finger, photograph in photographs_of(keys.study):
        item = photograph_item(finger, photograph)
        ruling = keys.rulings.get(item)
        if photograph.image is None or is_rejected(ruling):
            continue
        change = None if ruling is None else ruling.change
        assert not isinstance(change, ContactCorrection)  # the items' own rule
        yield Task(
            name=item,
            item=item,
            file=photograph.image,
            key=item_key(keys, item, photograph),
            work=partial(
                face_record,
                photograph=photograph,
                correction=change,
                overlay=f"overlays/finger_{finger.name}_{photograph.face}_{_plain(photograph.image)}.png",
                scales=scales,
            ),
            inputs=keys.inputs_of(photograph),
        )


def photographs_of(study: Study) -> Iterator[tuple[Finger, Photograph]]:
    """Yield each photograph of each finger that is a picture."""
    for finger in study.fingers:
        for photograph in finger.photographs:
            if photograph.image is not None:
                yield finger, photograph


def item_key(keys: Keys, item: str, table: BaseModel) -> str:
    """Return the key of an observation or a photograph."""
    return keys.of(table, keys.edits(item))


def _plain(file: str) -> str:
    """Return a file's name as part of another's."""
    return re.sub(r"[^\w.-]+", "_", file)


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
    for name in ("changes.py", "corrected.py", "fingers.py", "footage.py", "measure.py", "scales.py"):
        add(package / "study" / name)
    return digest.hexdigest()
