"""Text in CSV files: a spreadsheet must not take what a person typed for a formula."""

import csv
import re
from collections.abc import Iterable, Sequence
from types import SimpleNamespace
from typing import Final

# What spreadsheets take for a formula, or what reads as escaped; numbers and lists of them are neither.
_FIRST: Final = frozenset("'=+-@\t\r")
_FORMULA: Final = re.compile(r"'*[=+\-@\t\r]")
_NUMBER: Final = r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?"
_NUMBERS: Final = re.compile(rf"{_NUMBER}(?:, ?{_NUMBER})*")


def escape_formula(text: str) -> str:
    """Return a text as a CSV cell that no spreadsheet evaluates; `unescape_formula` is its inverse.

    Examples
    --------
    >>> [escape_formula(text) for text in ("=1+1", "-1.5", "-x", "'=1", "left")]
    ["'=1+1", '-1.5', "'-x", "''=1", 'left']
    """
    if text[:1] not in _FIRST or not _FORMULA.match(text) or _NUMBERS.fullmatch(text):
        return text
    return f"'{text}"


def unescape_formula(cell: str) -> str:
    """Return the text of a cell that `escape_formula` may have escaped."""
    return cell[1:] if cell.startswith("'") and _FORMULA.match(cell) else cell


def csv_text(rows: Iterable[Sequence[str]]) -> str:
    r"""Return rows of texts as the content of a CSV file with lines that end in ``\n``."""
    lines: list[str] = []
    # A writer with its own line ends quotes a lone \r; one with \n does not.
    end = SimpleNamespace(write=lambda line: lines.append(line.removesuffix("\r\n") + "\n"))
    csv.writer(end).writerows([escape_formula(cell) for cell in row] for row in rows)
    return "".join(lines)
