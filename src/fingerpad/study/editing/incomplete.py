"""What the manifest would not take of a table that is not complete yet, in its own words."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal, TypeAlias

from fingerpad.exceptions import ManifestError
from fingerpad.study.manifest.contacts import ContactSequence, Observation
from fingerpad.study.manifest.curves import Curve
from fingerpad.study.manifest.fingers import Finger
from fingerpad.study.manifest.read import file_inside
from fingerpad.study.manifest.scales import OwnScale
from fingerpad.study.manifest.tables import ManifestModel, Name
from fingerpad.study.manifest.validation import validated

Kind: TypeAlias = Literal[
    "study", "uncertainty", "scale", "finger", "photograph", "observation", "sequence", "curve"
]

# Keys that name files.
_FILES: Final = ("file", "outline", "background", "force", "times")


@dataclass(frozen=True, slots=True, kw_only=True)
class Known:
    """Names of a study: of its scales, of those that wait for a first finger, of fingers and contacts."""

    scales: frozenset[str]
    waiting_scales: frozenset[str]
    fingers: frozenset[str]
    contacts: frozenset[str]


class _Scale(ManifestModel):
    """A scale with its name, which elsewhere is a key."""

    name: Name
    table: OwnScale


_MODELS: Final[Mapping[str, type[ManifestModel]]] = {
    "finger": Finger,
    "observation": Observation,
    "sequence": ContactSequence,
    "curve": Curve,
}


def validation_errors(
    kind: Kind, key: str, content: Mapping[str, Any], *, known: Known, folder: Path
) -> tuple[str, ...]:
    """Say what is missing or wrong in a table.

    Parameters
    ----------
    kind, key : str
        What it is, and its name.
    content : mapping
        The table.
    known : Known
        What it may go by.
    folder : Path
        The study folder.
    """
    where = f"{kind} {key}"
    try:
        if kind == "scale":
            checked: ManifestModel = validated(_Scale, {"name": key, "table": content}, where, strict=True)
        else:
            checked = validated(_MODELS[kind], content, where, strict=True)
    except ManifestError as error:
        lines = str(error).replace(f"{where}: table.", f"{where}: ").splitlines()
        return tuple(line.removeprefix(f"{where}: ") for line in lines)
    return (*_name_faults(checked, known), *_file_faults(checked, folder))


def _name_faults(checked: ManifestModel, known: Known) -> Iterator[str]:
    """Say which finger or scale is not there, or which name is taken."""
    taken = known.contacts
    if isinstance(checked, _Scale | Finger):
        taken = known.scales if isinstance(checked, _Scale) else known.fingers
    name, finger = getattr(checked, "name", None), getattr(checked, "finger", None)
    if name is not None and name.casefold() in {other.casefold() for other in taken}:
        yield f"name: {name!r} is taken; names must differ by more than case"
    if finger is not None and finger not in known.fingers:
        yield f"finger: {finger!r} is not complete, or there is none of this name"
    for part in (checked, *getattr(checked, "photographs", [])):
        scale = getattr(part, "scale", None)
        if isinstance(scale, str) and scale not in known.scales | known.waiting_scales:
            yield f"scale: {scale!r} is not complete, or there is none of this name"


def _file_faults(checked: ManifestModel, folder: Path) -> Iterator[str]:
    """Say which files are not in the study folder."""
    for part in (checked, *getattr(checked, "photographs", [])):
        scale = part.table if isinstance(part, _Scale) else getattr(part, "scale", None)
        named = {place: getattr(part, place, None) for place in _FILES}
        for place, file in (named | {"coin": getattr(scale, "coin", None)}).items():
            if file is not None:
                try:
                    is_sequence = isinstance(part, ContactSequence) and place == "file"
                    file_inside(folder, file, "", f".{place}", may_be_folder=is_sequence)
                except ManifestError as error:
                    yield str(error).removeprefix(": .")
