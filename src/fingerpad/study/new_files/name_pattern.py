"""A pattern of the names of files or labels, stated once, and what it gives of each name."""

import re
from collections.abc import Collection, Iterable
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import Final, Self

from fingerpad.exceptions import ManifestError
from fingerpad.study.new_files.quantities import DIGITS, HAND_WORDS, Field, FileValues, read_value

FILE_FIELDS: Final[tuple[Field, ...]] = ("person", "finger", "face", "role", "wedge", "load", "session")
_PLACEHOLDER: Final = re.compile(r"\{([^{}]*)\}|(\*)")
_NUMBER: Final = r"\d+(?:[.,p]\d+)?"
_TEXT: Final = r"[^\W_]+(?:-[^\W_]+)*?"
_HAND, _DIGIT = "|".join(HAND_WORDS), "|".join(DIGITS)
_FINGER: Final = rf"(?:{_HAND})[ _-]?(?:{_DIGIT})|(?:{_DIGIT})[ _-](?:{_HAND})|{_TEXT}"
_EXPRESSIONS: Final = {"wedge": _NUMBER, "load": _NUMBER, "roll": f"-?{_NUMBER}", "finger": _FINGER}
_LONGEST: Final = 200
_MOST_ANY: Final = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class PatternMatch:
    """What a pattern gives of a name.

    Attributes
    ----------
    file : str
        The name.
    values : FileValues
        What it states.
    fits : bool
        Whether the name fits the pattern.
    problem : str
        Why something of it is not known; empty where all is.
    """

    file: str
    values: FileValues
    fits: bool = True
    problem: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class NamePattern:
    """A pattern of names.

    Attributes
    ----------
    text : str
        As a person wrote it.
    expression : re.Pattern
        What it means.
    fields : mapping
        What is in it, in order; for loads the unit, None where the pattern has none.
    """

    text: str
    expression: re.Pattern[str]
    fields: dict[Field, str | None]

    @classmethod
    def of(cls, text: str, known: Collection[Field] = FILE_FIELDS) -> Self:
        """Read a pattern, which holds some of the `known` fields; errors as of `match_file_names`."""
        if len(text) > _LONGEST:
            raise ManifestError(f"a pattern of more than {_LONGEST} characters")
        words = ", ".join(f"{{{name}}}" for name in known)
        expression, end, fields = "", -1, dict[Field, str | None]()
        if text.count("*") > _MOST_ANY:
            raise ManifestError(f"* more than {_MOST_ANY} times in the pattern {text!r}")
        for part in _PLACEHOLDER.finditer(text):
            if part.start() == end:
                raise ManifestError(f"{part[0]} follows another with nothing between them in {text!r}")
            expression += re.escape(text[max(end, 0) : part.start()])
            end = part.end()
            if part[2]:
                expression += ".*?"
                continue
            field: Field | None = next((name for name in known if name == part[1].strip().casefold()), None)
            if field is None:
                raise ManifestError(f"{part[0]} is unknown: a pattern holds {words}, and * for anything")
            if field in fields:
                raise ManifestError(f"{{{field}}} stands twice in the pattern {text!r}")
            unit = re.match(r"[ _-]?(mN|gf|g)(?![^\W\d_])", text[end:], re.IGNORECASE)
            fields[field] = unit[1].casefold() if unit and field == "load" else None
            expression += f"({_EXPRESSIONS.get(field, _TEXT)})"
        if not fields:
            raise ManifestError(f"write {words} where they stand in the names, found {text!r}")
        expression += re.escape(text[end:])
        return cls(text=text, expression=re.compile(expression, re.IGNORECASE), fields=fields)

    def match(self, name: str, stem: str) -> PatternMatch:
        """Return what the stem of a name, without suffix, states."""
        values = FileValues()
        found = self.expression.fullmatch(stem[:_LONGEST])
        if found is None:
            return PatternMatch(file=name, values=values, fits=False, problem="does not fit the pattern")
        problems = []
        for text, (field, unit) in zip(found.groups(), self.fields.items(), strict=True):
            number = field in {"wedge", "load", "roll"}
            try:
                read_value(
                    values, field, re.sub("p", ".", text, flags=re.IGNORECASE) if number else text, unit
                )
            except ValueError as error:
                problems.append(f"{field}: {error}")
        return PatternMatch(file=name, values=values, problem="; ".join(problems))


def match_file_names(pattern: str, files: Iterable[str]) -> list[PatternMatch]:
    """Read names of files by a pattern.

    Parameters
    ----------
    pattern : str
        A name without its suffix, with ``{person}``, ``{finger}``, ``{face}``, ``{role}``, ``{wedge}``,
        ``{load}`` and ``{session}`` where these stand, and ``*`` where anything stands. Letters after a load
        are its unit: ``{load}mN``. Numbers have a point, a comma or the letter p for the decimal point. Texts
        are letters, digits and dashes; only hand and digit may have an underscore between them. Case does not
        matter.
    files : iterable of str
        Names of files, with or without folders.

    Returns
    -------
    list of PatternMatch
        One for each file, in order.

    Raises
    ------
    ManifestError
        If the pattern has no such field, an unknown one, or one twice.

    Examples
    --------
    >>> found = match_file_names("S{person}_{finger}_{load}N*", ["S7_left_index_0p5N_b.png", "ruler.png"])
    >>> found[0].values
    {'person': '7', 'finger': 'left_index', 'load_N': 0.5}
    >>> found[1].problem
    'does not fit the pattern'
    """
    compiled = NamePattern.of(pattern)
    return [compiled.match(file, PurePosixPath(file).stem) for file in files]
