"""How far a study is: what is measured, what has changed since, and what is left."""

from dataclasses import dataclass
from pathlib import Path

from fingerpad.study.manifest import Contact, read_study
from fingerpad.study.scales import named_scales
from fingerpad.study.store import STORE_NAME, Store
from fingerpad.study.tasks import tasks_of


@dataclass(frozen=True, slots=True, kw_only=True)
class Status:
    """Numbers of observations and sequences of a study.

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
    if manifest.is_dir():
        manifest = manifest / "study.toml"
    study = read_study(manifest)
    folder = manifest.absolute().parent
    contacts: list[Contact] = [*study.observations, *study.sequences]
    if not (out / STORE_NAME).is_file():
        return Status(done=0, failed=0, stale=0, left=len(contacts), seconds_left=None)
    counts = dict.fromkeys(("done", "failed", "stale", "left"), 0)
    with Store.open(out / STORE_NAME) as store:
        stored = store.results()
        for task in tasks_of(contacts, named_scales(study, folder), folder, store.digest):
            found = stored.get(task.contact.name)
            counts["left" if found is None else found.status if found.key == task.key else "stale"] += 1
    usual = sum(each.seconds for each in stored.values()) / len(stored) if stored else None
    return Status(
        **counts, seconds_left=None if usual is None else usual * (counts["stale"] + counts["left"])
    )
