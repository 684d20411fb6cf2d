"""New files and scales: what each is taken as, the edits that add them, and a study started from a folder.

Guesses say so, and so does what nothing states.
"""

import re
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath
from typing import Any, Final, cast

from fingerpad._files import folded
from fingerpad._words import counted, joined
from fingerpad.exceptions import FingerpadError, ManifestError
from fingerpad.image import Face
from fingerpad.study.editing.edit import Edit, change_study, create_study
from fingerpad.study.imports import names
from fingerpad.study.imports.identify import Guess, GuessedScale, identify_file, join_files, read_file_table
from fingerpad.study.manifest.load import Kind, LoadedStudy
from fingerpad.study.status import Missing, lacking, unused_files

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
            case "observation" | "sequence" as kind:
                force = self.force if kind == "sequence" else None
                stem = names.plain_name(PurePosixPath(new.file).stem) or "contact"
                self._edit(
                    kind, names.free_name(stem, self.taken), **values, file=new.file, force=force, **self.own
                )
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


_USELESS: Final = (
    "nothing that a study needs, as far as names of columns tell: a spreadsheet of files has file, finger, "
    "wedge, load and scale, a table of a press time, force, displacement and area, each with its unit"
)
_WORDS: Mapping[str, str] = {use: words for uses in USES.values() for use, words in uses.items() if use}


@dataclass(frozen=True, slots=True, kw_only=True)
class StartedStudy:
    """A study that was started from files."""

    loaded: LoadedStudy
    taken: Mapping[str, str]  # as what, by file
    guesses: tuple[str, ...]  # to be checked
    left: Mapping[str, str]  # why, by file that it does not name
    missing: tuple[Missing, ...]


def start_study(
    folder: Path, *, finger: str = "", scale: str = "", wedge_angle_deg: float | None = None
) -> StartedStudy:
    """Start a study from the files that lie in a folder; what nothing states is left out.

    What a spreadsheet states of files holds before their names; `finger` and `wedge_angle_deg` are those of
    files that state none, `scale` that of contact images and sequences for which no spreadsheet states one,
    as ``500 ppi`` or ``0.05 mm/px``: it holds before what pictures say of themselves.
    """
    scale = scale and written_scale(scale, ())
    if not folder.is_dir():
        raise ManifestError(f"{folder}: is no folder: name that of the pictures")
    title = folder.resolve().name
    empty = LoadedStudy.empty(folder)
    left: dict[str, str] = {}
    found: dict[str, tuple[NewFile, Guess]] = {}
    for one in unused_files(empty):
        try:
            guess = Guess(kind="sequence", uses=("sequence",), sure=True)  # of a folder of frames
            if one.kind != "folder":
                guess = with_scales(identify_file(folder / one.key), {})
            found[one.key] = with_guess(named_file(one.key, guess.kind, ()), guess), guess
        except FingerpadError as error:
            left[one.key] = f"cannot be read: {error}"
    if not found:
        raise ManifestError(f"{folder}: holds no picture, sequence or table that can be read: put them there")
    read, problems = _filled_in(folder, found)
    coins = [file for file, (new, _) in found.items() if new.use == "coin"]
    for file, (new, guess) in found.items():
        own = new if new.finger or new.use not in TAKES else replace(new, finger=finger)
        if own.use == "photograph" and not own.scale and len(coins) == 1:
            own = replace(own, scale=COIN + coins[0])
        found[file] = _stated_for_all(own, scale, wedge_angle_deg), guess
    proposal = proposed_edits(empty, [new for new, _ in found.values()])
    if proposal.waiting and not any(edit.kind == "finger" for edit in proposal.edits):
        raise ManifestError(
            f"{folder}: no study was written, since nothing states which finger {proposal.waiting[0]} shows"
            + (f", nor {counted(len(proposal.waiting) - 1, 'other file')}" if proposal.waiting[1:] else "")
            + ": give --finger left_index, or whichever one it is; or name each file after its finger, as "
            "left_index_30deg_2N.png for a contact or left_index_palmar.jpg for a photograph; or list the "
            "files in a spreadsheet with the columns file, finger, wedge and load"
        )
    loaded = create_study(folder, title)
    if proposal.edits:
        loaded = change_study(folder, proposal.edits, expected=loaded.digest, before=loaded)
    used = {Path(name).as_posix() for name in loaded.files()}
    for file, (new, _) in found.items():
        if file in proposal.waiting:
            left[file] = "nothing states its finger: give --finger NAME"
        elif file not in used and file not in read:
            left[file] = _WORDS.get(new.use, _USELESS)
    std = loaded.study.uncertainty.load_relative_std  # what every study is started with
    return StartedStudy(
        loaded=loaded,
        taken={file: _WORDS[new.use] for file, (new, _) in found.items() if file in used} | read,
        guesses=(
            f"load_relative_std = {std:g}: every load is known within {100 * std:g} %",
            *loaded.study.doubts(),
            *problems,
            *(words for file in found if file in used for words in _guesses(*found[file])),
        ),
        left=left,
        missing=tuple(lacking(loaded)),
    )


def _stated_for_all(own: NewFile, scale: str, wedge_angle_deg: float | None) -> NewFile:
    """Return a file with the scale and the wedge angle of all files, where nothing states others."""
    if own.wedge_angle_deg is None:
        own = replace(own, wedge_angle_deg=wedge_angle_deg)
    if not scale or own.use not in {"observation", "sequence"} or (own.scale and "scale" not in own.guessed):
        return own
    return replace(own, scale=scale, guessed=tuple(key for key in own.guessed if key != "scale"))


def _filled_in(folder: Path, found: dict[str, tuple[NewFile, Guess]]) -> tuple[dict[str, str], list[str]]:
    """Take what spreadsheets state of files; return of how many each does, and what cannot be taken."""
    read, problems = {}, []
    for sheet in [file for file, (new, _) in found.items() if new.use == "sheet"]:
        table = read_file_table(folder / sheet)
        named = join_files(table, [file for file in found if file != sheet])
        problems += [
            f"{sheet}, line {row.line}: {'; '.join(row.problems)}"
            for row in sorted((*named.rows.values(), *named.rows_without_file), key=lambda row: row.line)
            if row.problems
        ]
        if table.sheet:
            problems.append(f"{sheet}: of its sheets {table.sheet!r} alone is read: save each as a file")
        if table.unread:
            unread = joined(map(repr, table.unread), 5)
            problems.append(f"{sheet}: no column for {unread}: known are finger, face, wedge, load and scale")
        problems += [
            f"{sheet}, line {row.line}: no one file is called {row.file!r}"
            for row in named.rows_without_file
            if named.rows
        ]
        if not named.rows:
            problems.append(f"{sheet}: names none of the files")
        else:
            read[sheet] = f"what it states of {counted(len(named.rows), 'file')}"
        for file, row in named.rows.items():
            new, guess = found[file]
            taken, problem = stated_values(new, row.values, ())
            if problem:
                problems.append(f"{file}: {problem}")
            found[file] = with_guessed_scale(replace(new, **taken), guess), guess
    return read, problems


def _guesses(new: NewFile, guess: Guess) -> Iterator[str]:
    """Yield what of a file is a guess."""
    if "use" in new.guessed:
        others = " or ".join(_WORDS.get(use, "something else") for use in guess.uses[1:3])
        yield f"{new.file}: taken as {_WORDS[new.use]}, but may be {others}"
    if "face" in new.guessed:
        yield f"{new.file}: its face is taken as {new.face}"
    if "scale" in new.guessed:
        yield f"{new.file}: {guess.scales[new.use].why}"
