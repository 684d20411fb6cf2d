"""How far a study is: what is measured, what has changed since, and what is left."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Final

from fingerpad.study.corrections.log import CorrectionLog
from fingerpad.study.engine.store import STORE_NAME, Mark, Store
from fingerpad.study.manifest import manifest_in, read_study
from fingerpad.study.measuring.run import items_of
from fingerpad.study.measuring.sequences import frames_in
from fingerpad.study.measuring.tasks import Keys

_STATES: Final = ("done", "failed", "stale", "left")


@dataclass(frozen=True, slots=True, kw_only=True)
class Status:
    """Numbers of photographs, loading curves, observations and sequences of a study.

    Attributes
    ----------
    done, failed : int
        Measured, and those in which nothing could be measured, with the inputs as they are now.
    stale : int
        Measured, but picture, parameters or measuring code have changed since.
    left : int
        Not measured yet.
    seconds : dict of str to float or None
        What each of these four costs on one process: what the done and the failed took, and what the stale
        and the left may take; None without any measured yet.
    """

    done: int
    failed: int
    stale: int
    left: int
    seconds: dict[str, float | None]

    @property
    def seconds_left(self) -> float | None:
        """What the next run may take, on one process."""
        stale, left = self.seconds["stale"], self.seconds["left"]
        return None if stale is None or left is None else stale + left

    @property
    def total(self) -> int:
        """All of them."""
        return self.done + self.failed + self.stale + self.left


def study_status(manifest: Path, out: Path) -> Status:
    """Compare a study with what is stored of it; nothing is measured.

    Raises
    ------
    ManifestError
        If the manifest cannot be acted upon.
    StoreError
        If the store cannot be used.
    """
    manifest = manifest_in(manifest)
    study, folder = read_study(manifest), manifest.absolute().parent
    rulings = CorrectionLog(folder).rulings()
    counts = dict.fromkeys(_STATES, 0)
    if not (out / STORE_NAME).is_file():
        keys = Keys(study=study, folder=folder, digest=str, rulings=rulings)
        counts["left"] = len(list(items_of(keys)))
        return Status(**counts, seconds=dict.fromkeys(_STATES))
    spent, pictures = dict.fromkeys(_STATES, 0.0), dict.fromkeys(_STATES, 0)
    films = {sequence.name: sequence for sequence in study.sequences}
    with Store.open(out / STORE_NAME) as store:
        marks = store.marks()
        of_item = _by_item(marks)
        keys = Keys(study=study, folder=folder, digest=cache(store.digest), rulings=rulings)
        for name, key in items_of(keys):
            mark, parts = marks.get(name), of_item.get(name, ())
            state = "left" if mark is None else mark.status if mark.key == key() else "stale"
            counts[state] += 1
            spent[state] += sum(part.seconds for part in parts)
            pictures[state] += frames_in(films[name], folder) if name in films else 1
            if state == "left":
                pictures[state] -= sum(part.count for part in parts)
    seen = sum(mark.count for mark in marks.values())
    usual = sum(mark.seconds for mark in marks.values()) / seen if seen else None
    coming = {name: None if usual is None else usual * pictures[name] for name in ("stale", "left")}
    return Status(**counts, seconds={**spent, **coming})


def _by_item(marks: Mapping[str, Mark]) -> dict[str, list[Mark]]:
    """Return the marks of each item: those of a film are its own and its pieces', parted by a blank."""
    found: dict[str, list[Mark]] = {}
    for task, mark in marks.items():
        found.setdefault(task if "/" in task else task.partition(" ")[0], []).append(mark)
    return found
