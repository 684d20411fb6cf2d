"""What commands print: records as JSON or as text, notes and errors on stderr."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import typer

from fingerpad._display import aligned
from fingerpad._json import dumps, plain
from fingerpad._rounding import two_digits, value_with_uncertainty
from fingerpad.flags import Flagged, flags_in


def error(words: str) -> None:
    """Print lines on stderr, each beginning with the name of the command."""
    for line in words.splitlines():
        typer.echo(f"fingerpad: {line}", err=True)


def note(words: str) -> None:
    """Print on stderr what looks wrong in the input."""
    typer.echo(f"note: {words}", err=True)


def result(record: Any, as_json: bool, as_text: Callable[[Any], None] | None = None) -> None:
    """Print a record as one JSON document, or as text: by default as lines, one for each key."""
    if as_json:
        typer.echo(dumps(record))
    else:
        (as_text or text)(record)


def folder(title: str, path: Path | None, as_json: bool) -> None:
    """Say where pictures or a page were written, if any were, unless scripts read the output."""
    if path is not None and not as_json:
        typer.echo(f"{title}: {path}")


def text(record: Mapping[str, Any]) -> None:
    """Print a record as lines of text, each number with its standard uncertainty."""
    values = plain(record)
    shown = {}
    for key, value in values.items():
        if not key.endswith("_std"):
            shown[key] = _text(value, values.get(f"{key}_std"))
        elif key.removesuffix("_std") not in values:
            shown[key] = two_digits(value) if isinstance(value, float) and value > 0 else _text(value)
    rows(shown.items())


def rows(lines: Iterable[Sequence[str]]) -> None:
    """Print lines of cells with their columns below each other."""
    typer.echo("\n".join(aligned(lines)))


def flags(record: Mapping[str, Any], *kinds: Flagged) -> None:
    """Print what each flag of a record means, and what to do about it."""
    for flag in flags_in(record.get("flags", ()), *kinds):
        typer.echo(f"{flag.code}: {flag.words}. To do: {flag.to_do}.")


def _text(value: Any, std: Any = None) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{key} {_text(item, (std or {}).get(key))}" for key, item in value.items())
    if isinstance(value, list):
        parts = (f"({_text(item)})" if isinstance(item, list) else _text(item) for item in value)
        return ", ".join(parts) or "none"
    if value is None:
        return "not known"
    if isinstance(std, float) and std > 0:
        return value_with_uncertainty(value, std)
    return f"{value:.6g}" if isinstance(value, float) else str(value)
