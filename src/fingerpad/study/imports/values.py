"""Values that a spreadsheet or a name states of a file, read leniently."""

import math
import re
from collections.abc import Mapping
from typing import Final, Literal, TypeAlias, TypedDict, get_args

from fingerpad import units
from fingerpad.image import Face

Role: TypeAlias = Literal["observation", "photograph", "sequence", "curve", "outline"]
Field: TypeAlias = Literal["person", "finger", "face", "role", "wedge", "roll", "load", "scale", "session"]


class FileValues(TypedDict, total=False):
    """What is stated of a file: keys of a new file on the page, in the manifest's units."""

    role: Role | Literal[""]
    person: str
    finger: str
    face: Face
    wedge_angle_deg: float
    roll_angle_deg: float
    load_N: float
    scale: str
    ppi: float
    mm_per_px: float
    session: str


HAND_WORDS: Final = {"left": "left", "right": "right", "l": "left", "r": "right"}
DIGITS: Final = {
    "thumb": "thumb",
    "index": "index",
    "forefinger": "index",
    "middle": "middle",
    "ring": "ring",
    "little": "little",
    "pinky": "little",
    "pinkie": "little",
}
INITIALS: Final = {"T": "thumb", "I": "index", "M": "middle", "R": "ring", "L": "little", "P": "little"}
FACES: Final[tuple[Face, ...]] = get_args(Face)
_FACE_WORDS: Final[Mapping[str, Face]] = {
    **{face: face for face in FACES},
    "front": "palmar",
    "pad": "palmar",
    "volar": "palmar",
    "tip": "distal",
    "end": "distal",
    "side": "radial",
    "lateral": "radial",
}
_ROLE_WORDS: Final[Mapping[str, Role | Literal[""]]] = {
    **dict.fromkeys(("contact", "contacts", "observation", "print", "fingerprint"), "observation"),
    **dict.fromkeys(("photograph", "photo", "face", "faces", "finger"), "photograph"),
    **dict.fromkeys(("sequence", "film", "video", "movie", "stack"), "sequence"),
    **dict.fromkeys(("curve", "loading"), "curve"),
    "outline": "outline",
    **dict.fromkeys(("coin", "ruler", "scale", "calibration", "force", "none", "other"), ""),
}
# Factor that turns a value in the unit into the library's; grams are grams-force.
FACTORS: Final[Mapping[str, Mapping[str, float]]] = {
    "load": {
        **{unit.casefold(): factor for unit, factor in units.FACTORS["force"].items()},
        "g": units.FACTORS["force"]["gf"],
        "kgf": 9.80665,
    },
    "wedge": {"deg": 1.0, "degree": 1.0, "degrees": 1.0, "°": 1.0, "rad": math.degrees(1.0)},
    "roll": {"deg": 1.0},
    "mm_per_px": {"mm/px": 1.0, "mm/pixel": 1.0, "um/px": 1e-3, "µm/px": 1e-3, "μm/px": 1e-3},
    "px_per_mm": {"px/mm": 1.0, "pixel/mm": 1.0, "pixels/mm": 1.0},
    "ppi": {"ppi": 1.0, "dpi": 1.0},
}
_LIMITS: Final = {"load": (0.0, 1e4), "wedge": (0.0, 90.0), "roll": (-90.0, 90.0)}
_NUMBER: Final = re.compile(r"\s*([+-]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eE][+-]?\d+)?)\s*(\S.*?)?\s*")


def number_in(text: str, quantity: str, unit: str | None = None) -> float:
    """Return a number with its unit, in the library's.

    Parameters
    ----------
    text : str
        A number with a decimal point or comma, and perhaps its unit, which then holds.
    quantity : str
        ``load``, ``wedge`` or ``roll``, or a scale: ``mm_per_px``, ``px_per_mm`` or ``ppi``.
    unit : str, optional
        The unit where the text has none; by default that of the library.

    Raises
    ------
    ValueError
        If it is no such number.

    Examples
    --------
    >>> number_in("1,5", "load"), number_in("500 mN", "load"), number_in("50", "load", "g")
    (1.5, 0.5, 0.4903325)
    """
    known = FACTORS[quantity]
    found = _NUMBER.fullmatch(text)
    if found is None:
        raise ValueError(f"{text!r} is not a number")
    said = (found[2] or unit or next(iter(known))).casefold()
    if said not in known:
        raise ValueError(f"{text!r} has an unknown unit; {quantity} is read in {', '.join(known)}")
    value = float(f"{float(found[1].replace(',', '.')) * known[said]:.12g}")
    low, high = _LIMITS.get(quantity, (1e-6, 1e6))
    if not low <= value <= high:
        raise ValueError(f"{text!r} is out of range")
    return value


def finger_name(text: str, hand: str = "") -> str:
    """Return the name of a finger: hand and digit where the words say them, else the words themselves.

    Examples
    --------
    >>> finger_name("LI"), finger_name("Right middle"), finger_name("index", "L"), finger_name("pad 3")
    ('left_index', 'right_middle', 'left_index', 'pad_3')
    """
    words = [word.lower() for word in re.findall(r"[^\W\d_]+", f"{hand} {text}")]
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


def read_value(values: FileValues, field: Field, text: str, unit: str | None = None) -> None:
    """Read a text into the values of a file.

    Raises
    ------
    ValueError
        If it cannot be what the field holds.
    """
    match field:
        case "load":
            values["load_N"] = number_in(text, "load", unit)
        case "wedge":
            values["wedge_angle_deg"] = number_in(text, "wedge", unit)
        case "roll":
            values["roll_angle_deg"] = number_in(text, "roll", unit)
        case "scale":
            _read_scale(values, text, unit)
        case "face":
            word = next((word for word in _words(text) if word in _FACE_WORDS), None)
            if word is None:
                raise ValueError(f"{text!r} is no face: {', '.join(FACES)}")
            values["face"] = _FACE_WORDS[word]
        case "role":
            words = _words(text)
            faces = [_FACE_WORDS[word] for word in words if word in FACES]
            if faces:
                values["face"], values["role"] = faces[0], "photograph"
                return
            word = next((word for word in words if word in _ROLE_WORDS), None)
            if word is None:
                raise ValueError(f"{text!r} is no type: contact, photograph, sequence, curve, outline, coin")
            values["role"] = _ROLE_WORDS[word]
        case "finger":
            values["finger"] = _named(finger_name(text), text)
        case "person":
            values["person"] = _named(plain_name(text), text)
        case "session":
            values["session"] = _named(plain_name(text), text)


def _words(text: str) -> list[str]:
    return [word.lower() for word in re.findall(r"[^\W\d_]+", text)]


def _named(name: str, text: str) -> str:
    if not name:
        raise ValueError(f"{text!r} is no name")
    return name


def _read_scale(values: FileValues, text: str, unit: str | None) -> None:
    """Read a number with the unit of a scale, or the name of one."""
    found = _NUMBER.fullmatch(text)
    if found is None:
        values["scale"] = _named(plain_name(text), text)
        return
    said = (found[2] or unit or "").casefold()
    if said in FACTORS["mm_per_px"]:
        values["mm_per_px"] = number_in(text, "mm_per_px", said)
    elif said in FACTORS["px_per_mm"]:
        values["mm_per_px"] = 1 / number_in(text, "px_per_mm", said)
    elif said in FACTORS["ppi"]:
        values["ppi"] = number_in(text, "ppi", said)
    else:
        raise ValueError(f"{text!r} has no unit: give mm/px or ppi")
