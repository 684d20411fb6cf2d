"""The tables of the manifest: scales, fingers, contacts, loading curves, and the whole study.

What is wrong with the values of a table is said in words.
"""

import difflib
import math
import re
from collections.abc import Iterator
from functools import cache
from itertools import pairwise
from typing import Annotated, Any, Final, Literal, NamedTuple, Self, TypeAlias, TypeVar, get_args

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    TypeAdapter,
    ValidationError,
    model_validator,
)

from fingerpad._plausible import MOST_N, PLAUSIBLE_THICKNESS_MM, in_radians, semi_axes_doubt
from fingerpad._words import joined
from fingerpad.exceptions import ManifestError


def not_tiny(value: float) -> float:
    """Return a value that is more than positive by name: arithmetic on others underflows."""
    if value < 1e-9:
        raise ValueError(f"{value:g} is too small to be meant")
    return value


def _over_bone(value: object) -> object:
    """Refuse an infinite thickness, as a curve's may be, with the way out."""
    if value == math.inf:
        raise ValueError("leave it out where there is no bone: E by Hertz theory is that of deep tissue")
    return value


# Wedge angles that differ by less, in degrees, may be meant as one.
_ONE_ANGLE: Final = 1.0

# Wide bounds that only a wrong unit or a typing error exceeds.
Positive = Annotated[float, Field(gt=0, le=1e6, allow_inf_nan=False), AfterValidator(not_tiny)]
Length = Annotated[float, Field(gt=0, le=1000, allow_inf_nan=False), AfterValidator(not_tiny)]
LengthStd = Annotated[float, Field(ge=1e-9, le=1000, allow_inf_nan=False)]
_THINNEST, _THICKEST = PLAUSIBLE_THICKNESS_MM
TissueThickness = Annotated[
    float, BeforeValidator(_over_bone), Field(ge=_THINNEST, le=_THICKEST, allow_inf_nan=False)
]
Load = Annotated[float, Field(gt=0, le=1e4, allow_inf_nan=False), AfterValidator(not_tiny)]
RelativeStd = Annotated[float, Field(ge=0, lt=1, allow_inf_nan=False)]
WedgeAngle = Annotated[float, Field(ge=0, le=90)]
RollAngle = Annotated[float, Field(ge=-90, le=90)]
AngleStd = Annotated[float, Field(ge=0, le=90, allow_inf_nan=False)]
Finite = Annotated[float, Field(allow_inf_nan=False)]
# A place in a picture, or so far beside it that nothing of it is seen.
_NEAR = Field(ge=-1_000_000, le=1_000_000)
Pixel = Annotated[float, _NEAR]
# Names become file names: letters, digits and . _ + - only.
Name = Annotated[str, Field(pattern=r"^\w[\w.+-]*$", max_length=60)]

# Where something is in a table: keys, and numbers in lists.
Loc: TypeAlias = tuple[int | str, ...]

# Keys that name files; in a sequence `file` may name a folder of frames.
FILE_KEYS: Final = ("background", "coin", "file", "force", "grid", "observations_csv", "outline", "times")
# Keys that hold a table, or several by number or by name.
_TABLE_KEYS: Final = ("scale", "scales", "fingers", "photographs", "observations", "sequences", "curves")


class ManifestModel(BaseModel):
    """A table of the manifest: no key that is not known, no value that changes."""

    model_config = ConfigDict(extra="forbid", frozen=True, use_attribute_docstrings=True)

    def files(self) -> Iterator[tuple[Loc, str]]:
        """Yield where this table and those in it name a file, and the name."""
        for key in _keys_of(type(self), FILE_KEYS):
            if (name := getattr(self, key)) is not None:
                yield (key,), name
        for loc, table in self.tables():
            yield from ((loc + inner, name) for inner, name in table.files())

    def tables(self) -> Iterator[tuple[Loc, "ManifestModel"]]:
        """Yield where this table holds another, and that table."""
        for key in _keys_of(type(self), _TABLE_KEYS):
            held = getattr(self, key)
            if isinstance(held, ManifestModel):
                yield (key,), held
            elif isinstance(held, list | dict):
                places = held.items() if isinstance(held, dict) else enumerate(held)
                yield from (((key, place), table) for place, table in places)


@cache
def _keys_of(model: type[ManifestModel], keys: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(key for key in keys if key in model.model_fields)


def _listed(value: object) -> object:
    """Let a spreadsheet's cell hold a list, as in "250, 200"."""
    try:
        return [float(part) for part in value.split(",")] if isinstance(value, str) else value
    except ValueError:
        raise ValueError("expected numbers, as in 250, 200") from None


Point: TypeAlias = Annotated[list[Pixel], Field(min_length=2, max_length=2), BeforeValidator(_listed)]
Box: TypeAlias = Annotated[
    list[Annotated[int, _NEAR]], Field(min_length=4, max_length=4), BeforeValidator(_listed)
]

MarkStd = Annotated[float, Field(ge=0, le=1000, allow_inf_nan=False)]
Mark = Annotated[list[Annotated[Pixel, Field(ge=0)]], Field(min_length=2, max_length=2)]


class ResolutionScale(ManifestModel):
    """Pixels per inch."""

    ppi: Annotated[float, Field(ge=20, le=1e5)]
    """Pixels per inch."""
    relative_std: RelativeStd = 0.0
    """Relative standard uncertainty."""


class PitchScale(ManifestModel):
    """Millimetres per pixel."""

    mm_per_px: Annotated[float, Field(ge=1e-4, le=1)]
    """Millimetres per pixel."""
    relative_std: RelativeStd = 0.0
    """Relative standard uncertainty."""


class LineScale(ManifestModel):
    """A line of known length, drawn on a ruler: its two ends (row, column), px."""

    line: Annotated[list[Mark], Field(min_length=2, max_length=2)]
    """The two ends, each (row, column), px."""
    length_mm: Length
    """Length of the line, mm."""
    length_mm_std: MarkStd = 0.0
    """Standard uncertainty of the length, mm."""
    ends_px_std: MarkStd = 0.0
    """Standard uncertainty of each end, px."""

    @model_validator(mode="after")
    def _two_ends(self) -> Self:
        if self.line[0] == self.line[1]:
            raise ValueError(f"the line must have two different ends, found {self.line[0]} twice")
        return self


class CoinScale(ManifestModel):
    """A coin of known diameter, found in a picture taken like those to measure."""

    coin: str
    """Picture of the coin, in the plane of what is measured."""
    diameter_mm: Length
    """Diameter of the coin, mm."""
    diameter_mm_std: MarkStd = 0.0
    """Standard uncertainty of the diameter, mm."""


class CircleScale(ManifestModel):
    """Three points (row, column), px, on the rim of a coin or another circle of known diameter."""

    circle: Annotated[list[Mark], Field(min_length=3, max_length=3)]
    """The three points, each (row, column), px."""
    diameter_mm: Length
    """Diameter of the circle, mm."""
    diameter_mm_std: MarkStd = 0.0
    """Standard uncertainty of the diameter, mm."""
    points_px_std: MarkStd = 0.0
    """Standard uncertainty of each point, px."""


class GridScale(ManifestModel):
    """A checkerboard or a grid of dots in a picture taken like those to measure."""

    grid: str
    """Picture of the grid, in the plane of what is measured."""
    points: Annotated[list[Annotated[int, Field(ge=3, le=200)]], Field(min_length=2, max_length=2)]
    """Number of inner corners or of dots down and across."""
    spacing_mm: Length
    """Distance of neighbouring points, mm."""
    spacing_mm_std: MarkStd = 0.0
    """Standard uncertainty of the distance, mm."""
    pattern: Literal["checkerboard", "dots"] = "checkerboard"
    """What the grid consists of."""


ScaleTable: TypeAlias = ResolutionScale | PitchScale | LineScale | CoinScale | CircleScale | GridScale
# The first key of each tells which kind of table it is; the tag must not look like a key in messages.
SCALE_KINDS: Final = tuple(next(iter(model.model_fields)) for model in get_args(ScaleTable))
NAMED: Final = "<name>"
TAGS: Final = frozenset((NAMED, *(f"<{kind}>" for kind in SCALE_KINDS)))


def _one_way(value: object) -> object:
    """Refuse a table that says its scale in no way or in two."""
    if isinstance(value, dict):
        found = [kind for kind in SCALE_KINDS if kind in value]
        if len(found) != 1:
            seen = " and ".join(found) if found else "none of them"
            raise ValueError(f"give one of {', '.join(SCALE_KINDS)}, found {seen}")
    elif not isinstance(value, str | ManifestModel):
        raise ValueError("give the name of one of [scales], or a table such as { ppi = 500 }")  # noqa: TRY004
    return value


def _no_name(value: object) -> object:
    """Refuse a name where the scale itself belongs: names do not lead to names."""
    if isinstance(value, str):
        raise ValueError("expected a table, as in { ppi = 500 }")  # noqa: TRY004
    return value


def _tag(value: object) -> str:
    if isinstance(value, str):
        return NAMED
    keys = value if isinstance(value, dict) else type(value).model_fields  # type: ignore[attr-defined]
    return next(f"<{kind}>" for kind in SCALE_KINDS if kind in keys)


_Tagged: TypeAlias = (
    Annotated[ResolutionScale, Tag("<ppi>")]
    | Annotated[PitchScale, Tag("<mm_per_px>")]
    | Annotated[LineScale, Tag("<line>")]
    | Annotated[CoinScale, Tag("<coin>")]
    | Annotated[CircleScale, Tag("<circle>")]
    | Annotated[GridScale, Tag("<grid>")]
)
# A table, or the name of one that several pictures share: one uncertain number for all of them.
ScaleKey: TypeAlias = Annotated[
    _Tagged | Annotated[Name, Tag(NAMED)], Discriminator(_tag), BeforeValidator(_one_way)
]
OwnScale: TypeAlias = Annotated[
    _Tagged, Discriminator(_tag), BeforeValidator(_one_way), BeforeValidator(_no_name)
]


def is_exact(scale: ManifestModel) -> bool:
    """Tell whether a scale has no uncertainty; that of a coin or a grid follows from its picture."""
    stds = (name for name in type(scale).model_fields if name.endswith("_std"))
    return not isinstance(scale, CoinScale | GridScale) and not any(getattr(scale, name) for name in stds)


Side = Literal["up", "down", "left", "right"]


class SemiAxes(ManifestModel):
    """Semi-axes of a finger pad, mm."""

    palmar: Length
    """Out of the pad, mm: half of the fingertip's thickness."""
    distal: Length
    """Out of the fingertip, mm: from where the finger is widest to the tip."""
    radial_ulnar: Length
    """Across the finger, mm: half of its width."""


class SemiAxesStd(ManifestModel):
    """Standard uncertainties of semi-axes, mm."""

    palmar: LengthStd
    """Of the palmar semi-axis, mm."""
    distal: LengthStd
    """Of the distal semi-axis, mm."""
    radial_ulnar: LengthStd
    """Of the semi-axis across, mm."""


class Photograph(ManifestModel):
    """One face of a finger: a photograph before a plain backdrop with its scale, or points of its outline."""

    face: Literal["palmar", "distal", "radial", "ulnar"]
    """The face that looks at the camera."""
    outline: str | None = None
    """Table (CSV, XLSX, MAT or TDMS) of outline points, `x_mm,y_mm`, in place of a photograph."""
    outline_relative_std: RelativeStd = 0.0
    """Relative standard uncertainty of the outline's scale, where `scale` does not name it."""
    file: str | None = None
    """The photograph."""
    scale: ScaleKey | None = None
    """Name of a scale, or a table of its own; of an outline, the one that its millimetres were made with."""
    tip: Side = "up"
    """Where the fingertip points in the photograph."""
    palmar_side: Side | None = None
    """Where the palmar side points; found in views from the side, down in the distal view."""
    region_of_interest_px: Annotated[list[Pixel], Field(min_length=4, max_length=4)] | None = None
    """First row and column, last row and column in which the outline is looked for."""
    synthetic: bool = False
    """Whether the photograph was rendered."""

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        if (self.outline is None) == (self.file is None):
            raise ValueError("give either outline or file, one of the two")
        if self.file is not None and self.scale is None:
            raise ValueError("an image needs its scale, as in scale = { ppi = 500 }")
        ours = {"face", "synthetic", "outline", "scale" if self.scale else "outline_relative_std"}
        idle = (
            self.model_fields_set - ours if self.outline else self.model_fields_set & {"outline_relative_std"}
        )
        if idle:
            beside = "an outline" if self.outline else "an image"
            raise ValueError(f"beside {beside} there is no use for {', '.join(sorted(idle))}")
        return self


class Finger(ManifestModel):
    """A finger, with its semi-axes given or to be fitted to the outlines of its photographs.

    Without both, contact areas alone follow from its pictures.
    """

    name: Name
    """Name of the finger, by which observations refer to it."""
    person: Name | None = None
    """Code for the person; without it all fingers of the study are taken as one person's."""
    digit: Name | None = None
    """Which finger of the person it is, as `left_index`, where several names stand for one finger that was
    measured in several ways: comparisons count it once. By default the name."""
    semi_axes_mm: SemiAxes | None = None
    """Semi-axes as measured elsewhere."""
    semi_axes_mm_std: SemiAxesStd | None = None
    """Their standard uncertainties."""
    photographs: list[Photograph] = Field(default=[])
    """Photographs or outlines of two or more faces, in place of semi-axes."""
    pad_thickness_mm: Length | None = None
    """Thickness of the soft pad, mm, to compare indentations with."""
    effective_thickness_mm: TissueThickness | None = None
    """Thickness, mm, of the layer on wide bone that acts like this finger's tissue."""
    effective_thickness_mm_std: LengthStd | None = None
    """Its standard uncertainty, mm; exact without it."""
    synthetic: bool = False
    """Whether the finger was rendered or simulated."""

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        if self.semi_axes_mm is not None and self.photographs:
            raise ValueError(
                "semi-axes are entered (semi_axes_mm), and photographs give them, too: remove either"
            )
        if (self.semi_axes_mm is None) != (self.semi_axes_mm_std is None):
            raise ValueError("semi_axes_mm and semi_axes_mm_std belong together")
        thickness, std = self.effective_thickness_mm, self.effective_thickness_mm_std
        if std is not None and (thickness is None or std >= thickness):
            raise ValueError(
                "effective_thickness_mm_std is the uncertainty of effective_thickness_mm: give both, and the "
                "uncertainty below the thickness"
            )
        images = [one.file for one in self.photographs if one.file is not None]
        for image in dict.fromkeys(images):
            if images.count(image) > 1:  # results and corrections know a photograph by its file
                raise ValueError(
                    f"the photograph {image} is named {images.count(image)} times: copy the picture under "
                    "another name for each face that it shows"
                )
        return self


Direction = Literal["along", "across"]
Surface = Literal["ridged", "smooth"]

# What a person can correct in the measurement of a contact image.
CORRECTIONS: Final = frozenset(("dark_on_light", "mask_px", "region_of_interest_px", "seed_px", "threshold"))
_IMAGE_KEYS: Final = CORRECTIONS | {"background", "finger_axis_deg", "surface"}


class PlacedFinger(ManifestModel):
    """A finger on its wedge, and how pictures of its contact are measured."""

    name: Name
    """Name, unique in the study."""
    finger: str
    """Name of the finger."""
    wedge_angle_deg: WedgeAngle
    """Angle of the wedge: 0 is flat, 90 on the fingertip."""
    roll_angle_deg: RollAngle = 0.0
    """Roll about the finger's long axis: 0 is flat, ±90 on a lateral face."""
    scale: ScaleKey | None = None
    """Name of a scale, or a table of its own; of an ellipse, the one that its millimetres were made with."""
    background: str | None = None
    """Picture of the empty platen, which is divided out."""
    finger_axis_deg: Finite = 0.0
    """Direction of the finger in the picture, from straight up, counter-clockwise."""
    dark_on_light: bool | None = None
    """Whether ridges are darker than the background, where it is not found."""
    seed_px: Point | None = None
    """A point (row, column) inside the contact, where there are several patches."""
    region_of_interest_px: Box | None = None
    """First row and column, last row and column that are looked at."""
    mask_px: Annotated[list[Point], Field(min_length=3)] | None = None
    """Corners (row, column) of a polygon round the contact."""
    threshold: Positive | None = None
    """Grey levels from the background to a ridge."""
    surface: Surface = "ridged"
    """Whether the contact in pictures has ridges, or none, as of a silicone fingertip; by default as the
    study says. The first frame of a smooth sequence is its background where none is named."""
    notes: str = ""
    """Free text, kept in the tables."""
    synthetic: bool = False
    """Whether it was rendered or simulated."""


class ContactEllipse(ManifestModel):
    """Semi-axes of a contact ellipse measured elsewhere, mm."""

    semi_major: Length
    """Larger semi-axis, mm."""
    semi_minor: Length
    """Smaller semi-axis, mm."""
    std: LengthStd
    """Standard uncertainty of either, mm; without that of the scale, where the observation states one."""
    long_axis: Direction | None = None
    """Direction of the larger one relative to the finger."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.semi_minor > self.semi_major:
            raise ValueError(
                f"semi_minor {self.semi_minor:g} must not exceed semi_major {self.semi_major:g}; swap them, "
                "and say in long_axis whether the longer one lies along or across the finger"
            )
        return self


class Observation(PlacedFinger):
    """One contact at one load: a contact image with its scale, or an ellipse measured elsewhere."""

    load_N: Load  # noqa: N815 (the unit's own letter)
    """Normal load, N."""
    session: Name | None = None
    """What was measured at one time; repeats are looked for within it."""
    file: str | None = None
    """The contact image."""
    ellipse_mm: ContactEllipse | None = None
    """Contact ellipse measured elsewhere, in place of an image."""

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        if (self.file is None) == (self.ellipse_mm is None):
            raise ValueError("give either file or ellipse_mm, one of the two")
        if self.file is not None and self.scale is None:
            raise ValueError("an image needs its scale, as in scale = { ppi = 500 }")
        idle = sorted(self.model_fields_set & _IMAGE_KEYS)
        if self.file is None and idle:
            raise ValueError(
                f"without an image there is no use for {', '.join(idle)}; remove what is not meant"
            )
        return self


class ContactSequence(PlacedFinger):
    """An image sequence of one press: a folder of pictures, an image stack or a video, and its force."""

    file: str
    """Folder of pictures, TIFF of many pages, or video."""
    force: str
    """Table (CSV, XLSX, MAT or TDMS) of force, `time_s,force_N`, perhaps `trigger_V`, `displacement_mm`."""
    force_columns: dict[Literal["time", "force", "trigger", "displacement"], str] = Field(default={})
    """Other headers of that file, as in `Fz:mN` or `stage:um`."""
    frames_per_second: Positive | None = None
    """Rate of the frames."""
    start_s: Finite | None = None
    """Time of the first frame on the clock of the force, s."""
    contact_load_N: Load | None = None  # noqa: N815 (the unit's own letter)
    """Force in the frame of first contact, N."""
    times: str | None = None
    """Table (CSV, XLSX, MAT or TDMS) with one `time_s` for each frame."""
    pool_min_load_N: Load | None = None  # noqa: N815 (the unit's own letter)
    """Least load of the loading frames that are pooled, N."""

    @model_validator(mode="after")
    def _one_clock(self) -> Self:
        if self.scale is None:
            raise ValueError("a sequence needs its scale, as in scale = { ppi = 500 }")
        idle = sorted(self.model_fields_set & {"frames_per_second", "start_s", "contact_load_N"})
        if self.times is not None and idle:
            raise ValueError(f"times gives each frame its time: there is no use for {', '.join(idle)}")
        if self.start_s is not None and self.contact_load_N is not None:
            raise ValueError("give either start_s or contact_load_N, one of the two")
        return self


Contact: TypeAlias = Observation | ContactSequence

_KNOWN = ("stage_compliance_mm_per_N", "area_delay_s", "thickness_mm")
# Keys that a curve without a file may have, too.
_OF_RADIUS = {"finger", "wedge_angle_deg", "file", "loading_radius_mm", "loading_radius_mm_std", "synthetic"}


class Curve(ManifestModel):
    """Loading data of one finger at one wedge angle: a curve, the radius R_g found elsewhere, or both."""

    finger: str
    """Name of the finger."""
    wedge_angle_deg: WedgeAngle
    """Angle of the wedge: 0 is flat, 90 on the fingertip."""
    file: str | None = None
    """Table (CSV, XLSX, MAT or TDMS), `time_s,force_N,displacement_mm,area_mm2`; time, area optional."""
    file_columns: dict[Literal["time", "force", "displacement", "area"], str] = Field(default={})
    """Other headers of that file, as in `stage:um`."""
    cycle: Annotated[int, Field(ge=0)] = 0
    """Which press of the record is fitted, from 0."""
    contact_point: Literal["joint", "contact_by_threshold", "two_lines", "gradient", "power_law"] = "joint"
    """How the place of contact is found."""
    fit_load_range_N: Annotated[list[Load], Field(min_length=2, max_length=2)] | None = None  # noqa: N815
    """Loads between which the modulus grows, N."""
    stage_compliance_mm_per_N: Annotated[float, Field(ge=0, le=100)] | None = None  # noqa: N815
    """Compliance of the stage, mm/N."""
    stage_compliance_mm_per_N_std: LengthStd | None = None  # noqa: N815
    """Its standard uncertainty, mm/N."""
    area_delay_s: Annotated[float, Field(ge=-60, le=60)] | None = None
    """By how much areas are late, s."""
    area_delay_s_std: Annotated[float, Field(gt=0, le=60)] | None = None
    """Its standard uncertainty, s."""
    scale: ScaleKey | None = None
    """Name of the scale that the areas were measured with, or a table of its own."""
    area_relative_std: RelativeStd | None = None
    """Relative standard uncertainty of the areas that is common to all of the curve, where `scale` does not
    give it: twice that of lengths."""
    thickness_mm: Annotated[float, Field(ge=0.001, allow_inf_nan=True)] | None = None
    """Thickness of the layer that is pressed, mm; `inf` for a half-space."""
    thickness_mm_std: LengthStd | None = None
    """Its standard uncertainty, mm."""
    loading_radius_mm: Length | None = None
    """R_g found elsewhere, mm."""
    loading_radius_mm_std: LengthStd | None = None
    """Its standard uncertainty, mm."""
    synthetic: bool = False
    """Whether the curve was simulated."""

    @property
    def finger_and_wedge(self) -> tuple[str, float, bool]:
        """Finger and angle, and whether it is synthetic: as in `Summary.finger_and_wedge`."""
        return self.finger, self.wedge_angle_deg, self.synthetic

    @property
    def press(self) -> tuple[str, int] | None:
        """The file and which press in it; None where there is no file."""
        return None if self.file is None else (self.file, self.cycle)

    @model_validator(mode="after")
    def _useful(self) -> Self:
        if self.file is None and self.loading_radius_mm is None:
            raise ValueError("give file, loading_radius_mm, or both")
        idle = type(self).model_fields.keys() - _OF_RADIUS if self.file is None else set[str]()
        if self.loading_radius_mm is None:
            idle |= {"loading_radius_mm_std"}
        if self.fit_load_range_N is not None and not self.fit_load_range_N[0] < self.fit_load_range_N[1]:
            raise ValueError(
                f"fit_load_range_N must rise, found {self.fit_load_range_N}; give the smaller load first"
            )
        idle |= {f"{key}_std" for key in _KNOWN if getattr(self, key) is None}
        if self.thickness_mm == math.inf:
            idle |= {"thickness_mm_std"}
        if self.scale is not None:
            idle |= {"area_relative_std"}
        if found := sorted(idle & self.model_fields_set):
            raise ValueError(f"there is no use for {found[0]} here; remove it")
        return self


# A phrase inside a sentence.
Text = Annotated[str, Field(max_length=300)]


class Uncertainty(ManifestModel):
    """Standard uncertainties common to all observations."""

    # A finger's angle on a wedge is known like a joint's by a goniometer, to 2 to 5 degrees.
    wedge_angle_deg_std: AngleStd = 3.0
    """Standard uncertainty of wedge angles; 0 takes them as exact."""
    roll_angle_deg_std: AngleStd = 3.0
    """Standard uncertainty of roll angles; 0 takes them as exact."""
    jig_angle_deg_std: AngleStd = 0.0
    """Standard uncertainty of the pose of the jig that holds the wedges, degrees: one error of all wedge
    angles of the study, beside that of each angle."""
    load_relative_std: RelativeStd = 0.0
    """Relative standard uncertainty of loads, each with an error of its own."""
    load_gain_relative_std: RelativeStd = 0.0
    """Relative standard uncertainty of the force sensor's gain: one error of all loads of the study, of
    contacts, sequences and curves, which no number of presses averages out."""
    poisson_ratio_std: Annotated[float, Field(ge=0, le=0.5)] = 0.0
    """Standard uncertainty of Poisson's ratio."""
    method: Literal["first_order", "monte_carlo"] = "first_order"
    """How uncertainties are propagated."""

    @property
    def wedge_deg_std(self) -> float:
        """Standard uncertainty of one wedge angle from all its errors, degrees."""
        return math.hypot(self.wedge_angle_deg_std, self.jig_angle_deg_std)

    @property
    def load_std(self) -> float:
        """Relative standard uncertainty of one load from all its errors."""
        return math.hypot(self.load_relative_std, self.load_gain_relative_std)


class Apparatus(ManifestModel):
    """What a methods section says of the experiment and no file shows, in the words to be printed."""

    imaging: Text = ""
    """How contact images were taken."""
    platen: Text = ""
    """What the finger pressed on."""
    force_sensor: Text = ""
    """What measured the force."""
    stage: Text = ""
    """What moved finger or platen."""
    scale_calibration: Text = ""
    """How the scale was found."""
    poisson_ratio_basis: Text = ""
    """Why Poisson's ratio is what it is."""
    thickness_basis: Text = ""
    """Where the thickness of the tissue comes from."""
    approach_mm_per_s: Positive | None = None
    """Speed of approach, mm/s."""
    dwell_s: Positive | None = None
    """Time held before the image was taken, s."""


class Study(ManifestModel):
    """The whole manifest."""

    model_config = ConfigDict(json_schema_extra={"required": ["title", "fingers"]})

    title: str
    """Title of the study."""
    description: str = ""
    """Whose fingers, which apparatus, which day."""
    poisson_ratio: Annotated[float, Field(gt=-1, le=0.5)] = 0.5
    """Poisson's ratio of the tissue."""
    surface: Surface = "ridged"
    """Whether contacts in pictures have ridges, where an observation or a sequence does not say it."""
    uncertainty: Uncertainty = Uncertainty()
    """Standard uncertainties that all observations share."""
    apparatus: Apparatus = Apparatus()
    """What the methods section says of the experiment."""
    scales: dict[Name, OwnScale] = Field(default={})
    """Scales by name, for pictures that share one."""
    fingers: list[Finger] = Field(default=[])
    """The fingers."""
    observations: list[Observation] = Field(default=[])
    """Contacts, each at one load."""
    observations_csv: str | None = None
    """CSV file of observations, with the same keys as headers."""
    sequences: list[ContactSequence] = Field(default=[])
    """Image sequences of presses."""
    curves: list[Curve] = Field(default=[])
    """Loading curves."""

    def named_scales(self) -> Iterator[str]:
        """Yield the name of a scale for every use of it."""
        return (scale for scale in self.scales_in_use() if isinstance(scale, str))

    def scales_in_use(self) -> Iterator[ScaleKey]:
        """Yield the scale of each picture and sequence: a table, or the name of one."""
        for _, table in self.tables():
            for one in (table, *(inner for _, inner in table.tables())):
                if (scale := getattr(one, "scale", None)) is not None:
                    yield scale

    def doubts(self) -> Iterator[str]:
        """Yield which lengths, loads and angles look as if they were in another unit, or twice as large."""
        for finger in self.fingers:
            axes = finger.semi_axes_mm
            if axes and (doubt := semi_axes_doubt((axes.palmar, axes.distal, axes.radial_ulnar))):
                yield f"{finger.name}: semi_axes_mm: {doubt}"
        yield from self._names_alike()
        entered: dict[tuple[object, ...], list[str]] = {}
        for one in self.observations:
            # Presses under one load may agree to a tenth of a millimetre by chance, others to a hundredth.
            if (ellipse := one.ellipse_mm) and (axis := ellipse.semi_major) != round(axis, 1):
                at = one.finger, one.wedge_angle_deg, one.roll_angle_deg, one.load_N
                under = () if axis != round(axis, 2) else at
                entered.setdefault((axis, ellipse.semi_minor, *under), []).append(one.name)
        if twice := [names for names in entered.values() if len(names) > 1]:
            others = f", and {len(twice) - 1} more of such" if len(twice) > 1 else ""
            words = f"{joined(twice[0], 3)}: the same ellipse_mm to the last digit{others}"
            yield f"{words}: is a press entered twice?"
        pressed = [one.name for one in self.observations if one.load_N > MOST_N]
        if pressed:
            yield f"{joined(pressed, 1)}: more than {MOST_N:g} N: is load_N in millinewtons, not newtons?"
        placed = [
            one.name for one in (*self.observations, *self.sequences) if in_radians(one.wedge_angle_deg)
        ]
        if placed:
            yield f"{joined(placed, 1)}: less than 1.6°: is wedge_angle_deg in radians, not degrees?"
        yield from self._angles_alike()

    def _names_alike(self) -> Iterator[str]:
        """Yield names that may be of one finger, person or session."""
        named = {
            "finger": [finger.name for finger in self.fingers],
            "person": [finger.person or "" for finger in self.fingers],
            "session": [observation.session or "" for observation in self.observations],
        }
        for kind, all_names in named.items():
            alike: dict[str, list[str]] = {}
            for name in dict.fromkeys(all_names):
                alike.setdefault(re.sub(r"(?<!\d)[\W_]+|[\W_]+(?!\d)", "", name).casefold(), []).append(name)
            for names in alike.values():
                if len(names) > 1:
                    which = f"{joined(names, 3)}: are these names of one {kind}?"
                    yield f"{which} then write one of them everywhere"

    def _angles_alike(self) -> Iterator[str]:
        """Yield angles of a finger that may be of one placement."""
        angles: dict[str, set[float]] = {}
        tables: tuple[Contact | Curve, ...] = (*self.observations, *self.sequences, *self.curves)
        for one in tables:
            angles.setdefault(one.finger, set()).add(one.wedge_angle_deg)
        for finger_name, stated in angles.items():
            for low, high in pairwise(sorted(stated)):
                if high - low < _ONE_ANGLE and not in_radians(high):
                    which = f"{finger_name}: wedge_angle_deg {low:.6g} and {high:.6g}"
                    yield f"{which}: is this one placement? then write one angle for all its presses"
                    break

    @property
    def has_models(self) -> bool:
        """Whether there is more than contact areas: a loading curve, or a finger of known shape."""
        return bool(self.curves) or any(one.semi_axes_mm or one.photographs for one in self.fingers)

    def assumed(self) -> list[str]:
        """Name the uncertainties that results assume, since the manifest does not state them."""
        if not self.has_models:
            return []
        common = self.uncertainty
        stds = {
            "wedge_angle_deg_std": f"the wedge angle to ± {common.wedge_angle_deg_std:g}°",
            "roll_angle_deg_std": f"the roll angle to ± {common.roll_angle_deg_std:g}°",
        }
        return [words for key, words in stds.items() if key not in common.model_fields_set]

    def taken_as_exact(self) -> Iterator[str]:
        """Name what results take as exact, since the manifest gives no uncertainty of it."""
        common = self.uncertainty
        stds = {
            "the wedge angle": common.wedge_deg_std,
            "the roll angle": common.roll_angle_deg_std,
            "the load": common.load_std,
            "Poisson's ratio": common.poisson_ratio_std,
        }
        if not self.has_models:
            stds = {"the load": common.load_std}
        yield from (words for words, std in stds.items() if not std)
        for finger in self.fingers:
            if finger.effective_thickness_mm is not None and finger.effective_thickness_mm_std is None:
                yield f"the effective thickness of {finger.name}"
        for finger in self.fingers:
            outlines = [one for one in finger.photographs if one.outline and one.scale is None]
            if not all(one.outline_relative_std for one in outlines):
                yield f"the scale of the outlines of {finger.name}"
        for curve in self.curves:
            if curve.loading_radius_mm is not None and not curve.loading_radius_mm_std:
                yield f"R_g of {curve.finger} at {curve.wedge_angle_deg:g}°"
        if any(curve.file and curve.stage_compliance_mm_per_N is None for curve in self.curves):
            yield "the stage of loading curves (rigid)"
        for name in dict.fromkeys(self.named_scales()):
            if is_exact(self.scales[name]):
                yield f"the scale “{name}”"
        if any(isinstance(one, ManifestModel) and is_exact(one) for one in self.scales_in_use()):
            yield "scales of single pictures"


_SCALE_KEYS: Final = frozenset(key for table in ScaleTable.__args__ for key in table.model_fields)

Model = TypeVar("Model", bound=BaseModel)


class Fault(NamedTuple):
    """Something that is missing or wrong in a table."""

    key_path: str  # empty for the table itself
    words: str

    def __str__(self) -> str:
        return f"{self.key_path}: {self.words}" if self.key_path else self.words


def checked(kind: TypeAdapter[Any], content: Any, *, strict: bool) -> tuple[Any, tuple[Fault, ...]]:
    """Return a table as `kind`, or None and its faults; cells of text cannot be taken strictly."""
    try:
        return kind.validate_python(content, strict=strict), ()
    except ValidationError as error:
        return None, tuple(_faults(error))


def validated(model: type[Model], content: Any, where: str, *, strict: bool) -> Model:
    """Return a table as a model; `ManifestError` has one line for each fault."""
    found, faults = checked(TypeAdapter(model), content, strict=strict)
    if faults:
        raise ManifestError("\n".join(f"{where}: {fault}" for fault in faults))
    assert isinstance(found, model)
    return found


# What is expected where the kind of a value is wrong; other words are pydantic's.
_EXPECTED: Final = {
    "bool": "true or false",
    "dict": "a table",
    "float": "a number",
    "int": "a whole number",
    "int_from_float": "a whole number",
    "list": "a list",
    "string": "text",
    "too_short": "at least {min_length} values",
    "too_long": "at most {max_length} values",
}


def _faults(error: ValidationError) -> Iterator[Fault]:
    """Yield each fault with what is expected and what was found."""
    unknown = [str(fault["loc"][-1]) for fault in error.errors() if fault["type"] == "extra_forbidden"]
    meant = {close for key in unknown for close in difflib.get_close_matches(key, _keys(), n=1)}
    for fault in error.errors():
        key = str(fault["loc"][-1]) if fault["loc"] else ""
        message = fault["msg"].removeprefix("Value error, ").replace("Input should be", "expected")
        kind = fault["type"].removesuffix("_type").removesuffix("_parsing")
        if fault["type"] == "missing" and key in meant:
            continue  # said with the unknown key that was meant for it
        if fault["type"] == "extra_forbidden":
            words = f"unknown key{_hint(key)}"
        elif fault["type"] == "string_pattern_mismatch":
            words = f"write it with letters, digits and . _ + - only, found {fault['input']!r}"
        elif fault["type"] == "missing":
            words = "required, but missing"
        elif fault["type"] == "model_type":
            fields = _models()[fault["ctx"]["class_name"]].model_fields
            keys = ", ".join(f"{name} = ..." for name, field in fields.items() if field.is_required())
            words = f"expected a table{f', as in {{ {keys} }}' if keys else ''}, found {fault['input']!r:.60}"
        elif kind in _EXPECTED or isinstance(fault["input"], str | int | float | bool):
            if kind in _EXPECTED:
                message = f"expected {_EXPECTED[kind].format(**fault.get('ctx', {}))}"
            words = f"{message}, found {repr(fault['input'])[:60]}"
            if fault["type"] == "float_type" and isinstance(fault["input"], str):
                words += "; numbers stand without quotes and have a decimal point"
            elif fault["type"] == "float_parsing" and "," in str(fault["input"]):
                words += "; write it with a decimal point, as the other numbers of the table"
        else:
            words = message
        yield Fault(key_path(fault["loc"]), words)


def key_path(loc: Loc) -> str:
    """Return the path of a key as the manifest would write it."""
    seen = (part for part in loc if part not in TAGS and part != "[key]")  # pydantic's, of a wrong key
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in seen).lstrip(".")


@cache
def _models() -> dict[str, type[ManifestModel]]:
    """Return the models of all tables by their names."""
    found: list[type[ManifestModel]] = [ManifestModel]
    for model in found:
        found += model.__subclasses__()
    return {model.__name__: model for model in found}


@cache
def _keys() -> tuple[str, ...]:
    """Return the keys of all tables of a manifest, for what a misspelt one was meant to be."""
    models = (model for model in _models().values() if model.__module__ == __name__)  # no correction's
    return tuple(dict.fromkeys(key for model in models for key in model.model_fields))


def _hint(key: str) -> str:
    if key in _SCALE_KEYS:
        return f"; write it in the table of a scale, as in scale = {{ {key} = ... }}"
    if key in _keys():
        return "; it belongs in another table"
    close = difflib.get_close_matches(key, _keys(), n=1)
    return f"; did you mean {close[0]!r}?" if close else ""
