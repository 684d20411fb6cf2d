"""Contact images measured under corrections: prepared once, then measured in milliseconds."""

import math
from collections.abc import Hashable
from dataclasses import replace
from typing import Final, Literal

import numpy as np

from fingerpad.exceptions import FingerpadError, ImageError
from fingerpad.image import (
    ContactImageOptions,
    ContactImageResult,
    PreparedContactImage,
    SequenceSettings,
    estimate_settings,
    open_frames,
    scan_texture,
)
from fingerpad.study.corrections.apply import (
    ContactPicture,
    contact_correction,
    contact_options,
    frame_corrections,
    measured_under,
)
from fingerpad.study.corrections.changes import ContactCorrection
from fingerpad.study.corrections.log import CorrectedPooling, parts_of_item
from fingerpad.study.manifest.models import CORRECTIONS, Contact, ContactSequence, Observation, ScaleKey
from fingerpad.study.measuring.contacts import (
    Measurement,
    excluding_flags,
    from_contact_image,
    is_pooled,
    reviewed,
)
from fingerpad.study.results.rows import model_contact
from fingerpad.study.results.summary_file import PLACEMENT
from fingerpad.study.results.table import COLUMNS, record_at
from fingerpad.study.results.validity.model_checks import HEADLINES
from fingerpad.web.answers import Answer, Point, Quantity, RequestError, quantities
from fingerpad.web.api.base import Body, Item, Opened, Params, router
from fingerpad.web.api.photographs import measured_finger
from fingerpad.web.api.scales import scale_of
from fingerpad.web.pictures import Cache, ImageLocation
from fingerpad.web.study_session import PLACEHOLDERS, StudySession

_PREPARED: Final[Cache[PreparedContactImage]] = Cache(12)
_AUTOMATIC: Final[Cache[tuple[ContactImageResult | None, str | None]]] = Cache(50)
_SETTINGS: Final[Cache[SequenceSettings | None]] = Cache(50)
# A sequence may have thousands of frames: some of them suffice to estimate its settings.
_SAMPLED_FRAMES: Final = 200

_MEASURED: Final = (
    *("semi_major_mm", "semi_minor_mm", "gross_area_mm2", "ridge_area_mm2", "ridge_period_mm"),
    "ellipse_iou",
)
_MODELLED: Final = (
    *("load_N", "u_deg", "mean_curvature_radius_mm", "radius_from_indentation_mm"),
    *("radius_from_compliance_mm", "indentation_mm", "youngs_modulus_kpa", "effective_thickness_mm"),
    *("youngs_modulus_on_layer_kpa", "indentation_on_layer_mm", "loading_radius_on_layer_mm"),
)


class ContactModel(Answer):
    """What the contact model gives for a contact, by the names of ``results.csv``.

    Of the last run are the `verdicts` and what the model leaves uncertain.
    """

    numbers: dict[str, Quantity]
    layer_flag: str | None
    range_notes: list[str]
    verdicts: dict[str, str]


class ContactPooling(Answer):
    """Whether a contact will be pooled: the flags against it, and its manual correction."""

    pooled: bool
    excluding_flags: list[str]
    correction: CorrectedPooling | None


class ContactMeasurement(Answer):
    """A contact image measured under a correction; its model may wait for photographs of the finger.

    `handles_px` are its centre and an end of either axis; the automatic measurement is there to compare with.
    """

    item: str
    by: Literal["automatic", "corrected", "manual"]
    outline_px: list[Point]
    handles_px: tuple[Point, Point, Point]
    numbers: dict[str, Quantity]
    automatic: dict[str, Quantity] | None
    automatic_outline_px: list[Point] | None
    automatic_error: str | None
    model: ContactModel | None
    waits: bool
    dark_on_light: bool
    threshold: float | None
    flags: list[str]
    pooling: ContactPooling | None
    mm_per_px: float


class ContactLevels(Answer):
    """How many pixels have which level: grey levels from the background towards contact."""

    counts: list[float]
    edges: list[float]
    automatic_threshold: float | None


# What the page shows of a contact's row, and what that is made of.
_MODEL_COLUMNS: Final = COLUMNS.keys() & {
    *(*PLACEMENT, *HEADLINES, *_MODELLED, "layer_flag", "range_notes"),
    *(f"{name}_std" for name in (*HEADLINES, *_MODELLED)),
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
    image = _Image(opened, params)
    change = params.change or image.correction()
    seen = measured_under(image.prepared(change), change)
    measured = replace(from_contact_image(seen, image.contact, image.found), observation=image.item)
    waits = params.soon and image.complete and opened.known_finger(image.contact.finger) is None
    model = image.model(measured) if image.complete and not waits else None
    own, error = image.automatic() if change.edits else (seen, None)
    ellipse = seen.ellipse_px
    return ContactMeasurement.of(
        seen,
        item=image.item,
        by="manual" if change.ellipse_px is not None else "corrected" if change.edits else "automatic",
        outline_px=seen.outline.round(2),
        handles_px=[ellipse.centre, *ellipse.points(4)[:2]],
        numbers=quantities(seen.as_record().get, _MEASURED),
        automatic=own and quantities(own.as_record().get, _MEASURED),
        automatic_outline_px=own and own.outline.round(2),
        automatic_error=error,
        model=model,
        waits=waits,
        flags=measured.flags,
        pooling=model and image.pooling(measured, model),
    )


@router.post("/measure/levels")
def levels(opened: Opened, params: Body[ContactParams]) -> ContactLevels:
    """Return the histogram of levels in which a threshold is chosen, and the automatic threshold."""
    change = (params.change or ContactCorrection()).model_copy(update={"threshold": None})
    prepared = _Image(opened, params).prepared(change)
    counts, edges = prepared.level_histogram()
    automatic = None if prepared.reason else prepared.measure().threshold
    return ContactLevels.of(counts=counts, edges=edges, automatic_threshold=automatic)


class _Image:
    """A contact image, a frame or a new file: its table, whether that is complete, and its scale."""

    def __init__(self, opened: StudySession, params: ContactParams) -> None:
        self.opened, self.item = opened, params.item
        contact: Contact
        if not self.item.startswith("file:"):
            contact, self.complete = opened.contact(self.item)
        elif params.scale is not None:
            file = self.item.removeprefix("file:")
            contact = Observation(name="new", file=file, scale=params.scale, **PLACEHOLDERS)
            self.complete = False
        else:
            raise RequestError.impossible(f"{self.item}: state its scale")
        if contact.scale is None:
            raise RequestError.not_there(f"no contact image is named {self.item!r}")
        known = contact.scale if params.scale is None else params.scale
        self.contact: Contact = contact.model_copy(update={"scale": known})
        self.found = scale_of(opened, known)

    def correction(self) -> ContactCorrection:
        """Return what holds: a person's correction, or what key frames carry to a frame."""
        if not isinstance(self.contact, ContactSequence):
            return contact_correction(self.opened.corrections.active_correction(self.item))
        _, name, number = parts_of_item(self.item)
        frame, active = int(number), self.opened.corrections.active_corrections()
        return contact_correction(frame_corrections(active, name, range(frame, frame + 1)).get(frame))

    def prepared(self, change: ContactCorrection) -> PreparedContactImage:
        """Return the prepared image; strokes and a manual ellipse do not change it."""
        reading = ContactCorrection.model_validate({name: getattr(change, name) for name in CORRECTIONS})
        place = self.opened.image_location(self.item)
        coloured = self.contact.surface == "smooth"
        return _PREPARED.get(
            self._key(reading),
            lambda: ContactPicture(
                self.opened.pictures.pixels(replace(place, colour=coloured)),
                self.found.scale,
                self.contact,
                self.opened.folder,
                self._settings(),
            ).prepared(reading),
        )

    def automatic(self) -> tuple[ContactImageResult | None, str | None]:
        """Return the automatic measurement, or why it failed."""

        def measured() -> tuple[ContactImageResult | None, str | None]:
            try:
                return self.prepared(ContactCorrection()).measure(), None
            except ImageError as error:
                return None, str(error)

        return _AUTOMATIC.get(self._key(ContactCorrection()), measured)

    def _key(self, change: ContactCorrection) -> Hashable:
        """Return all that the reading of the image depends on."""
        settings, stamp = self._settings(), self.opened.image_location(self.item).stamp
        return (
            *(stamp, self._background_stamp(), self.found.scale, self.contact.model_dump_json()),
            *(change.model_dump_json(), settings and tuple(settings.items())),
        )

    def _background_stamp(self) -> Hashable:
        contact = self.contact
        if contact.background is not None:
            return ImageLocation(self.opened.file(contact.background)).stamp
        if contact.surface == "smooth" and isinstance(contact, ContactSequence):
            return ImageLocation(self.opened.sequence_path(contact.file), frame=0).stamp
        return None

    def _settings(self) -> ContactImageOptions | None:
        """Return the settings of a frame's sequence, estimated from some frames; None where that fails."""
        sequence, opened = self.contact, self.opened
        if not isinstance(sequence, ContactSequence):
            return None
        path, count = opened.sequence_path(sequence.file), opened.count_frames(sequence.file) or 0
        some = np.unique(np.linspace(0, count - 1, min(count, _SAMPLED_FRAMES)).round().astype(int)).tolist()

        def learn() -> SequenceSettings | None:
            smooth, limit = sequence.surface == "smooth", opened.pictures.memory_limit
            frames, scale = open_frames(path, colour=smooth, memory_limit=limit), self.found.scale
            try:
                options = contact_options(sequence, opened.folder)
                scan = scan_texture(map(frames.at, some), scale, **options)
                return estimate_settings(frames, scale, scan=scan, **options)
            except ImageError:
                return None

        stamps = tuple(ImageLocation(path, frame=frame).stamp for frame in some)
        key = (path, stamps, self._background_stamp(), self.found.scale, sequence.model_dump_json())
        reading = _SETTINGS.get(key, learn)
        return None if reading is None else reading.settings

    def model(self, measured: Measurement) -> ContactModel | None:
        """Return what the contact model gives, as in the results."""
        try:
            finger = measured_finger(self.opened, self.contact.finger)
        except FingerpadError:  # said where the photographs are
            return None
        found, load = self.opened.results(), getattr(self.contact, "load_N", None)
        if load is None and found is not None:
            frame = record_at(found.table[found.table["observation"] == self.item])
            load = frame and frame["load_N"]
        if finger is None or load is None:
            return None
        study, loaded = self.opened.study(), replace(measured, load_N=load)
        row = model_contact(study, finger, self.contact, loaded, _MODEL_COLUMNS)
        placement = tuple(row[name] for name in PLACEMENT)
        summaries = found.summary.summaries if found else []
        headlines = next((one.validity.headlines for one in summaries if one.key == placement), {})
        for name in HEADLINES:
            if (std := row[f"{name}_std"]) is not None:
                relative = np.nan_to_num(headlines[name].model_relative_std) if name in headlines else 0.0
                row[f"{name}_total_std"] = math.hypot(std, relative * row[name])
        return ContactModel(
            numbers=quantities(row.get, _MODELLED),
            layer_flag=row["layer_flag"],
            range_notes=(row["range_notes"] or "").split(),
            verdicts={name: one.verdict for name, one in headlines.items()},
        )

    def pooling(self, measured: Measurement, model: ContactModel) -> ContactPooling | None:
        """Return whether a contact will be pooled; None of frames, for which other rules hold."""
        if isinstance(self.contact, ContactSequence):
            return None
        active = self.opened.corrections.active_correction(self.item)
        seen = reviewed(measured, active)
        excluding = excluding_flags(self.contact, seen, model.range_notes)
        return ContactPooling(
            pooled=is_pooled(seen, excluding),
            excluding_flags=sorted(excluding),
            correction=active.pooling if active else None,
        )
