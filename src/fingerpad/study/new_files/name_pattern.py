"""A pattern of file names, stated once, and what it gives of each name."""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import Final, get_args

from fingerpad.exceptions import ManifestError
from fingerpad.study.new_files.quantities import Field, FileValues, read_value

_FIELDS: Final[tuple[Field, ...]] = get_args(Field)
_PLACE: Final = re.compile(r"\{([^{}]*)\}")
_NUMBER: Final = r"\d+(?:[.,]\d+)?"
_TEXT: Final = r"[^\W_]+(?:-[^\W_]+)*?"
_LONGEST: Final = 200
_MOST_ANY: Final = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class PatternMatch:
    """What a pattern gives of a name; `problem` where the name does not fit, and empty where it does."""

    file: str
    values: FileValues
    problem: str = ""


def match_file_names(pattern: str, files: Iterable[str]) -> list[PatternMatch]:
    """Read names of files by a pattern.

    Parameters
    ----------
    pattern : str
        A name without its suffix, with ``{person}``, ``{finger}``, ``{face}``, ``{role}``, ``{wedge}``,
        ``{load}`` and ``{session}`` where these stand, and ``{}`` where anything stands. Letters after a load
        are its unit: ``{load}mN``. Case does not matter.
    files : iterable of str
        Names of files, with or without folders.

    Returns
    -------
    list of PatternMatch
        One for each file, in order.

    Raises
    ------
    ManifestError
        If the pattern has no such place, an unknown one, or one twice.

    Examples
    --------
    >>> found = match_file_names("S{person}_{finger}_{load}N", ["S7_LI_0.5N.png", "ruler.png"])
    >>> found[0].values
    {'person': '7', 'finger': 'left_index', 'load_N': 0.5}
    >>> found[1].problem
    'does not fit the pattern'
    """
    expression, places = _compiled(pattern)
    return [_match(expression, places, file) for file in files]


def _compiled(pattern: str) -> tuple[re.Pattern[str], list[tuple[Field, str | None]]]:
    if len(pattern) > _LONGEST:
        raise ManifestError(f"a pattern of more than {_LONGEST} characters")
    parts = _PLACE.split(pattern)
    if parts[1::2].count("") > _MOST_ANY:
        raise ManifestError(f"{{}} more than {_MOST_ANY} times in a pattern")
    if "" in parts[2:-1:2]:
        raise ManifestError("two places with nothing between them: put what stands there in the names")
    expression = ""
    places: list[tuple[Field, str | None]] = []
    for number, part in enumerate(parts):
        if number % 2 == 0:
            expression += re.escape(part)
            continue
        name = part.strip().casefold()
        if not name:
            expression += ".*?"
            continue
        field: Field | None = next((field for field in _FIELDS if field == name), None)
        if field is None or field == "scale":
            known = ", ".join(f"{{{one}}}" for one in _FIELDS if one != "scale")
            raise ManifestError(f"{{{part}}} is unknown: a pattern holds {known}, and {{}} for anything")
        if field in [one for one, _ in places]:
            raise ManifestError(f"{{{field}}} stands twice in the pattern")
        unit = re.match(r"[ _-]?(mN|gf|g)(?![^\W\d_])", parts[number + 1], re.IGNORECASE)
        places.append((field, unit[1].casefold() if unit and field == "load" else None))
        expression += f"({_NUMBER if field in {'wedge', 'load'} else _TEXT})"
    if not places:
        raise ManifestError(
            "write {person}, {finger}, {face}, {wedge} or {load} where they stand in the names"
        )
    return re.compile(expression, re.IGNORECASE), places


def _match(expression: re.Pattern[str], places: list[tuple[Field, str | None]], file: str) -> PatternMatch:
    values = FileValues()
    found = expression.fullmatch(PurePosixPath(file).stem[:_LONGEST])
    if found is None:
        return PatternMatch(file=file, values=values, problem="does not fit the pattern")
    problems = []
    for text, (field, unit) in zip(found.groups(), places, strict=True):
        try:
            read_value(values, field, text, unit)
        except ValueError as error:
            problems.append(f"{field}: {error}")
    return PatternMatch(file=file, values=values, problem="; ".join(problems))
