"""A study started from the files in its folder: what each is taken as, and what is not known."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from fingerpad._words import counted, joined
from fingerpad.exceptions import FingerpadError, ManifestError
from fingerpad.study.editing import propose
from fingerpad.study.editing.edit import change_study, create_study
from fingerpad.study.imports.identify import Guess, identify_file, join_files, read_file_table
from fingerpad.study.manifest.load import LoadedStudy
from fingerpad.study.status import Missing, lacking, unused_files

_USELESS: Final = (
    "nothing that a study needs, as far as names of columns tell: a spreadsheet of files has file, finger, "
    "wedge, load and scale, a table of a press time, force, displacement and area, each with its unit"
)
_WORDS: Mapping[str, str] = {
    use: words for uses in propose.USES.values() for use, words in uses.items() if use
}


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
    scale = scale and propose.written_scale(scale, ())
    if not folder.is_dir():
        raise ManifestError(f"{folder}: is no folder: name that of the pictures")
    title = folder.resolve().name
    empty = LoadedStudy.empty(folder)
    left: dict[str, str] = {}
    found: dict[str, tuple[propose.NewFile, Guess]] = {}
    for one in unused_files(empty):
        try:
            guess = Guess(kind="sequence", uses=("sequence",), sure=True)  # of a folder of frames
            if one.kind != "folder":
                guess = propose.with_scales(identify_file(folder / one.key), {})
            found[one.key] = propose.with_guess(propose.named_file(one.key, guess.kind, ()), guess), guess
        except FingerpadError as error:
            left[one.key] = f"cannot be read: {error}"
    if not found:
        raise ManifestError(f"{folder}: holds no picture, sequence or table that can be read: put them there")
    read, problems = _filled_in(folder, found)
    coins = [file for file, (new, _) in found.items() if new.use == "coin"]
    for file, (new, guess) in found.items():
        own = new if new.finger or new.use not in propose.TAKES else replace(new, finger=finger)
        if own.use == "photograph" and not own.scale and len(coins) == 1:
            own = replace(own, scale=propose.COIN + coins[0])
        found[file] = _stated_for_all(own, scale, wedge_angle_deg), guess
    proposal = propose.proposed_edits(empty, [new for new, _ in found.values()])
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


def _stated_for_all(own: propose.NewFile, scale: str, wedge_angle_deg: float | None) -> propose.NewFile:
    """Return a file with the scale and the wedge angle of all files, where nothing states others."""
    if own.wedge_angle_deg is None:
        own = replace(own, wedge_angle_deg=wedge_angle_deg)
    if not scale or own.use not in {"observation", "sequence"} or (own.scale and "scale" not in own.guessed):
        return own
    return replace(own, scale=scale, guessed=tuple(key for key in own.guessed if key != "scale"))


def _filled_in(
    folder: Path, found: dict[str, tuple[propose.NewFile, Guess]]
) -> tuple[dict[str, str], list[str]]:
    """Take what spreadsheets state of files; return of how many each does, and what cannot be taken."""
    read, problems = {}, []
    for sheet in [file for file, (new, _) in found.items() if new.use == "sheet"]:
        table = read_file_table(folder / sheet)
        named = join_files(table, [file for file in found if file != sheet])
        problems += [
            f"{sheet}, line {row.line}: {'; '.join(row.problems)}" for row in table.rows if row.problems
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
            taken, problem = propose.stated_values(new, row.values, ())
            if problem:
                problems.append(f"{file}: {problem}")
            found[file] = propose.with_guessed_scale(replace(new, **taken), guess), guess
    return read, problems


def _guesses(new: propose.NewFile, guess: Guess) -> Iterator[str]:
    """Yield what of a file is a guess."""
    if "use" in new.guessed:
        others = " or ".join(_WORDS.get(use, "something else") for use in guess.uses[1:3])
        yield f"{new.file}: taken as {_WORDS[new.use]}, but may be {others}"
    if "face" in new.guessed:
        yield f"{new.file}: its face is taken as {new.face}"
    if "scale" in new.guessed:
        yield f"{new.file}: {guess.scales[new.use].why}"
