"""Cells of CSV files, safe from being read as formulas by spreadsheets."""

import csv
import math
import re
from collections.abc import Iterable
from importlib.resources import files
from pathlib import Path
from types import SimpleNamespace
from typing import Final, Literal

# What spreadsheets take for a formula, or what reads as escaped; numbers and lists of them are neither.
_FIRST: Final = frozenset("'=+-@\t\r")
_FORMULA: Final = re.compile(r"'*[=+\-@\t\r]")
_NUMBER: Final = r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?"
_NUMBERS: Final = re.compile(rf"{_NUMBER}(?:, ?{_NUMBER})*")


def escape_formula(text: str) -> str:
    """Return a text as a CSV cell that no spreadsheet evaluates; `unescape_formula` is its inverse."""
    if text[:1] not in _FIRST or not _FORMULA.match(text) or _NUMBERS.fullmatch(text):
        return text
    return f"'{text}"


def unescape_formula(cell: str) -> str:
    """Return the text of a cell that `escape_formula` may have escaped."""
    return cell[1:] if cell.startswith("'") and _FORMULA.match(cell) else cell


def csv_cell(value: object) -> str:
    """Return a value as a CSV cell, empty for None and for numbers that are not finite."""
    if value is None:
        return ""
    if isinstance(value, float):
        return float.__repr__(value) if math.isfinite(value) else ""
    if isinstance(value, str):
        return escape_formula(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, list | tuple) and not any(isinstance(item, list | tuple) for item in value):
        return ", ".join(map(csv_cell, value))
    raise TypeError(f"a CSV cell cannot hold a {type(value).__name__}")


def package_table(package: str, file: str) -> list[dict[str, str]]:
    """Return the lines of a table that belongs to the package, by its header."""
    return list(csv.DictReader(files(package).joinpath(file).read_text(encoding="utf-8").splitlines()))


def write_csv(path: Path, rows: Iterable[Iterable[object]], mode: Literal["w", "x"] = "w") -> None:
    """Write rows of values as a CSV file; with mode ``x`` only where there is none."""
    with path.open(mode, newline="", encoding="utf-8") as file:
        csv.writer(file).writerows(map(csv_cell, row) for row in rows)


def csv_text(rows: Iterable[Iterable[object]], separator: str = ",") -> str:
    r"""Return rows of values as the content of a CSV file with lines that end in ``\n``."""
    lines: list[str] = []
    # A writer with its own line ends quotes a lone \r; one with \n does not.
    end = SimpleNamespace(write=lambda line: lines.append(line.removesuffix("\r\n") + "\n"))
    csv.writer(end, delimiter=separator).writerows(map(csv_cell, row) for row in rows)
    return "".join(lines)
