"""Words of lists and counts, and how sentences begin and end."""

import re
from collections.abc import Iterable
from typing import Final

_NBSP: Final = "\N{NO-BREAK SPACE}"
_IN_A_QUANTITY: Final = (
    (re.compile(r"(?<=\d) (?=(?:mm|µm|N|kPa|s|ppi|px)\b|%|±)"), _NBSP),
    (re.compile(r"± (?=\d)"), f"±{_NBSP}"),
    (re.compile(r"(?<![^= (])-(?=\d)"), "−"),
)


def joined(parts: Iterable[str], most: int | None = None) -> str:
    """Return parts in a row, as "a, b and c"; of more than `most` the first, and how many more there are."""
    every = list(parts)
    if most is not None and len(every) > most:
        every = [*every[:most], f"{len(every) - most} more"]
    *first, last = every
    return f"{', '.join(first)} and {last}" if first else last


def counted(count: int, noun: str) -> str:
    """Return a count with its noun, in the plural where that is due."""
    plural = f"{noun}es" if noun.endswith("s") else f"{noun}s"
    return f"{count} {noun if count == 1 else plural}"


def ended(words: str) -> str:
    """Return words as a sentence ends: a question has its mark."""
    return words if words.endswith("?") else f"{words}."


def capitalized(words: str) -> str:
    """Return words with their first letter as a capital, and the others as they are."""
    return words[:1].upper() + words[1:]


def unbroken(words: str) -> str:
    """Return words with minus signs, and no line ending between a number, its ± and its unit."""
    for found, shown in _IN_A_QUANTITY:
        words = found.sub(shown, words)
    return words
