"""The study that is open: its manifest as it is now, its items and their pictures, its results."""

import hashlib
import json
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from threading import Lock
from typing import Any, Final

from fingerpad.exceptions import ImageError, ManifestError
from fingerpad.image import open_frames
from fingerpad.study.manifest import (
    CoinScale,
    ContactSequence,
    Finger,
    Observation,
    Photograph,
    Study,
    read_study,
)
from fingerpad.web.correction_log import Corrections
from fingerpad.web.events import Events
from fingerpad.web.pictures import Cache, Pictures, Place
from fingerpad.web.refusal import Refusal
from fingerpad.web.running import Running

_MOST_FILES: Final = 100_000
_PATIENCE_S: Final = 30.0
_OWN: Final = frozenset(("study.toml", "draft.toml", "corrections.jsonl"))


@dataclass(frozen=True, slots=True, kw_only=True)
class Manifest:
    """What the manifest says now.

    Attributes
    ----------
    title : str
        Of the study.
    digest : str
        Stands for all of it: changed by any edit.
    study : Study or None
        What is complete; None where nothing is.
    incomplete : tuple
        Tables that lack something.
    missing : tuple of dict
        What they lack, in words.
    """

    title: str
    digest: str
    study: Study | None
    incomplete: tuple[Any, ...]
    missing: tuple[dict[str, str], ...]


class OpenStudy:
    """A study folder and its results.

    Parameters
    ----------
    folder, out : Path
        The study folder, and the folder of results.
    manifest : str
        Name of the manifest.
    events : Events
        Who is told of changes.
    pixel_limit : int
        The most pixels of a picture.
    """

    def __init__(self, folder: Path, *, manifest: str, out: Path, events: Events, pixel_limit: int) -> None:
        self.folder, self.out = folder, out
        self.manifest_path = folder / manifest
        self.events = events
        self.pixel_limit = pixel_limit
        self.pictures = Pictures(pixel_limit)
        self.running = Running(events)
        self.corrections = Corrections(folder)
        self._counts: Cache[int] = Cache(10_000, lambda _: 1)
        self._read: tuple[object, Manifest] | None = None
        self._lock = Lock()

    @property
    def name(self) -> str:
        """Name of the folder."""
        return self.folder.name

    def close(self) -> None:
        """Stop what is at work, and wait until it has put down what it had in hand."""
        self.running.cancel()
        self.running.wait(_PATIENCE_S)

    def read(self) -> Manifest:
        """Return what the manifest says, read again when a file of it has changed."""
        with self._lock:
            stamp = self._stamp()
            if self._read is None or self._read[0] != stamp:
                self._read = (stamp, self._manifest(stamp))
            return self._read[1]

    def study(self) -> Study:
        """Return what is complete of the study."""
        found = self.read()
        if found.study is None:
            words = "; ".join(one["words"] for one in found.missing) or "nothing is there yet"
            raise Refusal.impossible(f"the study is not complete: {words}", faults=list(found.missing))
        return found.study

    def _stamp(self) -> object:
        names = [self.manifest_path.name, "draft.toml"]
        if self._read is not None and (study := self._read[1].study) is not None:
            names += [study.observations_csv] if study.observations_csv is not None else []
        return tuple(_stamp_of(self.folder / name) for name in names)

    def _manifest(self, stamp: object) -> Manifest:
        digest = hashlib.sha256(json.dumps(stamp, default=str).encode()).hexdigest()[:16]
        try:
            study = read_study(self.manifest_path)
        except ManifestError as error:
            missing = tuple({"kind": "study", "key": "", "words": line} for line in str(error).splitlines())
            return Manifest(title=self.name, digest=digest, study=None, incomplete=(), missing=missing)
        return Manifest(title=study.title, digest=digest, study=study, incomplete=(), missing=())

    def observation(self, name: str) -> Observation | None:
        """Return an observation by its name."""
        return next((one for one in self.study().observations if one.name == name), None)

    def sequence(self, name: str) -> ContactSequence:
        """Return a sequence by its name."""
        found = next((one for one in self.study().sequences if one.name == name), None)
        if found is None:
            raise Refusal.not_there(f"no sequence is named {name!r}")
        return found

    def photograph(self, item: str) -> tuple[Finger, Photograph]:
        """Return a photograph, and whose it is, by finger and file."""
        finger_name, _, file = item.partition("/")
        for finger in self.study().fingers:
            for photograph in finger.photographs:
                if finger.name == finger_name and photograph.image == file:
                    return finger, photograph
        raise Refusal.not_there(f"no item is named {item!r}")

    def count_frames(self, sequence: ContactSequence) -> int | None:
        """Return how many frames a film has, None where it cannot be opened."""
        path = self.folder / sequence.path
        try:
            return self._counts.get(
                (sequence.path, _stamp_of(path)),
                lambda: open_frames(path, pixel_limit=self.pixel_limit).count,
            )
        except ImageError:
            return None

    def place_of(self, item: str) -> Place:
        """Return where an item's picture is: only files that the manifest names or that lie in the folder."""
        if item.startswith("file:"):
            return Place(self.file(item.removeprefix("file:")), colour=True)
        if item.startswith("coin:"):
            scale = self.study().scales.get(item.removeprefix("coin:"))
            if not isinstance(scale, CoinScale):
                raise Refusal.not_there(f"no scale by a coin is named {item.removeprefix('coin:')!r}")
            return Place(self.folder / scale.coin)
        if "#" in item:
            name, _, number = item.rpartition("#")
            sequence = self.sequence(name)
            if not number.isdecimal() or len(number) > 9:
                raise Refusal.not_there(f"{item!r} is no frame: write it as {name}#12")
            return Place(self.folder / sequence.path, frame=int(number))
        if "/" in item:
            _, photograph = self.photograph(item)
            return Place(self.folder / str(photograph.image), colour=True)
        observation = self.observation(item)
        if observation is None or observation.image is None:
            raise Refusal.not_there(
                f"no item is named {item!r}"
                if observation is None
                else f"{item}: its ellipse is given, without a picture"
            )
        return Place(self.folder / observation.image)

    def shape_of(self, item: str) -> tuple[int, int] | None:
        """Return rows and columns of an item's picture, None where it has none."""
        if "/" not in item and "#" not in item and (one := self.observation(item)) and one.image is None:
            return None
        place = self.place_of(item)
        pixels = self.pictures.colour(place) if place.colour else self.pictures.grey(place).pixels
        return pixels.shape[0], pixels.shape[1]

    def files(self) -> dict[str, os.stat_result]:
        """Return every file of the study folder by its name in the manifest's manner, results left aside."""
        return dict(sorted(_files_below(self.folder, self.out)))

    def file(self, name: str) -> Path:
        """Return the path of one of them: found among what is there, never made from the name."""
        path = self.folder / name if name in self.files() else None
        if path is None:
            raise Refusal.not_there(f"the study holds no file {name[:80]!r}")
        return path


def _stamp_of(path: Path) -> tuple[int, int, int] | None:
    try:
        status = path.stat()
    except (OSError, ValueError):
        return None
    return status.st_size, status.st_mtime_ns, status.st_ino


def _files_below(folder: Path, out: Path) -> Iterator[tuple[str, os.stat_result]]:
    """Yield the plain files below a folder; links are not followed."""
    waiting, count = [(folder, "")], 0
    while waiting:
        here, prefix = waiting.pop()
        try:
            entries = list(os.scandir(here))
        except OSError:
            continue
        for entry in entries:
            if entry.name.startswith(".") or (not prefix and entry.name in _OWN):
                continue
            if entry.is_dir(follow_symlinks=False):
                if Path(entry.path) != out and not (Path(entry.path) / "store.sqlite").is_file():
                    waiting.append((Path(entry.path), f"{prefix}{entry.name}/"))
            elif entry.is_file(follow_symlinks=False) and count < _MOST_FILES:
                count += 1
                yield f"{prefix}{entry.name}", entry.stat(follow_symlinks=False)
