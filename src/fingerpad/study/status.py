"""How far a study is: what is measured, what has changed since, and what is left."""

from dataclasses import dataclass
from functools import cache
from pathlib import Path

from fingerpad.study.corrections.log import CorrectionLog
from fingerpad.study.engine.store import STORE_NAME, Store
from fingerpad.study.manifest import manifest_in, read_study
from fingerpad.study.measuring.run import items_of
from fingerpad.study.measuring.sequences import frames_in
from fingerpad.study.measuring.tasks import Keys


@dataclass(frozen=True, slots=True, kw_only=True)
class Status:
    """Numbers of photographs, observations and sequences of a study.

    Attributes
    ----------
    done, failed : int
        Measured, and those in which nothing could be measured, with the inputs as they are now.
    stale : int
        Measured, but picture, parameters or measuring code have changed since.
    left : int
        Not measured yet.
    seconds_left : float or None
        What measuring the stale and the left may take, on one process; None without any measured yet.
    """

    done: int
    failed: int
    stale: int
    left: int
    seconds_left: float | None

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
    if not (out / STORE_NAME).is_file():
        keys = Keys(study=study, folder=folder, digest=str, rulings=rulings)
        return Status(done=0, failed=0, stale=0, left=len(list(items_of(keys))), seconds_left=None)
    counts = dict.fromkeys(("done", "failed", "stale", "left"), 0)
    pictures = 0
    films = {sequence.name: sequence for sequence in study.sequences}
    with Store.open(out / STORE_NAME) as store:
        marks = store.marks()
        keys = Keys(study=study, folder=folder, digest=cache(store.digest), rulings=rulings)
        for name, key in items_of(keys):
            mark = marks.get(name)
            state = "left" if mark is None else mark.status if mark.key == key() else "stale"
            counts[state] += 1
            if state in {"left", "stale"}:
                pictures += frames_in(films[name], folder) if name in films else 1
            if state == "left" and name in films:
                pictures -= sum(mark.count for task, mark in marks.items() if task.startswith(f"{name} "))
    seen = sum(mark.count for mark in marks.values())
    usual = sum(mark.seconds for mark in marks.values()) / seen if seen else None
    return Status(**counts, seconds_left=None if usual is None else usual * max(0, pictures))
