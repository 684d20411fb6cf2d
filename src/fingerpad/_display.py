"""Representation of results: a short ``repr``, a summary or record as text, and HTML in notebooks."""

import base64
import html
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields
from numbers import Real
from typing import Any, ClassVar

import numpy as np

from fingerpad._rounding import value_with_uncertainty
from fingerpad.exceptions import FingerpadError

_MAX_ITEMS, _MAX_TEXT, _MAX_NESTED = 4, 60, 75


class Displayed:
    """Base of dataclasses with a short representation, whatever the size of their arrays."""

    __slots__ = ()

    def __repr__(self) -> str:
        shown = ", ".join(f"{name}={short_text(value)}" for name, value in self._shown())
        return f"{type(self).__name__}({shown})"

    def _shown(self) -> list[tuple[str, Any]]:
        """Return the fields with their values, but for what is None unless it was asked for."""
        public = (one for one in fields(self) if one.repr and not one.name.startswith("_"))  # type: ignore[arg-type]
        values = ((field, getattr(self, field.name)) for field in public)
        return [
            (field.name, value) for field, value in values if value is not None or field.default is not None
        ]

    def summary(self) -> str:
        """Return the contents in words, one line each, and those of long results in them below."""
        values = self._shown()
        own = titled_lines(type(self).__name__, {name: short_text(value) for name, value in values})
        long = (value for _, value in values if isinstance(value, Displayed) and _is_long(value))
        return "\n\n".join([own, *(value.summary() for value in long)])

    def _repr_html_(self) -> str:
        """Return the summary for a notebook, with a drawing where there is one of its kind."""
        text = f"<pre>{html.escape(self.summary())}</pre>"
        try:
            from fingerpad.figures.show import draw  # noqa: PLC0415 (drawing needs packages that the rest does not)

            image = base64.b64encode(draw(self).png).decode("ascii")
        except (FingerpadError, ImportError):
            return text
        return f'<img src="data:image/png;base64,{image}" style="max-width: 560px" alt="">{text}'


def aligned(lines: Iterable[Sequence[str]], indent: str = "") -> list[str]:
    """Return lines of cells with their columns below each other."""
    lines = list(lines)
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    padded = (
        "  ".join(f"{cell:<{width}}" for cell, width in zip(line, widths, strict=True)) for line in lines
    )
    return [f"{indent}{line.rstrip()}" for line in padded]


def titled_lines(title: str, texts: Mapping[str, str]) -> str:
    """Return a title with names and texts below it, the texts under each other."""
    width = max(map(len, texts), default=0)
    return "\n".join([title, *(f"  {name:<{width}}  {text}" for name, text in texts.items())])


def short_text(value: Any) -> str:
    """Return a value in few words: arrays by few items or by shape, long results by name."""
    if isinstance(value, np.ndarray):
        few = value.ndim <= 1 and value.size <= _MAX_ITEMS
        return short_text(value.tolist()) if few else f"<array {value.shape}>"
    if isinstance(value, Mapping | list | tuple | frozenset):
        return f"<{len(value)} items>" if len(value) > _MAX_ITEMS else _few_items(value)
    if isinstance(value, float | np.floating):
        return f"{value:.6g}"
    if isinstance(value, Displayed):
        return f"{type(value).__name__}(…)" if _is_long(value) else _cut(str(value), _MAX_NESTED)
    if isinstance(value, np.bool_):
        value = bool(value)
    text = value if isinstance(value, str) else repr(value)
    if callable(value):
        return f"<{type(value).__name__}>"
    return _cut(text, _MAX_TEXT)


def _cut(text: str, length: int) -> str:
    return text if len(text) <= length else f"{text[:length]}…"


def _is_long(value: Displayed) -> bool:
    """Return whether a result does not fit a line; words of its own, unlike its representation, are cut."""
    text = str(value)
    return "\n" in text or (len(text) > _MAX_NESTED and text == repr(value))


def _few_items(values: Mapping[Any, Any] | list[Any] | tuple[Any, ...] | frozenset[Any]) -> str:
    if isinstance(values, Mapping):  # keys alone, but for numbers
        items = [
            f"{key}: {short_text(one)}" if isinstance(one, Real) else str(key) for key, one in values.items()
        ]
    else:
        items = [short_text(value) for value in values]
    if isinstance(values, frozenset):
        items.sort()
    return f"[{', '.join(items)}]" if isinstance(values, list) else f"({', '.join(items)})"


class Recorded(Displayed):
    """Base of results whose summary is their record of plain values."""

    __slots__ = ()
    _title: ClassVar[str]

    def as_record(self) -> dict[str, Any]:
        """Return the numbers by names that end in units."""
        raise NotImplementedError

    def summary(self) -> str:
        """Return the numbers as text, one line each.

        Returns
        -------
        str
            With units and uncertainties.
        """
        return record_text(self._title, self.as_record())


def record_text(title: str, record: Mapping[str, Any]) -> str:
    """Return a record as lines: numbers with their standard uncertainty, what is unknown left out."""
    shown = {
        name: value_with_uncertainty(value, record.get(f"{name}_std"))
        if isinstance(value, float)
        else short_text(value)
        for name, value in record.items()
        if not (_is_empty(value) or name.endswith(("_std", "_ci95")))
    }
    return titled_lines(title, shown)


def _is_empty(value: Any) -> bool:
    return value is None or (isinstance(value, tuple | list | dict | frozenset) and not value)
