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
    """Out of the pad, mm."""
    distal: Length
    """Out of the fingertip, mm."""
    radial_ulnar: Length
    """Across the finger, mm."""


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
    """CSV file of outline points, `x_mm,y_mm`, in place of a photograph."""
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
    """A finger, with its semi-axes given or to be fitted to the outlines of its photographs."""

    name: Name
    """Name of the finger, by which observations refer to it."""
    person: Name | None = None
    """Code for the person; without it all fingers of the study are taken as one person's."""
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
