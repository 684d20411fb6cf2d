"""Contacts of a finger with the platen: single ones under one load, and films of whole presses."""

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
    WedgeAngle,
)

Direction = Literal["along", "across"]

# What a person can correct in the measurement of a contact image.
CORRECTIONS: Final = frozenset(("dark_on_light", "mask_px", "region_of_interest_px", "seed_px", "threshold"))
_IMAGE_KEYS: Final = CORRECTIONS | {"background", "scale", "finger_axis_deg"}


class PlacedFinger(ManifestModel):
    """A finger on its wedge, and how pictures of its contact are measured."""

    name: Name
    finger: str
    wedge_angle_deg: WedgeAngle
    roll_angle_deg: Finite = 0.0
    scale: ScaleKey | None = None
    background: str | None = None
    finger_axis_deg: Finite = 0.0
    dark_on_light: bool | None = None
    seed_px: Point | None = None
    region_of_interest_px: Box | None = None
    mask_px: Annotated[list[Point], Field(min_length=3)] | None = None
    threshold: Positive | None = None
    notes: str = ""
    synthetic: bool = False


class ContactEllipse(ManifestModel):
    """Semi-axes of a contact ellipse measured elsewhere, mm."""

    semi_major: Length
    semi_minor: Length
    std: LengthStd
    long_axis: Direction | None = None

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
    session: Name | None = None
    file: str | None = None
    ellipse_mm: ContactEllipse | None = None

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
    """A film of one press: a folder of pictures, a TIFF of many pages or a video, and its force."""

    file: str
    force: str
    force_columns: dict[Literal["time", "force", "trigger"], str] = Field(default={})
    frames_per_second: Positive | None = None
    start_s: Finite | None = None
    contact_load_N: Load | None = None  # noqa: N815 (the unit's own letter)
    times: str | None = None
    pool_min_load_N: Load | None = None  # noqa: N815 (the unit's own letter)

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
