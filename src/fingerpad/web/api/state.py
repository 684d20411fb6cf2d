"""The state of a study: its contents, missing entries, and the status of each item."""

from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any, Final, Literal, get_args

import numpy as np
from fastapi import Query
from pydantic import Field

from fingerpad._files import digest_of
from fingerpad.exceptions import StoreError
from fingerpad.flags import FLAGS
from fingerpad.image import FACE_AXES
from fingerpad.image.sequence.frames import TIFF_SUFFIXES
from fingerpad.report.write import REPORT_NAME
from fingerpad.study.corrections.apply import InterpolatedCorrection, frame_corrections
from fingerpad.study.corrections.items import (
    CORRECTIONS_NAME,
    SECOND_OPERATOR_NAME,
    ActiveCorrection,
    frames_of,
    is_rejected,
)
from fingerpad.study.editing.propose import Use, named_file
from fingerpad.study.editing.scales import scale_words
from fingerpad.study.engine.store import STORE_NAME, Store
from fingerpad.study.imports.names import FileKind
from fingerpad.study.manifest import Finger, LoadedStudy, Study
from fingerpad.study.manifest.load import STUDY_NAME, Kind
from fingerpad.study.manifest.models import Apparatus, Surface, Uncertainty
from fingerpad.study.measuring.context import RunContext
from fingerpad.study.measuring.curves import curve_names
from fingerpad.study.measuring.run import StudyItems
from fingerpad.study.results.load import Results
from fingerpad.study.results.summary_file import FingerRecord
from fingerpad.study.results.table import COLUMNS
from fingerpad.study.status import item_states, semi_axes_state
from fingerpad.web.answers import Answer, Face, Quantities, SemiAxes, Status
from fingerpad.web.api.base import Opened, Params, study_router
from fingerpad.web.events import RunStatus
from fingerpad.web.last_results import (
    FRAME_COLUMNS,
    contact_rows,
    frame_rows,
    known_finger,
    last_results,
    results_faults,
)
from fingerpad.web.pictures import kind_of_file
from fingerpad.web.study_session import StudySession, table_content

router = study_router()

_UNREADABLE: Final = (OSError, StoreError)
_WORDS: Final[Mapping[str, Any]] = {
    "flags": {
        kind: {code: {"words": flag.words, "to_do": flag.to_do} for code, flag in flags.items()}
        for kind, flags in FLAGS.items()
    },
    "columns": {name: column.meaning for name, column in COLUMNS.items()},
}


class MissingEntry(Answer):
    """Something that the study lacks; `place` is the key of the table that would hold it, or empty."""

    kind: Kind | Literal["file", "folder"]
    key: str
    words: str
    place: str


class Review(Answer):
    """What a person did to an item."""

    corrected: bool
    accepted: bool
    rejected: str | None
    who: str | None


class ScaleEntry(Answer):
    """A named scale; `table` is as the manifest states it."""

    name: str
    table: dict[str, Any]
    words: str
    used_by: int
    complete: bool


class PhotographEntry(Review):
    """A photograph or an outline of a finger's face."""

    item: str
    file: str | None
    outline: bool
    status: Status
    face: Face | None
    scale: str | dict[str, Any] | None
    scale_words: str
    tip: str | None
    palmar_side: str | None
    synthetic: bool


class FingerEntry(Quantities):
    """A finger of the study; `status` and `reason` are of its semi-axes."""

    has_units = False

    name: str
    table: dict[str, Any]
    complete: bool
    synthetic: bool
    semi_axes_mm: SemiAxes | None
    semi_axes_mm_std: SemiAxes | None
    effective_thickness_mm: float | None
    effective_thickness_mm_std: float | None
    status: Status
    reason: str | None
    photographs: list[PhotographEntry]


class ObservationEntry(Review):
    """An observation: one contact at one load."""

    item: str
    finger: str | None
    wedge_angle_deg: float | None
    roll_angle_deg: float | None
    load_N: float | None  # noqa: N815
    scale: str | dict[str, Any] | None
    scale_words: str
    file: str | None
    notes: str
    surface: Surface
    synthetic: bool
    status: Status
    flags: list[str]
    reason: str | None
    complete: bool


class SequenceEntry(Answer):
    """A sequence of contact images."""

    name: str
    finger: str | None
    wedge_angle_deg: float | None
    roll_angle_deg: float | None
    force: str | None
    scale: str | dict[str, Any] | None
    scale_words: str
    file: str | None
    frames_per_second: float | None
    surface: Surface
    synthetic: bool
    status: Status
    frames: int | None
    flags: dict[str, int]
    corrected: int
    rejected: int
    reviewed: int
    complete: bool


class CurveEntry(Quantities):
    """A loading curve, or a radius from loading data."""

    has_units = False

    key: str
    finger: str | None
    wedge_angle_deg: float | None
    file: str | None
    loading_radius_mm: float | None
    loading_radius_mm_std: float | None
    synthetic: bool
    complete: bool
    status: Status
    reason: str | None


class FileReading(Answer):
    """What the name of a file says; empty or null where it says nothing or could mean two things."""

    use: Use
    finger: str
    face: Face | None
    wedge_angle_deg: float | None
    load_N: float | None  # noqa: N815


class FileEntry(Answer):
    """A file of the study folder; what its name says where the study does not use it."""

    file: str
    kind: FileKind
    bytes: int
    used: bool
    reading: FileReading | None


class FlagWords(Answer):
    """What a flag means, and what to do about it."""

    words: str
    to_do: str


class Descriptions(Answer):
    """Descriptions of flags, by what is flagged and their codes, and of columns."""

    flags: dict[str, dict[str, FlagWords]]
    columns: dict[str, str]


class Counts(Answer):
    """Number of items of each status."""

    done: int
    failed: int
    stale: int
    left: int
    total: int


class ResultsStatus(Answer):
    """Whether there are results, and whether they are those of the current study."""

    there: bool
    faults: list[str]
    report: bool
    finished: str | None
    fresh: bool


class State(Answer):
    """The state of a study; `stated` are the keys of `uncertainty` that its manifest holds."""

    name: str
    title: str
    description: str
    digest: str
    poisson_ratio: float
    surface: Surface
    uncertainty: Uncertainty
    stated: list[str]
    apparatus: Apparatus
    taken_as_exact: list[str]
    assumed: list[str]
    ready: bool
    missing: list[MissingEntry]
    scales: list[ScaleEntry]
    fingers: list[FingerEntry]
    observations: list[ObservationEntry]
    sequences: list[SequenceEntry]
    curves: list[CurveEntry]
    files: list[FileEntry]
    words: Descriptions
    counts: Counts
    run: RunStatus
    results: ResultsStatus


class StateAfterRemoval(State):
    """The state of a study, and the number by which the removed file can be restored."""

    removed: str


class StateAfterRestore(State):
    """The state of a study, and the name of the restored file."""

    restored: str


class FrameEntry(Review):
    """A frame of a sequence."""

    item: str
    frame: int
    status: str
    flags: list[str]
    phase: str | None
    phase_corrected_by: str | None
    time_s: float | None
    load_N: float | None  # noqa: N815
    measured_indentation_mm: float | None
    gross_area_mm2: float | None
    aspect_ratio: float | None
    pooled: bool
    interpolated: bool


class Frames(Answer):
    """Some frames of a sequence, and how many there are."""

    total: int
    frames: list[FrameEntry]


def document(opened: StudySession) -> dict[str, Any]:
    """Return the state of a study; nothing is measured."""
    loaded = opened.read()
    study = loaded.study
    active_corrections = opened.corrections.active_corrections()
    states = _item_states(study, opened, active_corrections)
    found = last_results(opened)
    seen = contact_rows(found.table) if found else {}
    fingers = {one.name: one for one in study.fingers}
    counts = Counter(states.values())
    return {
        "name": opened.name,
        "title": study.title,
        "description": study.description,
        "digest": loaded.digest,
        "poisson_ratio": study.poisson_ratio,
        "surface": study.surface,
        "uncertainty": study.uncertainty.model_dump(),
        "stated": sorted(study.uncertainty.model_fields_set),
        "apparatus": study.apparatus.model_dump(),
        "taken_as_exact": study.taken_as_exact(),
        "assumed": study.assumed(),
        "ready": not loaded.issues,
        "missing": [asdict(one) for one in opened.missing()],
        "scales": _scales(loaded),
        "fingers": [
            _finger(
                opened,
                *one,
                finger=fingers.get(one[0]),
                record=found.summary.finger(one[0]) if found else None,
                states=states,
                active_corrections=active_corrections,
            )
            for one in _tables(loaded, "finger")
        ],
        "observations": [
            {
                **_observation(*one, states=states, seen=seen, active_corrections=active_corrections),
                "surface": _surface(loaded, one[1]),
            }
            for one in _tables(loaded, "observation")
        ],
        "sequences": [
            {
                **_sequence(opened, *one, states=states, active_corrections=active_corrections),
                "surface": _surface(loaded, one[1]),
            }
            for one in _tables(loaded, "sequence")
        ],
        "curves": _curves(loaded, states, found),
        "files": _files(opened),
        "words": _WORDS,
        "counts": {
            **{name: counts[name] for name in ("done", "failed", "stale", "left")},
            "total": len(states),
        },
        "run": opened.run_job.describe(),
        "results": {
            "there": found is not None,
            "faults": results_faults(opened),
            "report": _has_report(opened),
            "finished": found and found.summary.provenance.made,
            "fresh": _is_fresh(opened, study, found, counts),
        },
    }


def _is_fresh(opened: StudySession, study: Study, found: Results | None, counts: Mapping[str, int]) -> bool:
    """Tell whether the results and the report are up to date."""
    if found is None or counts["stale"] + counts["left"] or not _has_report(opened):
        return False
    return _same_inputs(opened, study, found.summary.provenance.inputs_sha256)


def _has_report(opened: StudySession) -> bool:
    return (opened.out / REPORT_NAME).is_file()


def _item_states(
    study: Study, opened: StudySession, active_corrections: Mapping[str, ActiveCorrection]
) -> dict[str, str]:
    """Return the status of each item: done, failed, stale or left."""
    path = opened.out / STORE_NAME
    if path.is_file():
        with suppress(*_UNREADABLE), Store.reading(path) as store:  # a run reports what is wrong with it
            return item_states(StudyItems.of(RunContext.of(study, opened.folder, active_corrections, store)))
    return item_states(StudyItems.of(RunContext.of(study, opened.folder, active_corrections, None)))


def _same_inputs(opened: StudySession, study: Study, known: Mapping[str, str]) -> bool:
    """Tell whether manifest, spreadsheet and corrections are those of a run."""
    sheet = [study.observations_csv] if study.observations_csv else []
    names = [STUDY_NAME, *sheet, CORRECTIONS_NAME, SECOND_OPERATOR_NAME]
    return all(digest_of(opened.folder / name) == known.get(name, "") for name in names)


def review_record(active_correction: ActiveCorrection | None) -> dict[str, Any]:
    """Return the review of an item."""
    return {
        "corrected": active_correction is not None and bool(active_correction.change.edits),
        "accepted": active_correction is not None and active_correction.change.accepted,
        "rejected": active_correction and active_correction.change.rejected,
        "who": active_correction and active_correction.who,
    }


def _values(table: Mapping[str, Any], kinds: type | tuple[type, ...], *names: str) -> dict[str, Any]:
    """Return values of a table by name, None where one is missing or of another type.

    A table that is not complete yet may hold anything.
    """
    values = {name: table.get(name) for name in names}
    return {
        name: value if isinstance(value, kinds) and not isinstance(value, bool) else None
        for name, value in values.items()
    }


def _text(table: Mapping[str, Any], name: str) -> str | None:
    value: str | None = _values(table, str, name)[name]
    return value


def _tables(loaded: LoadedStudy, kind: str) -> Iterator[tuple[str, dict[str, Any], bool]]:
    """Yield key and content of each table of a kind, and whether it is complete."""
    return ((one.key, table_content(one), one.complete) for one in loaded.tables if one.kind == kind)


def _scales(loaded: LoadedStudy) -> list[dict[str, Any]]:
    uses = Counter(loaded.study.named_scales())
    for one in loaded.incomplete:
        names = (table.get("scale") for table in one.tables)
        uses.update(name for name in names if isinstance(name, str))
    return [
        {
            "name": name,
            "table": table,
            "words": scale_words(table),
            "used_by": uses[name],
            "complete": complete,
        }
        for name, table, complete in _tables(loaded, "scale")
    ]


def _finger(
    opened: StudySession,
    name: str,
    table: dict[str, Any],
    complete: bool,
    *,
    finger: Finger | None,
    record: FingerRecord | None,
    states: Mapping[str, str],
    active_corrections: Mapping[str, ActiveCorrection],
) -> dict[str, Any]:
    known = known_finger(opened, name) if complete else None
    status = "left" if finger is None else semi_axes_state(finger, states, record)
    axes = ("palmar", "distal", "radial_ulnar")
    return {
        "name": name,
        "table": table,
        "complete": complete,
        "synthetic": table.get("synthetic") is True,
        "semi_axes_mm": known and dict(zip(axes, known.semi_axes.tolist(), strict=True)),
        "semi_axes_mm_std": known
        and dict(zip(axes, np.sqrt(known.covariance.diagonal()).tolist(), strict=True)),
        **_values(table, (int, float), "effective_thickness_mm", "effective_thickness_mm_std"),
        "status": status,
        "reason": record.reason if record and status == "failed" else None,
        "photographs": [
            _photograph(name, one, states, active_corrections) for one in table.get("photographs", [])
        ],
    }


def _photograph(
    finger: str,
    table: Mapping[str, Any],
    states: Mapping[str, str],
    active_corrections: Mapping[str, ActiveCorrection],
) -> dict[str, Any]:
    file = _text(table, "file") or _text(table, "outline")
    face = _text(table, "face")
    return {
        "item": f"{finger}/{file}",
        "file": file,
        "outline": "outline" in table,
        "status": "given" if "outline" in table else _status(f"{finger}/{file}", states, active_corrections),
        "face": face if face in FACE_AXES else None,
        **_values(table, str, "tip", "palmar_side"),
        **_values(table, (str, dict), "scale"),
        "scale_words": scale_words(table.get("scale")),
        "synthetic": table.get("synthetic") is True,
        **review_record(active_corrections.get(f"{finger}/{file}")),
    }


def _surface(loaded: LoadedStudy, table: Mapping[str, Any]) -> str:
    """Return whether a contact has ridges: as its table says, or else the study."""
    stated = table.get("surface")
    return str(stated) if stated in get_args(Surface) else loaded.study.surface


def _observation(
    name: str,
    table: Mapping[str, Any],
    complete: bool,
    *,
    states: Mapping[str, str],
    seen: Mapping[str, Mapping[str, Any]],
    active_corrections: Mapping[str, ActiveCorrection],
) -> dict[str, Any]:
    row = seen.get(name, {})
    return {
        "item": name,
        **_values(table, str, "finger"),
        **_values(table, (int, float), "wedge_angle_deg", "roll_angle_deg", "load_N"),
        **_values(table, (str, dict), "scale"),
        "scale_words": scale_words(table.get("scale")),
        "file": _text(table, "file"),
        "notes": _text(table, "notes") or "",
        "synthetic": table.get("synthetic") is True,
        "status": "given" if "ellipse_mm" in table else _status(name, states, active_corrections),
        "flags": (row.get("flags") or "").split(),
        "reason": row.get("reason"),
        **review_record(active_corrections.get(name)),
        "complete": complete,
    }


def _status(item: str, states: Mapping[str, str], active_corrections: Mapping[str, ActiveCorrection]) -> str:
    """Return the status of an item; rejected items are only that."""
    return "rejected" if is_rejected(active_corrections.get(item)) else states.get(item, "left")


def _sequence(
    opened: StudySession,
    name: str,
    table: dict[str, Any],
    complete: bool,
    *,
    states: Mapping[str, str],
    active_corrections: Mapping[str, ActiveCorrection],
) -> dict[str, Any]:
    found = last_results(opened)
    rows = frame_rows(found.table, name).values() if found else ()
    of_frames = frames_of(active_corrections, name).values()
    return {
        "name": name,
        **_values(table, str, "finger", "force"),
        **_values(table, (int, float), "wedge_angle_deg", "roll_angle_deg", "frames_per_second"),
        **_values(table, (str, dict), "scale"),
        "scale_words": scale_words(table.get("scale")),
        "file": _text(table, "file"),
        "synthetic": table.get("synthetic") is True,
        "status": states.get(name, "left"),
        "frames": None if (file := _text(table, "file")) is None else opened.count_frames(file),
        "flags": Counter(flag for row in rows for flag in (row["flags"] or "").split()),
        "corrected": sum(bool(active_correction.change.edits) for active_correction in of_frames),
        "rejected": sum(active_correction.change.rejected is not None for active_correction in of_frames),
        "reviewed": len(of_frames),
        "complete": complete,
    }


def _curves(loaded: LoadedStudy, states: Mapping[str, str], found: Results | None) -> list[dict[str, Any]]:
    place = ("finger", "wedge_angle_deg", "file")
    names = iter(curve_names(loaded.study))
    seen = found.summary.curves if found else []
    reasons: dict[tuple[Any, ...], str | None] = {
        (one.finger, one.wedge_angle_deg, one.file): one.reason for one in seen
    }

    def described(key: str, table: dict[str, Any], complete: bool) -> dict[str, Any]:
        item = next(names) if complete else None
        return {
            "key": key,
            **_values(table, str, "finger", "file"),
            **_values(table, (int, float), "wedge_angle_deg", "loading_radius_mm", "loading_radius_mm_std"),
            "synthetic": table.get("synthetic") is True,
            "complete": complete,
            "status": states.get(item or "", "given"),
            "reason": reasons.get(tuple(map(table.get, place))) if complete else None,
        }

    return [described(*one) for one in _tables(loaded, "curve")]


def _files(opened: StudySession) -> list[dict[str, Any]]:
    unused = {one.key for one in opened.missing() if one.kind == "file"}
    folders = tuple(f"{one.key}/" for one in opened.missing() if one.kind == "folder")
    fingers = [finger.name for finger in opened.study().fingers]

    def described(name: str, size: int) -> dict[str, Any]:
        kind, used = kind_of_file(name), name not in unused and not name.startswith(folders)
        if (
            name in unused
            and Path(name).suffix.lower() in TIFF_SUFFIXES
            and (opened.count_frames(name) or 1) > 1
        ):
            kind = "sequence"
        reading = None
        if name in unused:
            stated = named_file(name, kind, fingers)
            reading = {key: getattr(stated, key) for key in FileReading.model_fields}
        return {"file": name, "kind": kind, "bytes": size, "used": used, "reading": reading}

    return [described(name, status.st_size) for name, status in opened.files().items()]


@router.get("/state")
def state(opened: Opened) -> State:
    """Return the state of the open study."""
    return State.of(document(opened))


class FramesParams(Params):
    """Frames of a sequence."""

    sequence: Annotated[str, Field(max_length=100)]
    offset: Annotated[int, Field(ge=0, le=10**9)] = 0
    limit: Annotated[int, Field(ge=1, le=5000)] = 2000


@router.get("/frames")
def frames(opened: Opened, params: Annotated[FramesParams, Query()]) -> Frames:
    """Return frames of a sequence, with the results of the last run."""
    name, found = params.sequence, last_results(opened)
    total = opened.count_frames(opened.sequence_file(name)) or 0
    rows = frame_rows(found.table, name) if found else {}
    shown = range(min(params.offset, total), min(params.offset + params.limit, total))
    active = frame_corrections(opened.corrections.active_corrections(), name, shown)
    return Frames.of(
        {
            "total": total,
            "frames": [_frame(name, number, rows.get(number), active.get(number)) for number in shown],
        }
    )


def _frame(
    sequence: str, number: int, row: Mapping[str, Any] | None, active_correction: ActiveCorrection | None
) -> dict[str, Any]:
    known = row or {}
    return {
        "item": f"{sequence}#{number}",
        "frame": number,
        "status": known.get("status", "none"),
        "flags": (known.get("flags") or "").split(),
        **{key: known.get(key) for key in FRAME_COLUMNS},
        "pooled": bool(known.get("pooled")),
        "interpolated": active_correction is not None
        and isinstance(active_correction.change, InterpolatedCorrection),
        **review_record(active_correction),
    }
