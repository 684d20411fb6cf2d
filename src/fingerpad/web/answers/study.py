"""The session, and the state of the open study."""

from typing import Any, Final, Literal

from fingerpad.study.imports.names import FileKind, Role
from fingerpad.study.manifest.load import Kind
from fingerpad.study.manifest.models import Apparatus, Surface, Uncertainty
from fingerpad.study.results.summary_file import OperatorAgreementRecord
from fingerpad.web.answers.base import Answer, Face, Status


class StudyName(Answer):
    """A study of the workspace; the title is null where its manifest cannot be read."""

    name: str
    title: str | None


class Limits(Answer):
    """What can be uploaded."""

    upload_bytes: int
    picture_memory_bytes: int


class SymbolMeaning(Answer):
    """What a symbol means, its unit, and the column of ``results.csv`` that holds it."""

    name: str
    meaning: str
    unit: str
    column: str


class Session(Answer):
    """What is open, what can be opened, the meaning of symbols, and the address of Plotly's script."""

    version: str
    study: StudyName | None
    workspace: str
    studies: list[StudyName]
    who: str
    plotly: str
    limits: Limits
    glossary: dict[str, SymbolMeaning]


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
    used_by: int
    complete: bool


class SemiAxes(Answer):
    """Semi-axes of a pad, or their standard uncertainties, mm."""

    palmar: float
    distal: float
    radial_ulnar: float


class PhotographEntry(Review):
    """A photograph or an outline of a finger's face."""

    item: str
    file: str | None
    outline: bool
    status: Status
    face: Face | None
    scale: str | dict[str, Any] | None
    tip: str | None
    palmar_side: str | None
    synthetic: bool


class FingerEntry(Answer):
    """A finger of the study; `status` and `reason` are of its semi-axes."""

    name: str
    table: dict[str, Any]
    complete: bool
    synthetic: bool
    semi_axes_mm: SemiAxes | None
    semi_axes_mm_std: SemiAxes | None
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


class CurveEntry(Answer):
    """A loading curve, or a radius from loading data."""

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
    """What the name of a file says; null where it says nothing or could mean two things."""

    role: Role | None
    finger: str | None
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


class RunStatus(Answer):
    """Progress of a run; `version` rises with each change."""

    state: Literal["idle", "running", "cancelling", "done", "cancelled", "failed"]
    phase: Literal["measuring", "tables", "report"] | None
    total: int
    done: int
    failed: int
    current: str
    file: str
    seconds: float
    seconds_left: float | None
    error: str | None
    failures: list[str]
    version: int


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


class PhaseStart(Answer):
    """A phase of a press, and the time on the force's clock after which it begins."""

    phase: Literal["before", "loading", "hold", "unloading", "after"]
    start_s: float


class SequenceSignal(Answer):
    """Force of a sequence over time, thinned for drawing, and how well displaced frames agree with it.

    `phases` are those found from the force; what a person set is the correction of ``SEQUENCE#phases``.

    `time_s` and `load_N` are the extremes in some thousand steps of time. `area_scatter` is the relative
    scatter of the areas of the last run about a power law of the load, with all frames later by `shift_s`.
    `start_s` is the time of frame 0 on the force's clock, None where each frame has a time of its own or no
    run has measured them.
    """

    time_s: list[float]
    load_N: list[float]  # noqa: N815
    phases: list[PhaseStart]
    start_s: float | None
    shift_s: list[float]
    area_scatter: list[float | None]


class Frames(Answer):
    """Some frames of a sequence, and how many there are."""

    total: int
    frames: list[FrameEntry]


class SecondOperatorImage(Review):
    """An image, and the second operator's review of it."""

    item: str


class SecondOperator(Answer):
    """Images that the first operator looked at, in random order, and how the second agrees.

    `unseen` are those that the first has not looked at yet.
    """

    first_operators: list[str]
    images: list[SecondOperatorImage]
    unseen: int
    agreement: list[OperatorAgreementRecord]


class StudyEvent(Answer):
    """Event ``study``: the manifest has changed."""

    digest: str


class CorrectionsEvent(Answer):
    """Event ``corrections``: an item was corrected."""

    item: str
    last_id: int


# Server-sent events by their names.
EVENTS: Final[dict[str, type[Answer]]] = {
    "study": StudyEvent,
    "corrections": CorrectionsEvent,
    "run": RunStatus,
}
