"""Frozen dataclasses, arrays and models of these as records that JSON can hold, and back."""

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from functools import cache
from typing import Any, Final, TypeVar, get_args, get_origin, get_type_hints

import numpy as np
from cattrs import Converter
from cattrs.gen import make_dict_unstructure_fn, override

Structured = TypeVar("Structured")


def _is_array(kind: Any) -> bool:
    return kind is np.ndarray or get_origin(kind) is np.ndarray


def _array_maker(kind: Any) -> Any:
    """Return what makes an array of the type that an annotation such as `FloatArray` states."""
    (dtype,) = get_args(get_args(kind)[1])
    return lambda values, _: np.array(values, dtype=dtype)


def _without_none(kind: Any) -> Any:
    """Return what makes a record of a dataclass: a field that is None by default is left out where it is."""
    optional: Any = {one.name: override(omit_if_default=True) for one in fields(kind) if one.default is None}
    return make_dict_unstructure_fn(kind, _CONVERTER, **optional)


_CONVERTER: Final = Converter(detailed_validation=False, unstruct_collection_overrides={frozenset: sorted})
_CONVERTER.register_unstructure_hook_func(_is_array, np.ndarray.tolist)
_CONVERTER.register_unstructure_hook_factory(is_dataclass, _without_none)
_CONVERTER.register_structure_hook_factory(_is_array, _array_maker)
# What checks its arguments itself takes them by name only.
_CONVERTER.register_structure_hook_func(
    lambda kind: is_dataclass(kind) and not kind.__dataclass_params__.init,  # type: ignore[union-attr]
    lambda record, kind: kind(**fields_from(kind, record)),
)
_hints = cache(get_type_hints)


def to_record(value: Any) -> Any:
    """Return a value made of dataclasses, arrays, mappings and sequences as what JSON can hold."""
    return _CONVERTER.unstructure(value)


def from_record(kind: type[Structured], record: Any) -> Structured:
    """Return what `to_record` was given, by the annotations of its type."""
    return _CONVERTER.structure(record, kind)


def fields_from(kind: type, record: Mapping[str, Any]) -> dict[str, Any]:
    """Return the fields of a dataclass of which a record holds only some."""
    hints = _hints(kind)
    return {name: _CONVERTER.structure(record[name], hints[name]) for name in hints if name in record}
