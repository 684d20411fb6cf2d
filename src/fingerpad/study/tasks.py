"""What there is to measure in a study, keyed by all that a result depends on, and results as records."""

import hashlib
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cache
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np

from fingerpad.image import SequenceSummary
from fingerpad.study.manifest import Contact, ContactSequence, Observation
from fingerpad.study.measure import Measurement
from fingerpad.study.runner import Measured
from fingerpad.study.scales import FoundScale
from fingerpad.study.sequences import FrameOverlay, SequenceResult
from fingerpad.study.store import Stored

# What of a contact's table changes nothing in what is measured on its picture.
_NOT_MEASURED: Final = frozenset(("finger", "wedge_angle_deg", "roll_angle_deg", "load_N", "notes", "scale"))
_FILES: Final = ("image", "background", "path", "force", "times")


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """One contact to measure.

    Attributes
    ----------
    contact : Contact
        Its table of the manifest.
    key : str
        Digest of its inputs, its parameters and the code that measures.
    """

    contact: Contact
    key: str

    def done_by(self, stored: Stored | None, out: Path) -> Measured | None:
        """Return what is stored of this task, None where that is nothing, stale, or lacks its pictures."""
        if stored is None or stored.key != self.key:
            return None
        measured = measured_from(stored.record, self.contact)
        return measured if all((out / name).is_file() for name in pictures_of(measured)) else None


def tasks_of(
    contacts: Sequence[Contact],
    scales: Mapping[str, FoundScale | str],
    folder: Path,
    digest: Callable[[Path], str],
) -> Iterator[Task]:
    """Yield a task for each contact; `digest` gives that of a file or folder."""
    for contact in contacts:
        parameters = contact.model_dump(mode="json", exclude=set(_NOT_MEASURED))
        files = {name: digest(folder / file) for name in _FILES if (file := getattr(contact, name, None))}
        scale = scales[contact.scale] if isinstance(contact.scale, str) else contact.scale
        if isinstance(scale, FoundScale):
            said: object = [scale.scale.mm_per_px, scale.scale.mm_per_px_std, scale.name, scale.flags]
        else:
            said = scale if scale is None or isinstance(scale, str) else scale.model_dump(mode="json")
            if (coin := getattr(scale, "coin", None)) is not None:
                files["coin"] = digest(folder / coin)
        parts = [parameters, said, files, measuring_code()]
        yield Task(
            contact=contact, key=hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()
        )


@cache
def measuring_code() -> str:
    """Return the digest of all code that measures pictures: a change of it makes every result stale."""
    digest = hashlib.sha256()

    def add(folder: Traversable) -> None:
        for item in sorted(folder.iterdir(), key=lambda item: item.name):
            if item.is_dir():
                add(item)
            elif item.name.endswith(".py"):
                digest.update(item.name.encode() + b"\0" + item.read_bytes())

    package = resources.files("fingerpad")
    add(package / "image")
    for name in ("measure.py", "sequences.py"):
        digest.update((package / "study" / name).read_bytes())
    return digest.hexdigest()


def pictures_of(measured: Measured) -> list[str]:
    """Return the overlays that belong to a result, relative to the output folder."""
    film = measured.sequence.overlays if measured.sequence is not None else ()
    return [
        *(each.overlay for each in measured.measurements if each.overlay is not None),
        *(overlay.file for overlay in film),
    ]


def stored_of(measured: Measured, key: str) -> Stored:
    """Return a result as the store keeps it."""
    film = measured.sequence
    record = {
        "measurements": [
            {**asdict(each), "covariance": each.covariance.tolist()} for each in measured.measurements
        ],
        "sequence": None
        if film is None
        else {
            "summary": film.summary and asdict(film.summary),
            "overlays": [list(overlay) for overlay in film.overlays],
            "reason": film.reason,
        },
    }
    status: Literal["done", "failed"] = "failed" if measured.failed else "done"
    return Stored(key=key, status=status, record=record, seconds=measured.seconds)


def measured_from(record: Mapping[str, Any], contact: Contact) -> Measured:
    """Return a result from its record, for the contact's present table."""
    measurements = [
        Measurement(**{**each, "covariance": np.array(each["covariance"]), "flags": tuple(each["flags"])})
        for each in record["measurements"]
    ]
    if isinstance(contact, Observation):
        measurements = [replace(each, load=contact.load_N) for each in measurements]
    return Measured(
        contact=contact.name,
        measurements=measurements,
        sequence=_film(record["sequence"], contact) if isinstance(contact, ContactSequence) else None,
    )


def _film(record: Mapping[str, Any], sequence: ContactSequence) -> SequenceResult:
    summary = record["summary"]
    return SequenceResult(
        manifest=sequence,
        summary=summary and SequenceSummary(**{**summary, "notes": tuple(summary["notes"])}),
        overlays=tuple(FrameOverlay(*overlay) for overlay in record["overlays"]),
        reason=record["reason"],
    )
