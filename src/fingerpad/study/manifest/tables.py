"""What all tables of the manifest are made of."""

from collections.abc import Iterator
from functools import cache
from typing import Annotated, Final, TypeAlias

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field


def not_tiny(value: float) -> float:
    """Return a value that is more than positive by name: arithmetic on others underflows."""
    if value < 1e-9:
        raise ValueError(f"{value:g} is too small to be meant")
    return value


# Wide bounds that only a wrong unit or a typing error exceeds.
Positive = Annotated[float, Field(gt=0, le=1e6, allow_inf_nan=False), AfterValidator(not_tiny)]
Length = Annotated[float, Field(gt=0, le=1000, allow_inf_nan=False), AfterValidator(not_tiny)]
LengthStd = Annotated[float, Field(ge=1e-9, le=1000, allow_inf_nan=False)]
# Of tissue over bone at a fingertip, with room on both sides: outside, the unit is wrong.
TissueThickness = Annotated[float, Field(ge=0.5, le=50, allow_inf_nan=False)]
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
    return [float(part) for part in value.split(",")] if isinstance(value, str) else value


Point: TypeAlias = Annotated[list[Pixel], Field(min_length=2, max_length=2), BeforeValidator(_listed)]
Box: TypeAlias = Annotated[
    list[Annotated[int, _NEAR]], Field(min_length=4, max_length=4), BeforeValidator(_listed)
]
