"""Words of what is wrong with the values of a table."""

import difflib
from collections.abc import Iterable, Iterator
from functools import cache
from typing import Any, Final, NamedTuple, TypeVar

from pydantic import BaseModel, TypeAdapter, ValidationError

from fingerpad.exceptions import ManifestError
from fingerpad.study.manifest.models import TAGS, Loc, ManifestModel, ScaleTable, Study

_SCALE_KEYS: Final = frozenset(key for table in ScaleTable.__args__ for key in table.model_fields)

Model = TypeVar("Model", bound=BaseModel)


class Fault(NamedTuple):
    """Something that is missing or wrong in a table."""

    key_path: str  # empty for the table itself
    words: str

    def __str__(self) -> str:
        return f"{self.key_path}: {self.words}" if self.key_path else self.words


def checked(kind: TypeAdapter[Any], content: Any, *, strict: bool) -> tuple[Any, tuple[Fault, ...]]:
    """Return a table as `kind`, or None and its faults; cells of text cannot be taken strictly."""
    try:
        return kind.validate_python(content, strict=strict), ()
    except ValidationError as error:
        return None, tuple(_faults(error))


def validated(model: type[Model], content: Any, where: str, *, strict: bool) -> Model:
    """Return a table as a model; `ManifestError` has one line for each fault."""
    found, faults = checked(TypeAdapter(model), content, strict=strict)
    if faults:
        raise ManifestError("\n".join(f"{where}: {fault}" for fault in faults))
    assert isinstance(found, model)
    return found


def _faults(error: ValidationError) -> Iterator[Fault]:
    """Yield each fault with what is expected and what was found."""
    unknown = [str(fault["loc"][-1]) for fault in error.errors() if fault["type"] == "extra_forbidden"]
    meant = {close for key in unknown for close in difflib.get_close_matches(key, _keys(), n=1)}
    for fault in error.errors():
        key = str(fault["loc"][-1]) if fault["loc"] else ""
        message = fault["msg"].removeprefix("Value error, ").replace("Input should be", "expected")
        if fault["type"] == "missing" and key in meant:
            continue  # said with the unknown key that was meant for it
        if fault["type"] == "extra_forbidden":
            words = f"unknown key{_hint(key)}"
        elif fault["type"] == "string_pattern_mismatch":
            words = f"write it with letters, digits and . _ + - only, found {fault['input']!r}"
        elif fault["type"] == "missing":
            words = "required, but missing"
        elif isinstance(fault["input"], str | int | float | bool):
            words = f"{message}, found {repr(fault['input'])[:60]}"
            if fault["type"] == "float_type" and isinstance(fault["input"], str):
                words += "; numbers stand without quotes and have a decimal point"
            elif fault["type"] == "float_parsing" and "," in str(fault["input"]):
                words += "; write it with a decimal point, as the other numbers of the table"
        else:
            words = message
        yield Fault(key_path(fault["loc"]), words)


def key_path(loc: Loc) -> str:
    """Return the path of a key as the manifest would write it."""
    seen = (part for part in loc if part not in TAGS and part != "[key]")  # pydantic's, of a wrong key
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in seen).lstrip(".")


@cache
def _keys() -> tuple[str, ...]:
    """Return the keys of all tables, for what a misspelt one was meant to be."""

    def inner(models: Iterable[type[ManifestModel]]) -> Iterator[str]:
        for model in models:
            yield from model.model_fields
            yield from inner(model.__subclasses__())

    return tuple(dict.fromkeys(inner((Study, *ManifestModel.__subclasses__()))))


def _hint(key: str) -> str:
    if key in _SCALE_KEYS:
        return f"; write it in the table of a scale, as in scale = {{ {key} = ... }}"
    if key in _keys():
        return "; it belongs in another table"
    close = difflib.get_close_matches(key, _keys(), n=1)
    return f"; did you mean {close[0]!r}?" if close else ""
