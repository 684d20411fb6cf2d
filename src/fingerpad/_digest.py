"""The digest of values of any kind, by which what was made of them is found again."""

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
import pandas as pd
from pydantic import BaseModel


def digest_of_values(*values: object) -> str:
    """Return the SHA-256 of plain values, arrays, tables, models, dataclasses and lists of them."""
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
        return [value[name].to_numpy() for name in sorted(value)]
    if is_dataclass(value):
        return [getattr(value, field.name) for field in fields(value)]
    if isinstance(value, Mapping):
        return list(value.items())
    if isinstance(value, set | frozenset):
        return sorted(map(repr, value))
    return value if isinstance(value, list | tuple) else None
