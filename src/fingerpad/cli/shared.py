"""What all commands share: errors in plain words, exit codes, and printing."""

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from enum import IntEnum
from typing import Annotated, Any, TypeAlias

import typer

from fingerpad._json import dumps, plain
from fingerpad.exceptions import FingerpadError, GeometryError

AsJson: TypeAlias = Annotated[bool, typer.Option("--json", help="Print one JSON document instead of text.")]


class Exit(IntEnum):
    """Exit codes."""

    REFUSED = 2  # manifest, command line, or a place where results cannot be written
    SOME_FAILED = 3
    INTERRUPTED = 130


@contextmanager
def plain_errors() -> Iterator[None]:
    """Turn the library's errors into lines on stderr and an exit code."""
    try:
        yield
    except FingerpadError as error:
        for line in str(error).splitlines():
            typer.echo(f"fingerpad: {line}", err=True)
        raise typer.Exit(Exit.REFUSED) from None
    except KeyboardInterrupt:
        typer.echo("fingerpad: interrupted; what was measured is kept: run it again to go on", err=True)
        raise typer.Exit(Exit.INTERRUPTED) from None


def require_positive(flag: str, value: float | None) -> None:
    """Refuse a value that is given but not positive and finite."""
    if value is not None and not (value > 0 and math.isfinite(value)):
        raise GeometryError(f"{flag} must be positive and finite, found {value:g}")


def print_json(value: Any) -> None:
    """Print one JSON document."""
    typer.echo(dumps(value))


def print_record(record: Mapping[str, Any], as_json: bool) -> None:
    """Print a record as JSON or as lines of text."""
    if as_json:
        print_json(record)
    else:
        print_text(record)


def print_text(record: Mapping[str, Any]) -> None:
    """Print a record as lines of text."""
    width = max(map(len, record))
    for key, value in plain(record).items():
        typer.echo(f"{key:<{width}}  {_text(value)}")


def _text(value: Any) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{key} {_text(item)}" for key, item in value.items())
    if isinstance(value, list):
        return ", ".join(map(_text, value)) or "none"
    if value is None:
        return "not known"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
