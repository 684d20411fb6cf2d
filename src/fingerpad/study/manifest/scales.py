"""Scales of pictures: one way to say each, in a table of its own or in place."""

from typing import Annotated, Final, Literal, Self, TypeAlias, get_args

from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from fingerpad.study.manifest.tables import Length, ManifestModel, Name, Pixel, RelativeStd

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
    if isinstance(scale, LineScale):
        return not (scale.length_mm_std or scale.ends_px_std)
    if isinstance(scale, CircleScale):
        return not (scale.diameter_mm_std or scale.points_px_std)
    return isinstance(scale, ResolutionScale | PitchScale) and not scale.relative_std
