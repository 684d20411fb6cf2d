"""New files and scales: what each is taken as, and the edits that add them to a study; guesses say so."""

import re
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import PurePosixPath
from typing import Any, Final, cast, get_args

from fingerpad._csv import package_table
from fingerpad._files import folded
from fingerpad.exceptions import ManifestError
from fingerpad.image import Face
from fingerpad.study.editing.edit import Edit
from fingerpad.study.imports import names
from fingerpad.study.imports.identify import Guess, GuessedScale
from fingerpad.study.manifest.load import Kind, LoadedStudy
from fingerpad.study.manifest.models import SCALE_KINDS, ScaleTable


@dataclass(frozen=True, slots=True, kw_only=True)
class ScaleWay:
    """A way to state a scale."""

    needs: list[str]
    may: list[str]
    starts: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownSize:
    """A length that everybody has at hand, mm."""

    size_mm: float
    words: str


SCALE_WAYS: Final[Mapping[str, ScaleWay]] = {
    way: ScaleWay(
        needs=[name for name, one in model.model_fields.items() if one.is_required()],
        may=[name for name, one in model.model_fields.items() if not one.is_required()],
        starts=names.TABLES["starts"].get(way, {}),
    )
    for way, model in zip(SCALE_KINDS, get_args(ScaleTable), strict=True)
}
# Cards are ISO/IEC 7810, format ID-1: bank cards, most identity cards and driving licences.
COINS, CARD = (
    tuple(
        KnownSize(size_mm=float(line["size_mm"]), words=f"{line['words']}, {line['size_mm']} mm")
        for line in package_table("fingerpad.study.editing", "known_sizes.csv")
        if line["what"] == what
    )
    for what in ("coin", "card")
)
# What a file of each kind may be used as, in words, and which values it is given, by its use.
USES: Final[Mapping[names.FileKind, Mapping[names.Use, str]]] = names.TABLES["uses"]
TAKES: Final[Mapping[names.Use, Sequence[str]]] = names.TABLES["takes"]
COIN: Final = "coin in "
# Programs that know no resolution write 72 or 96.
_SCREEN_PPI: Final = 96
_LEAST_PPI: Final = 72
_SAME_PPI: Final = 0.1


@dataclass(frozen=True, slots=True, kw_only=True)
class NewFile:
    """A file to add to a study, and what is known of it."""

    file: str
    use: names.Use = ""  # empty for none
    person: str = ""
    finger: str = ""
    session: str = ""
    face: Face | None = None
    wedge_angle_deg: float | None = None
    load_N: float | None = None  # noqa: N815
    # A name, or as it is written: `500 ppi`, `0.05 mm/px`, `coin in FILE`.
    scale: str = ""
    diameter_mm: float | None = None
    guessed: tuple[str, ...] = ()  # which of `use`, `face` and `scale` are guesses, to be confirmed


class StatedValues(names.FileValues, total=False):
    """What a spreadsheet or a name states of a new file, under its keys."""

    guessed: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Proposal:
    """Edits that add files to a study."""

    edits: tuple[Edit, ...]
    added: int
    waiting: tuple[str, ...]  # files whose finger is not known


def named_file(file: str, kind: names.FileKind, fingers: Collection[str]) -> NewFile:
    """Return what the name of a file says; the study's only finger is that of a file that names none."""
    only = next(iter(fingers)) if len(fingers) == 1 else ""
    stated: dict[str, Any] = {"finger": only, **names.read_file_name(file, kind, fingers=fingers)}
    return NewFile(file=file, **stated)


def with_scales(guess: Guess, scales: Mapping[str, Mapping[str, Any]]) -> Guess:
    """Return a guess with the scales that may hold.

    A scale is proposed where the study has only one, or the file of a contact image states a resolution: that
    of a scanner, so that it is proposed for no photograph.
    """
    ppi, found = guess.dots_per_inch, dict[names.Use, GuessedScale]()
    stated = "" if ppi is None else f"{round(ppi, 1):g} ppi"
    if len(scales) == 1:
        ((name, table),) = scales.items()
        only = GuessedScale(name, f"scale {name}, the only one of the study")
        found = {"observation": only, "sequence": only}
        if table.keys().isdisjoint({"ppi", "mm_per_px"}):
            found["photograph"] = only
    elif ppi is not None and ppi > _SCREEN_PPI:
        same = [name for name, table in scales.items() if abs(_ppi(table) - ppi) < _SAME_PPI]
        scale, why = stated, f"{stated} as its file says"
        if same:
            scale, why = same[0], f"scale {same[0]}, with the resolution in its file"
        found = {"observation": GuessedScale(scale, why)}
    return replace(guess, scales=found, stated=stated)


def _ppi(table: Mapping[str, Any]) -> float:
    return float(ppi) if isinstance(ppi := table.get("ppi"), int | float) else -1.0


def with_guess(new: NewFile, guess: Guess) -> NewFile:
    """Return a file with what is guessed of it where its name says nothing."""
    use, guessed = guess.uses[0], [] if guess.sure else ["use"]
    face = new.face
    if use == "photograph" and face is None and (face := guess.face) and not guess.face_sure:
        guessed.append("face")
    return with_guessed_scale(replace(new, use=use, face=face, guessed=tuple(guessed)), guess)


def with_guessed_scale(new: NewFile, guess: Guess) -> NewFile:
    """Return a file with the scale that is guessed for its use, where it has none."""
    if new.scale or new.use not in guess.scales:
        return new
    return replace(new, scale=guess.scales[new.use].scale, guessed=(*new.guessed, "scale"))


def stated_values(
    new: NewFile, values: names.FileValues, scales: Collection[str]
) -> tuple[StatedValues, str]:
    """Return values of a `NewFile` as a spreadsheet or a name states them, and which cannot be taken."""
    taken = cast(StatedValues, {**values})
    problem, finger, person = "", values.get("finger", new.finger), values.get("person")
    is_guess = "use" in new.guessed
    if "use" not in values and "face" in values and is_guess and new.use == "observation":
        taken["use"] = "photograph"
    may_be_contact = new.use in {"coin", "ruler"} or (is_guess and new.use in {"observation", "photograph"})
    if may_be_contact and values.get("load_N") and values.keys().isdisjoint({"use", "face"}):
        taken["use"] = "observation"  # nothing else has a load
    if person and finger:
        taken["finger"] = finger if finger.startswith(f"{person}_") else f"{person}_{finger}"
    if (scale := values.get("scale")) is not None and " " not in scale:  # a name, no number with its unit
        del taken["scale"]
        if known := next((name for name in scales if name.casefold() == scale.casefold()), None):
            taken["scale"] = known
        else:
            problem = f"no scale of the study is called {scale}"
    return {**taken, "guessed": tuple(key for key in new.guessed if key not in taken)}, problem


def written_scale(words: str, scales: Collection[str]) -> str:
    """Return a scale as it is kept of what a person writes; a number alone from 72 on is a resolution."""
    if words in scales:
        return words
    try:
        bare = words.strip().replace(",", ".").replace(".", "", 1).isdecimal()
        table = names.scale_in(words, "ppi" if bare and names.number_in(words, "ppi") >= _LEAST_PPI else None)
    except ValueError:
        raise ManifestError(
            f"{words!r}: write it as 500 ppi or 0.05 mm/px, or as the name of a scale of the study"
        ) from None
    return names.scale_words(table)


def proposed_edits(loaded: LoadedStudy, files: Sequence[NewFile], *, synthetic: bool = False) -> Proposal:
    """Return the edits that add files to a study; those without a use are passed over.

    New fingers come before their files, and a scale that several files share has a name. The first force is
    that of all sequences.
    """
    return _Proposing(loaded, files, synthetic=synthetic).proposal()


class _Proposing:
    """The edits that add files to a study, made one file after the other."""

    def __init__(self, loaded: LoadedStudy, files: Sequence[NewFile], *, synthetic: bool) -> None:
        self.files = files
        self.own = {"synthetic": True if synthetic else None}
        keys = {kind: {one.key for one in loaded.tables if one.kind == kind} for kind in ("scale", "finger")}
        self.scales, self.fingers = keys["scale"], keys["finger"]  # fingers that are added as well
        contacts = (one.key for one in loaded.tables if one.kind in {"observation", "sequence"})
        # As `names.free_name` takes them.
        self.taken, self.taken_scales = set(map(folded, contacts)), set(map(folded, self.scales))
        self.curves = sum(one.kind == "curve" for one in loaded.tables)
        self.named: dict[str, str] = {}  # scales that are added, by how they are written
        self.uses = Counter(one.scale for one in files if "scale" in TAKES.get(one.use, ()))
        self.force = next((one.file for one in files if one.use == "force"), None)
        self.edits: list[Edit] = []

    def proposal(self) -> Proposal:
        waiting, added = [], 0
        for new in self.files:
            if new.use == "coin" and new.diameter_mm:
                self._scale(f"{COIN}{new.file}")
            if new.use not in TAKES:
                continue
            if not new.finger:
                waiting.append(new.file)
                continue
            added += 1
            self._add(new)
        coins = sum(written.startswith(COIN) for written in self.named)
        return Proposal(edits=tuple(self.edits), added=added + coins, waiting=tuple(waiting))

    def _add(self, new: NewFile) -> None:
        if new.finger not in self.fingers:
            self._edit("finger", new.finger, person=new.person)
            self.fingers.add(new.finger)
        values = {key: getattr(new, key) for key in TAKES[new.use]}
        if "scale" in values:
            values["scale"] = self._scale(new.scale)
        match new.use:
            case "observation":
                self._edit("observation", self._name(new), **values, file=new.file, **self.own)
            case "sequence":
                self._edit("sequence", self._name(new), **values, file=new.file, force=self.force, **self.own)
            case "curve":
                self._edit("curve", str(self.curves), **values, file=new.file, **self.own)
                self.curves += 1
            case _:
                outline = new.file if new.use == "outline" else None
                del values["finger"]
                self._edit("photograph", f"{new.finger}/{new.file}", **values, outline=outline, **self.own)

    def _edit(self, kind: Kind, key: str, **values: Any) -> None:
        said = {name: value for name, value in values.items() if value not in (None, "")}
        self.edits.append(Edit(kind=kind, key=key, set=said))

    def _name(self, new: NewFile) -> str:
        return names.free_name(names.plain_name(PurePosixPath(new.file).stem) or "contact", self.taken)

    def _scale(self, written: str) -> Any:
        """Return the name of a scale, added where several files share it; else its table."""
        if not written or written in self.scales:
            return written
        if not written.startswith(COIN):
            table: dict[str, Any] = {**names.scale_in(written)}
            if self.uses[written] < 2:
                return table
            name = re.sub(r"[^\w.]+", "_", written)
        else:
            file = written.removeprefix(COIN)
            table, name = {"coin": file}, "coin"
            if diameter := next((one.diameter_mm for one in self.files if one.file == file), None):
                table["diameter_mm"] = diameter
        if written not in self.named:
            self.named[written] = names.free_name(name, self.taken_scales)
            self._edit("scale", self.named[written], **table)
        return self.named[written]
