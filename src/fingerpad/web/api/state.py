"""The state of a study: its contents, missing entries, and the status of each item."""

from collections import Counter
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Annotated, Any, TypeAlias, get_args

import numpy as np
from pydantic import StrictFloat, StrictStr, ValidationError, ValidatorFunctionWrapHandler, WrapValidator

from fingerpad._files import digest_of
from fingerpad._words import ended
from fingerpad.exceptions import StoreError
from fingerpad.flags import FLAGS, Flag
from fingerpad.image import Face
from fingerpad.image.sequence.frames import TIFF_SUFFIXES
from fingerpad.report.write import REPORT_NAME
from fingerpad.study.corrections.log import CORRECTIONS_NAME, SECOND_OPERATOR_NAME, is_rejected
from fingerpad.study.engine.store import STORE_NAME, Store
from fingerpad.study.engine.task import MEASUREMENT_VERSIONS
from fingerpad.study.imports.identify import kind_of_file
from fingerpad.study.imports.names import FileKind, scale_words
from fingerpad.study.manifest.load import STUDY_NAME, Kind, Table
from fingerpad.study.manifest.models import Apparatus, Surface, Uncertainty
from fingerpad.study.measuring.context import RunContext
from fingerpad.study.measuring.curves import curve_names
from fingerpad.study.measuring.run import StudyItems
from fingerpad.study.new_files import NewFile, named_file
from fingerpad.study.results.table import Row, records
from fingerpad.study.status import Missing, item_states, semi_axes_state
from fingerpad.web.answers import Answer, Axis, Quantity, Review, Status, review_of, semi_axes
from fingerpad.web.api.base import Opened, router
from fingerpad.web.events import RunStatus
from fingerpad.web.study_session import StudySession


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
    """Whether there are results, and whether they are those of the current study and program."""

    there: bool
    faults: list[str]
    report: bool
    finished: str | None
    fresh: bool
    other_program: bool


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


@router.get("/state")
def state_of(opened: Opened) -> State:
    """Return the state of a study; nothing is measured."""
    return _Known(opened).state()


class _Known:
    """What is known of a study, and what of that is said of each of its tables."""

    def __init__(self, opened: StudySession) -> None:
        self.opened, self.loaded = opened, opened.read()
        self.found, self.faults = opened.results_or_faults()
        self.active = opened.corrections.active_corrections()
        self.states = self._item_states()

    def _item_states(self) -> dict[str, str]:
        """Return the status of each item: done, failed, stale or left."""

        def states(store: Store | None) -> dict[str, str]:
            context = RunContext(
                study=self.loaded.study,
                folder=self.opened.folder,
                active_corrections=self.active,
                store=store,
            )
            return item_states(StudyItems(context))

        path = self.opened.out / STORE_NAME
        if path.is_file():
            # A run reports what is wrong with the store.
            with suppress(OSError, StoreError), Store.reading(path) as store:
                return states(store)
        return states(None)

    def state(self) -> State:
        opened, study, counts = self.opened, self.loaded.study, Counter(self.states.values())
        return State.of(
            study,
            name=opened.name,
            digest=self.loaded.digest,
            stated=sorted(study.uncertainty.model_fields_set),
            doubts=list(map(ended, study.doubts())),
            ready=not self.loaded.issues,
            missing=opened.missing(),
            scales=self.scales(),
            fingers=[self.finger(one) for one in self.tables("finger")],
            observations=self.observations(),
            sequences=[self.sequence(one) for one in self.tables("sequence")],
            curves=self.curves(),
            files=self.files(),
            flags=FLAGS,
            counts={name: counts[name] for name in ("done", "failed", "stale", "left")},
            run=opened.run_job.describe(),
            results=self.results(fresh=not counts["stale"] + counts["left"]),
        )

    def tables(self, kind: Kind) -> list[Table]:
        return [one for one in self.loaded.tables if one.kind == kind]

    def status(self, item: str) -> str:
        """Return the status of an item; rejected items are only that."""
        return "rejected" if is_rejected(self.active.get(item)) else self.states.get(item, "left")

    def of_table(self, table: Mapping[str, Any], *, complete: bool = True) -> dict[str, Any]:
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
            ScaleEntry.of(
                one, name=one.key, table=one.stated, words=scale_words(one.stated), used_by=uses[one.key]
            )
            for one in self.tables("scale")
        ]

    def finger(self, one: Table) -> FingerEntry:
        name, table = one.key, one.stated
        finger = self.opened.finger(name)
        record = self.found.summary.finger(name) if self.found else None
        known = self.opened.known_finger(name) if one.complete else None
        status = "left" if finger is None else semi_axes_state(finger, self.states, record)
        return FingerEntry.of(
            self.of_table(table, complete=one.complete),
            name=name,
            table=table,
            semi_axes_mm=known and semi_axes(known.semi_axes, np.sqrt(known.covariance.diagonal()), ""),
            effective_thickness_mm=Quantity.read(table.get, "effective_thickness_mm", ""),
            status=status,
            reason=record.reason if record and status == "failed" else None,
            photographs=[self.photograph(name, each) for each in table.get("photographs", [])],
        )

    def photograph(self, finger: str, table: Mapping[str, Any]) -> PhotographEntry:
        file = next((one for key in ("file", "outline") if isinstance(one := table.get(key), str)), None)
        item = f"{finger}/{file}"
        return PhotographEntry.of(
            self.of_table(table),
            **review_of(self.active.get(item)),
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

        def entry(one: Table) -> ObservationEntry:
            table, row = one.stated, seen.get(one.key, {})
            return ObservationEntry.of(
                self.of_table(table, complete=one.complete),
                **review_of(self.active.get(one.key)),
                item=one.key,
                status="given" if "ellipse_mm" in table else self.status(one.key),
                flags=(row.get("flags") or "").split(),
                reason=row.get("reason"),
            )

        return [entry(one) for one in self.tables("observation")]

    def sequence(self, one: Table) -> SequenceEntry:
        file = one.stated.get("file")
        return SequenceEntry.of(
            self.of_table(one.stated, complete=one.complete),
            name=one.key,
            status=self.states.get(one.key, "left"),
            frames=self.opened.count_frames(file) if isinstance(file, str) else None,
        )

    def curves(self) -> list[CurveEntry]:
        names = iter(curve_names(self.loaded.study))
        seen = self.found.summary.curves if self.found else []
        reasons = {(one.finger, one.wedge_angle_deg, one.file): one.reason for one in seen}

        def entry(one: Table) -> CurveEntry:
            table, item = one.stated, (next(names) if one.complete else None) or ""
            at: Any = tuple(map(table.get, ("finger", "wedge_angle_deg", "file")))
            return CurveEntry.of(
                self.of_table(table, complete=one.complete),
                key=one.key,
                loading_radius_mm=Quantity.read(table.get, "loading_radius_mm", ""),
                status=self.states.get(item, "given"),
                reason=reasons.get(at) if one.complete else None,
            )

        return [entry(one) for one in self.tables("curve")]

    def files(self) -> list[FileEntry]:
        unused = {one.key for one in self.opened.missing() if one.kind == "file"}
        folders = tuple(f"{one.key}/" for one in self.opened.missing() if one.kind == "folder")
        fingers = [finger.name for finger in self.loaded.study.fingers]

        def entry(name: str, size: int) -> FileEntry:
            kind, reading = kind_of_file(name), None
            if name in unused:
                if Path(name).suffix.lower() in TIFF_SUFFIXES and (self.opened.count_frames(name) or 1) > 1:
                    kind = "sequence"
                reading = named_file(name, kind, fingers)
            used = reading is None and not name.startswith(folders)
            return FileEntry.of(file=name, kind=kind, bytes=size, used=used, reading=reading)

        return [entry(name, size) for name, size in self.opened.files().items()]

    def results(self, *, fresh: bool) -> ResultsStatus:
        """Return whether there are results and a report; `fresh` tells whether all items are done."""
        made = self.found.summary.provenance if self.found else None
        has_report = (self.opened.out / REPORT_NAME).is_file()
        if made and fresh and has_report:
            sheet = self.loaded.study.observations_csv
            names = filter(None, (STUDY_NAME, sheet, CORRECTIONS_NAME, SECOND_OPERATOR_NAME))
            digests = {name: digest_of(self.opened.folder / name) for name in names}
            fresh = all(digest == made.inputs_sha256.get(name, "") for name, digest in digests.items())
        return ResultsStatus(
            there=made is not None,
            faults=self.faults,
            report=has_report,
            finished=made.made if made else None,
            fresh=bool(made and fresh and has_report),
            other_program=made is not None and made.measurement_versions != MEASUREMENT_VERSIONS,
        )
