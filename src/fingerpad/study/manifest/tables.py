"""What all tables of the manifest are made of."""

from typing import Annotated, TypeAlias

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
Load = Annotated[float, Field(gt=0, le=1e4, allow_inf_nan=False), AfterValidator(not_tiny)]
RelativeStd = Annotated[float, Field(ge=0, lt=1, allow_inf_nan=False)]
WedgeAngle = Annotated[float, Field(ge=0, le=90)]
AngleStd = Annotated[float, Field(ge=0, le=90, allow_inf_nan=False)]
Finite = Annotated[float, Field(allow_inf_nan=False)]
# A place in a picture, or so far beside it that nothing of it is seen.
_NEAR = Field(ge=-1_000_000, le=1_000_000)
Pixel = Annotated[float, _NEAR]
# Names become file names: letters, digits and . _ + - only.
Name = Annotated[str, Field(pattern=r"^\w[\w.+-]*$", max_length=60)]


class Table(BaseModel):
    """A table of the manifest: no key that is not known, no value that changes."""

    model_config = ConfigDict(extra="forbid", frozen=True)


def _listed(value: object) -> object:
    """Let a spreadsheet's cell hold a list, as in "250, 200"."""
    return [float(part) for part in value.split(",")] if isinstance(value, str) else value


Point: TypeAlias = Annotated[list[Pixel], Field(min_length=2, max_length=2), BeforeValidator(_listed)]
Box: TypeAlias = Annotated[
    list[Annotated[int, _NEAR]], Field(min_length=4, max_length=4), BeforeValidator(_listed)
]
