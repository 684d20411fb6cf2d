"""Results as JSON: arrays become lists, NaN becomes null."""

import json
import math
from collections.abc import Mapping
from typing import Any

import numpy as np


def plain(value: Any) -> Any:
    """Return `value` as what JSON can hold."""
    if isinstance(value, np.ndarray) and value.dtype.kind in "biuf":
        known = np.isfinite(value)
        if not known.all():
            value = value.astype(object)
            value[~known] = None
        return value.tolist()
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    # Dataclasses and pydantic models are what their fields hold.
    fields = getattr(type(value), "__dataclass_fields__", getattr(type(value), "__pydantic_fields__", None))
    if fields is not None:
        return {name: plain(getattr(value, name)) for name in fields}
    if isinstance(value, Mapping):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def dumps(value: Any, *, indent: int | None = None) -> str:
    """Return `value` as a JSON text."""
    return json.dumps(plain(value), indent=indent, ensure_ascii=False, allow_nan=False)
