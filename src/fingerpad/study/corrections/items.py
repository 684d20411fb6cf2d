"""What can be corrected: observations, frames and phases of sequences, and photographs, by name."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Literal, TypeAlias

from fingerpad._files import digest_of
from fingerpad.exceptions import ImageError, StoreError
from fingerpad.image import open_frames
from fingerpad.study.corrections.history import ActiveCorrection, sequence_of_phases
from fingerpad.study.manifest import Study

Kind: TypeAlias = Literal["observation", "frame", "phases", "photograph"]


def kind_of(item: str, study: Study) -> Kind:
    """Return what an item is.

    Raises
    ------
    StoreError
        If the manifest names no such item.
    """
    kind = named_kind(item, study)
    if kind is None:
        raise StoreError(
            f"{item[:80]!r} is nothing that can be corrected: name an observation, a frame as SEQUENCE#12, "
            "the phases of a sequence as SEQUENCE#phases, or a photograph as FINGER/IMAGE, as the manifest "
            "has them"
        )
    return kind


def named_kind(item: str, study: Study) -> Kind | None:
    """Return what an item is, None where the manifest names no such item."""
    if "/" in item:
        finger, _, image = item.partition("/")
        images = {photo.file for each in study.fingers if each.name == finger for photo in each.photographs}
        return "photograph" if image in images else None
    if (sequence := sequence_of_phases(item)) is not None:
        return "phases" if any(one.name == sequence for one in study.sequences) else None
    name, mark, number = item.partition("#")
    if mark:
        known = any(sequence.name == name for sequence in study.sequences)
        return "frame" if known and _is_frame(number) else None
    return "observation" if any(each.name == item for each in study.observations) else None


def image_of(item: str, study: Study) -> str | None:
    """Return the file of an item's picture, or of the force whose phases it is.

    None where it has none of its own, as a frame of a sequence.
    """
    if "/" in item:
        return item.partition("/")[2]
    if (sequence := sequence_of_phases(item)) is not None:
        return next((each.force for each in study.sequences if each.name == sequence), None)
    return next((each.file for each in study.observations if each.name == item), None)


def picture_digest(item: str, study: Study, folder: Path) -> str:
    """Return the SHA-256 of an item's file as of `image_of`, or of a frame's pixels; empty without any."""
    image = image_of(item, study)
    if image is not None:
        return digest_of(folder / image)
    name, _, number = item.partition("#")
    path = next((sequence.file for sequence in study.sequences if sequence.name == name), None)
    if path is None or not _is_frame(number):
        return ""
    try:
        return open_frames(folder / path).at(int(number)).digest
    except ImageError:
        return ""


def on_another_image(
    active_corrections: Mapping[str, ActiveCorrection], digest: Callable[[str], str]
) -> list[str]:
    """Return the items whose picture is not the one that was corrected.

    Parameters
    ----------
    active_corrections : mapping
        Active corrections by item.
    digest : callable
        That of an item's current picture, as of `picture_digest`.
    """
    return [
        item
        for item, active_correction in active_corrections.items()
        if active_correction.picture and digest(item) not in {"", active_correction.picture}
    ]


def frames_of(
    active_corrections: Mapping[str, ActiveCorrection], sequence: str
) -> dict[int, ActiveCorrection]:
    """Return the active corrections of a sequence's frames, by the frame's number."""
    start = f"{sequence}#"
    named = {
        item.removeprefix(start): one for item, one in active_corrections.items() if item.startswith(start)
    }
    return {
        int(number): active_correction for number, active_correction in named.items() if _is_frame(number)
    }


def _is_frame(number: str) -> bool:
    """Tell whether a frame is numbered as the rows name it."""
    return number.isdecimal() and str(int(number)) == number
