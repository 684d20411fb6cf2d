"""What is wrong with values of the manifest, in words that name the key."""

import difflib
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Final, TypeVar

from pydantic import BaseModel, ValidationError

from fingerpad.exceptions import ManifestError
from fingerpad.study.manifest.contacts import ContactEllipse, ContactSequence, Observation
from fingerpad.study.manifest.curves import Curve
from fingerpad.study.manifest.fingers import Finger, Photograph, SemiAxes
from fingerpad.study.manifest.scales import TAGS, CoinScale, LineScale, PitchScale, ResolutionScale
from fingerpad.study.manifest.study import Study, Uncertainty

_SCALES: Final = (ResolutionScale, PitchScale, LineScale, CoinScale)
_TABLES: Final = (
    Study,
    Uncertainty,
    Curve,
    Observation,
    ContactSequence,
    ContactEllipse,
    Finger,
    Photograph,
    SemiAxes,
)
_KEYS: Final = tuple(key for table in (*_TABLES, *_SCALES) for key in table.model_fields)
_SCALE_KEYS: Final = frozenset(key for table in _SCALES for key in table.model_fields)
Model = TypeVar("Model", bound=BaseModel)


def validated(model: type[Model], content: Mapping[str, Any], where: str, *, strict: bool) -> Model:
    """Check `content`; cells of a spreadsheet are text and cannot be taken strictly.

    Raises
    ------
    ManifestError
        With one line for each fault.
    """
    try:
        return model.model_validate(content, strict=strict)
    except ValidationError as error:
        faults = _value_faults(error, content)
        raise ManifestError("\n".join(f"{where}: {fault}" for fault in faults)) from None


def _value_faults(error: ValidationError, content: Mapping[str, Any]) -> Iterator[str]:
    """Say for each fault where it is, what is expected, what was found, and the name of what has it."""
    unknown = [str(fault["loc"][-1]) for fault in error.errors() if fault["type"] == "extra_forbidden"]
    meant = {close for key in unknown for close in difflib.get_close_matches(key, _KEYS, n=1)}
    for fault in error.errors():
        place, key = _place(fault["loc"]), str(fault["loc"][-1]) if fault["loc"] else ""
        message = fault["msg"].removeprefix("Value error, ").replace("Input should be", "expected")
        if fault["type"] == "missing" and key in meant:
            continue  # said with the unknown key that was meant for it
        owner = "" if key == "name" else _owner(fault["loc"], content)
        if fault["type"] == "extra_forbidden":
            words = f"unknown key{_hint(key)}"
        elif fault["type"] == "string_pattern_mismatch":
            words = f"write it with letters, digits and . _ + - only, found {fault['input']!r}"
        elif fault["type"] == "missing":
            words = "required, but missing"
        elif isinstance(fault["input"], dict) and fault["type"] == "list_type":
            words, owner = f"expected a list of tables: write [[{place}]] in place of [{place}]", ""
        elif isinstance(fault["input"], str | int | float | bool):
            words = f"{message}, found {repr(fault['input'])[:60]}"
        else:
            words = message
        yield f"{place}: {words}{owner}" if place else words


def _place(parts: Iterable[int | str]) -> str:
    """Return where a fault is, as the manifest would write it."""
    seen = (part for part in parts if part not in TAGS)
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in seen).lstrip(".")


def _owner(parts: Iterable[int | str], content: Any) -> str:
    """Return the name of the innermost table with one, as the end of a fault: the n-th is hard to count."""
    name = None
    for part in parts:
        try:
            content = content[part]
        except (KeyError, IndexError, TypeError):  # the tag of a choice is no place
            continue
        name = content.get("name", name) if isinstance(content, Mapping) else name
    return f" (in {name})" if isinstance(name, str) else ""


def _hint(key: str) -> str:
    if key in _SCALE_KEYS:
        return f"; write it in the table of a scale, as in scale = {{ {key} = ... }}"
    close = difflib.get_close_matches(key, _KEYS, n=1)
    return f"; did you mean {close[0]!r}?" if close else ""
