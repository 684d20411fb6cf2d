"""How far a study is, and whether all that is kept of it is what was written."""

from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from fingerpad._files import digest_of
from fingerpad.exceptions import FingerpadError
from fingerpad.study.corrections.items import CORRECTIONS_NAME, SECOND_OPERATOR_NAME
from fingerpad.study.corrections.log import CorrectionLog
from fingerpad.study.engine.store import STORE_NAME, Store, TaskStatus
from fingerpad.study.error_text import counted
from fingerpad.study.manifest import Finger, manifest_in, read_study
from fingerpad.study.measuring.context import Item, RunContext
from fingerpad.study.measuring.fingers import photograph_item
from fingerpad.study.measuring.run import StudyItems, item_of
from fingerpad.study.results.result_set import result_files, result_set_faults
from fingerpad.study.results.summary_file import FingerRecord, SummaryFile

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
    failed_items : tuple of str
        Names of the failed.
    faults : tuple of str
        What is wrong with the files of the last run, each naming its file.
    """

    done: int
    failed: int
    stale: int
    left: int
    seconds: dict[str, float | None]
    failed_items: tuple[str, ...] = ()
    faults: tuple[str, ...] = ()

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
    """Compare a study with what is stored of it; nothing is measured, and nothing is written.

    Raises
    ------
    ManifestError
        If the manifest cannot be acted upon.
    StoreError
        If the store cannot be used.
    """
    manifest = manifest_in(manifest)
    study, folder = read_study(manifest), manifest.absolute().parent
    active_corrections = CorrectionLog(folder).active_corrections()
    if not (out / STORE_NAME).is_file():
        context = RunContext.of(study, folder, active_corrections, None)
        counts = {**dict.fromkeys(_STATES, 0), "left": len(list(StudyItems.of(context)))}
        return Status(
            **counts,
            seconds=dict.fromkeys(_STATES),
            failed_items=(),
            faults=tuple(result_set_faults(out)),
        )
    counts, pictures = dict.fromkeys(_STATES, 0), dict.fromkeys(_STATES, 0)
    spent: dict[str, float] = dict.fromkeys(_STATES, 0.0)
    with Store.reading(out / STORE_NAME) as store:
        context = RunContext.of(study, folder, active_corrections, store)
        statuses = store.statuses()
        of_item = _by_item(statuses)
        items = StudyItems.of(context)
        states = item_states(items)
        for item in items:
            state, parts = states[item.name], of_item.get(item.name, ())
            counts[state] += 1
            spent[state] += sum(part.seconds for part in parts)
            pictures[state] += item.pictures
            if state == "left":
                pictures[state] -= sum(part.count for part in parts)
        faults = tuple(result_set_faults(out, store.digest))
    seen = sum(status.count for status in statuses.values())
    usual = sum(status.seconds for status in statuses.values()) / seen if seen else None
    coming = {name: None if usual is None else usual * pictures[name] for name in ("stale", "left")}
    return Status(
        **counts,
        seconds={**spent, **coming},
        failed_items=tuple(name for name, state in states.items() if state == "failed"),
        faults=faults,
    )


def item_states(items: StudyItems) -> dict[str, str]:
    """Return the state of each photograph, loading curve, observation and sequence, as `Status` counts them.

    The files of an item that is not in the store are not read.
    """
    store = items.context.store
    statuses = {} if store is None else store.statuses()

    def state(item: Item) -> str:
        status = statuses.get(item.name)
        return "left" if status is None else status.status if status.key == item.key else "stale"

    return {item.name: state(item) for item in items}


def semi_axes_state(finger: Finger, states: Mapping[str, str], record: FingerRecord | None) -> str:
    """Return the state of a finger's semi-axes in the results of the last run.

    Parameters
    ----------
    finger : Finger
        Its table of the manifest.
    states : mapping
        The state of each item, by `item_states`.
    record : FingerRecord or None
        What ``summary.json`` says of the finger; None without a run of it.

    Returns
    -------
    str
        ``given`` if they are entered; otherwise as `Status` counts items: ``stale`` also where a photograph
        was added, removed or rejected since.
    """
    if finger.semi_axes_mm is not None:
        return "given"
    if record is None:
        return "left"
    items = [photograph_item(finger, one) for one in finger.photographs if one.file is not None]
    now = [item for item in items if item in states]  # the others are rejected
    if any(states[item] in {"stale", "left"} for item in now):
        return "stale"
    if record.reason is not None:
        return "failed"
    measured = sorted(f"{finger.name}/{one.file}" for one in record.photographs)
    return "done" if sorted(now) == measured else "stale"


def _by_item(statuses: Mapping[str, TaskStatus]) -> dict[str, list[TaskStatus]]:
    """Return the statuses of each item: of a sequence its own and its pieces'."""
    found: dict[str, list[TaskStatus]] = {}
    for task, status in statuses.items():
        found.setdefault(item_of(task), []).append(status)
    return found


@dataclass(frozen=True, slots=True, kw_only=True)
class Verification:
    """What a look at all files of a study found.

    Attributes
    ----------
    intact : dict of str to str
        What is as it was written: a file or group of files, with what it holds.
    faults : tuple of str
        What is not, each naming its file.
    changed_inputs : tuple of str
        Inputs that are not those of the last run: the next one measures them again.
    """

    intact: dict[str, str]
    faults: tuple[str, ...]
    changed_inputs: tuple[str, ...]


def verify_study(manifest: Path, out: Path) -> Verification:
    """Read all that is kept of a study, and compare it with its checksums; nothing is written.

    Parameters
    ----------
    manifest : Path
        The study's TOML file, or its folder.
    out : Path
        Folder of its results.
    """
    manifest = manifest_in(manifest)
    folder = manifest.absolute().parent
    intact: dict[str, str] = {}
    faults: list[str] = []
    try:
        study = read_study(manifest)
        count = len(study.observations) + len(study.sequences)
        intact[manifest.name] = f"{counted(len(study.fingers), 'finger')}, {counted(count, 'contact')}"
    except FingerpadError as error:
        faults += str(error).splitlines()
    for name in (CORRECTIONS_NAME, SECOND_OPERATOR_NAME):
        if not (folder / name).is_file():
            continue
        try:
            log = CorrectionLog(folder, name)
            intact[name] = counted(log.count, "record")
            faults += log.notes
        except FingerpadError as error:
            faults.append(str(error))
    if (out / STORE_NAME).is_file():
        found = list(_store_faults(out / STORE_NAME))
        if not found:
            with Store.reading(out / STORE_NAME) as store:
                intact[STORE_NAME] = counted(len(store.statuses()), "result")
        faults += found
    listed = result_files(out)
    found = result_set_faults(out, digest_of)
    if listed and not found:
        intact["results"] = counted(len(listed), "file")
    faults += found
    return Verification(
        intact=intact, faults=tuple(faults), changed_inputs=tuple(_changed_inputs(folder, out))
    )


def _store_faults(path: Path) -> Iterator[str]:
    try:
        with Store.reading(path) as store:
            for task in store.damaged():
                yield f"{STORE_NAME}: the stored result of {task} is damaged"
            for task, status in store.statuses().items():
                for name, digest in status.drawn.items():
                    drawn = store.drawn_file(name, digest)
                    if drawn is None or digest_of(drawn) != digest:
                        yield f"{name}: is missing or was changed; {task} will be measured again"
    except FingerpadError as error:
        yield str(error)


def _changed_inputs(folder: Path, out: Path) -> Iterator[str]:
    """Yield the inputs of the last run that are not what they were, as far as it tells."""
    with suppress(OSError, FingerpadError):
        for name, digest in SummaryFile.read(out).provenance.inputs_sha256.items():
            path = folder / name
            if path.is_file() and digest_of(path) != digest:
                yield name
