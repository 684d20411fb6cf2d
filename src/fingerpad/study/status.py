"""How far a study is, what it still lacks, and whether all that is kept of it is what was written."""

import re
from collections import defaultdict
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, nullcontext, suppress
from dataclasses import dataclass
from functools import lru_cache, partial
from pathlib import Path, PurePosixPath
from typing import Any, Final

from fingerpad._columns import ColumnsError, columns_in_toml, named_columns, require_columns
from fingerpad._files import content_digest, digest_of
from fingerpad._words import counted
from fingerpad.exceptions import FingerpadError
from fingerpad.image import FACE_AXES, SEMI_AXES
from fingerpad.image.sequence.force import FORCE_COLUMNS
from fingerpad.image.sequence.frames import PICTURE_SUFFIXES
from fingerpad.loading.curve import CURVE_COLUMNS
from fingerpad.study.corrections.log import CORRECTIONS_NAME, SECOND_OPERATOR_NAME, CorrectionLog
from fingerpad.study.engine.store import STORE_NAME, Store, TaskStatus
from fingerpad.study.imports.identify import USABLE_SUFFIXES
from fingerpad.study.imports.names import read_file_name
from fingerpad.study.manifest.load import STUDY_NAME, LoadedStudy, Table, manifest_in, read_study
from fingerpad.study.manifest.models import ContactSequence, Curve, Fault, Finger
from fingerpad.study.measuring.context import Item, RunContext
from fingerpad.study.measuring.fingers import photograph_item
from fingerpad.study.measuring.run import StudyItems, item_of
from fingerpad.study.results.result_set import result_files, result_set_faults, results_folder
from fingerpad.study.results.summary_file import FingerRecord, SummaryFile

_STATES: Final = ("done", "failed", "stale", "left")


@dataclass(frozen=True, slots=True, kw_only=True)
class Status:
    """Numbers of photographs, loading curves, observations and sequences of a study."""

    done: int
    failed: int  # nothing could be measured, with the inputs as they are now
    stale: int  # picture, parameters or measuring code have changed since
    left: int
    # On one process, by state: what the done and the failed took, what the stale and the left may take.
    seconds: dict[str, float | None]
    failed_items: tuple[str, ...] = ()
    faults: tuple[str, ...] = ()  # of the files of the last run

    @property
    def seconds_left(self) -> float | None:
        """What the next run may take, on one process."""
        stale, left = self.seconds["stale"], self.seconds["left"]
        return None if stale is None or left is None else stale + left

    @property
    def total(self) -> int:
        """All of them."""
        return self.done + self.failed + self.stale + self.left


def study_status(manifest: Path, out: Path | None = None) -> Status:
    """Compare a study with what is stored of it; nothing is measured, and nothing is written."""
    manifest, out = manifest_in(manifest), out or results_folder(manifest)
    study, folder = read_study(manifest), manifest.absolute().parent
    active_corrections = CorrectionLog(folder).active_corrections()
    has_store = (out / STORE_NAME).is_file()
    counts, pictures = dict.fromkeys(_STATES, 0), dict.fromkeys(_STATES, 0)
    spent: dict[str, float] = dict.fromkeys(_STATES, 0.0)
    parts_of: dict[str, list[TaskStatus]] = defaultdict(list)  # of a sequence its pieces', too
    with Store.reading(out / STORE_NAME) if has_store else nullcontext() as store:
        statuses = {} if store is None else store.statuses()
        for task, status in statuses.items():
            parts_of[item_of(task)].append(status)
        items = StudyItems(
            RunContext(study=study, folder=folder, active_corrections=active_corrections, store=store)
        )
        states = item_states(items)
        for item in items:
            state, parts = states[item.name], parts_of[item.name]
            counts[state] += 1
            spent[state] += sum(part.seconds for part in parts)
            pictures[state] += item.pictures
            if state == "left":
                pictures[state] -= sum(part.count for part in parts)
        faults = tuple(result_set_faults(out, digest_of if store is None else store.digest))
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
    """Return the state of each item, as `Status` counts them; of unknown ones no file is read."""
    store = items.context.store
    statuses = {} if store is None else store.statuses()

    def state(item: Item[Any]) -> str:
        status = statuses.get(item.name)
        return "left" if status is None else status.status if status.key == item.key else "stale"

    return {item.name: state(item) for item in items}


def semi_axes_state(finger: Finger, states: Mapping[str, str], record: FingerRecord | None) -> str:
    """Return the state of semi-axes in the results of the last run: ``given``, or one as of items."""
    if finger.semi_axes_mm is not None or not finger.photographs:
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


@dataclass(frozen=True, slots=True, kw_only=True)
class Verification:
    """What a look at all files of a study found."""

    intact: dict[str, str]  # by file or group of files, what it holds
    faults: tuple[str, ...]
    changed_inputs: tuple[str, ...]  # since the last run: the next one measures them again


def verify_study(manifest: Path, out: Path | None = None) -> Verification:
    """Read all that is kept of a study, and compare it with its checksums; nothing is written."""
    manifest, out = manifest_in(manifest), out or results_folder(manifest)
    folder = manifest.absolute().parent
    intact: dict[str, str] = {}
    faults: list[str] = []
    with _errors_in(faults):
        study = read_study(manifest)
        count = len(study.observations) + len(study.sequences)
        intact[manifest.name] = f"{counted(len(study.fingers), 'finger')}, {counted(count, 'contact')}"
    for name in (CORRECTIONS_NAME, SECOND_OPERATOR_NAME):
        if (folder / name).is_file():
            with _errors_in(faults):
                log = CorrectionLog(folder, name)
                intact[name] = counted(log.count, "record")
                faults += log.notes
    if (out / STORE_NAME).is_file():
        with _errors_in(faults), Store.reading(out / STORE_NAME) as store:
            before = len(faults)
            faults.extend(_store_faults(store))  # those before an error are kept
            if len(faults) == before:
                intact[STORE_NAME] = counted(len(store.statuses()), "result")
    listed = result_files(out)
    found = result_set_faults(out, digest_of)
    if listed and not found:
        intact["results"] = counted(len(listed), "file")
    faults += found
    return Verification(
        intact=intact, faults=tuple(faults), changed_inputs=tuple(_changed_inputs(folder, out))
    )


@contextmanager
def _errors_in(faults: list[str]) -> Iterator[None]:
    """Take what cannot be read as a fault."""
    try:
        yield
    except FingerpadError as error:
        faults += str(error).splitlines()


def _store_faults(store: Store) -> Iterator[str]:
    for task in store.damaged():
        yield f"{STORE_NAME}: the stored result of {task} is damaged"
    for task, status in store.statuses().items():
        for name, digest in status.drawn.items():
            drawn = store.drawn_file(name, digest)
            if drawn is None or digest_of(drawn) != digest:
                yield f"{name}: is missing or was changed; {task} will be measured again"


def _changed_inputs(folder: Path, out: Path) -> Iterator[str]:
    """Yield the inputs of the last run that are not what they were, as far as it tells."""
    with suppress(OSError, FingerpadError):
        for name, digest in SummaryFile.read(out).provenance.inputs_sha256.items():
            path = folder / name
            if path.exists() and content_digest(path) != digest:
                yield name


# A run's output folder, which may lie inside the study's.
_OF_A_RUN: Final = frozenset(("store.sqlite", "results.json", "results.csv"))
# More pictures than these in a folder of their own are the frames of a sequence.
_SEQUENCE: Final = 20
_OF_PHOTOGRAPH: Final = re.compile(r"photographs\[(?P<number>\d+)\]\.?(?P<place>.*)")
_NEEDS_SCALE: Final = " needs its scale"
_FIELD_WORDS: Final = {
    "diameter_mm": "the diameter of the coin or circle",
    "face": "which face it shows",
    "finger": "which finger it is",
    "force": "the file of the force",
    "length_mm": "the line's length",
    "load_N": "the load",
    "points": "the inner corners or dots, down and along",
    "spacing_mm": "the spacing of the grid",
    "wedge_angle_deg": "the wedge angle",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Missing:
    """One thing that a study lacks."""

    # As of an `Edit`; "file" or "folder" (of frames) and its name for one that no table names.
    kind: str
    key: str
    words: str  # with the way out
    place: str = ""  # the key to set; empty where it takes more than one value
    proposed: str = ""  # what it may be set to, to be checked


def missing(loaded: LoadedStudy) -> list[Missing]:
    """Return what a study lacks to say something about every finger, and files that it does not use."""
    return [*lacking(loaded), *unused_files(loaded)]


def lacking(loaded: LoadedStudy) -> list[Missing]:
    """Return what a study lacks to say something about every finger."""
    study = loaded.study
    found = [
        _lacking(one, fault) if one.key else Missing(kind=one.kind, key="", words=line)
        for one in loaded.incomplete
        for fault, line in zip(one.faults, one.lines, strict=True)
    ]
    waiting: set[str] = {one.kind for one in loaded.incomplete}
    if not study.fingers and "finger" not in waiting:
        found.append(Missing(kind="study", key="", words="no finger yet: add one"))
    for finger in study.fingers:
        found.extend(_lacking_faces(finger))
    found.extend(_lacking_columns(loaded))
    if not waiting.isdisjoint({"observation", "sequence", "curve"}) or not study.fingers:
        return found
    contacts = [*study.observations, *study.sequences]
    touched = {one.finger for one in contacts} | {one.finger for one in study.curves}
    if not touched:
        words = "no contact yet: add a contact image with its load"
        return [*found, Missing(kind="study", key="", words=words)]
    words = "no contact image and no curve is of it"
    idle = (one.name for one in study.fingers if one.name not in touched)
    return [*found, *(Missing(kind="finger", key=name, words=words) for name in idle)]


def _lacking(one: Table, fault: Fault) -> Missing:
    """Return a fault of a table for someone who sees its fields on a page, and not the manifest."""
    place, words = fault
    kind, key, of = str(one.kind), one.key, ""
    if (found := _OF_PHOTOGRAPH.fullmatch(place)) is not None:
        photograph = one.content["photographs"][int(found["number"])]
        file = str(photograph.get("file") or photograph.get("outline"))
        kind, key, of = "photograph", f"{one.key}/{file}", f"{PurePosixPath(file).name}: "
        place = found["place"]
    said = str(Fault(place, words))  # without the names of keys where that can be
    if _NEEDS_SCALE in words:
        place, said = "scale", "its scale is missing"
    elif words == "required, but missing" and place in _FIELD_WORDS:
        said = f"{_FIELD_WORDS[place]} is missing"
    return Missing(kind=kind, key=key, words=f"{of}{said}", place=place)


def _lacking_columns(loaded: LoadedStudy) -> Iterator[Missing]:
    """Yield which curves and forces have columns that are not known."""
    for one in loaded.tables:
        match one.model:
            case Curve(file=str(file), file_columns=stated) if one.complete:
                place, known = "file_columns", CURVE_COLUMNS
            case ContactSequence(force=file, force_columns=stated) if one.complete:
                place, known = "force_columns", FORCE_COLUMNS
            case _:
                continue
        path, columns = loaded.folder / file, tuple((str(name), column) for name, column in stated.items())
        with suppress(OSError):
            words, proposed = _columns_fault(path, path.stat().st_mtime_ns, place, known, columns)
            if words:
                yield Missing(kind=one.kind, key=one.key, words=words, place=place, proposed=proposed)


@lru_cache(maxsize=1000)  # a study is looked at after each edit
def _columns_fault(
    path: Path,
    _changed_ns: int,
    place: str,
    known: tuple[tuple[str, ...], tuple[str, ...]],
    columns: tuple[tuple[str, str], ...],
) -> tuple[str, str]:
    """Return which columns a table lacks, with the way out, and what names them; empty for none."""
    try:
        require_columns(path, *known, columns=dict(columns))
    except ColumnsError as error:
        words = error.with_way_out(partial(columns_in_toml, place)).removeprefix(f"{path}: ")
        named = dict(columns) | {name: choices[0] for name, choices in error.proposed.items()}
        return words, named_columns(named)
    except (FingerpadError, OSError):  # said by the run
        pass
    return "", ""


def _lacking_faces(finger: Finger) -> Iterator[Missing]:
    if finger.semi_axes_mm is not None:
        return
    if not finger.photographs:
        words = "for more than contact areas, give its semi-axes or photographs of its faces"
        yield Missing(kind="finger", key=finger.name, words=words, place="semi_axes_mm")
        return
    shown = {axis for photograph in finger.photographs for axis in FACE_AXES[photograph.face]}
    for axis in SEMI_AXES:
        if axis not in shown:
            words = axis.replace("_", "-")
            faces = " or ".join(face for face, axes in FACE_AXES.items() if axis in axes)
            yield Missing(
                kind="finger",
                key=finger.name,
                words=f"no photograph shows the {words} semi-axis: add one of the {faces} face",
            )


def unused_files(loaded: LoadedStudy) -> Iterator[Missing]:
    """Yield the files that no table names; frames in a folder of their own together."""
    folder = loaded.folder
    used = {Path(name).as_posix() for name in loaded.files()}
    frames: dict[str, list[str]] = {}
    for path in _files(folder):
        name = path.relative_to(folder).as_posix()
        if not used.isdisjoint([name, *map(str, PurePosixPath(name).parents[:-1])]):
            continue
        frames.setdefault(path.parent.relative_to(folder).as_posix(), []).append(name)
    for place, names in sorted(frames.items()):
        pictures = {name for name in names if Path(name).suffix.lower() in PICTURE_SUFFIXES}
        # Pictures named by different loads are contacts.
        loads = {read_file_name(name, "picture").get("load_N") for name in pictures} - {None}
        if place != "." and len(pictures) > _SEQUENCE and len(loads) < 2:
            words = f"{len(pictures)} pictures that nothing names: add them as a sequence"
            yield Missing(kind="folder", key=place, words=words)
            names = [name for name in names if name not in pictures]  # noqa: PLW2901
        for name in sorted(names):
            yield Missing(kind="file", key=name, words="nothing names it: say what it is, or leave it")


def _files(folder: Path) -> Iterator[Path]:
    """Yield the files of a study that could be measured, but nothing hidden and nothing that a run wrote."""
    for path in sorted(folder.iterdir()):
        if path.name.startswith(".") or path.name == STUDY_NAME:
            continue
        if path.is_dir():
            if not path.is_symlink() and not any((path / name).exists() for name in _OF_A_RUN):
                yield from _files(path)
        elif path.suffix.lower() in USABLE_SUFFIXES:
            yield path
