"""Records, whose keys carry units, as lines of text."""

from collections.abc import Mapping
from typing import Any, ClassVar

from fingerpad._display import Displayed, short_text
from fingerpad._rounding import value_with_uncertainty


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
        name: _value(value, record.get(f"{name}_std"))
        for name, value in record.items()
        if not _is_empty(value) and not name.endswith(("_std", "_ci95"))
    }
    width = max((len(name) for name in shown), default=0)
    return "\n".join([title, *(f"  {name:<{width}}  {text}" for name, text in shown.items())])


def _is_empty(value: Any) -> bool:
    return value is None or (isinstance(value, tuple | list | dict | frozenset) and not value)


def _value(value: Any, std: float | None) -> str:
    return value_with_uncertainty(value, std) if isinstance(value, float) else short_text(value)
