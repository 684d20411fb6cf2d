"""Parts of all answers, and types that many of them have."""

from collections.abc import Mapping
from typing import Any, Literal, Self, TypeAlias

from pydantic import BaseModel, ConfigDict

from fingerpad._json import dumps

Point: TypeAlias = tuple[float, float]
Point3D: TypeAlias = tuple[float, float, float]
MeasuredBy: TypeAlias = Literal["automatic", "corrected", "manual"]
Status: TypeAlias = Literal["done", "failed", "stale", "left", "given", "rejected"]
Cell: TypeAlias = str | bool | int | float | None
Face: TypeAlias = Literal["palmar", "distal", "radial", "ulnar"]
Axis: TypeAlias = Literal["palmar", "distal", "radial_ulnar"]


class Answer(BaseModel):
    """An answer, or a part of one: no key is added or left out."""

    model_config = ConfigDict(extra="forbid", json_schema_serialization_defaults_required=True)

    @classmethod
    def of(cls, content: Mapping[str, Any]) -> Self:
        """Return the answer with some content: arrays become lists, and NaN becomes null."""
        # A file's name may hold bytes that are not text.
        return cls.model_validate_json(dumps(content).encode(errors="replace"))


class Fault(BaseModel):
    """What is wrong with a request, and where."""

    place: str = ""
    words: str


class Refusal(Answer):
    """Why a request failed: `digest` where another window changed what it was about."""

    model_config = ConfigDict(extra="allow")

    error: str
    faults: list[Fault] = []
    digest: str | None = None


class PoolingCorrectionRecord(Answer):
    """A manual correction of whether a contact is pooled."""

    include: bool
    why: str
    who: str
    when: str
