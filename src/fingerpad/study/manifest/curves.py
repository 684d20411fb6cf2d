"""Loading data: curves to fit, or the radius found from one elsewhere."""

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from fingerpad.study.manifest.scales import ScaleKey
from fingerpad.study.manifest.tables import Length, LengthStd, Load, ManifestModel, RelativeStd, WedgeAngle

_KNOWN = ("stage_compliance_mm_per_N", "area_delay_s", "thickness_mm")
_FILE_KEYS = frozenset(
    (
        *("file_columns", "contact_point", "cycle", "fit_load_range_N", "scale", "area_relative_std"),
        *_KNOWN,
        *(f"{key}_std" for key in _KNOWN),
    )
)


class Curve(ManifestModel):
    """Loading data of one finger at one wedge angle: a curve, the radius R_g found elsewhere, or both."""

    finger: str
    """Name of the finger."""
    wedge_angle_deg: WedgeAngle
    """Angle of the wedge: 0 is flat, 90 on the fingertip."""
    file: str | None = None
    """CSV file, `time_s,force_N,displacement_mm,area_mm2`; time and area are optional."""
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
    def place(self) -> tuple[str, float, bool]:
        """Finger and angle, and whether it is synthetic: as in `Summary.place`."""
        return self.finger, self.wedge_angle_deg, self.synthetic

    @model_validator(mode="after")
    def _useful(self) -> Self:
        if self.file is None and self.loading_radius_mm is None:
            raise ValueError("give file, loading_radius_mm, or both")
        idle = _FILE_KEYS if self.file is None else frozenset()
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
