"""Contacts of a finger with the platen: single ones under one load, and sequences of whole presses."""

from typing import Annotated, Final, Literal, Self, TypeAlias

from pydantic import Field, model_validator

from fingerpad.study.manifest.scales import ScaleKey
from fingerpad.study.manifest.tables import (
    Box,
    Finite,
    Length,
    LengthStd,
    Load,
    ManifestModel,
    Name,
    Point,
    Positive,
    RollAngle,
    WedgeAngle,
)

Direction = Literal["along", "across"]

# What a person can correct in the measurement of a contact image.
CORRECTIONS: Final = frozenset(("dark_on_light", "mask_px", "region_of_interest_px", "seed_px", "threshold"))
_IMAGE_KEYS: Final = CORRECTIONS | {"background", "scale", "finger_axis_deg", "surface"}


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
    """Name of a scale, or a table of its own."""
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
    """Standard uncertainty of either, mm."""
    long_axis: Direction | None = None
    """Direction of the larger one relative to the finger."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.semi_minor > self.semi_major:
            raise ValueError(
                f"semi_minor {self.semi_minor:g} must not exceed semi_major {self.semi_major:g}; swap them"
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
    surface: Literal["ridged", "smooth"] = "ridged"
    """Whether the contact in the image has ridges, or none, as of a silicone fingertip."""

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
    """CSV file of the force, `time_s,force_N` and perhaps `trigger_V` and `displacement_mm`."""
    force_columns: dict[Literal["time", "force", "trigger", "displacement"], str] = Field(default={})
    """Other headers of that file, as in `Fz:mN` or `stage:um`."""
    frames_per_second: Positive | None = None
    """Rate of the frames."""
    start_s: Finite | None = None
    """Time of the first frame on the clock of the force, s."""
    contact_load_N: Load | None = None  # noqa: N815 (the unit's own letter)
    """Force in the frame of first contact, N."""
    times: str | None = None
    """CSV file with one `time_s` for each frame."""
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
