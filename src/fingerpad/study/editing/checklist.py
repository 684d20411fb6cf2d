"""What a study still lacks, in plain words."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Final

from fingerpad._tables import TABLE_SUFFIXES
from fingerpad.image import FACE_AXES
from fingerpad.image.sequence.frames import PICTURE_SUFFIXES, VIDEO_SUFFIXES
from fingerpad.study.manifest import Finger, LoadedStudy, Study
from fingerpad.study.manifest.load import STUDY_NAME, Table
from fingerpad.study.manifest.messages import Fault

# What can be a picture, a sequence, a curve, an outline or a spreadsheet that tells of them.
_USABLE: Final = PICTURE_SUFFIXES | VIDEO_SUFFIXES | TABLE_SUFFIXES
# A run's output folder, which may lie inside the study's.
_OF_A_RUN: Final = frozenset(("store.sqlite", "results.json", "results.csv"))
# More pictures than these in a folder of their own are the frames of a sequence.
_SEQUENCE: Final = 20
_OF_PHOTOGRAPH: Final = re.compile(r"photographs\[(?P<number>\d+)\]\.?(?P<place>.*)")
_NEEDS_AXES: Final = "give either semi_axes_mm or photographs"
_NEEDS_SCALE: Final = " needs its scale"
_FIELD_WORDS: Final = {
    "diameter_mm": "the diameter of the coin or circle",
    "face": "which face it shows",
    "finger": "which finger it is",
    "force": "the file of the force",
    "length_mm": "the line's length",
    "load_N": "the load",
    "points": "the inner corners or dots, down and along",
    "spacing_mm": "the spacing of the grid",
    "wedge_angle_deg": "the wedge angle",
}
_AXIS_WORDS: Final = {"palmar": "palmar", "distal": "distal", "radial_ulnar": "radial-ulnar"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Missing:
    """One thing that a study lacks.

    Attributes
    ----------
    kind, key : str
        What lacks it, as of an `Edit`; kind ``file`` and its name for a file that nothing names, ``folder``
        for a folder of frames.
    words : str
        What is lacking, and the way out.
    place : str
        The key to set in that table; empty where it takes more than one value.
    """

    kind: str
    key: str
    words: str
    place: str = ""


def missing(loaded: LoadedStudy) -> list[Missing]:
    """Return what a study lacks to say something about every finger, and files that it does not use."""
    study = loaded.study
    found = [
        _lacking(one, fault) if one.key else Missing(kind=one.kind, key="", words=line)
        for one in loaded.incomplete
        for fault, line in zip(one.faults, one.lines, strict=True)
    ]
    waiting: set[str] = {one.kind for one in loaded.incomplete}
    if not study.fingers and "finger" not in waiting:
        found.append(Missing(kind="study", key="", words="no finger yet: add one"))
    for finger in study.fingers:
        found.extend(_lacking_faces(finger))
    if study.fingers:
        found.extend(_lacking_contacts(study, waiting))
    found.extend(_unused(loaded))
    return found


def _lacking(one: Table, fault: Fault) -> Missing:
    """Return a fault of a table for someone who sees its fields on a page, and not the manifest."""
    place, words = fault
    kind, key, of = str(one.kind), one.key, ""
    if (found := _OF_PHOTOGRAPH.fullmatch(place)) is not None:
        photograph = one.content["photographs"][int(found["number"])]
        file = str(photograph.get("file") or photograph.get("outline"))
        kind, key, of = "photograph", f"{one.key}/{file}", f"{PurePosixPath(file).name}: "
        place = found["place"]
    if _NEEDS_SCALE in words:
        place = "scale"
    if words.startswith(_NEEDS_AXES):
        place = "semi_axes_mm"
    return Missing(kind=kind, key=key, words=f"{of}{_words(place, words)}", place=place)


def _words(place: str, words: str) -> str:
    """Return what is wrong at a place, without the names of keys where that can be."""
    if words == "required, but missing" and place in _FIELD_WORDS:
        return f"{_FIELD_WORDS[place]} is missing"
    if words.startswith(_NEEDS_AXES):
        return "give its semi-axes, or photographs of its faces"
    return "its scale is missing" if _NEEDS_SCALE in words else str(Fault(place, words))


def _lacking_faces(finger: Finger) -> Iterator[Missing]:
    if finger.semi_axes_mm is not None:
        return
    shown = {axis for photograph in finger.photographs for axis in FACE_AXES[photograph.face]}
    for axis, words in _AXIS_WORDS.items():
        if axis not in shown:
            faces = " or ".join(face for face, axes in FACE_AXES.items() if axis in axes)
            yield Missing(
                kind="finger",
                key=finger.name,
                words=f"no photograph shows the {words} semi-axis: add one of the {faces} face",
            )


def _lacking_contacts(study: Study, waiting: set[str]) -> Iterator[Missing]:
    contacts = [*study.observations, *study.sequences]
    if not contacts and not study.curves and waiting.isdisjoint({"observation", "sequence", "curve"}):
        yield Missing(kind="study", key="", words="no contact yet: add a contact image with its load")
        return
    touched = {contact.finger for contact in contacts} | {curve.finger for curve in study.curves}
    for finger in study.fingers:
        if finger.name not in touched and waiting.isdisjoint({"observation", "sequence", "curve"}):
            yield Missing(kind="finger", key=finger.name, words="no contact image and no curve is of it")


def _unused(loaded: LoadedStudy) -> Iterator[Missing]:
    """Yield the files that no table names; frames in a folder of their own together."""
    folder = loaded.folder
    used = {Path(name).as_posix() for name in loaded.files()}
    frames: dict[str, list[str]] = {}
    for path in _files(folder):
        name = path.relative_to(folder).as_posix()
        if name in used or any(name.startswith(f"{other}/") for other in used):
            continue
        frames.setdefault(path.parent.relative_to(folder).as_posix(), []).append(name)
    for place, names in sorted(frames.items()):
        pictures = {name for name in names if Path(name).suffix.lower() in PICTURE_SUFFIXES}
        if place != "." and len(pictures) > _SEQUENCE:
            words = f"{len(pictures)} pictures that nothing names: add them as a sequence"
            yield Missing(kind="folder", key=place, words=words)
            names = [name for name in names if name not in pictures]  # noqa: PLW2901
        for name in sorted(names):
            yield Missing(kind="file", key=name, words="nothing names it: say what it is, or leave it")


def _files(folder: Path) -> Iterator[Path]:
    """Yield the files of a study that could be measured, but nothing hidden and nothing that a run wrote."""
    for path in sorted(folder.iterdir()):
        if path.name.startswith(".") or path.name == STUDY_NAME:
            continue
        if path.is_dir():
            if not path.is_symlink() and not any((path / name).exists() for name in _OF_A_RUN):
                yield from _files(path)
        elif path.suffix.lower() in _USABLE:
            yield path
