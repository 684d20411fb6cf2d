"""What the name of a file says about the picture, sequence or table in it."""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from pathlib import PurePosixPath
from typing import Final, Literal, TypeAlias

from fingerpad.image import Face
from fingerpad.study.new_files.quantities import DIGITS, FACES, HAND_WORDS, INITIALS, Role

Kind: TypeAlias = Literal["picture", "sequence", "table", "other"]

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
_OF_SCALE: Final = frozenset(
    ("ruler", "scale", "coin", "euro", "cent", "calibration", "card", "checkerboard", "grid")
)
_ROLES: Final[dict[Kind, Role]] = {"picture": "observation", "sequence": "sequence", "table": "curve"}
_FACE_ROLES: Final[dict[Kind, Role]] = {"picture": "photograph", "table": "outline"}


@dataclass(frozen=True, slots=True, kw_only=True)
class FileNameReading:
    """What a file's name says; None where it says nothing, or could mean two things.

    Attributes
    ----------
    role : {"observation", "photograph", "sequence", "curve", "outline"} or None
        What the file is in a study; None for a ruler, a coin or the force of a sequence.
    finger : str or None
        Name of the finger, with the person's in front where both are named: ``S01_left_index``.
    face : {"palmar", "distal", "radial", "ulnar"} or None
        The face that a photograph shows.
    wedge_angle_deg, load_N : float or None
        Wedge angle and load.
    """

    role: Role | None
    finger: str | None
    face: Face | None
    wedge_angle_deg: float | None
    load_N: float | None  # noqa: N815


def read_file_name(name: str, kind: Kind, *, fingers: Iterable[str] = ()) -> FileNameReading:
    """Read what a file's name says about its content.

    Parameters
    ----------
    name : str
        Name of the file, with or without folders.
    kind : {"picture", "sequence", "table", "other"}
        Kind of file.
    fingers : iterable of str
        Fingers of the study; one of them in the name is that finger.

    Returns
    -------
    FileNameReading

    Examples
    --------
    >>> found = read_file_name("S01_LI_wedge45_500mN.png", "picture")
    >>> found.finger, found.wedge_angle_deg, found.load_N
    ('S01_left_index', 45.0, 0.5)
    >>> read_file_name("left-thumb-30deg-1,5N.tif", "picture").load_N
    1.5
    >>> print(read_file_name("IMG_0031.jpg", "picture").load_N)
    None
    """
    stem = PurePosixPath(name).stem
    words = [word.lower() for word in _WORD.findall(stem)]
    face = next((face for face in FACES if face in words), None)
    role = (_FACE_ROLES if face else _ROLES).get(kind, _ROLES.get(kind))
    if names_a_scale(name) or (kind == "table" and names_a_force(name)):
        role = None
    known = [finger for finger in fingers if finger.lower() in stem.lower()]
    return FileNameReading(
        role=role,
        finger=max(known, key=len) if known else _finger(stem),
        face=face,
        wedge_angle_deg=_wedge(stem),
        load_N=_load(stem),
    )


def names_a_scale(name: str) -> bool:
    """Tell whether a name says that a file shows a ruler, a coin or the like."""
    return not _OF_SCALE.isdisjoint(word.lower() for word in _WORD.findall(PurePosixPath(name).stem))


def names_a_force(name: str) -> bool:
    """Tell whether a name says that a table holds a force, as beside a sequence, and no loading curve."""
    words = {word.lower() for word in _WORD.findall(PurePosixPath(name).stem)}
    return "force" in words and words.isdisjoint(("displacement", "indentation", "curve"))


def _finger(stem: str) -> str | None:
    """Return hand and digit, by full words in any order or by two capitals, after the person."""
    words = [word.lower() for word in re.findall(r"[^\W\d_]+", re.sub(r"(?<=[a-z])(?=[A-Z])", " ", stem))]
    pairs = [pair for one, other in pairwise(words) for pair in ((one, other), (other, one))]
    found = [
        *(
            f"{HAND_WORDS[hand]}_{DIGITS[digit]}"
            for hand, digit in pairs
            if hand in HAND_WORDS and digit in DIGITS
        ),
        *(f"{HAND_WORDS[hand.lower()]}_{INITIALS[digit]}" for hand, digit in _CAPITALS.findall(stem)),
    ]
    if not found:
        return None
    person = _PERSON.search(stem)
    return f"{person[0]}_{found[0]}".replace(" ", "") if person else found[0]


def _wedge(stem: str) -> float | None:
    for pattern in _WEDGE:
        if (found := pattern.search(stem)) and (angle := _float(found[1])) <= 90:
            return angle
    return None


def _load(stem: str) -> float | None:
    found = _LOAD.search(stem)
    return None if found is None else _float(found[1]) * (1e-3 if found[2] else 1.0)


def _float(words: str) -> float:
    return float(words.replace(",", "."))
