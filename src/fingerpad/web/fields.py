"""What questions are made of."""

from typing import Annotated, TypeAlias

from pydantic import Field

from fingerpad.study.manifest.tables import Pixel

Spot: TypeAlias = Annotated[list[Pixel], Field(min_length=2, max_length=2)]
Line: TypeAlias = Annotated[list[Spot], Field(min_length=2, max_length=2)]
Item: TypeAlias = Annotated[str, Field(min_length=1, max_length=1000)]
Person: TypeAlias = Annotated[str, Field(max_length=60)]


def as_pair(spot: list[float]) -> tuple[float, float]:
    """Return a place as the library takes it."""
    return spot[0], spot[1]
