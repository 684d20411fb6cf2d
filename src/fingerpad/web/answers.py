"""What the API answers: the models behind the OpenAPI document and the types of the page's scripts.

Every key is required, so that the page finds what the types promise; what may be missing is null. Lengths of
a picture are pairs (row, column) in pixels.
"""

from typing import Any, Final, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict

from fingerpad.study.corrections.history import Action
from fingerpad.study.editing.file_names import Kind as FileKind
from fingerpad.study.editing.file_names import Role
from fingerpad.study.manifest.check import Kind
from fingerpad.study.manifest.study import Uncertainty

Point: TypeAlias = tuple[float, float]
Point3D: TypeAlias = tuple[float, float, float]
MeasuredBy: TypeAlias = Literal["program", "program with corrections", "person"]
Status: TypeAlias = Literal["done", "failed", "stale", "left", "given", "rejected"]
Cell: TypeAlias = str | bool | int | float | None
Face: TypeAlias = Literal["palmar", "distal", "radial", "ulnar"]
Axis: TypeAlias = Literal["palmar", "distal", "radial_ulnar"]


class Answer(BaseModel):
    """An answer, or a part of one: no key is added or left out."""

    model_config = ConfigDict(extra="forbid", json_schema_serialization_defaults_required=True)


class Fault(BaseModel):
    """What is wrong with a request, and where."""

    place: str = ""
    words: str


class Refusal(Answer):
    """Why a request failed: `study` and `digest` where another window changed what it was about."""

    model_config = ConfigDict(extra="allow")

    error: str
    faults: list[Fault] = []
    study: str | None = None
    digest: str | None = None


# The session


class StudyName(Answer):
    """A study of the workspace; the title is null where its manifest cannot be read."""

    name: str
    title: str | None


class Limits(Answer):
    """What can be uploaded."""

    upload_bytes: int
    picture_memory_bytes: int


class Session(Answer):
    """What is open, what can be opened, and the address of Plotly's script."""

    version: str
    study: StudyName | None
    workspace: str
    studies: list[StudyName]
    who: str
    plotly: str
    limits: Limits


# The state of the study


class MissingEntry(Answer):
    """Something that the study lacks."""

    kind: Kind | Literal["file", "folder"]
    key: str
    words: str


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
    """A finger of the study."""

    name: str
    table: dict[str, Any]
    complete: bool
    synthetic: bool
    semi_axes_mm: SemiAxes | None
    semi_axes_mm_std: SemiAxes | None
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


class Descriptions(Answer):
    """Descriptions of flags, notes and columns by their codes."""

    flags: dict[str, str]
    photograph_flags: dict[str, str]
    range_notes: dict[str, str]
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
    """The state of a study."""

    name: str
    title: str
    description: str
    digest: str
    poisson_ratio: float
    uncertainty: Uncertainty
    taken_as_exact: list[str]
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
    time_s: float | None
    load_N: float | None  # noqa: N815
    pooled: bool


class Frames(Answer):
    """Some frames of a sequence, and how many there are."""

    total: int
    frames: list[FrameEntry]


# Files and pictures


class UploadedFile(Answer):
    """An uploaded file."""

    file: str
    kind: Literal["picture", "film", "table", "other"]
    bytes: int
    rows_px: int | None
    columns_px: int | None
    resolution_ppi: float | None
    frames: int | None
    columns: list[str] | None
    problem: str | None


class LeftOutFile(Answer):
    """A file that the ZIP does not hold, and why."""

    file: str
    why: str


class BundleContents(Answer):
    """What the ZIP of the study holds."""

    files: int
    bytes: int
    left_out: list[LeftOutFile]


class PictureInfo(Answer):
    """Size and depth of a picture, and the addresses of its previews."""

    item: str
    rows_px: int
    columns_px: int
    bits: int
    resolution_ppi: float | None
    preview: str
    thumbnail: str


# Measurements


class CoinOutline(Answer):
    """A coin found in a picture."""

    outline_px: list[Point]
    radius_px: float
    radius_px_std: float


class ScaleMeasurement(Answer):
    """The scale that a table gives."""

    mm_per_px: float
    mm_per_px_std: float
    relative_std: float
    resolution_ppi: float
    flags: list[str]
    coin: CoinOutline | None


class LengthMeasurement(Answer):
    """The length of a line."""

    length_mm: float
    length_mm_std: float


class ContactNumbers(Answer):
    """The numbers measured in a contact image."""

    semi_major_mm: float
    semi_major_mm_std: float | None
    semi_minor_mm: float
    semi_minor_mm_std: float | None
    orientation_deg: float
    gross_area_mm2: float
    gross_area_mm2_std: float | None
    ridge_area_mm2: float | None
    ridge_area_mm2_std: float | None
    ridge_period_mm: float | None
    ellipse_iou: float | None


class AutomaticContact(ContactNumbers):
    """The automatic measurement, to compare with a corrected one."""

    outline_px: list[Point]


class ContactEllipse(Answer):
    """A contact ellipse; the angle is that of the major axis from straight up."""

    centre: Point
    semi_axes: Point
    orientation_deg: float


class ContactHandles(Answer):
    """Where the handles of a contact ellipse are."""

    centre_px: Point
    major_ends_px: tuple[Point, Point]
    minor_ends_px: tuple[Point, Point]


class ContactSettings(Answer):
    """Settings of the measurement, chosen automatically unless they were corrected."""

    dark_on_light: bool
    threshold: float | None


class ContactModel(Answer):
    """What the contact model gives for a contact: keys as in ``results.csv``."""

    load_N: float  # noqa: N815
    u_deg: float | None
    mean_curvature_radius_mm: float | None
    mean_curvature_radius_mm_std: float | None
    radius_from_indentation_mm: float | None
    radius_from_indentation_mm_std: float | None
    radius_from_compliance_mm: float | None
    radius_from_compliance_mm_std: float | None
    indentation_mm: float | None
    indentation_mm_std: float | None
    youngs_modulus_kpa: float | None
    youngs_modulus_kpa_std: float | None
    effective_thickness_mm: float | None
    effective_thickness_mm_std: float | None
    youngs_modulus_on_layer_kpa: float | None
    youngs_modulus_on_layer_kpa_std: float | None
    indentation_on_layer_mm: float | None
    indentation_on_layer_mm_std: float | None
    loading_radius_on_layer_mm: float | None
    loading_radius_on_layer_mm_std: float | None
    layer_flag: str | None
    range_notes: list[str]


class ContactMeasurement(Answer):
    """A contact image measured under a correction."""

    item: str
    by: MeasuredBy
    outline_px: list[Point]
    ellipse_px: ContactEllipse
    handles: ContactHandles
    numbers: ContactNumbers
    program: AutomaticContact | None
    program_error: str | None
    model: ContactModel | None
    settings: ContactSettings
    flags: list[str]
    mm_per_px: float
    mm_per_px_std: float
    milliseconds: float


class FaceEllipse(Answer):
    """The ellipse of a face."""

    centre: Point
    semi_axes: Point
    lean_deg: float


class FaceHandles(Answer):
    """Where the handles of a face's ellipse are."""

    centre_px: Point
    across_end_px: Point
    along_end_px: Point


class FaceSemiAxes(Answer):
    """Semi-axes that a face gives, mm, with standard uncertainties."""

    semi_axes_mm: dict[Axis, float]
    semi_axes_mm_std: dict[Axis, float | None]


class FaceDifference(Answer):
    """By how much a face's semi-axes exceed those of all faces, relative to these; null where it has none."""

    item: str
    face: Face
    palmar: float | None
    distal: float | None
    radial_ulnar: float | None


class CombinedFaces(Answer):
    """The semi-axes that all faces of a finger give."""

    semi_axes_mm: SemiAxes
    semi_axes_mm_std: SemiAxes
    chi_square: float
    degrees_of_freedom: int
    p_value: float | None
    disagree: bool
    between_relative_std: float
    disagreements: list[FaceDifference]


class PhotographMeasurement(FaceSemiAxes):
    """A photograph measured under a correction."""

    item: str
    by: MeasuredBy
    face: Face
    axes: list[Axis]
    ellipse_px: FaceEllipse
    handles: FaceHandles
    points_px: list[Point]
    outliers_px: list[Point]
    arc_deg: float | None
    lean_deg: float | None
    flags: list[str]
    mm_per_px: float
    mm_per_px_std: float
    program: FaceSemiAxes | None
    finger: CombinedFaces | None
    finger_error: str | None
    milliseconds: float


# Corrections


class CorrectionRecord(Answer):
    """One record of the corrections."""

    id: int
    item: str
    when: str
    who: str
    action: Action
    change: dict[str, Any]
    picture: str


class Corrections(Answer):
    """The corrections of an item; `change` is the active one."""

    item: str
    last_id: int
    change: dict[str, Any]
    on_another_image: bool
    can_undo: bool
    can_redo: bool
    history: list[CorrectionRecord]


# Results


class Column(Answer):
    """A column of the results; `std` is the column of its standard uncertainty."""

    key: str
    words: str
    unit: str | None
    std: str | None


class Rows(Answer):
    """Some rows of the results."""

    total: int
    matching: int
    columns: list[Column]
    rows: list[dict[str, Cell]]


class RangeNote(Answer):
    """A limit of the model that some rows are beyond."""

    code: str
    words: str
    rows: int


class Group(Answer):
    """A finger at one placement."""

    finger: str
    wedge_angle_deg: float
    roll_angle_deg: float
    synthetic: bool


class PlottedRows(Answer):
    """The columns that are plotted."""

    item: list[str]
    load_N: list[float | None]  # noqa: N815
    radius_from_indentation_mm: list[float | None]
    radius_from_indentation_mm_std: list[float | None]
    radius_from_indentation_mm_fixed_geometry_std: list[float | None]
    radius_from_compliance_mm: list[float | None]
    gross_area_mm2: list[float | None]
    gross_area_mm2_std: list[float | None]
    aspect_ratio: list[float | None]
    indentation_mm: list[float | None]
    indentation_mm_std: list[float | None]
    youngs_modulus_kpa: list[float | None]
    youngs_modulus_kpa_std: list[float | None]
    indentation_on_layer_mm: list[float | None]
    indentation_on_layer_mm_std: list[float | None]
    youngs_modulus_on_layer_kpa: list[float | None]
    youngs_modulus_on_layer_kpa_std: list[float | None]
    pooled: list[bool]


class PlottedGroup(Group):
    """A finger at one placement: pooled values, and the rows to plot."""

    radius_from_indentation_mm: float | None
    radius_from_indentation_mm_std: float | None
    mean_curvature_radius_mm: float | None
    mean_curvature_radius_mm_std: float | None
    loading_radius_mm: float | None
    loading_radius_mm_std: float | None
    rows: PlottedRows
    range_notes: list[RangeNote]


class Plot(Answer):
    """What to plot."""

    groups: list[PlottedGroup]


class BudgetCheck(Answer):
    """Uncertainty of the highest-load contact: first-order shares, and Sobol's total indices."""

    observation: str
    value: float
    std: float
    valid: bool
    shares: dict[str, float | None]
    total: dict[str, float | None]


class BudgetGroup(Group):
    """The uncertainty budget of a finger at one placement."""

    pooled: dict[str, float | None] | None
    check: BudgetCheck | None


class Budget(Answer):
    """The uncertainty budgets."""

    groups: list[BudgetGroup]


class Figure(Answer):
    """A figure of the report, and the addresses of its files."""

    name: str
    caption: str
    svg: str
    png: str


class Figures(Answer):
    """The figures of the report."""

    figures: list[Figure]


class AuditedNumber(Answer):
    """A number printed by Dzidek et al. (2017), and what the equations give."""

    item: str
    printed: float
    unit: str
    verdict: str
    computed: float | None
    low: float | None
    high: float | None
    with_misprint: float | None
    formula: str
    remark: str


class Audit(Answer):
    """The audit of the printed numbers."""

    items: list[AuditedNumber]


# The pad in three dimensions


class Mesh(Answer):
    """A grid of points, mm."""

    x_mm: list[list[float]]
    y_mm: list[list[float]]
    z_mm: list[list[float]]


class NamedLine(Answer):
    """A line to draw, mm."""

    name: str
    points_mm: list[Point3D]


class Platen(Answer):
    """The corners of the platen, mm."""

    corners_mm: list[Point3D]


class Wedge(Answer):
    """The wedge as a solid of triangles, mm."""

    vertices_mm: list[Point3D]
    faces: list[tuple[int, int, int]]


class SurfacePoint(Answer):
    """A point of the midline at the parametric angle u."""

    u_deg: float
    point_mm: Point3D


class PadGeometry(Answer):
    """A pad on its wedge: place of contact, curvature, and what to draw."""

    u_deg: float
    u_deg_std: float | None
    v_deg: float
    in_plane_radius_mm: float | None
    in_plane_radius_mm_std: float | None
    transverse_radius_mm: float | None
    transverse_radius_mm_std: float | None
    mean_curvature_radius_mm: float | None
    mean_curvature_radius_mm_std: float | None
    geometric_mean_radius_mm: float | None
    geometric_mean_radius_mm_std: float | None
    contact_point_mm: Point3D
    normal: Point3D
    principal_directions: tuple[Point3D, Point3D]
    mesh: Mesh
    lines: list[NamedLine]
    platen: Platen
    wedge: Wedge
    points: list[SurfacePoint]


# Events


class StudyEvent(Answer):
    """Event ``study``: the manifest has changed."""

    digest: str


class SessionEvent(Answer):
    """Event ``session``: another study is open, or none."""

    study: str | None


class CorrectionsEvent(Answer):
    """Event ``corrections``: an item was corrected."""

    item: str
    last_id: int


EVENTS: Final[dict[str, type[Answer]]] = {
    "study": StudyEvent,
    "session": SessionEvent,
    "corrections": CorrectionsEvent,
    "run": RunStatus,
}
