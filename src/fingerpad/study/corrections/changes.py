"""What a person can correct in a measurement: each change says all that is wanted of its item."""

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Annotated, Any, Literal, Self, TypeAlias

import numpy as np
from pydantic import AfterValidator, Field, StringConstraints, model_validator

from fingerpad.image import BrushStroke, ImageEllipse, Phase, PhaseIntervals, RegionPolygon
from fingerpad.study.manifest.models import Box, Finite, ManifestModel, Pixel, Point, Positive, Side, not_tiny

Reason = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=500)]
Size = Annotated[float, Field(gt=0, le=1e5, allow_inf_nan=False), AfterValidator(not_tiny)]
Pair = Annotated[list[Size], Field(min_length=2, max_length=2)]
Points = Annotated[list[Point], Field(min_length=1, max_length=5000)]
# Key of what a person drew, its points (row, column), and how far round them that reaches, px.
Drawn: TypeAlias = tuple[str, Sequence[Sequence[float]], float]


class Stroke(ManifestModel):
    """A stroke of a round brush or rubber; of one point a disk."""

    points_px: Points
    radius_px: Size


class RegionStroke(ManifestModel):
    """A stroke over a contact region; without a radius the points enclose an area."""

    action: Literal["add", "remove", "replace"]
    points_px: Points
    radius_px: Size | None = None

    @model_validator(mode="after")
    def _drawn(self) -> Self:
        if self.radius_px is None and len(self.points_px) < 3:
            raise ValueError("points_px: an area needs three points or more; give radius_px for a stroke")
        if self.radius_px is not None and self.action == "replace":
            raise ValueError("radius_px: leave it out: an area replaces the region, a stroke does not")
        return self

    @property
    def edit(self) -> BrushStroke | RegionPolygon:
        """The stroke as `PreparedContactImage.measure` takes it."""
        points = [(row, column) for row, column in self.points_px]
        if self.radius_px is None:
            return RegionPolygon(action=self.action, points=points)
        assert self.action != "replace"
        return BrushStroke(action=self.action, points=points, radius=self.radius_px)


class ManualContactEllipse(ManifestModel):
    """A contact ellipse by its handles: major and minor semi-axis, the major's angle from straight up."""

    centre: Point
    semi_axes: Pair
    orientation_deg: Finite = 0.0

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.semi_axes[1] > self.semi_axes[0]:
            raise ValueError(f"semi_axes: give the major one first, found {self.semi_axes}")
        return self


class ManualFaceEllipse(ManifestModel):
    """The ellipse of a face by its handles: semi-axes across and along, turned from across towards along."""

    centre: Point
    semi_axes: Pair
    tilt_deg: Annotated[float, Field(ge=-90, le=90)] = 0.0


class PoolingCorrection(ManifestModel):
    """Whether a contact counts in pooled results, as corrected manually, and why."""

    include: bool
    why: Reason


class PhaseStart(ManifestModel):
    """A phase of a press, and when it begins on the clock of the force."""

    phase: Phase
    start_s: Finite


class PhaseCorrection(ManifestModel):
    """The phases of a press as set manually, and why; up to the first it is not loaded yet."""

    starts: Annotated[list[PhaseStart], Field(min_length=1, max_length=1000)]
    why: Reason

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        for one, other in pairwise(self.starts):
            if other.start_s < one.start_s:
                raise ValueError(
                    f"starts: {other.phase} at {other.start_s:g} s begins before {one.phase} at "
                    f"{one.start_s:g} s: give them in their order"
                )
        return self

    @property
    def intervals(self) -> PhaseIntervals:
        """The phases as `measure_sequence` takes them."""
        return PhaseIntervals([one.start_s for one in self.starts], [one.phase for one in self.starts])


class _Judged(ManifestModel):
    """Whether a person takes the measurement, or why not."""

    accepted: bool = False
    rejected: Reason | None = None

    @model_validator(mode="after")
    def _one_verdict(self) -> Self:
        if self.accepted and self.rejected is not None:
            raise ValueError("give either accepted or rejected, one of the two")
        return self

    @property
    def edits(self) -> dict[str, Any]:
        """What it says of the measurement beyond the verdict, as JSON."""
        verdict = {"accepted", "rejected", "pooling"}
        return self.model_dump(mode="json", exclude_defaults=True, exclude=verdict)

    def as_json(self) -> dict[str, Any]:
        """Return it as a record keeps it."""
        return self.model_dump(mode="json", exclude_defaults=True)

    def _drawn(self) -> Iterator[Drawn]:
        """Yield what is drawn into the picture."""
        yield from ()

    def outside(self, shape: tuple[int, int]) -> str | None:
        """Say what misses a picture of this shape altogether; None where nothing does."""
        for name, points, reach in self._drawn():
            first, last = np.min(points, axis=0), np.max(points, axis=0)
            if np.any(last < -0.5 - reach) or np.any(first > np.array(shape) - 0.5 + reach):
                return (
                    f"{name}: row {first[0]:g}, column {first[1]:g} lies outside the picture of {shape[0]} "
                    f"rows and {shape[1]} columns"
                )
        return None


class ContactCorrection(_Judged):
    """What a person corrects in the measurement of a contact image or a frame."""

    dark_on_light: bool | None = None
    threshold: Positive | None = None
    seed_px: Point | None = None
    mask_px: Annotated[list[Point], Field(min_length=3, max_length=5000)] | None = None
    region_of_interest_px: Box | None = None
    strokes: Annotated[list[RegionStroke], Field(max_length=2000)] = Field(default=[])
    ellipse_px: ManualContactEllipse | None = None
    key_frame: bool = False
    pooling: PoolingCorrection | None = None

    @model_validator(mode="after")
    def _carried(self) -> Self:
        if self.key_frame and self.ellipse_px is None:
            raise ValueError("key_frame: only an ellipse is carried to other frames: give ellipse_px")
        return self

    @property
    def manual_ellipse(self) -> ImageEllipse | None:
        """The ellipse as `PreparedContactImage.measure` takes it."""
        if self.ellipse_px is None:
            return None
        (row, column), (major, minor) = self.ellipse_px.centre, self.ellipse_px.semi_axes
        turn = self.ellipse_px.orientation_deg
        return ImageEllipse(centre=(row, column), semi_axes=(major, minor), orientation=math.radians(turn))

    def _drawn(self) -> Iterator[Drawn]:
        if self.seed_px:
            yield "seed_px", [self.seed_px], 0.0
        if self.mask_px:
            yield "mask_px", self.mask_px, 0.0
        if box := self.region_of_interest_px:
            yield "region_of_interest_px", [box[:2], box[2:]], 0.0
        if self.ellipse_px:
            yield "ellipse_px.centre", [self.ellipse_px.centre], 0.0
        for k, stroke in enumerate(self.strokes):
            yield f"strokes[{k}].points_px", stroke.points_px, stroke.radius_px or 0.0


class PhotographCorrection(_Judged):
    """What a person corrects in the measurement of a photograph."""

    region_of_interest_px: Annotated[list[Pixel], Field(min_length=4, max_length=4)] | None = None
    tip: Side | None = None
    palmar_side: Side | None = None
    ellipse_px: ManualFaceEllipse | None = None
    added_points_px: Annotated[list[Point], Field(max_length=5000)] = Field(default=[])
    erased: Annotated[list[Stroke], Field(max_length=2000)] = Field(default=[])

    def _drawn(self) -> Iterator[Drawn]:
        # The ellipse's centre may lie beyond a picture that shows the tip alone.
        if box := self.region_of_interest_px:
            yield "region_of_interest_px", [box[:2], box[2:]], 0.0
        yield from ((f"added_points_px[{k}]", [point], 0.0) for k, point in enumerate(self.added_points_px))
        for k, stroke in enumerate(self.erased):
            yield f"erased[{k}].points_px", stroke.points_px, stroke.radius_px


class SequenceCorrection(_Judged):
    """What a person corrects in a sequence as a whole."""

    accepted: Literal[False] = False
    rejected: None = None
    phases: PhaseCorrection | None = None


Change: TypeAlias = ContactCorrection | PhotographCorrection | SequenceCorrection
