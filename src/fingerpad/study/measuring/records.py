"""Results as the store keeps them: plain values, to the last digit."""

from collections.abc import Mapping
from dataclasses import asdict, fields, is_dataclass
from typing import Any

import numpy as np

from fingerpad.study.measuring.measure import Measurement


def measurement_record(measured: Measurement) -> dict[str, Any]:
    """Return what is known of a measurement as plain values."""
    known = {name: value for name, value in asdict(measured).items() if value is not None}
    return {**known, "covariance_mm2": measured.covariance_mm2.tolist()}


def measurement_from(record: Mapping[str, Any]) -> Measurement:
    """Return a measurement from its record."""
    return Measurement(
        **{
            **record,
            "covariance_mm2": np.array(record["covariance_mm2"]),
            "flags": tuple(record["flags"]),
        }
    )


def to_plain(value: Any) -> Any:
    """Return a value made of dataclasses, arrays, mappings and tuples as what JSON can hold.

    Examples
    --------
    >>> to_plain({"a": np.arange(2)})
    {'a': {'kind': 'array', 'values': [0, 1]}}
    """
    if isinstance(value, np.ndarray):
        return {"kind": "array", "values": value.tolist()}
    if is_dataclass(value) and not isinstance(value, type):
        inner = {field.name: to_plain(getattr(value, field.name)) for field in fields(value)}
        return {"kind": type(value).__name__, **inner}
    if isinstance(value, Mapping):
        return {key: to_plain(item) for key, item in value.items()}
    if isinstance(value, tuple):
        return [to_plain(item) for item in value]
    return value.item() if isinstance(value, np.generic) else value


def from_plain(value: Any, kinds: Mapping[str, type]) -> Any:
    """Return what `to_plain` was given; only dataclasses of `kinds` are made."""
    if isinstance(value, list):
        return tuple(from_plain(item, kinds) for item in value)
    if not isinstance(value, dict):
        return value
    if value.get("kind") == "array":
        return np.array(value["values"])
    inner = {key: from_plain(item, kinds) for key, item in value.items() if key != "kind"}
    return kinds[value["kind"]](**inner) if "kind" in value else inner
