"""A digest of results: the same for the same values in every process, which a pickle's bytes are not."""

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
import pandas as pd
from pydantic import BaseModel

from fingerpad.study.results.columns import COLUMNS


def digest_of_values(*values: object) -> str:
    """Return the SHA-256 of some values: plain ones, arrays, tables, models, dataclasses and lists of them.

    Examples
    --------
    >>> digest_of_values({"a": 1.0}, {"x", "y"}) == digest_of_values({"a": 1.0}, {"y", "x"})
    True
    >>> digest_of_values(1) == digest_of_values(1.0)
    False
    """
    digest = hashlib.sha256()
    for part in _parts(values):
        digest.update(len(part).to_bytes(8, "big") + part)
    return digest.hexdigest()


def _parts(value: Any) -> Iterator[bytes]:
    """Yield a value bit by bit, each with its kind."""
    yield type(value).__name__.encode()
    if isinstance(value, np.ndarray):
        yield f"{value.dtype.str} {value.shape}".encode()
        yield repr(value.tolist()).encode() if value.dtype == object else value.tobytes()
    elif isinstance(value, BaseModel):
        yield value.model_dump_json().encode()
        yield value.model_dump_json(exclude_unset=True).encode()
    elif (inner := _inside(value)) is not None:
        yield repr(len(inner)).encode()
        for item in inner:
            yield from _parts(item)
    else:
        yield repr(value).encode()


def _inside(value: Any) -> Sequence[Any] | None:
    """Return what a value is made of, in an order of its own; None for a plain one."""
    if isinstance(value, pd.DataFrame):
        return [value[name].to_numpy() for name in COLUMNS]
    if is_dataclass(value):
        return [getattr(value, field.name) for field in fields(value)]
    if isinstance(value, Mapping):
        return list(value.items())
    if isinstance(value, set | frozenset):
        return sorted(map(repr, value))
    return value if isinstance(value, list | tuple) else None
