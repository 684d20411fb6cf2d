"""Parts of all answers, and types that many of them have.

Every key is required, so that the page finds what the types promise; what may be missing is null. Lengths of
a picture are pairs (row, column) in pixels.
"""

import json
from collections.abc import Mapping
from typing import Any, ClassVar, Final, Literal, Self, TypeAlias

from pydantic import BaseModel, ConfigDict, computed_field

from fingerpad._arrays import FloatArray
from fingerpad._json import dumps
from fingerpad._rounding import positive_with_uncertainty, value_with_uncertainty

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
    def of(cls, source: object = None, /, **content: Any) -> Self:
        """Return an answer of some content, and for the rest of a source's attributes or keys of these names.

        Arrays become lists, and NaN becomes null.
        """
        rest = cls.model_fields.keys() - content.keys() if source is not None else ()
        if isinstance(source, Mapping):
            found = {name: source.get(name) for name in rest} | content
        else:
            found = {name: getattr(source, name) for name in rest} | content
        checked = {name: found.pop(name) for name in list(found) if _is_checked(found[name])}
        # A file's name may hold bytes that are not text.
        return cls.model_validate(json.loads(dumps(found).encode(errors="replace")) | checked)


def _is_checked(value: object) -> bool:
    """Tell whether something is an answer itself, or a list of them."""
    return isinstance(value[0] if isinstance(value, list) and value else value, Answer)


# Units by the ending of a key.
UNITS: Final = {
    "mm_per_px": "mm/px",
    "_per_mm": "mm⁻¹",
    "_mm2": "mm²",
    "_mm": "mm",
    "_kpa": "kPa",
    "_deg": "°",
    "_px": "px",
    "_ppi": "ppi",
    "_N": "N",
    "_s": "s",
}


def with_unit(words: str, unit: str) -> str:
    """Return a number in words with its unit."""
    return f"{words}{'' if unit == '°' else ' '}{unit}" if unit else words


def unit_of(key: str) -> str:
    """Return the unit of a quantity, by the ending of its key."""
    return next((unit for ending, unit in UNITS.items() if key.endswith(ending)), "")


def quantity_words(values: Mapping[str, Any], key: str, unit: str | None = None) -> str:
    """Return a quantity with its standard uncertainty, in which the model's part is where it has one."""
    total = values.get(f"{key}_total_std")
    if total is not None:
        words = positive_with_uncertainty(values[key], total)
    else:
        words = value_with_uncertainty(values[key], values.get(f"{key}_std"))
    return with_unit(words.replace(" ", "\u00a0"), unit_of(key) if unit is None else unit)


class Quantities(Answer):
    """Numbers, and each in words: rounded by its uncertainty, with its unit unless a header has it."""

    has_units: ClassVar[bool] = True

    @computed_field  # type: ignore[prop-decorator]
    @property
    def words(self) -> dict[str, str]:
        """Return the numbers in words, by their keys; those of axes as ``semi_axes_mm.palmar``."""
        values, found = dict(self), {}
        for key, value in values.items():
            if key.endswith("_std"):
                continue
            if isinstance(value, float) or (value is None and f"{key}_std" in values):
                found[key] = quantity_words(values, key, None if self.has_units else "")
            elif key.endswith("_mm") and isinstance(value, BaseModel | dict):
                stds = dict(values.get(f"{key}_std") or {})
                for axis, length in dict(value).items():
                    words = value_with_uncertainty(length, stds.get(axis)).replace(" ", "\u00a0")
                    found[f"{key}.{axis}"] = f"{words} mm" if self.has_units else words
        return found


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


class SemiAxes(Answer):
    """Semi-axes of a pad, or their standard uncertainties, mm."""

    palmar: float
    distal: float
    radial_ulnar: float

    @classmethod
    def of_three(cls, lengths: FloatArray) -> Self:
        """Return semi-axes in the order of an array."""
        return cls(**dict(zip(cls.model_fields, lengths.tolist(), strict=True)))
