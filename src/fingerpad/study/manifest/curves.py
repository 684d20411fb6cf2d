"""Loading data: curves to fit, or the radius found from one elsewhere."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from fingerpad.study.manifest.tables import Length, LengthStd, Load, Table, WedgeAngle

_FILE_KEYS = frozenset(("columns", "contact_point", "cycle", "region_N"))


class Curve(Table):
    """Loading data of one finger at one wedge angle: a curve, the radius R_g found elsewhere, or both."""

    finger: str
    wedge_angle_deg: WedgeAngle
    file: str | None = None
    columns: dict[Literal["time", "force", "displacement", "area"], str] = Field(default={})
    cycle: Annotated[int, Field(ge=0)] = 0
    contact_point: Literal["joint", "baseline_deviation", "two_lines", "gradient", "power_law"] = "joint"
    region_N: Annotated[list[Load], Field(min_length=2, max_length=2)] | None = None  # noqa: N815
    effective_radius_mm: Length | None = None
    effective_radius_std_mm: LengthStd | None = None
    synthetic: bool = False

    @model_validator(mode="after")
    def _useful(self) -> Self:
        if self.file is None and self.effective_radius_mm is None:
            raise ValueError("give file, effective_radius_mm, or both")
        idle = _FILE_KEYS if self.file is None else frozenset()
        if self.effective_radius_mm is None:
            idle |= {"effective_radius_std_mm"}
        if self.region_N is not None and not self.region_N[0] < self.region_N[1]:
            raise ValueError(f"region_N must rise, found {self.region_N}; give the smaller load first")
        if found := sorted(idle & self.model_fields_set):
            raise ValueError(f"there is no use for {found[0]} here; remove it")
        return self
