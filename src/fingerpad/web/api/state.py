"""The state of a study: its contents, missing entries, and the status of each item."""

from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Final, TypeAlias, get_args

import numpy as np
from pydantic import (
    Field,
    StrictFloat,
    StrictStr,
    ValidationError,
    ValidatorFunctionWrapHandler,
    WrapValidator,
)

from fingerpad._files import digest_of
from fingerpad.exceptions import StoreError
from fingerpad.flags import FLAGS, Flag
from fingerpad.image.sequence.frames import TIFF_SUFFIXES
from fingerpad.report.write import REPORT_NAME
from fingerpad.study.corrections.apply import InterpolatedCorrection, frame_corrections
from fingerpad.study.corrections.log import (
    CORRECTIONS_NAME,
    SECOND_OPERATOR_NAME,
    ActiveCorrection,
    is_rejected,
)
from fingerpad.study.editing.propose import NewFile, named_file, scale_words
from fingerpad.study.engine.store import STORE_NAME, Store
from fingerpad.study.imports.identify import kind_of_file
from fingerpad.study.imports.names import FileKind
from fingerpad.study.manifest.load import STUDY_NAME, LoadedStudy
from fingerpad.study.manifest.models import Apparatus, Study, Surface, Uncertainty
from fingerpad.study.measuring.context import RunContext
from fingerpad.study.measuring.curves import curve_names
from fingerpad.study.measuring.run import StudyItems
from fingerpad.study.results.load import Results
from fingerpad.study.results.table import Row, records
from fingerpad.study.status import Missing, item_states, semi_axes_state
from fingerpad.web.answers import Answer, Axis, Face, Quantity, Status, semi_axes
from fingerpad.web.api.base import Opened, Params, Query, router
from fingerpad.web.events import RunStatus
from fingerpad.web.last_results import frame_rows, known_finger, last_results, results_faults
from fingerpad.web.study_session import StudySession, table_content


def _or_null(value: Any, validated: ValidatorFunctionWrapHandler) -> Any:
    try:
        return validated(value)
    except ValidationError:
        return None


# What a table of the manifest states; one that is not complete may hold anything, which is null then.
Text: TypeAlias = Annotated[StrictStr | None, WrapValidator(_or_null)]
Number: TypeAlias = Annotated[StrictFloat | None, WrapValidator(_or_null)]
StatedScale: TypeAlias = Annotated[str | dict[str, Any] | None, WrapValidator(_or_null)]
StatedFace: TypeAlias = Annotated[Face | None, WrapValidator(_or_null)]


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
    face: StatedFace
    scale: StatedScale
    scale_words: str
    synthetic: bool


class FingerEntry(Answer):
    """A finger of the study; `status` and `reason` are of its semi-axes."""

    name: str
    table: dict[str, Any]
    complete: bool
    synthetic: bool
    semi_axes_mm: dict[Axis, Quantity] | None
    effective_thickness_mm: Quantity
    status: Status
    reason: str | None
    photographs: list[PhotographEntry]


class PlacedEntry(Answer):
    """What was recorded of a finger on a wedge."""

    finger: Text
    wedge_angle_deg: Number
    file: Text
    synthetic: bool
    status: Status
    complete: bool


class ContactEntry(PlacedEntry):
    """Contact images of a finger on a wedge."""

    roll_angle_deg: Number
    scale: StatedScale
    scale_words: str
    surface: Surface


class ObservationEntry(ContactEntry, Review):
    """An observation: one contact at one load."""

    item: str
    load_N: Number  # noqa: N815
    flags: list[str]
    reason: str | None


class SequenceEntry(ContactEntry):
    """A sequence of contact images."""

    name: str
    force: Text
    frames_per_second: Number
    frames: int | None


class CurveEntry(PlacedEntry):
    """A loading curve, or a radius from loading data."""

    key: str
    loading_radius_mm: Quantity
    reason: str | None


class FileEntry(Answer):
    """A file of the study folder; where the study does not use it, what its name says."""

    file: str
    kind: FileKind
    bytes: int
    used: bool
    reading: NewFile | None


class ResultsStatus(Answer):
    """Whether there are results, and whether they are those of the current study."""

    there: bool
    faults: list[str]
    report: bool
    finished: str | None
    fresh: bool


class State(Answer):
    """The state of a study, flags by what is flagged and their codes, and the number of items by status.

    `stated` are the keys of `uncertainty` that its manifest holds.
    """

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
    doubts: list[str]
    ready: bool
    missing: list[Missing]
    scales: list[ScaleEntry]
    fingers: list[FingerEntry]
    observations: list[ObservationEntry]
    sequences: list[SequenceEntry]
    curves: list[CurveEntry]
    files: list[FileEntry]
    flags: dict[str, dict[str, Flag]]
    counts: dict[str, int]
    run: RunStatus
    results: ResultsStatus


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
    interpolated: bool


_FRAME_COLUMNS: Final = (
    *("status", "flags", "phase", "phase_corrected_by", "time_s", "load_N"),
    *("measured_indentation_mm", "gross_area_mm2", "aspect_ratio"),
)


class Frames(Answer):
    """Some frames of a sequence, and how many there are."""

    total: int
    frames: list[FrameEntry]


def state_of(opened: StudySession) -> State:
    """Return the state of a study; nothing is measured."""
    loaded = opened.read()
    study = loaded.study
    active = opened.corrections.active_corrections()
    known = _Known(
        opened=opened,
        loaded=loaded,
        states=_item_states(study, opened, active),
        active=active,
        found=last_results(opened),
    )
    counts = Counter(known.states.values())
    return State.of(
        study,
        name=opened.name,
        digest=loaded.digest,
        stated=sorted(study.uncertainty.model_fields_set),
        taken_as_exact=study.taken_as_exact(),
        assumed=study.assumed(),
        doubts=list(study.doubts()),
        ready=not loaded.issues,
        missing=opened.missing(),
        scales=known.scales(),
        fingers=[known.finger(*one) for one in known.tables("finger")],
        observations=known.observations(),
        sequences=[known.sequence(*one) for one in known.tables("sequence")],
        curves=known.curves(),
        files=_files(opened),
        flags=FLAGS,
        counts={name: counts[name] for name in ("done", "failed", "stale", "left")},
        run=opened.run_job.describe(),
        results=known.results(counts),
    )


def _item_states(
    study: Study, opened: StudySession, active: Mapping[str, ActiveCorrection]
) -> dict[str, str]:
    """Return the status of each item: done, failed, stale or left."""
    path = opened.out / STORE_NAME
    if path.is_file():
        # A run reports what is wrong with the store.
        with suppress(OSError, StoreError), Store.reading(path) as store:
            return item_states(StudyItems.of(RunContext.of(study, opened.folder, active, store)))
    return item_states(StudyItems.of(RunContext.of(study, opened.folder, active, None)))


def review_record(correction: ActiveCorrection | None) -> dict[str, Any]:
    """Return the review of an item."""
    return {
        "corrected": correction is not None and bool(correction.change.edits),
        "accepted": correction is not None and correction.change.accepted,
        "rejected": correction and correction.change.rejected,
        "who": correction and correction.who,
    }


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Known:
    """What is known of a study, and what of that is said of each of its tables."""

    opened: StudySession
    loaded: LoadedStudy
    states: Mapping[str, str]
    active: Mapping[str, ActiveCorrection]
    found: Results | None

    def tables(self, kind: str) -> Iterator[tuple[str, dict[str, Any], bool]]:
        """Yield key and content of each table of a kind, and whether it is complete."""
        return ((one.key, table_content(one), one.complete) for one in self.loaded.tables if one.kind == kind)

    def status(self, item: str) -> str:
        """Return the status of an item; rejected items are only that."""
        return "rejected" if is_rejected(self.active.get(item)) else self.states.get(item, "left")

    def stated(self, table: Mapping[str, Any], *, complete: bool = True) -> dict[str, Any]:
        """Return what a table states, and what follows: its surface is its own, or that of the study."""
        surface = table.get("surface")
        return {
            **table,
            "surface": surface if surface in get_args(Surface) else self.loaded.study.surface,
            "scale_words": scale_words(table.get("scale")),
            "synthetic": table.get("synthetic") is True,
            "complete": complete,
        }

    def scales(self) -> list[ScaleEntry]:
        uses = Counter(self.loaded.study.named_scales())
        for one in self.loaded.incomplete:
            names = (table.get("scale") for table in one.tables)
            uses.update(name for name in names if isinstance(name, str))
        return [
            ScaleEntry(
                name=name, table=table, words=scale_words(table), used_by=uses[name], complete=complete
            )
            for name, table, complete in self.tables("scale")
        ]

    def finger(self, name: str, table: dict[str, Any], complete: bool) -> FingerEntry:
        finger = next((one for one in self.loaded.study.fingers if one.name == name), None)
        record = self.found.summary.finger(name) if self.found else None
        known = known_finger(self.opened, name) if complete else None
        status = "left" if finger is None else semi_axes_state(finger, self.states, record)
        return FingerEntry.of(
            self.stated(table, complete=complete),
            name=name,
            table=table,
            semi_axes_mm=known and semi_axes(known.semi_axes, np.sqrt(known.covariance.diagonal()), ""),
            effective_thickness_mm=Quantity.read(table.get, "effective_thickness_mm", ""),
            status=status,
            reason=record.reason if record and status == "failed" else None,
            photographs=[self.photograph(name, one) for one in table.get("photographs", [])],
        )

    def photograph(self, finger: str, table: Mapping[str, Any]) -> PhotographEntry:
        file = next((one for key in ("file", "outline") if isinstance(one := table.get(key), str)), None)
        item = f"{finger}/{file}"
        return PhotographEntry.of(
            self.stated(table),
            **review_record(self.active.get(item)),
            item=item,
            file=file,
            outline="outline" in table,
            status="given" if "outline" in table else self.status(item),
        )

    def observations(self) -> list[ObservationEntry]:
        seen: dict[str, Row] = {}
        if self.found:
            contacts = self.found.table[self.found.table["frame"].isna()]
            seen = {one["observation"]: one for one in records(contacts, "observation", "flags", "reason")}
        return [
            ObservationEntry.of(
                self.stated(table, complete=complete),
                **review_record(self.active.get(name)),
                item=name,
                status="given" if "ellipse_mm" in table else self.status(name),
                flags=(seen.get(name, {}).get("flags") or "").split(),
                reason=seen.get(name, {}).get("reason"),
            )
            for name, table, complete in self.tables("observation")
        ]

    def sequence(self, name: str, table: dict[str, Any], complete: bool) -> SequenceEntry:
        file = table.get("file")
        return SequenceEntry.of(
            self.stated(table, complete=complete),
            name=name,
            status=self.states.get(name, "left"),
            frames=self.opened.count_frames(file) if isinstance(file, str) else None,
        )

    def curves(self) -> list[CurveEntry]:
        names = iter(curve_names(self.loaded.study))
        seen = self.found.summary.curves if self.found else []
        reasons = {(one.finger, one.wedge_angle_deg, one.file): one.reason for one in seen}

        def entry(key: str, table: dict[str, Any], complete: bool) -> CurveEntry:
            item = next(names) if complete else None
            at: Any = tuple(map(table.get, ("finger", "wedge_angle_deg", "file")))
            return CurveEntry.of(
                self.stated(table, complete=complete),
                key=key,
                loading_radius_mm=Quantity.read(table.get, "loading_radius_mm", ""),
                status=self.states.get(item or "", "given"),
                reason=reasons.get(at) if complete else None,
            )

        return [entry(*one) for one in self.tables("curve")]

    def results(self, counts: Mapping[str, int]) -> ResultsStatus:
        """Return whether there are results and a report, and whether they are up to date."""
        made = self.found.summary.provenance if self.found else None
        has_report = (self.opened.out / REPORT_NAME).is_file()
        measured = not counts["stale"] + counts["left"]
        return ResultsStatus(
            there=made is not None,
            faults=results_faults(self.opened),
            report=has_report,
            finished=made.made if made else None,
            fresh=bool(made and measured and has_report and self._has_same_inputs(made.inputs_sha256)),
        )

    def _has_same_inputs(self, known: Mapping[str, str]) -> bool:
        """Tell whether manifest, spreadsheet and corrections are those of a run."""
        sheet = self.loaded.study.observations_csv
        names = filter(None, (STUDY_NAME, sheet, CORRECTIONS_NAME, SECOND_OPERATOR_NAME))
        return all(digest_of(self.opened.folder / name) == known.get(name, "") for name in names)


def _files(opened: StudySession) -> list[FileEntry]:
    unused = {one.key for one in opened.missing() if one.kind == "file"}
    folders = tuple(f"{one.key}/" for one in opened.missing() if one.kind == "folder")
    fingers = [finger.name for finger in opened.study().fingers]

    def entry(name: str, size: int) -> FileEntry:
        kind, reading = kind_of_file(name), None
        if name in unused:
            if Path(name).suffix.lower() in TIFF_SUFFIXES and (opened.count_frames(name) or 1) > 1:
                kind = "sequence"
            reading = named_file(name, kind, fingers)
        used = reading is None and not name.startswith(folders)
        return FileEntry.of(file=name, kind=kind, bytes=size, used=used, reading=reading)

    return [entry(name, status.st_size) for name, status in opened.files().items()]


@router.get("/state")
def state(opened: Opened) -> State:
    """Return the state of the open study."""
    return state_of(opened)


class FramesParams(Params):
    """Frames of a sequence."""

    sequence: Annotated[str, Field(max_length=100)]
    offset: Annotated[int, Field(ge=0, le=10**9)] = 0
    limit: Annotated[int, Field(ge=1, le=5000)] = 2000


@router.get("/frames")
def frames(opened: Opened, params: Query[FramesParams]) -> Frames:
    """Return frames of a sequence, with the results of the last run."""
    name, found = params.sequence, last_results(opened)
    total = opened.count_frames(opened.sequence_file(name)) or 0
    rows = frame_rows(found.table, name, *_FRAME_COLUMNS) if found else {}
    shown = range(min(params.offset, total), min(params.offset + params.limit, total))
    active = frame_corrections(opened.corrections.active_corrections(), name, shown)

    def entry(number: int) -> FrameEntry:
        row, correction = rows.get(number, {}), active.get(number)
        return FrameEntry.of(
            row,
            **review_record(correction),
            item=f"{name}#{number}",
            frame=number,
            status=row.get("status", "none"),
            flags=(row.get("flags") or "").split(),
            interpolated=correction is not None and isinstance(correction.change, InterpolatedCorrection),
        )

    return Frames(total=total, frames=[entry(number) for number in shown])
