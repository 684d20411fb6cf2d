"""Contact images measured while a person corrects them: decoded and prepared once, then a few milliseconds each."""

import time
from collections.abc import Mapping
from typing import Any, Final

import numpy as np

from fingerpad.exceptions import ImageError
from fingerpad.image import BrushStroke, HandEllipse, Imprint, PreparedImprint, prepare_imprint
from fingerpad.study.manifest import Contact, ScaleKey
from fingerpad.study.measure import Measurement, from_imprint, place_of
from fingerpad.study.rows import make_rows
from fingerpad.study.scales import FoundScale
from fingerpad.web.asked import Item
from fingerpad.web.bench import Bench
from fingerpad.web.fingers import known_finger
from fingerpad.web.open_study import OpenStudy
from fingerpad.web.operations import Operation, Question
from fingerpad.web.pictures import Cache
from fingerpad.web.refusal import Refusal
from fingerpad.web.results import last_results
from fingerpad.web.scales import scale_of

_PREPARED: Final[Cache[PreparedImprint]] = Cache(12, lambda _: 1)
_SETTINGS: Final = ("dark_on_light", "threshold", "seed_px", "mask_px", "region_of_interest_px")


class ContactQuestion(Question):
    """Which contact image, and the correction under which it is measured."""

    item: Item
    change: dict[str, Any] | None = None
    scale: ScaleKey | None = None


def measure(bench: Bench, _: Any, asked: ContactQuestion) -> dict[str, Any]:
    """Measure a contact image as it is being corrected; nothing is stored."""
    began = time.perf_counter()
    opened = bench.study
    contact = _contact(opened, asked.item)
    key = asked.scale or (contact and contact.scale)
    if key is None:
        raise Refusal.impossible(f"{asked.item}: say its scale first")
    found = scale_of(opened, key)
    change = asked.change or {}
    imprint = _prepared(opened, asked.item, contact, found, change).with_edits(**_edits(change))
    own: Imprint | None = imprint
    error = None
    if change:
        try:
            own = _prepared(opened, asked.item, contact, found, {}).imprint
        except ImageError as refused:
            own, error = None, str(refused)
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
        "flags": list(imprint.flags),
        "mm_per_px": found.scale.mm_per_px,
        "mm_per_px_std": found.scale.mm_per_px_std,
        "milliseconds": 1000 * (time.perf_counter() - began),
    }


def _contact(opened: OpenStudy, item: str) -> Contact | None:
    """Return the table that an item belongs to, None for a file that no table names yet."""
    if item.startswith("file:"):
        return None
    if "#" in item:
        return opened.sequence(item.rpartition("#")[0])
    observation = opened.observation(item)
    if observation is None:
        raise Refusal.not_there(f"no contact image is named {item!r}")
    return observation


def _prepared(
    opened: OpenStudy, item: str, contact: Contact | None, found: FoundScale, change: Mapping[str, Any]
) -> PreparedImprint:
    place = opened.place_of(item)
    said = {name: change.get(name, getattr(contact, name, None)) for name in _SETTINGS}
    background = getattr(contact, "background", None)

    def prepare() -> PreparedImprint:
        where = {} if contact is None else place_of(contact, opened.folder)
        seed, mask, window = said["seed_px"], said["mask_px"], said["region_of_interest_px"]
        where |= {"seed": seed and tuple(seed), "mask": mask, "region_of_interest": window and tuple(window)}
        return prepare_imprint(
            opened.pictures.grey(place).pixels,
            found.scale,
            dark_on_light=said["dark_on_light"],
            threshold=said["threshold"],
            **where,
        )

    return _PREPARED.get((place.stamp, found.scale, repr(said), background), prepare)


def _edits(change: Mapping[str, Any]) -> dict[str, Any]:
    strokes = [
        BrushStroke(action=one["action"], points=one["points_px"], radius=one["radius_px"])
        for one in change.get("strokes") or ()
    ]
    hand = change.get("ellipse_px")
    ellipse = hand and HandEllipse(
        centre=tuple(hand["centre"]),
        semi_axes=tuple(hand["semi_axes"]),
        orientation=float(np.radians(hand.get("orientation_deg", 0.0))),
    )
    return {"strokes": strokes, "ellipse": ellipse}


def _by(change: Mapping[str, Any]) -> str:
    if change.get("ellipse_px"):
        return "person"
    return (
        "program with corrections" if any(change.get(key) for key in (*_SETTINGS, "strokes")) else "program"
    )


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
    opened: OpenStudy, item: str, contact: Contact | None, imprint: Imprint, found: FoundScale
) -> dict[str, Any] | None:
    """Return what the model makes of a contact: the row that the results would have."""
    finger = None if contact is None else known_finger(opened, contact.finger)
    if contact is None or finger is None:
        return None
    load = getattr(contact, "load_N", None) or _load_of_frame(opened, item)
    if load is None:
        return None
    measured = Measurement(name=item, load=load, **from_imprint(imprint, contact, found))
    row = make_rows(opened.study(), {finger.name: finger}, [(contact, measured)]).rows[0]
    return {**row, "range_notes": (row["range_notes"] or "").split(), "flags": row["flags"].split()}


def _load_of_frame(opened: OpenStudy, item: str) -> float | None:
    found = last_results(opened)
    row = found and next((row for row in found.rows if row["observation"] == item), None)
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
