"""The content of ``summary.json``: written by a run, read by the page, by comparisons and by users."""

import csv
import math
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, NamedTuple, Self, TypeAlias

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainSerializer,
    ValidationError,
    create_model,
    model_validator,
)

from fingerpad._csv import package_table
from fingerpad.exceptions import FingerpadError
from fingerpad.study.results.result_set import RERUN


def _nan(value: object) -> object:
    return math.nan if value is None or (isinstance(value, float) and math.isinf(value)) else value


def _null(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _plausible(value: float) -> float:
    if not math.isnan(value) and not 1e-9 <= value <= 1000:
        raise ValueError(f"{value:g} mm is no semi-axis of a finger")
    return value


# What is not known is null in the file, and NaN or an empty text here.
Number: TypeAlias = Annotated[float, BeforeValidator(_nan), PlainSerializer(_null, float | None)]
Text: TypeAlias = Annotated[
    str, BeforeValidator(lambda text: text or ""), PlainSerializer(lambda text: text or None, str | None)
]
SemiAxis: TypeAlias = Annotated[Number, AfterValidator(_plausible)]
Interval: TypeAlias = tuple[Number, Number]
Triple: TypeAlias = tuple[Number, Number, Number]
Shares: TypeAlias = dict[str, Number]
PlacementKey: TypeAlias = tuple[Any, ...]

# What a key tells of the one that it begins with, where it has no description of its own.
_COMPANIONS: Final = {
    line["end"]: line["tells"] for line in package_table("fingerpad.study.results", "companions.csv")
}
_UNIT: Final = re.compile(r"_(?:mm_per_s|mm2?|kpa|N|deg)(?=_|$)")
_MISSING: Final = object()
_UNITS: Final = {"_mm": ", mm", "_mm2": ", mm²", "_kpa": ", kPa", "_kpa_per_N": ", kPa/N"}


def _describe(schema: dict[str, Any]) -> None:
    """Describe keys that tell something of another by their ends."""
    for name, key in schema["properties"].items():
        end = next((end for end in _COMPANIONS if name.endswith(end)), None)
        if "description" not in key and end is not None:
            of = name.removesuffix(end)
            unit = next((unit for ends, unit in _UNITS.items() if of.endswith(ends)), "")
            unit = unit if "_std" in end or "_ci95" in end else ""
            key["description"] = f"{_COMPANIONS[end]} `{of}`{unit}."


class Record(BaseModel):
    """A part of ``summary.json``; keys of another version are passed over."""

    model_config = ConfigDict(frozen=True, from_attributes=True, json_schema_extra=_describe)

    @classmethod
    def of(cls, *sources: object, **given: Any) -> Self:
        """Return a record of the attributes that objects have under the names of its keys, or without units.

        What is given by name is taken first, then the first source that has it; keys that may be left out are
        given by name alone. Where a source is None, what no other has is not known.
        """
        for name, key in cls.model_fields.items():
            attributes = (name, _UNIT.sub("", name))
            found = (getattr(of, each) for of in sources for each in attributes if hasattr(of, each))
            if key.is_required() and name not in given:
                value = next(found, None if any(of is None for of in sources) else _MISSING)
                given |= {} if value is _MISSING else {name: value}
        return cls.model_validate(given)


class Family(NamedTuple):
    """Ends of the keys that tell more of a quantity: after its name, and after its name without the unit."""

    ends: tuple[str, ...] = ("_std",)
    bare: tuple[str, ...] = ()
    optional: bool = False  # whether they are left out where the quantity is not known


# Of geometric means over the contacts under one load: the uncertainty and its parts.
AT_LOAD: Final = (
    *("_std", "_ci95_low", "_ci95_high"),
    *(f"_{part}_std" for part in ("noise", "repeatability", "session", "edge", "other")),
)
_POOLED: Final = (
    *("_count", "_effective_count", "_largest_weight", "_birge_ratio"),
    *("_same_for_all_mm", "_same_for_all_mm_std", "_between_std_mm"),
    *("_scatter_within_loads_mm", "_scatter_between_loads_mm", "_variance_shares"),
)
WithStd = Annotated[Number, Family()]
Fitted = Annotated[Number, Family(("_std", "_ci95"))]
OnLayer = Annotated[Number, Family(bare=("_variance_shares",))]
PooledOnLayer = Annotated[Number, Family(bare=("_variance_shares", "_birge_ratio", "_count"))]
Pooled = Annotated[Number, Family(("_std", "_fixed_geometry_std", "_ci95"), _POOLED, optional=True)]
AtLoad = Annotated[Number, Family(AT_LOAD)]
ModelledAtLoad = Annotated[Number, Family((*AT_LOAD, "_model_std"))]
# What keys hold that are no numbers, and what a record has in place of one that is left out.
_HOLDS: Final[Mapping[str, tuple[Any, Any]]] = {
    "_ci95": (Interval | None, None),
    "_variance_shares": (Shares | None, None),
    "_count": (int, ...),
}


class Quantities(Record):
    """A record to which `with_families` adds keys."""

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...


def with_families(record: type[Quantities]) -> Any:
    """Return a record in which each quantity is followed by the keys of its family."""
    keys: dict[str, Any] = {}
    for name in record.__annotations__:
        field, bare = record.model_fields[name], _UNIT.sub("", name)
        keys[name] = field.annotation, field
        for family in (one for one in field.metadata if isinstance(one, Family)):
            for of, end in (*((name, end) for end in family.ends), *((bare, end) for end in family.bare)):
                holds, default = _HOLDS.get(end, (Number, math.nan))
                keys[of + end] = holds, default if family.optional else ...
    keys |= {"__base__": record.__bases__, "__module__": record.__module__, "__doc__": record.__doc__}
    return create_model(record.__name__, **keys)


class Placed(Record):
    """A finger at one placement."""

    finger: str = Field(description="The finger.")
    wedge_angle_deg: float = Field(description="Angle of the wedge, degrees.")
    roll_angle_deg: float = Field(description="Roll of the finger, degrees.")
    synthetic: bool = Field(description="Whether anything of it was rendered or simulated.")

    @property
    def key(self) -> PlacementKey:
        """The values of `PLACEMENT`."""
        return self.finger, self.wedge_angle_deg, self.roll_angle_deg, self.synthetic


# What the rows of one summary have in common.
PLACEMENT: Final = tuple(Placed.model_fields)


class FaceRecord(Record):
    """What one face alone says of a finger's semi-axes; it shows two of them."""

    face: str = Field(description="The face.")
    palmar_mm: Number = Field(default=math.nan, description="Palmar semi-axis, mm.")
    distal_mm: Number = Field(default=math.nan, description="Distal semi-axis, mm.")
    radial_ulnar_mm: Number = Field(default=math.nan, description="Radial–ulnar semi-axis, mm.")
    palmar_relative_difference: Number = math.nan
    distal_relative_difference: Number = math.nan
    radial_ulnar_relative_difference: Number = math.nan
    flags: list[str] = Field(description="Doubts.")


class PhotographRecord(Record):
    """A photograph of a finger."""

    face: str = Field(description="The face.")
    file: str = Field(description="The image file.")
    uncertainty_mm_std: dict[str, Shares] = Field(
        description="Standard uncertainty of each semi-axis, mm, by term."
    )
    arc_deg: Number = Field(description="Extent of the arc used, parametric degrees.")
    exponent: Number = Field(description="Exponent of the superellipse that follows the pad best.")
    exponent_std: Number
    outline_radii_deg_mm: list[Triple] = Field(
        description="Of a side face: angle of a wedge, degrees, and at its place the outline's radius of "
        "curvature with its standard uncertainty, mm."
    )
    flags: list[str] = Field(description="Doubts.")


class FingerRecord(Record):
    """A finger's semi-axes."""

    finger: str = Field(description="Its name.")
    person: str | None = Field(description="Whose it is.")
    digit: str | None = Field(default=None, description="Which of theirs, where it is not its name.")
    source: str = Field(description="`given`, `photographs`, or `none` without semi-axes.")
    synthetic: bool = Field(description="Whether anything of it was rendered or simulated.")
    palmar_mm: SemiAxis = Field(description="Palmar semi-axis, mm.")
    distal_mm: SemiAxis = Field(description="Distal semi-axis, mm.")
    radial_ulnar_mm: SemiAxis = Field(description="Radial–ulnar semi-axis, mm.")
    covariance_mm2: tuple[Triple, Triple, Triple] = Field(description="Covariance of the three, mm².")
    scale: str | None = Field(description="Scale that all its photographs share.")
    chi_square: Number = Field(description="Disagreement of the faces.")
    degrees_of_freedom: int | None = Field(description="Of `chi_square`.")
    p_value: Number = Field(description="Chance of a larger `chi_square`.")
    between_faces_relative_std: Number = Field(
        description="Standard deviation between faces, relative, in the covariance."
    )
    faces: list[FaceRecord] | None = Field(description="What each face says; null without any.")
    photographs: list[PhotographRecord] = Field(description="Its photographs.")
    reason: str | None = Field(description="Why there are no semi-axes.")

    @property
    def semi_axes_mm(self) -> tuple[float, float, float]:
        """Palmar, distal and radial–ulnar semi-axis, mm."""
        return self.palmar_mm, self.distal_mm, self.radial_ulnar_mm

    @model_validator(mode="after")
    def _whole(self) -> Self:
        axes, covariance = self.semi_axes_mm, self.covariance_mm2
        unknown = any(map(math.isnan, (*axes, *(entry for row in covariance for entry in row))))
        if unknown and not all(map(math.isnan, axes)):
            raise ValueError("semi-axes and covariance_mm2 belong together")
        if any(covariance[place][place] < 0 for place in range(3)):
            raise ValueError("covariance_mm2 must not be negative on its diagonal")
        return self


@with_families
class HighestLoadOnLayer(Quantities):
    """The contact at the highest load in the range of the laws, by Hertz theory and on the layer."""

    observation: str = Field(description="The contact.")
    load_N: Number = Field(description="Its load, N.")
    layer_flag: Text = Field(description="What takes it out of the range of the laws.")
    youngs_modulus_on_layer_kpa: OnLayer = Field(description="Young's modulus on the layer, kPa.")
    indentation_on_layer_mm: OnLayer = Field(description="Indentation on the layer, mm.")
    loading_radius_on_layer_mm: OnLayer = Field(description="A/(πξ) on the layer, mm.")
    youngs_modulus_kpa: OnLayer = Field(description="Young's modulus by Hertz theory, kPa.")
    indentation_mm: OnLayer = Field(description="Indentation by Hertz theory, mm.")
    geometric_radius_from_compliance_mm: OnLayer = Field(description="A/(πξ) by Hertz theory, mm.")


@with_families
class PooledOnLayerRecord(Quantities):
    """All contacts that count and are in the range of the laws, pooled."""

    youngs_modulus_kpa: PooledOnLayer = Field(description="Young's modulus by Hertz theory, kPa.")
    youngs_modulus_on_layer_kpa: PooledOnLayer = Field(description="Young's modulus on the layer, kPa.")
    loading_radius_on_layer_mm: PooledOnLayer = Field(description="A/(πξ) on the layer, mm.")


class OnLayerRecord(Record):
    """A finger at a placement on its layer of tissue over bone."""

    effective_thickness_mm: Number = Field(description="Effective thickness of the tissue, as stated, mm.")
    effective_thickness_mm_std: Number
    highest_load: HighestLoadOnLayer = Field(description="One contact.")
    pooled: PooledOnLayerRecord = Field(description="All contacts.")


class UncertaintyCheckRecord(Record):
    """The corrected radius of the contact at the highest load, by first order and by Monte Carlo."""

    observation: str = Field(description="The contact.")
    value: float = Field(description="Corrected radius, mm.")
    std: float = Field(description="Its first-order standard uncertainty, mm.")
    interval: Interval = Field(description="Its first-order 95 % interval, mm.")
    simulated_std: Number = Field(description="Standard uncertainty by Monte Carlo, mm.")
    simulated_interval: Interval = Field(description="95 % interval by Monte Carlo, mm.")
    draws: int = Field(description="Number of draws.")
    converged: bool = Field(description="Whether two digits of the standard uncertainty have converged.")
    valid: bool = Field(description="Whether both intervals agree to one digit of the standard uncertainty.")
    shares: Shares = Field(description="Share of each source in the variance, of first order.")
    total: Shares = Field(description="Sobol's total index of each source.")


class HeadlineRecord(Record):
    """A result with its uncertainty from what was measured and from the model."""

    verdict: str = Field(description="`holds`, `strained`, `fails` or `not tested`.")
    value: Number = Field(description="In the unit that its name says.")
    value_std: Number = Field(description="Standard uncertainty from what was measured, in that unit.")
    model_std: Number = Field(description="Standard uncertainty from the model's discrepancy, in that unit.")
    total_std: Number = Field(description="Standard uncertainty from both, in that unit.")
    model_relative_std: Number = Field(description="`model_std`, relative to the value.")
    model_from: str = Field(description="What the model's part was estimated from, or why it was not.")


class CheckRecord(Record):
    """A check of the model."""

    check: str = Field(description="Its name.")
    compared: str = Field(description="What is compared, in words.")
    headlines: tuple[str, ...] = Field(description="Results that it concerns.")
    verdict: str = Field(default="not tested", description="`holds`, `strained`, `fails` or `not tested`.")
    unit: Text = Field(
        default="", description="Unit of value, reference and difference; null for pure numbers."
    )
    value: Number = Field(default=math.nan, description="What the model gives.")
    value_std: Number = math.nan
    reference: Number = Field(default=math.nan, description="What it is compared with.")
    reference_std: Number = math.nan
    difference: Number = Field(default=math.nan, description="Value less reference.")
    relative_difference: Number = Field(
        default=math.nan, description="Size of the difference, relative, signed."
    )
    difference_of: Text = Field(default="", description="Of which result that is; null for what is compared.")
    deviations: Number = Field(default=math.nan, description="The difference over its standard uncertainty.")
    p_value: Number = Field(default=math.nan, description="Chance of a larger difference if the model held.")
    note: Text = Field(default="", description="What was assumed, or why there is no verdict.")


class LayerValidityRecord(Record):
    """Whether the layer of tissue over bone holds as a model."""

    verdict: str = Field(description="The worst of the checks.")
    checks: list[CheckRecord] = Field(description="All checks.")


class ValidityRecord(Record):
    """Whether Hertz theory holds for a finger at a placement."""

    model: str = Field(description="The model.")
    verdict: str = Field(description="The worst of the checks.")
    observation: Text = Field(description="Contact at the highest load, of which E and indentation are.")
    load_N: Number = Field(description="Its load, N.")
    headlines: dict[str, HeadlineRecord] = Field(description="Results by column.")
    checks: list[CheckRecord] = Field(description="All checks, also those without data.")
    on_layer: LayerValidityRecord | None = Field(description="The same of the layer; null without one.")


@with_families
class PlacementRecord(Quantities, Placed):
    """A finger at one placement; without a sound contact keys of pooled values are left out."""

    count: int = Field(description="Number of contacts, without frames.")
    frames: int = Field(description="Number of frames of sequences.")
    mean_curvature_radius_mm: WithStd = Field(description="Radius of the undeformed pad, 1/H, mm.")
    geometric_mean_radius_mm: WithStd = Field(description="√(R′R″) of the undeformed pad, mm.")
    radius_from_indentation_mm: Pooled = Field(description="Corrected radius, pooled, mm.")
    radius_from_compliance_mm: Pooled = Field(description="Radius to compare with R_g, pooled, mm.")
    on_layer: OnLayerRecord | None = Field(description="On its layer of tissue; null without a thickness.")
    loading_radius_mm: WithStd = Field(description="R_g from its loading curves, mm.")
    highest_load_N: Number = Field(description="Highest load of its contacts, or frames, that count, N.")
    highest_area_mm2: WithStd = Field(
        description="Area of one contact there, mm², uncertain by its own image; `by_load` has means."
    )
    area_exponent: WithStd = Field(description="n of A ∝ Wⁿ over its contacts.")
    area_exponent_ci95: Interval | None = None
    uncertainty_check: UncertaintyCheckRecord | None = Field(description="Of one contact.")
    radius_from_indentation_mm_model_std: Number
    radius_from_indentation_mm_total_std: Number
    radius_from_indentation_mm_verdict: str
    validity: ValidityRecord = Field(description="Whether Hertz theory holds.")


class ContactRepeatabilityRecord(Record):
    """By how much the ellipses of repeats scatter beyond the noise of their images."""

    synthetic: bool = Field(description="Whether it is of rendered contacts.")
    contact_area_log_std: Number = Field(description="Relative standard deviation of the area.")
    aspect_ratio_log_std: Number = Field(description="Relative standard deviation of the aspect ratio.")
    log_radius_and_elongation_covariance: tuple[Interval, Interval] | None = Field(
        description="Covariance of ln √(ℓd ℓe) and ln(ℓd/ℓe)."
    )
    degrees_of_freedom: int = Field(description="From which it is known.")
    groups: int = Field(description="Number of contacts that were repeated.")
    count: int = Field(description="Number of their repeats in all.")
    missing: Text = Field(description="Why it is not known.")


class ScatterLevelRecord(Record):
    """Scatter of a quantity at one level."""

    quantity: str = Field(description="The quantity.")
    synthetic: bool = Field(description="Whether it is of rendered contacts.")
    level: str = Field(description="`person`, `finger`, `session` or `repeat`.")
    log_std: Number = Field(description="Standard deviation of the logarithm.")
    log_std_ci95_low: Number
    log_std_ci95_high: Number
    log_limit_of_agreement: Number = Field(
        description="Limit of agreement of two contacts that differ at this level and all below."
    )
    degrees_of_freedom: int = Field(description="Degrees of freedom.")
    groups: int = Field(description="Number of groups with several members.")
    count: int = Field(description="Number of their members.")
    includes: str = Field(description="Levels that cannot be separated from this one.")
    missing: str = Field(description="Why it is not known.")


class ScatterRecord(Record):
    """How a quantity scatters over a study's contacts."""

    quantity: str = Field(description="The quantity.")
    synthetic: bool = Field(description="Whether it is of rendered contacts.")
    icc: Number = Field(description="Intraclass correlation coefficient.")
    icc_ci95: Interval
    levels: list[ScatterLevelRecord] = Field(description="By level.")


class RepeatabilityRecord(Record):
    """How repeats scatter."""

    contact: list[ContactRepeatabilityRecord] = Field(description="Of real and of synthetic contacts.")
    scatter: list[ScatterRecord] = Field(description="By quantity.")


class AgreementRecord(Record):
    """Relative differences of the second of two persons from the first; null for too few pairs."""

    count: int = Field(description="Number of pairs.")
    bias: Number = Field(description="Mean difference.")
    bias_interval: Interval = Field(description="Its 95 % interval.")
    std: Number = Field(description="Standard deviation of the differences.")
    limits: Interval = Field(description="Limits of agreement: 95 % of differences lie between them.")
    limits_interval: Interval = Field(description="Outer ends of the 95 % intervals of both limits.")


class OperatorAgreementRecord(Record):
    """How two persons agree on the outlines of real or of synthetic images."""

    synthetic: bool = Field(description="Whether the images were rendered.")
    first_operators: list[str] = Field(description="Who was first.")
    second_operators: list[str] = Field(description="Who was second.")
    count: int = Field(description="Number of images.")
    iou_mean: float = Field(description="Mean intersection over union of both regions.")
    iou_least: float = Field(description="The least of them.")
    semi_major_mm: AgreementRecord | None = Field(default=None, description="Of semi-major axes.")
    semi_minor_mm: AgreementRecord | None = Field(default=None, description="Of semi-minor axes.")
    gross_area_mm2: AgreementRecord | None = Field(default=None, description="Of gross areas.")
    ridge_area_mm2: AgreementRecord | None = Field(default=None, description="Of ridge areas.")


@with_families
class AtLoadRecord(Quantities, Placed):
    """A finger at one placement under one load, as in the table of loads."""

    load_N: Number = Field(description="Mean of the loads, N.")
    contacts: int = Field(description="Number of contacts.")
    sessions: int = Field(description="Number of sessions.")
    scale: str | None = Field(default=None, description="Scale that all of them name.")
    contact_area_mm2: AtLoad = Field(description="Geometric mean of the contact areas, mm².")
    youngs_modulus_kpa: ModelledAtLoad = Field(description="Geometric mean of E by Hertz theory, kPa.")
    youngs_modulus_kpa_verdict: str
    youngs_modulus_on_layer_kpa: AtLoad = Field(description="Geometric mean of E on the layer, kPa.")
    youngs_modulus_on_layer_kpa_verdict: str


class OverlayRecord(Record):
    """A frame drawn with its measurement."""

    role: str = Field(description="`first contact`, `largest load` or `last contact`.")
    frame: int = Field(description="Its number.")
    file: str = Field(description="The picture, relative to the output folder.")


class SequenceRecord(Placed):
    """An image sequence of one press. Where it could not be measured the counts of frames are left out."""

    sequence: str = Field(description="Its name.")
    frames: int | None = Field(default=None, description="Number of frames.")
    frames_with_contact: int | None = Field(default=None, description="Number of those measured.")
    frames_without_contact: int | None = Field(default=None, description="Number of those without contact.")
    frames_failed: int | None = Field(default=None, description="Number of those that cannot be read.")
    phases: dict[str, int] | None = Field(default=None, description="Number of frames by phase.")
    first_contact_frame: int | None = Field(default=None, description="The first frame in contact.")
    notes: list[str] = Field(default=[], description="Doubts, in words.")
    phases_corrected_by: str | None = Field(description="Who set the phases.")
    phases_corrected_at: str | None = Field(description="When.")
    phases_reason: str | None = Field(description="Why.")
    phase_starts_s: list[tuple[str, float]] | None = Field(description="Each phase, and its start, s.")
    rows: int = Field(description="Number of its rows in `results.csv`.")
    pooled: int = Field(description="Number of those that are pooled.")
    area_exponent: Number = Field(description="n of A ∝ Wⁿ over its frames.")
    area_exponent_std: Number
    area_exponent_ci95: Interval | None = None
    overlays: list[OverlayRecord] = Field(description="Some frames.")
    reason: str | None = Field(description="Why it could not be measured.")


class ScaleRecord(Record):
    """A named scale: its size, or why there is none."""

    reason: str | None = Field(default=None, description="Why there is none.")
    mm_per_px: Number = Field(default=math.nan, description="Millimetres per pixel.")
    mm_per_px_std: Number = math.nan
    flags: list[str] = Field(default=[], description="Doubts.")


@with_families
class CurveFitRecord(Quantities):
    """What was fitted to a loading curve."""

    loading_radius_mm: Fitted = Field(description="R_g of A = π R_g ξ, mm.")
    reduced_modulus_kpa: Fitted = Field(description="E* at `modulus_load_N`, kPa.")
    youngs_modulus_kpa: Fitted = Field(description="E at `modulus_load_N`, kPa.")
    contact_offset_mm: Fitted = Field(description="Displacement at first contact, mm.")
    initial_modulus_kpa: Fitted = Field(description="E_0g of E_g = E_0g + β W, kPa.")
    load_coefficient_kpa_per_N: Fitted = Field(description="β, kPa/N.")
    load_exponent: Fitted = Field(description="m of W ∝ ξᵐ.")
    area_exponent: Fitted = Field(description="n of A ∝ Wⁿ.")
    reasons: dict[str, str] = Field(description="Why quantities are not known.")
    modulus_load_N: Number = Field(description="Largest load fitted, N.")
    region_N: Interval = Field(description="Loads between which E_g was taken to increase, N.")
    preferred_model: str = Field(description="Law of the force of the least AICc.")
    aicc: Shares = Field(description="AICc by law of the force.")
    aicc_alternatives: Shares = Field(description="AICc by other explanation of the curve.")
    weights: Shares = Field(description="Akaike weights.")
    notes: dict[str, str] = Field(description="What a flag means for this curve.")
    segments: list[dict[str, tuple[int, int] | None]] = Field(
        description="First and last row of each phase of each press, counted from zero."
    )
    hysteresis_mJ: list[Number] = Field(description="Energy lost in each press, mJ.")
    hysteresis_fraction: list[Number] = Field(description="The same over the work of the way in.")
    flags: list[str] = Field(description="Doubts.")


@with_families
class ThicknessFitRecord(Quantities):
    """The layer of tissue over bone that explains a loading curve."""

    thickness_mm: Fitted = Field(description="Effective thickness of the tissue, mm.")
    youngs_modulus_kpa: Fitted = Field(description="E of the tissue, kPa.")
    contact_offset_mm: Fitted = Field(description="Displacement at first contact, mm.")
    radius_mm: Fitted = Field(description="1/H of the pad, improved by the curve, mm.")
    reasons: dict[str, str] = Field(description="Why quantities are not known.")
    contact_over_thickness: Number = Field(description="a/t at the largest area.")
    correlation: Number = Field(description="Of the errors of 1/t and E.")
    preferred_model: str | None = Field(description="That of the least AICc.")
    layer_weight: Number = Field(description="Akaike weight of a layer against a half-space.")
    hertz_weight: Number = Field(description="Akaike weight of Hertz theory.")
    advice: str = Field(description="Which modulus to believe, and why.")
    aicc: Shares = Field(description="AICc by model.")
    weights: Shares = Field(description="Akaike weights.")
    notes: dict[str, str] = Field(description="What a flag means for this curve.")
    flags: list[str] = Field(description="Doubts.")


@with_families
class CurveOnLayerRecord(Quantities):
    """What the highest load of a loading curve and its indentation tell of the pad."""

    load_N: Number = Field(description="Highest load fitted, N.")
    indentation_mm: WithStd = Field(description="Its indentation from the place of contact by Hertz, mm.")
    contact_shift_mm: Number = Field(description="What to add from the place of contact on the layer, mm.")
    layer_flag: Text = Field(description="What takes it out of the range of the laws.")
    youngs_modulus_from_indentation_kpa: OnLayer = Field(description="E by Hertz theory, kPa.")
    youngs_modulus_from_indentation_on_layer_kpa: OnLayer = Field(description="E on the layer, kPa.")
    loading_radius_on_layer_mm: OnLayer = Field(description="A/(πξ) on the layer, mm.")


class CurveRecord(Record):
    """A loading curve, or a loading radius that the manifest gives."""

    file: str | None = Field(description="The file; null for a radius that is given.")
    cycle: int = Field(default=0, description="Which press of the file, from 0, where it is not the first.")
    finger: str = Field(description="The finger.")
    wedge_angle_deg: float = Field(description="Angle of the wedge, degrees.")
    synthetic: bool = Field(description="Whether it was simulated.")
    loading_radius_mm: Number = Field(description="R_g, mm.")
    loading_radius_mm_std: Number
    velocity_mm_per_s: Number = Field(description="How fast it was, mm/s.")
    reason: str | None = Field(description="Why there is no fit.")
    fit: CurveFitRecord | None = Field(description="What was fitted.")
    layer: ThicknessFitRecord | None = Field(description="The layer that the curve itself gives.")
    on_layer: CurveOnLayerRecord | None = Field(description="On the layer that the manifest states.")


class MethodsRecord(Record):
    """The methods section."""

    paragraphs: list[str] = Field(description="The text.")
    missing: list[str] = Field(description="What a reader would ask and the study does not state.")


class ProvenanceRecord(Record):
    """What is needed to repeat a run."""

    fingerpad: str = Field(description="Version of fingerpad.")
    python: str = Field(description="Version of Python.")
    libraries: dict[str, str] = Field(description="Versions of libraries that numbers depend on.")
    measurement_versions: dict[str, int] = Field(description="Versions of the kinds of measurement.")
    made: str = Field(description="When, UTC.")
    inputs_sha256: dict[str, str] = Field(description="SHA-256 of every input file.")
    formulas: dict[str, str] = Field(description="Formulas of the results.")
    limits_per_picture: dict[str, Number] = Field(description="Limits of time, s, and memory, GB.")


class SummaryFile(Record):
    """The content of ``summary.json``. What is not known is NaN, an empty text or None: null in the file."""

    title: str = Field(description="The study's title.")
    fingers: list[FingerRecord] = Field(description="Semi-axes of each finger.")
    summaries: list[PlacementRecord] = Field(description="Each finger at each placement.")
    repeatability: RepeatabilityRecord = Field(description="Scatter of repeats.")
    second_operator: list[OperatorAgreementRecord] = Field(description="How two persons agree.")
    by_load: list[AtLoadRecord] = Field(description="Area and modulus at each load.")
    sequences: list[SequenceRecord] = Field(description="Image sequences.")
    scales: dict[str, ScaleRecord] = Field(description="Named scales.")
    load_gain_relative_std: Number = Field(
        default=0.0, description="Relative standard uncertainty of the force's gain, where one is stated."
    )
    poisson_ratio: float = Field(default=0.5, description="Poisson's ratio of the tissue, where it is not ½.")
    curves: list[CurveRecord] = Field(description="Loading curves.")
    failures: list[str] = Field(description="What failed, and why.")
    methods: MethodsRecord = Field(description="Methods section in words.")
    provenance: ProvenanceRecord = Field(description="Versions, inputs and formulas.")

    def finger(self, name: str) -> FingerRecord | None:
        """Return the record of a finger, None where it has none."""
        return next((one for one in self.fingers if one.finger == name), None)

    def text(self) -> str:
        """Return the content of the file."""
        return self.model_dump_json(exclude_unset=True, indent=1) + "\n"

    @classmethod
    def read(cls, folder: Path) -> Self:
        """Read the summary of a finished run."""
        path = folder / "summary.json"
        try:
            with reading(path):
                return cls.model_validate_json(path.read_bytes(), strict=True)
        except ValidationError as error:
            fault = error.errors(include_url=False)[0]
            place = ".".join(map(str, fault["loc"]))
            what = f"is not understood ({place}: {fault['msg']})" if place else f"is none ({fault['msg']})"
            raise FingerpadError(f"{path}: {what}; {RERUN}") from error


@contextmanager
def reading(path: Path) -> Iterator[None]:
    """Say of a file of a run's output that is missing or cannot be read what it is, and the way out."""
    try:
        yield
    except FileNotFoundError:
        raise FingerpadError(
            f"{path.parent}: no {path.name} there, so no finished run; "
            "`fingerpad run STUDY --out FOLDER` makes one"
        ) from None
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise FingerpadError(f"{path}: cannot be read ({error})") from error
