"""Parts of all answers, and types that many of them have.

Every key is required, so that the page finds what the types promise; what may be missing is null. Lengths of
a picture are pairs (row, column) in pixels.
"""

import json
import math
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from http import HTTPStatus
from typing import Any, Final, Literal, Self, TypeAlias, get_args

from pydantic import BaseModel, ConfigDict
from starlette.exceptions import HTTPException

from fingerpad._arrays import FloatArray
from fingerpad._json import dumps
from fingerpad._rounding import positive_with_uncertainty, value_with_uncertainty
from fingerpad._words import unbroken
from fingerpad.study.corrections.apply import NOTHING
from fingerpad.study.corrections.log import ActiveCorrection

Point: TypeAlias = tuple[float, float]
Point3D: TypeAlias = tuple[float, float, float]
Status: TypeAlias = Literal["done", "failed", "stale", "left", "given", "rejected"]
Cell: TypeAlias = str | bool | int | float | None
Axis: TypeAlias = Literal["palmar", "distal", "radial_ulnar"]


class Answer(BaseModel):
    """An answer, or a part of one: no key is added or left out."""

    model_config = ConfigDict(extra="forbid", json_schema_serialization_defaults_required=True)

    @classmethod
    def of(cls, source: object = None, /, **content: Any) -> Self:
        """Return an answer of some content, and for the rest of a source's attributes or keys of these names.

        A quantity is made of its number and what is known of its uncertainty. Arrays become lists, and NaN
        becomes null.
        """

        def known(name: str) -> Any:
            if name in content or source is None:
                return content.get(name)
            if isinstance(source, Mapping):
                return source.get(name)
            return getattr(source, name) if name in cls.model_fields else getattr(source, name, None)

        found = content if source is None else content | {name: known(name) for name in cls.model_fields}
        for name, field in cls.model_fields.items():
            if field.annotation is Quantity and not isinstance(found.get(name), Quantity):
                found[name] = Quantity.read(known, name)
                for std in (f"{name}_std", f"{name}_total_std"):
                    found.pop(std, None)
        checked = {name: found.pop(name) for name in list(found) if _is_checked(found[name])}
        # A file's name may hold bytes that are not text.
        return cls.model_validate(json.loads(dumps(found).encode(errors="replace")) | checked)


def _is_checked(value: object) -> bool:
    """Tell whether something is an answer itself, or a list or table of them."""
    if isinstance(value, dict):
        value = list(value.values())
    return _is_checked(value[0]) if isinstance(value, list) and value else isinstance(value, Answer)


# Units by the ending of a key.
UNITS: Final = {
    "mm_per_px": "mm/px",
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


@cache
def unit_of(key: str) -> str:
    """Return the unit of a quantity, by the ending of its key."""
    return next((unit for ending, unit in UNITS.items() if key.endswith(ending)), "")


class Quantity(Answer):
    """A number, its standard uncertainty with what the model leaves uncertain, and both in words.

    The words are rounded by the uncertainty, with the unit unless a header has it; a dash where there is no
    number.
    """

    value: float | None
    std: float | None
    words: str

    @classmethod
    def read(cls, known: Callable[[str], Any], key: str, unit: str | None = None) -> Self:
        """Return what is known under a key, and of its uncertainty under the keys that begin with it."""
        value, total = _finite(known(key)), _finite(known(f"{key}_total_std"))
        std = total if total is not None else _finite(known(f"{key}_std"))
        rounded = value_with_uncertainty if total is None else positive_with_uncertainty
        words = unbroken(rounded(value, std)).replace(" ", "\u00a0")
        if value is not None:
            words = with_unit(words, unit_of(key) if unit is None else unit)
        return cls(value=value, std=std, words=words)


def quantities(
    known: Callable[[str], Any], keys: Iterable[Any], unit: str | None = None
) -> dict[Any, Quantity]:
    """Return what is known under some keys."""
    return {key: Quantity.read(known, key, unit) for key in keys}


def _finite(value: Any) -> float | None:
    return float(value) if isinstance(value, float | int) and math.isfinite(value) else None


class Refusal(Answer):
    """Why a request failed: each fault has its `place` and `words`."""

    model_config = ConfigDict(extra="allow")

    error: str
    faults: list[dict[str, str]] = []


class RequestError(HTTPException):
    """A request that failed: words of what is wrong and what to do, and further keys of the answer."""

    def __init__(self, status: HTTPStatus, words: str, **more: Any) -> None:
        super().__init__(status, words)
        self.more = more

    @classmethod
    def not_there(cls, words: str) -> "RequestError":
        """Return the error that something does not exist."""
        return cls(HTTPStatus.NOT_FOUND, words)

    @classmethod
    def conflict(cls, words: str, **more: Any) -> "RequestError":
        """Return the error that another request came first."""
        return cls(HTTPStatus.CONFLICT, words, **more)

    @classmethod
    def impossible(cls, words: str, **more: Any) -> "RequestError":
        """Return the error that a valid request cannot be done."""
        return cls(HTTPStatus.UNPROCESSABLE_ENTITY, words, **more)


class Review(Answer):
    """What a person did to an item."""

    corrected: bool
    accepted: bool
    rejected: str | None
    who: str | None


def review_of(correction: ActiveCorrection | None) -> dict[str, Any]:
    """Return the content of a `Review`."""
    change, who = (correction.change, correction.who) if correction else (NOTHING, None)
    review = {"corrected": bool(change.edits), "accepted": change.accepted, "rejected": change.rejected}
    return review | {"who": who}


def semi_axes(lengths: FloatArray, stds: FloatArray | None = None, unit: str = "mm") -> dict[Axis, Quantity]:
    """Return semi-axes and their standard uncertainties (mm), both in the order of an array."""
    axes = get_args(Axis)
    values = dict(zip(axes, lengths.tolist(), strict=True))
    if stds is not None:
        values |= zip((f"{axis}_std" for axis in axes), stds.tolist(), strict=True)
    return quantities(values.get, axes, unit)
