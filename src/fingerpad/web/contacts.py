"""Contact images measured while a person corrects them: prepared once, then a few milliseconds each."""

import time
from typing import Any, Final

import numpy as np

from fingerpad.exceptions import ImageError
from fingerpad.image import (
    HandEllipse,
    Imprint,
    ImprintSettings,
    PreparedImprint,
    Reading,
    learn_reading,
    open_frames,
    survey_frames,
)
from fingerpad.study.corrections.changes import ContactCorrection
from fingerpad.study.corrections.corrected import place_of, prepared_contact
from fingerpad.study.manifest import Contact, ContactSequence, Observation, ScaleKey
from fingerpad.study.measuring.measure import Measurement, contact_correction, doubts_of, from_imprint
from fingerpad.study.measuring.scales import FoundScale
from fingerpad.study.results.rows import make_rows
from fingerpad.web.asked import Item
from fingerpad.web.bench import Bench
from fingerpad.web.fingers import known_finger
from fingerpad.web.last_results import last_results
from fingerpad.web.open_study import OpenStudy
from fingerpad.web.operations import Operation, Question
from fingerpad.web.pictures import Cache, Place
from fingerpad.web.refusal import Refusal
from fingerpad.web.scales import scale_of

_PREPARED: Final[Cache[PreparedImprint]] = Cache(12, lambda _: 1)
_READINGS: Final[Cache[Reading | None]] = Cache(50, lambda _: 1)
# A film may have thousands of frames, and the page waits: some show as well how it is to be read.
_TEACHING_FRAMES: Final = 200
_NO_TABLE: Final = "none"


class ContactQuestion(Question):
    """Which contact image, and the correction under which it is measured."""

    item: Item
    change: ContactCorrection | None = None
    scale: ScaleKey | None = None


def measure(bench: Bench, _: Any, asked: ContactQuestion) -> dict[str, Any]:
    """Measure a contact image as it is being corrected; nothing is stored."""
    began = time.perf_counter()
    opened = bench.study
    contact = _contact(opened, asked)
    assert contact.scale is not None
    found = scale_of(opened, contact.scale)
    change = asked.change or contact_correction(opened.corrections.ruling(asked.item))
    prepared = _prepared(opened, asked.item, contact, found, change)
    imprint = prepared.with_edits(change.brush_strokes, change.hand_ellipse)
    own, error = _program(opened, asked.item, contact, found) if change.edits else (imprint, None)
    return {
        "item": asked.item,
        "by": _by(change),
        **_drawn(imprint, found),
        "numbers": numbers(imprint),
        "program": own and {**numbers(own), **_drawn(own, found)},
        "program_error": error,
        "model": _model(opened, asked.item, contact, imprint, found),
        "settings": {
            "dark_on_light": imprint.dark_on_light,
            "threshold": imprint.threshold,
            "contrast": imprint.contrast,
        },
        "flags": [*doubts_of(imprint), *found.flags],
        "mm_per_px": found.scale.mm_per_px,
        "mm_per_px_std": found.scale.mm_per_px_std,
        "milliseconds": 1000 * (time.perf_counter() - began),
    }


def _contact(opened: OpenStudy, asked: ContactQuestion) -> Contact:
    """Return the table that an item belongs to; a file that none names yet gets one for the moment."""
    item = asked.item
    if item.startswith("file:"):
        if asked.scale is None:
            raise Refusal.impossible(f"{item}: say its scale first")
        file = item.removeprefix("file:")
        return Observation(
            name=_NO_TABLE, finger=_NO_TABLE, wedge_angle_deg=0, load_N=1, image=file, scale=asked.scale
        )
    contact = opened.sequence(item.rpartition("#")[0]) if "#" in item else opened.observation(item)
    if contact is None or contact.scale is None:
        raise Refusal.not_there(f"no contact image is named {item!r}")
    return contact if asked.scale is None else contact.model_copy(update={"scale": asked.scale})


def _prepared(
    opened: OpenStudy, item: str, contact: Contact, found: FoundScale, change: ContactCorrection
) -> PreparedImprint:
    """Return a picture with its ridges told; strokes and ellipse need that only once."""
    place = opened.place_of(item)
    reading = change.model_copy(
        update={"strokes": [], "ellipse_px": None, "accepted": False, "rejected": None}
    )
    settings = reading_of(opened, contact, found) if isinstance(contact, ContactSequence) else None
    background = None if contact.background is None else Place(opened.file(contact.background)).stamp
    return _PREPARED.get(
        (place.stamp, found.scale, contact.model_dump_json(), reading.model_dump_json(), background),
        lambda: prepared_contact(
            opened.pictures.grey(place).pixels,
            found.scale,
            contact,
            opened.folder,
            reading,
            settings=settings,
        ),
    )


def reading_of(opened: OpenStudy, sequence: ContactSequence, found: FoundScale) -> ImprintSettings | None:
    """Return how a film is read, learnt from some of its frames; None where they teach nothing."""
    place = Place(opened.folder / sequence.path)

    def learn() -> Reading | None:
        frames = open_frames(place.path, pixel_limit=opened.pixel_limit)
        some = np.unique(
            np.linspace(0, frames.count - 1, min(frames.count, _TEACHING_FRAMES)).round().astype(int)
        )
        where = place_of(sequence, opened.folder)
        try:
            return learn_reading(
                frames,
                found.scale,
                survey=survey_frames(map(frames.at, map(int, some)), found.scale, **where),
                dark_on_light=sequence.dark_on_light,
                threshold=sequence.threshold,
                **where,
            )
        except ImageError:
            return None

    reading = _READINGS.get((place.stamp, found.scale, sequence.model_dump_json()), learn)
    return None if reading is None else reading.settings


def _program(
    opened: OpenStudy, item: str, contact: Contact, found: FoundScale
) -> tuple[Imprint | None, str | None]:
    """Return what the program measures by itself, or why it does not."""
    try:
        return _prepared(opened, item, contact, found, ContactCorrection()).imprint, None
    except ImageError as error:
        return None, str(error)


def _by(change: ContactCorrection) -> str:
    if change.ellipse_px is not None:
        return "person"
    return "program with corrections" if change.edits else "program"


def numbers(imprint: Imprint) -> dict[str, Any]:
    """Return an imprint's numbers, without what is drawn of it."""
    record = imprint.as_record()
    return {
        **{key: value for key, value in record.items() if key not in {"centroid_px", "flags"}},
        "axis_ratio": float(imprint.ellipse.axis_ratio),
    }


def _drawn(imprint: Imprint, found: FoundScale) -> dict[str, Any]:
    """Return an imprint's outline, ellipse and handles on its picture."""
    size = found.scale.mm_per_px
    major, minor = float(imprint.ellipse.semi_major) / size, float(imprint.ellipse.semi_minor) / size
    hand = HandEllipse(centre=imprint.centroid, semi_axes=(major, minor), orientation=imprint.orientation)
    # A quarter of the way round lies between two handles.
    top, left, bottom, right = hand.points(4)
    return {
        "outline_px": imprint.outline.round(2),
        "ellipse_px": {
            "centre": imprint.centroid,
            "semi_axes": [major, minor],
            "orientation_deg": float(np.degrees(imprint.orientation)),
        },
        "handles": {
            "centre_px": imprint.centroid,
            "major_ends_px": [top, bottom],
            "minor_ends_px": [left, right],
        },
    }


def _model(
    opened: OpenStudy, item: str, contact: Contact, imprint: Imprint, found: FoundScale
) -> dict[str, Any] | None:
    """Return what the model makes of a contact: the row that the results would have."""
    finger = None if item.startswith("file:") else known_finger(opened, contact.finger)
    if finger is None:
        return None
    load = getattr(contact, "load_N", None) or _load_of_frame(opened, item)
    if load is None:
        return None
    measured = Measurement(name=item, load=load, **from_imprint(imprint, contact, found))
    row = make_rows(opened.study(), {finger.name: finger}, [(contact, measured)]).table[0]
    return {**row, "range_notes": (row["range_notes"] or "").split(), "flags": row["flags"].split()}


def _load_of_frame(opened: OpenStudy, item: str) -> float | None:
    found = last_results(opened)
    row = found and found.row(item)
    return row["load_N"] if row else None


OPERATIONS: Final = (
    Operation(
        method="POST",
        path="/api/measure/contact",
        answer=measure,
        summary="Measure a contact image under a correction, without storing it",
        body=ContactQuestion,
    ),
)
