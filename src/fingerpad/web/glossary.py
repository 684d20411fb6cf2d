"""Symbols of quantities, and what they mean."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from fingerpad._csv import package_table


@dataclass(frozen=True, slots=True)
class Symbol:
    """A symbol and its meaning."""

    name: str
    meaning: str  # what it is, and what it is compared with
    unit: str  # its unit, as people see it; empty for pure numbers
    column: str = ""  # the column of ``results.csv`` that holds it; empty where none does


# By the symbol as plain text: a letter, then _subscript and ^superscript.
GLOSSARY: Final[Mapping[str, Symbol]] = {
    line.pop("symbol"): Symbol(**line) for line in package_table("fingerpad.web", "glossary.csv")
}
