"""Results of a run, and the pad in three dimensions."""

from typing import Literal

from fingerpad.study.results.summary_file import UncertaintyCheckRecord, ValidityRecord
from fingerpad.web.answers.base import Answer, Cell, Point3D, PoolingCorrectionRecord
from fingerpad.web.answers.study import SemiAxes


class Column(Answer):
    """A column of the results; `std` is that of its standard uncertainty, the model's part in it."""

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
    to_do: str
    rows: int


class Group(Answer):
    """A finger at one placement; `figure` begins the names of its figures in the report."""

    finger: str
    wedge_angle_deg: float
    roll_angle_deg: float
    synthetic: bool
    figure: str


class PlottedRows(Answer):
    """The columns that are plotted."""

    item: list[str]
    load_N: list[float | None]  # noqa: N815
    radius_from_indentation_mm: list[float | None]
    radius_from_indentation_mm_total_std: list[float | None]
    radius_from_indentation_mm_fixed_geometry_std: list[float | None]
    radius_from_compliance_mm: list[float | None]
    gross_area_mm2: list[float | None]
    gross_area_mm2_std: list[float | None]
    aspect_ratio: list[float | None]
    indentation_mm: list[float | None]
    indentation_mm_total_std: list[float | None]
    youngs_modulus_kpa: list[float | None]
    youngs_modulus_kpa_total_std: list[float | None]
    indentation_on_layer_mm: list[float | None]
    indentation_on_layer_mm_std: list[float | None]
    youngs_modulus_on_layer_kpa: list[float | None]
    youngs_modulus_on_layer_kpa_std: list[float | None]
    pooled: list[bool]


class PooledContact(Answer):
    """A contact that is left out of the pooled radius, or about which a person or a flag has a say.

    `pooled` and `why` are of the last run; `correction` is what is wanted now.
    """

    item: str
    load_N: float | None  # noqa: N815
    pooled: bool
    why: str
    correction: PoolingCorrectionRecord | None


class Pooling(Answer):
    """How many contacts and frames of a group count in its pooled radius, and the contacts in question.

    `contacts` is the number of measured and rejected ones.
    """

    contacts: int
    contacts_pooled: int
    contacts_rejected: int
    frames: int
    frames_pooled: int
    in_question: list[PooledContact]


class PlottedGroup(Group):
    """A finger at one placement: pooled values, and the rows to plot."""

    radius_from_indentation_mm: float | None
    mean_curvature_radius_mm: float | None
    mean_curvature_radius_mm_std: float | None
    loading_radius_mm: float | None
    loading_radius_mm_std: float | None
    rows: PlottedRows
    range_notes: list[RangeNote]
    validity: ValidityRecord
    pooling: Pooling


class Plot(Answer):
    """What to plot."""

    groups: list[PlottedGroup]


class BudgetGroup(Group):
    """The uncertainty budget of a finger at one placement."""

    pooled: dict[str, float | None] | None
    check: UncertaintyCheckRecord | None


class Budget(Answer):
    """The uncertainty budgets."""

    groups: list[BudgetGroup]


class Figure(Answer):
    """A figure of the report, and the addresses of its files."""

    name: str
    caption: str
    svg: str
    png: str | None
    settable: bool


class FigureAxis(Answer):
    """An axis of a figure; it can be set where all panels show one quantity on it."""

    axis: Literal["x", "y"]
    name: str
    scale: Literal["linear", "log"]
    settable: bool


class FigureDetails(Answer):
    """What can be set of a figure, as it is in the report."""

    name: str
    width_mm: float
    height_mm: float
    colours: list[str]
    axes: list[FigureAxis]


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
    """A pad on its wedge: semi-axes, place of contact, curvature, and what to draw."""

    semi_axes_mm: SemiAxes
    semi_axes_mm_std: SemiAxes | None
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
