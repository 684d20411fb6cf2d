"""What names of files and cells of a spreadsheet say: by their usual words, or by a stated pattern."""

import math
import re
import tomllib
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from importlib.resources import files
from itertools import pairwise
from pathlib import PurePosixPath
from typing import Any, Final, Literal, TypeAlias, cast, get_args

from typing_extensions import TypedDict  # for pydantic, before Python 3.12

from fingerpad import units
from fingerpad._files import folded
from fingerpad.exceptions import ManifestError
from fingerpad.image import Face

Role: TypeAlias = Literal["observation", "photograph", "sequence", "curve", "outline"]
# What a new file is used as; empty for something else.
Use: TypeAlias = Role | Literal["coin", "ruler", "force", "sheet", ""]
Field: TypeAlias = Literal["person", "finger", "face", "role", "wedge", "roll", "load", "scale", "session"]


class FileValues(TypedDict, total=False):
    """What is stated of a file: keys of a new file, in the manifest's units."""

    use: Use
    person: str
    finger: str
    face: Face
    wedge_angle_deg: float
    load_N: float
    scale: str  # a name, or as `scale_words` writes a number
    session: str


def words_of(table: str) -> dict[str, Any]:
    """Return what each word of a table of ``words.toml`` means."""
    return {word: meaning for meaning, words in TABLES[table].items() for word in words}


TABLES: Final = tomllib.loads(files("fingerpad.study.imports").joinpath("words.toml").read_text("utf-8"))
HAND_WORDS, DIGITS, INITIALS = words_of("hand"), words_of("digit"), words_of("initial")
FACES: Final[tuple[Face, ...]] = get_args(Face)
_FACE_WORDS: Final[Mapping[str, str]] = words_of("face")
_ROLE_WORDS: Final[Mapping[str, str]] = words_of("role")
_OF_SCALE: Final = words_of("scale").keys()
# Factor that turns a value in the unit into the library's.
FACTORS: Final[Mapping[str, Mapping[str, float]]] = {
    "load": {unit.casefold(): factor for unit, factor in units.FACTORS["force"].items()},
    "wedge": {"deg": 1.0, "degree": 1.0, "degrees": 1.0, "°": 1.0, "rad": math.degrees(1.0)},
    "roll": {"deg": 1.0},
    "mm_per_px": {"mm/px": 1.0, "mm/pixel": 1.0, "um/px": 1e-3, "µm/px": 1e-3, "μm/px": 1e-3},
    "px_per_mm": {"px/mm": 1.0, "pixel/mm": 1.0, "pixels/mm": 1.0},
    "ppi": {"ppi": 1.0, "dpi": 1.0},
}
_LIMITS: Final = {"load": (0.0, 1e4), "wedge": (0.0, 90.0), "roll": (-90.0, 90.0)}
# A number with a decimal point or comma, and one whose comma may part thousands; the page reads by them too.
NUMBER: Final = r"[+-]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][+-]?\d+)?"
AMBIGUOUS: Final = r"[+-]?[1-9]\d{0,2},\d{3}"
_QUANTITY: Final = re.compile(rf"\s*({NUMBER})\s*(\S.*?)?\s*")


def number_in(text: str, quantity: str, unit: str | None = None) -> float:
    """Return a number with its unit, in the library's.

    The unit is that of the text, or else `unit`, or else the library's. `quantity` is ``load``, ``wedge`` or
    ``roll``, or a scale: ``mm_per_px``, ``px_per_mm`` or ``ppi``. A ValueError says what is no such number.
    """
    known = FACTORS[quantity]
    found = _QUANTITY.fullmatch(text)
    if found is None:
        raise ValueError(f"{text!r} is not a number")
    if re.fullmatch(AMBIGUOUS, found[1]):
        raise ValueError(f"{text!r} could be {found[1].replace(',', '.')} or {found[1].replace(',', '')}")
    said = (found[2] or unit or next(iter(known))).casefold()
    if said not in known:
        raise ValueError(f"{text!r} has an unknown unit; {quantity} is read in {', '.join(known)}")
    value = float(f"{float(found[1].replace(',', '.')) * known[said]:.12g}")
    low, high = _LIMITS.get(quantity, (1e-6, 1e6))
    if not low <= value <= high:
        raise ValueError(f"{text!r} is out of range")
    return value


def finger_name(text: str, hand: str = "") -> str:
    """Return the name of a finger: hand and digit where the words say them, else the words themselves."""
    words = _words(f"{hand} {text}")
    sides = [HAND_WORDS[word] for word in words if word in HAND_WORDS]
    digits = [DIGITS[word] for word in words if word in DIGITS]
    if sides and digits:
        return f"{sides[0]}_{digits[0]}"
    if re.fullmatch(r"[LR][TIMRLP]", text.strip()):
        return f"{HAND_WORDS[text.strip()[0].lower()]}_{INITIALS[text.strip()[1]]}"
    if sides and text.strip().upper() in INITIALS:
        return f"{sides[0]}_{INITIALS[text.strip().upper()]}"
    return plain_name(text)


def plain_name(text: str) -> str:
    """Return a text as a name of the manifest: letters, digits and . _ + - only."""
    return re.sub(r"[^\w.+-]+", "_", text.strip()).strip("_.+-")[:60]


def free_name(stem: str, taken: set[str]) -> str:
    """Return a name unlike all `taken` ones even where case does not count, and take it as `folded`."""
    number, name = 1, stem
    while folded(name) in taken:
        number += 1
        name = f"{stem}_{number}"
    taken.add(folded(name))
    return name


_KEYS: Final = {"load": "load_N", "wedge": "wedge_angle_deg", "roll": "roll_angle_deg", "role": "use"}


def read_value(values: FileValues, field: Field, text: str, unit: str | None = None) -> None:
    """Read a text into the values of a file."""
    found, words = cast(dict[str, Any], values), _words(text)
    match field:
        case "load" | "wedge" | "roll":
            found[_KEYS[field]] = number_in(text, field, unit)
        case "scale" if _QUANTITY.fullmatch(text):
            found["scale"] = scale_words(scale_in(text, unit))
        case "role" if face := next((word for word in words if word in FACES), None):
            found |= {"face": face, "use": "photograph"}
        case "face" | "role":
            meanings = _FACE_WORDS if field == "face" else _ROLE_WORDS
            word = next((word for word in words if word in meanings), None)
            if word is None:
                types = "contact, photograph, sequence, curve, outline, coin"
                known = f"face: {', '.join(FACES)}" if field == "face" else f"type: {types}"
                raise ValueError(f"{text!r} is no {known}")
            found[_KEYS.get(field, field)] = meanings[word]
        case _:
            name = finger_name(text) if field == "finger" else plain_name(text)
            if not name:
                raise ValueError(f"{text!r} is no name")
            found[field] = name


def _words(text: str) -> list[str]:
    return [word.lower() for word in re.findall(r"[^\W\d_]+", text)]


def scale_in(text: str, unit: str | None = None) -> dict[str, float]:
    """Return the table of a scale that is written as a number with its unit."""
    found = _QUANTITY.fullmatch(text)
    said = ((found and found[2]) or unit or "").casefold()
    way = next((way for way in ("mm_per_px", "px_per_mm", "ppi") if said in FACTORS[way]), None)
    if way is None:
        raise ValueError(f"{text!r} has no unit: give mm/px or ppi")
    value = number_in(text, way, said)
    return {"mm_per_px": float(f"{1 / value:.12g}")} if way == "px_per_mm" else {way: value}


def scale_words(scale: object) -> str:
    """Return a scale of a manifest in words: its name, or how it is stated."""
    if not isinstance(scale, Mapping):
        return scale if isinstance(scale, str) else ""
    way = next((way for way in TABLES["written"] if way in scale), None)
    if way is None:
        return "incomplete"
    key, words = map(str, TABLES["written"][way])
    value = scale.get(key)
    return words.format(f"{value:.12g}") if isinstance(value, int | float) else way


FileKind: TypeAlias = Literal["picture", "sequence", "table", "other"]

# Letters, or one number with its decimal mark.
_WORD: Final = re.compile(r"[^\W\d_]+|\d+(?:[.,]\d+)?")
_NUMBER: Final = r"(?<![\d.,])(\d+(?:[.,]\d+)?)"
# A dash or underscore after one digit may stand for a decimal point: 0-5N, 1_5N.
_LOAD: Final = re.compile(rf"(?<!(?<!\d)\d[-_]){_NUMBER}[ _-]?(m?)N(?![^\W\d_])")
_WEDGE: Final = (
    re.compile(rf"(?<!(?<!\d)\d[-_]){_NUMBER}[ _-]?(?:deg|°)", re.IGNORECASE),
    re.compile(rf"(?:wedge|theta|θ)(?:[ _-]?angle)?[ _-]?{_NUMBER}", re.IGNORECASE),
)
_PERSON: Final = re.compile(r"(?<![^\W_])(?:s|p|subject|participant|person)[ _-]?(\d+)(?!\d)", re.IGNORECASE)
_CAPITALS: Final = re.compile(r"(?<![^\W\d_])([LR])([TIMRLP])(?![^\W\d_])")
_ROLES: Final[dict[FileKind, Role]] = {"picture": "observation", "sequence": "sequence", "table": "curve"}
_FACE_ROLES: Final[dict[FileKind, Role]] = {"picture": "photograph", "table": "outline"}

# Of a pattern.
FILE_FIELDS: Final[tuple[Field, ...]] = ("person", "finger", "face", "role", "wedge", "load", "session")
_PLACEHOLDER: Final = re.compile(r"\{([^{}]*)\}|(\*)")
_PATTERN_NUMBER: Final = r"\d+(?:[.,p]\d+)?"
_TEXT: Final = r"[^\W_]+(?:-[^\W_]+)*?"
_HAND, _DIGIT = "|".join(HAND_WORDS), "|".join(DIGITS)
_FINGER: Final = rf"(?:{_HAND})[ _-]?(?:{_DIGIT})|(?:{_DIGIT})[ _-](?:{_HAND})|{_TEXT}"
_EXPRESSIONS: Final = {
    "wedge": _PATTERN_NUMBER,
    "load": _PATTERN_NUMBER,
    "roll": f"-?{_PATTERN_NUMBER}",
    "finger": _FINGER,
}
_LONGEST: Final = 200
_MOST_ANY: Final = 3


def read_file_name(name: str, kind: FileKind, *, fingers: Iterable[str] = ()) -> FileValues:
    """Read what a file's name says about its content.

    As far as the name states it and could not mean two things. The person is in front of the finger:
    ``S01_left_index``. There is no role for a ruler, a coin or the force of a sequence. One of `fingers`,
    those of the study, in the name is that finger.
    """
    stem, words, values = PurePosixPath(name).stem, _stem_words(name), FileValues()
    if face := next((face for face in FACES if face in words), None):
        values["face"] = face
    role = (_FACE_ROLES if face else _ROLES).get(kind, _ROLES.get(kind))
    if role and not names_a_scale(name) and not (kind == "table" and names_a_force(name)):
        values["use"] = role
    known = [finger for finger in fingers if _stands_in(finger, stem)]
    if known:
        values["finger"] = max(known, key=len)
    elif finger := _finger(stem):
        values["finger"] = finger
        if person := _PERSON.search(stem):
            values["person"] = person[0].replace(" ", "")
            values["finger"] = f"{values['person']}_{finger}"
    angles = (_float(found[1]) for pattern in _WEDGE if (found := pattern.search(stem)))
    if (angle := next((angle for angle in angles if angle <= 90), None)) is not None:
        values["wedge_angle_deg"] = angle
    if load := _LOAD.search(stem):
        values["load_N"] = _float(load[1]) * (1e-3 if load[2] else 1.0)
    return values


def _stands_in(name: str, text: str) -> bool:
    """Tell whether a name stands in a text, not as a part of a longer word or number: P1 is not in P10."""
    before, after = (r"\d" if end.isdigit() else r"[^\W\d_]" for end in (name[0], name[-1]))
    return re.search(rf"(?<!{before}){re.escape(name)}(?!{after})", text, re.IGNORECASE) is not None


def names_a_scale(name: str) -> bool:
    """Tell whether a name says that a file shows a ruler, a coin or the like."""
    return not _OF_SCALE.isdisjoint(_stem_words(name))


def names_a_force(name: str) -> bool:
    """Tell whether a name says that a table holds a force, as beside a sequence, and no loading curve."""
    words = _stem_words(name)
    return "force" in words and words.isdisjoint(("displacement", "indentation", "curve"))


def _stem_words(name: str) -> set[str]:
    return {word.lower() for word in _WORD.findall(PurePosixPath(name).stem)}


def _finger(stem: str) -> str | None:
    """Return hand and digit, by full words in any order or by two capitals."""
    words = _words(re.sub(r"(?<=[a-z])(?=[A-Z])", " ", stem))
    pairs = [pair for one, other in pairwise(words) for pair in ((one, other), (other, one))]
    full = ((hand, digit) for hand, digit in pairs if hand in HAND_WORDS and digit in DIGITS)
    found = [
        *(f"{HAND_WORDS[hand]}_{DIGITS[digit]}" for hand, digit in full),
        *(f"{HAND_WORDS[hand.lower()]}_{INITIALS[digit]}" for hand, digit in _CAPITALS.findall(stem)),
    ]
    return found[0] if found else None


def _float(words: str) -> float:
    return float(words.replace(",", "."))


@dataclass(frozen=True, slots=True, kw_only=True)
class PatternMatch:
    """What a pattern gives of a name."""

    file: str
    values: FileValues
    fits: bool = True  # whether the name fits the pattern
    problem: str = ""  # why something of it is not known; empty where all is


class NamePattern:
    """A pattern of names, which holds some of the `known` fields; errors as of `match_file_names`."""

    def __init__(self, text: str, known: Collection[Field] = FILE_FIELDS) -> None:
        if len(text) > _LONGEST:
            raise ManifestError(f"a pattern of more than {_LONGEST} characters")
        words = ", ".join(f"{{{name}}}" for name in known)
        # Fields in order; for loads the unit, None where the pattern has none.
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
        self._fields = fields
        self._expression = re.compile(expression + re.escape(text[end:]), re.IGNORECASE)

    def match(self, name: str, stem: str) -> PatternMatch:
        """Return what the stem of a name, without suffix, states."""
        values = FileValues()
        found = self._expression.fullmatch(stem[:_LONGEST])
        if found is None:
            return PatternMatch(file=name, values=values, fits=False, problem="does not fit the pattern")
        problems = []
        for text, (field, unit) in zip(found.groups(), self._fields.items(), strict=True):
            if field in {"wedge", "load", "roll"}:
                text = re.sub("p", ".", text, flags=re.IGNORECASE)  # noqa: PLW2901
            try:
                read_value(values, field, text, unit)
            except ValueError as error:
                problems.append(f"{field}: {error}")
        return PatternMatch(file=name, values=values, problem="; ".join(problems))


def match_file_names(pattern: str, files: Iterable[str]) -> list[PatternMatch]:
    """Read names of files by a pattern.

    A pattern is a name without its suffix, with fields such as ``{person}`` and ``{load}``, and ``*`` where
    anything stands. Letters after a load are its unit: ``{load}mN``. Numbers have a point, a comma or the
    letter p for the decimal point; texts are letters, digits and dashes. Case does not matter.
    """
    compiled = NamePattern(pattern)
    return [compiled.match(file, PurePosixPath(file).stem) for file in files]
