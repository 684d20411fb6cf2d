"""Fingers: their semi-axes, or the photographs that show them."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from fingerpad.study.manifest.scales import ScaleKey
from fingerpad.study.manifest.tables import (
    Length,
    LengthStd,
    ManifestModel,
    Name,
    Pixel,
    RelativeStd,
    TissueThickness,
)

Side = Literal["up", "down", "left", "right"]


class SemiAxes(ManifestModel):
    """Semi-axes of a finger pad, mm."""

    palmar: Length
    distal: Length
    radial_ulnar: Length


class SemiAxesStd(ManifestModel):
    """Standard uncertainties of semi-axes, mm."""

    palmar: LengthStd
    distal: LengthStd
    radial_ulnar: LengthStd


class Photograph(ManifestModel):
    """One face of a finger: a photograph before a plain backdrop with its scale, or points of its outline."""

    face: Literal["palmar", "distal", "radial", "ulnar"]
    outline: str | None = None
    outline_relative_std: RelativeStd = 0.0
    file: str | None = None
    scale: ScaleKey | None = None
    tip: Side = "up"
    palmar_side: Side | None = None
    region_of_interest_px: Annotated[list[Pixel], Field(min_length=4, max_length=4)] | None = None
    synthetic: bool = False

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        if (self.outline is None) == (self.file is None):
            raise ValueError("give either outline or file, one of the two")
        if self.file is not None and self.scale is None:
            raise ValueError("an image needs its scale, as in scale = { ppi = 500 }")
        ours = {"face", "synthetic", "outline", "outline_relative_std"}
        idle = (
            self.model_fields_set - ours if self.outline else self.model_fields_set & {"outline_relative_std"}
        )
        if idle:
            beside = "an outline" if self.outline else "an image"
            raise ValueError(f"beside {beside} there is no use for {', '.join(sorted(idle))}")
        return self


class Finger(ManifestModel):
    """A finger, with its semi-axes given or to be fitted to the outlines of its photographs."""

    name: Name
    person: Name | None = None
    semi_axes_mm: SemiAxes | None = None
    semi_axes_mm_std: SemiAxesStd | None = None
    photographs: list[Photograph] = Field(default=[])
    pad_thickness_mm: Length | None = None
    effective_thickness_mm: TissueThickness | None = None
    effective_thickness_mm_std: LengthStd | None = None
    synthetic: bool = False

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        if (self.semi_axes_mm is None) == (not self.photographs):
            raise ValueError("give either semi_axes_mm or photographs, one of the two")
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
