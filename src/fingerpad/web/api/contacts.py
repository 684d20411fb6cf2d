"""Contact images measured under corrections: prepared once, then measured in milliseconds."""

import math
import time
from collections.abc import Hashable
from dataclasses import replace
from typing import Any, Final

import numpy as np

from fingerpad.exceptions import FingerpadError, ImageError
from fingerpad.image import (
    ContactImageOptions,
    ContactImageResult,
    ImageEllipse,
    PreparedContactImage,
    SequenceSettings,
    estimate_settings,
    open_frames,
    scan_texture,
)
from fingerpad.study.corrections.apply import (
    contact_correction,
    contact_options,
    frame_corrections,
    measured_under,
    prepared_contact,
)
from fingerpad.study.corrections.changes import ContactCorrection
from fingerpad.study.manifest import CORRECTIONS, Contact, ContactSequence, ScaleKey
from fingerpad.study.measuring.contacts import (
    IMPLAUSIBLE_SIZE,
    Measurement,
    doubts_of,
    excluding_flags,
    from_contact_image,
    is_pooled,
    reviewed,
)
from fingerpad.study.measuring.scales import FoundScale
from fingerpad.study.results.rows import PLACEMENT, model_contact
from fingerpad.study.results.table import COLUMNS
from fingerpad.study.results.validity import HEADLINES
from fingerpad.web.answers import Answer, MeasuredBy, Point, PoolingCorrectionRecord, Quantities
from fingerpad.web.api.base import Body, Item, Opened, Params, study_router
from fingerpad.web.api.corrections import pooling_correction
from fingerpad.web.api.photographs import measured_finger
from fingerpad.web.api.scales import scale_of
from fingerpad.web.errors import RequestError
from fingerpad.web.last_results import item_row, known_finger, last_headlines, last_results
from fingerpad.web.pictures import Cache, ImageLocation
from fingerpad.web.study_session import StudySession, contact_of_file, frame_of

router = study_router()

_PREPARED: Final[Cache[PreparedContactImage]] = Cache(12, lambda _: 1)
_AUTOMATIC: Final[Cache[tuple[ContactImageResult | None, str | None]]] = Cache(50, lambda _: 1)
_SETTINGS: Final[Cache[SequenceSettings | None]] = Cache(50, lambda _: 1)
# A sequence may have thousands of frames: some of them suffice to estimate its settings.
_SAMPLED_FRAMES: Final = 200


class ContactNumbers(Quantities):
    """The numbers measured in a contact image."""

    semi_major_mm: float
    semi_major_mm_std: float | None
    semi_minor_mm: float
    semi_minor_mm_std: float | None
    orientation_deg: float
    gross_area_mm2: float
    gross_area_mm2_std: float | None
    ridge_area_mm2: float | None
    ridge_area_mm2_std: float | None
    ridge_period_mm: float | None
    ellipse_iou: float | None


class AutomaticContact(ContactNumbers):
    """The automatic measurement, to compare with a corrected one."""

    outline_px: list[Point]


class ContactEllipsePx(Answer):
    """A contact ellipse; the angle is that of the major axis from straight up."""

    centre: Point
    semi_axes: Point
    orientation_deg: float


class ContactHandles(Answer):
    """Where the handles of a contact ellipse are."""

    centre_px: Point
    major_ends_px: tuple[Point, Point]
    minor_ends_px: tuple[Point, Point]


class ContactSettings(Answer):
    """Settings of the measurement, chosen automatically unless they were corrected."""

    dark_on_light: bool
    threshold: float | None


class ContactModel(Quantities):
    """What the contact model gives for a contact: keys as in ``results.csv``.

    Of the last run are `verdicts`, by key, and the model's part of a ``_total_std``.
    """

    load_N: float  # noqa: N815
    u_deg: float | None
    mean_curvature_radius_mm: float | None
    mean_curvature_radius_mm_std: float | None
    radius_from_indentation_mm: float | None
    radius_from_indentation_mm_total_std: float | None
    radius_from_compliance_mm: float | None
    radius_from_compliance_mm_std: float | None
    indentation_mm: float | None
    indentation_mm_total_std: float | None
    youngs_modulus_kpa: float | None
    youngs_modulus_kpa_total_std: float | None
    effective_thickness_mm: float | None
    effective_thickness_mm_std: float | None
    youngs_modulus_on_layer_kpa: float | None
    youngs_modulus_on_layer_kpa_std: float | None
    indentation_on_layer_mm: float | None
    indentation_on_layer_mm_std: float | None
    loading_radius_on_layer_mm: float | None
    loading_radius_on_layer_mm_std: float | None
    layer_flag: str | None
    range_notes: list[str]
    verdicts: dict[str, str]


class ContactPooling(Answer):
    """Whether a contact will be pooled: the flags against it, and its manual correction."""

    pooled: bool
    excluding_flags: list[str]
    correction: PoolingCorrectionRecord | None


class ContactMeasurement(Answer):
    """A contact image measured under a correction; its model may wait for photographs of the finger."""

    item: str
    by: MeasuredBy
    outline_px: list[Point]
    ellipse_px: ContactEllipsePx
    handles: ContactHandles
    numbers: ContactNumbers
    automatic: AutomaticContact | None
    automatic_error: str | None
    model: ContactModel | None
    waits: bool
    settings: ContactSettings
    flags: list[str]
    pooling: ContactPooling | None
    mm_per_px: float
    mm_per_px_std: float
    milliseconds: float


class ContactLevels(Answer):
    """How many pixels have which level: grey levels from the background towards contact."""

    counts: list[float]
    edges: list[float]
    automatic_threshold: float | None


# What the page shows of a contact's row, and what that is made of.
_MODEL_COLUMNS: Final = COLUMNS.keys() & {
    *(*PLACEMENT, *HEADLINES, *ContactModel.model_fields),
    *(f"{name}_std" for name in HEADLINES),
}


class ContactParams(Params):
    """A contact image, and the correction under which it is measured; `soon` waits for no photographs."""

    item: Item
    change: ContactCorrection | None = None
    scale: ScaleKey | None = None
    soon: bool = False


@router.post("/measure/contact")
def measure(opened: Opened, params: Body[ContactParams]) -> ContactMeasurement:
    """Measure a contact image under a correction; nothing is stored."""
    began = time.perf_counter()
    item = params.item
    contact, complete, found = _contact(opened, params)
    change = params.change or correction_of(opened, item)
    contact_image = measured_under(_prepared(opened, item, contact, found, change), change)
    waits = params.soon and complete and known_finger(opened, contact.finger) is None
    model = _model(opened, item, contact, contact_image, found) if complete and not waits else None
    own, error = _automatic(opened, item, contact, found) if change.edits else (contact_image, None)
    return ContactMeasurement.of(
        contact_image,
        item=item,
        by="manual" if change.ellipse_px is not None else "corrected" if change.edits else "automatic",
        outline_px=contact_image.outline.round(2),
        **_drawn(contact_image, found),
        numbers=_numbers(contact_image),
        automatic=own and _numbers(own) | {"outline_px": own.outline.round(2)},
        automatic_error=error,
        model=model,
        waits=waits,
        settings=ContactSettings.of(contact_image),
        flags=[*doubts_of(contact_image), *found.flags],
        pooling=model
        and _pooling(opened, item, contact, from_contact_image(contact_image, contact, found), model),
        mm_per_px=found.scale.mm_per_px,
        mm_per_px_std=found.scale.mm_per_px_std,
        milliseconds=1000 * (time.perf_counter() - began),
    )


@router.post("/measure/levels")
def levels(opened: Opened, params: Body[ContactParams]) -> ContactLevels:
    """Return the histogram of levels in which a threshold is chosen, and the automatic threshold."""
    contact, _, found = _contact(opened, params)
    change = (params.change or ContactCorrection()).model_copy(update={"threshold": None})
    prepared = _prepared(opened, params.item, contact, found, change)
    counts, edges = prepared.level_histogram()
    automatic = None if prepared.reason else prepared.measure().threshold
    return ContactLevels.of(counts=counts, edges=edges, automatic_threshold=automatic)


def _contact(opened: StudySession, params: ContactParams) -> tuple[Contact, bool, FoundScale]:
    """Return the table of an item, one for this request of a new file; whether it is complete; its scale."""
    item = params.item
    contact: Contact
    if item.startswith("file:"):
        if params.scale is None:
            raise RequestError.impossible(f"{item}: state its scale")
        file = item.removeprefix("file:")
        contact, complete = contact_of_file(file, params.scale), False
    else:
        contact, complete = opened.contact(item)
    scale = contact.scale if params.scale is None else params.scale
    if contact.scale is None or scale is None:
        raise RequestError.not_there(f"no contact image is named {item!r}")
    return contact.model_copy(update={"scale": scale}), complete, scale_of(opened, scale)


def correction_of(opened: StudySession, item: str) -> ContactCorrection:
    """Return what holds for a contact image: a person's correction, or what key frames carry to a frame."""
    name, mark, number = frame_of(item)
    if not mark:
        return contact_correction(opened.corrections.active_correction(item))
    frame = int(number)
    found = frame_corrections(opened.corrections.active_corrections(), name, range(frame, frame + 1))
    return contact_correction(found.get(frame))


def _prepared(
    opened: StudySession, item: str, contact: Contact, found: FoundScale, change: ContactCorrection
) -> PreparedContactImage:
    """Return a prepared contact image; strokes and a manual ellipse do not change it."""
    place = opened.image_location(item)
    reading = ContactCorrection.model_validate({name: getattr(change, name) for name in CORRECTIONS})
    return _PREPARED.get(
        _reading_of(opened, item, contact, found, reading),
        lambda: prepared_contact(
            opened.pictures.grey(place).pixels,
            found.scale,
            contact,
            opened.folder,
            reading,
            settings=_settings(opened, contact, found),
        ),
    )


def _settings(opened: StudySession, contact: Contact, found: FoundScale) -> ContactImageOptions | None:
    return sequence_settings(opened, contact, found) if isinstance(contact, ContactSequence) else None


def _reading_of(
    opened: StudySession, item: str, contact: Contact, found: FoundScale, change: ContactCorrection
) -> Hashable:
    """Return all that the reading of a contact image depends on."""
    settings = _settings(opened, contact, found)
    return (
        *(opened.image_location(item).stamp, _background_stamp(opened, contact), found.scale),
        *(contact.model_dump_json(), change.model_dump_json(), settings and tuple(settings.items())),
    )


def _background_stamp(opened: StudySession, contact: Contact) -> Hashable:
    if contact.background is not None:
        return ImageLocation(opened.file(contact.background)).stamp
    if contact.surface == "smooth" and isinstance(contact, ContactSequence):
        return ImageLocation(opened.sequence_path(contact.file), frame=0).stamp
    return None


def sequence_settings(
    opened: StudySession, sequence: ContactSequence, found: FoundScale
) -> ContactImageOptions | None:
    """Return the settings of a sequence, estimated from some frames; None where that fails."""
    path, count = opened.sequence_path(sequence.file), opened.count_frames(sequence.file) or 0
    some = np.unique(np.linspace(0, count - 1, min(count, _SAMPLED_FRAMES)).round().astype(int)).tolist()

    def learn() -> SequenceSettings | None:
        frames = open_frames(path, memory_limit=opened.memory_limit)
        try:
            options = contact_options(sequence, opened.folder)
            return estimate_settings(
                frames,
                found.scale,
                scan=scan_texture(map(frames.at, some), found.scale, **options),
                **options,
            )
        except ImageError:
            return None

    stamps = tuple(ImageLocation(path, frame=frame).stamp for frame in some)
    reading = _SETTINGS.get(
        (path, stamps, _background_stamp(opened, sequence), found.scale, sequence.model_dump_json()), learn
    )
    return None if reading is None else reading.settings


def _automatic(
    opened: StudySession, item: str, contact: Contact, found: FoundScale
) -> tuple[ContactImageResult | None, str | None]:
    """Return the automatic measurement, or why it failed."""

    def measured() -> tuple[ContactImageResult | None, str | None]:
        try:
            return _prepared(opened, item, contact, found, ContactCorrection()).measure(), None
        except ImageError as error:
            return None, str(error)

    return _AUTOMATIC.get(_reading_of(opened, item, contact, found, ContactCorrection()), measured)


def _numbers(contact_image: ContactImageResult) -> dict[str, Any]:
    record = contact_image.as_record()
    return {name: record[name] for name in ContactNumbers.model_fields}


def _drawn(contact_image: ContactImageResult, found: FoundScale) -> dict[str, Any]:
    """Return ellipse and handles of a contact in pixels."""
    size = found.scale.mm_per_px
    ellipse, centre = contact_image.ellipse, contact_image.centroid
    axes = float(ellipse.semi_major) / size, float(ellipse.semi_minor) / size
    drawn = ImageEllipse(centre=centre, semi_axes=axes, orientation=contact_image.orientation)
    # Four points: the ends of both axes.
    top, left, bottom, right = drawn.points(4)
    return {
        "ellipse_px": {
            "centre": centre,
            "semi_axes": axes,
            "orientation_deg": np.degrees(contact_image.orientation),
        },
        "handles": {"centre_px": centre, "major_ends_px": (top, bottom), "minor_ends_px": (left, right)},
    }


def _model(
    opened: StudySession, item: str, contact: Contact, contact_image: ContactImageResult, found: FoundScale
) -> ContactModel | None:
    """Return what the contact model gives, as in the results."""
    try:
        finger = measured_finger(opened, contact.finger)
    except FingerpadError:  # said where the photographs are
        finger = None
    if finger is None:
        return None
    load = getattr(contact, "load_N", None) or _load_of_frame(opened, item)
    if load is None:
        return None
    seen = from_contact_image(contact_image, contact, found)
    measured = replace(seen, observation=item, load_N=load)
    row = model_contact(opened.study(), finger, contact, measured, _MODEL_COLUMNS)
    headlines = last_headlines(opened, tuple(row[name] for name in PLACEMENT))
    for name in HEADLINES:
        if (std := row[f"{name}_std"]) is not None:
            relative = np.nan_to_num(headlines[name].model_relative_std) if name in headlines else 0.0
            row[f"{name}_total_std"] = math.hypot(std, relative * row[name])
    return ContactModel.of(
        row,
        range_notes=(row["range_notes"] or "").split(),
        verdicts={name: one.verdict for name, one in headlines.items()},
    )


def _pooling(
    opened: StudySession, item: str, contact: Contact, measured: Measurement, model: ContactModel
) -> ContactPooling | None:
    """Return whether a contact will be pooled; None of frames, for which other rules hold."""
    if isinstance(contact, ContactSequence):
        return None
    active = opened.corrections.active_correction(item)
    seen = reviewed(measured, active)
    excluding = excluding_flags(contact, seen, plausible=IMPLAUSIBLE_SIZE not in model.range_notes)
    return ContactPooling(
        pooled=is_pooled(seen, excluding),
        excluding_flags=sorted(excluding),
        correction=pooling_correction(active),
    )


def _load_of_frame(opened: StudySession, item: str) -> float | None:
    found = last_results(opened)
    row = found and item_row(found.table, item)
    return row["load_N"] if row else None
