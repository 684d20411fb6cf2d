"""Measurements, and the corrections of them."""

from typing import Any

from fingerpad.study.corrections.items import Action
from fingerpad.web.answers.base import Answer, Axis, Face, MeasuredBy, Point, PoolingCorrectionRecord
from fingerpad.web.answers.study import SemiAxes


class CoinOutline(Answer):
    """A coin found in a picture."""

    outline_px: list[Point]
    radius_px: float
    radius_px_std: float


class GridMeasurement(Answer):
    """A grid found in a picture, how far it is from flat, and the scale of rectified pictures."""

    points_px: list[Point]
    residual_px: float
    anisotropy: float
    variation: float
    unevenness: float
    rectified_mm_per_px: float
    rectified_relative_std: float


class ScaleMeasurement(Answer):
    """The scale that a table gives."""

    mm_per_px: float
    mm_per_px_std: float
    relative_std: float
    resolution_ppi: float
    flags: list[str]
    coin: CoinOutline | None
    grid: GridMeasurement | None


class RectifiedPictures(Answer):
    """Files of rectified pictures, by those that they were made of, and the scale of all of them."""

    files: dict[str, str]
    mm_per_px: float
    relative_std: float


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


class ContactEllipsePx(Answer):
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
    """What the contact model gives for a contact: keys as in ``results.csv``.

    Of the last run are `verdicts`, by key, and the model's part of a ``_total_std``.
    """

    load_N: float  # noqa: N815
    u_deg: float | None
    mean_curvature_radius_mm: float | None
    mean_curvature_radius_mm_std: float | None
    radius_from_indentation_mm: float | None
    radius_from_indentation_mm_total_std: float | None
    radius_from_compliance_mm: float | None
    radius_from_compliance_mm_std: float | None
    indentation_mm: float | None
    indentation_mm_total_std: float | None
    youngs_modulus_kpa: float | None
    youngs_modulus_kpa_total_std: float | None
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
    verdicts: dict[str, str]


class ContactPooling(Answer):
    """Whether a contact will be pooled: the flags against it, and its manual correction."""

    pooled: bool
    excluding_flags: list[str]
    correction: PoolingCorrectionRecord | None


class ContactMeasurement(Answer):
    """A contact image measured under a correction."""

    item: str
    by: MeasuredBy
    outline_px: list[Point]
    ellipse_px: ContactEllipsePx
    handles: ContactHandles
    numbers: ContactNumbers
    automatic: AutomaticContact | None
    automatic_error: str | None
    model: ContactModel | None
    settings: ContactSettings
    flags: list[str]
    pooling: ContactPooling | None
    mm_per_px: float
    mm_per_px_std: float
    milliseconds: float


class ContactLevels(Answer):
    """How many pixels have which level: grey levels from the background towards contact."""

    counts: list[float]
    edges: list[float]
    automatic_threshold: float | None


class FaceEllipse(Answer):
    """The ellipse of a face."""

    centre: Point
    semi_axes: Point
    tilt_deg: float


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


class SideRadius(Answer):
    """Radii of curvature of a side face where a wedge touches: of the outline itself, and of the ellipse."""

    wedge_angle_deg: float
    outline_mm: float
    outline_mm_std: float
    ellipse_mm: float


class PhotographMeasurement(FaceSemiAxes):
    """A photograph measured under a correction; its uncertainty is by term and axis."""

    item: str
    by: MeasuredBy
    face: Face
    axes: list[Axis]
    ellipse_px: FaceEllipse
    handles: FaceHandles
    points_px: list[Point]
    outliers_px: list[Point]
    uncertainty_mm_std: dict[str, dict[Axis, float]]
    arc_deg: float | None
    exponent: float | None
    exponent_std: float | None
    radii: list[SideRadius]
    tilt_deg: float | None
    flags: list[str]
    mm_per_px: float
    mm_per_px_std: float
    automatic: FaceSemiAxes | None
    finger: CombinedFaces | None
    finger_error: str | None
    milliseconds: float


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


class SimilarImage(Answer):
    """Another image of the same finger and device: its correction, and what it would become."""

    item: str
    last_id: int
    change: dict[str, Any]
    proposed: dict[str, Any]
    differs: bool


class SimilarImages(Answer):
    """The settings of an image's correction, and the images that they may apply to."""

    item: str
    settings: dict[str, Any]
    images: list[SimilarImage]
