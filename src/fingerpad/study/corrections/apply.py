"""Measuring with manual corrections, and the automatic result beside it."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from fingerpad import image
from fingerpad._arrays import FloatArray
from fingerpad._files import content_stamp
from fingerpad.exceptions import ImageError
from fingerpad.image.read import levels_of
from fingerpad.image.sequence.measure import with_first_frame
from fingerpad.study.corrections.changes import (
    ContactCorrection,
    ManualContactEllipse,
    PhaseCorrection,
    PhotographCorrection,
    SequenceCorrection,
)
from fingerpad.study.corrections.log import ActiveCorrection, frames_of, phases_item
from fingerpad.study.manifest.models import CORRECTIONS, Contact, ContactSequence, Photograph


class InterpolatedCorrection(ContactCorrection):
    """The ellipse between two key frames, with the relative standard uncertainties of its semi-axes.

    The contact lies between those of the key frames, uniformly at most: half-way its semi-axes are known to
    1/√12 of their change, and nearer to a key frame better.
    """

    semi_axes_relative_std: tuple[float, float]

    def widened(self, contact_image: image.ContactImageResult) -> image.ContactImageResult:
        """Return a measurement under this ellipse, with what interpolation adds to its uncertainty."""
        major, minor = self.semi_axes_relative_std
        effect = contact_image.values * [major, minor, major + minor, major + minor]
        covariance = contact_image.noise_covariance + np.outer(effect, effect)
        return replace(
            contact_image, noise_covariance=covariance, flags=(*contact_image.flags, "interpolated")
        )


def frame_corrections(
    active_corrections: Mapping[str, ActiveCorrection], sequence: str, within: range | None = None
) -> dict[int, ActiveCorrection]:
    """Return the active corrections by frame; between key frames, all or those `within`, the carried ones."""
    frames = frames_of(active_corrections, sequence)
    found = dict(frames)
    for first, last in _key_frame_pairs(frames):
        one, other = (_ellipse(frames[frame]) for frame in (first, last))
        between = range(first + 1, last)
        if within is not None:
            between = range(max(between.start, within.start), min(between.stop, within.stop))
        for frame in between:
            if frame not in frames:
                found[frame] = replace(
                    frames[first],
                    item=f"{sequence}#{frame}",
                    change=_between(one, other, (frame - first) / (last - first)),
                    picture="",
                    pooling=None,
                )
    return found


def frame_edits(active_corrections: Mapping[str, ActiveCorrection], sequence: str) -> list[Any]:
    """Return all that the edits of `frame_corrections` depend on, as JSON."""
    frames = frames_of(active_corrections, sequence)
    edits = {frame: edits for frame, one in sorted(frames.items()) if (edits := one.change.edits)}
    pairs = _key_frame_pairs(frames)
    judged = sorted(
        frame for frame in frames.keys() - edits.keys() if any(first < frame < last for first, last in pairs)
    )
    return [edits, pairs, judged]


def _key_frame_pairs(frames: Mapping[int, ActiveCorrection]) -> list[tuple[int, int]]:
    changes = ((frame, one.change) for frame, one in frames.items())
    keys = (
        frame
        for frame, change in changes
        if isinstance(change, ContactCorrection) and change.key_frame and change.rejected is None
    )
    return list(pairwise(sorted(keys)))


def _ellipse(one: ActiveCorrection) -> image.ImageEllipse:
    assert isinstance(one.change, ContactCorrection)  # as a key frame
    assert one.change.manual_ellipse is not None  # the model's own rule
    return one.change.manual_ellipse


def _between(one: image.ImageEllipse, other: image.ImageEllipse, share: float) -> InterpolatedCorrection:
    ellipse = image.interpolated_ellipse(one, other, share)
    change: FloatArray = np.abs(np.subtract(other.semi_axes, one.semi_axes)) / ellipse.semi_axes
    major, minor = (change * math.sqrt(share * (1 - share) / 3)).tolist()
    return InterpolatedCorrection(
        ellipse_px=ManualContactEllipse(
            centre=list(ellipse.centre),
            semi_axes=list(ellipse.semi_axes),
            orientation_deg=math.degrees(ellipse.orientation),
        ),
        semi_axes_relative_std=(major, minor),
    )


NOTHING: Final = ContactCorrection()


def contact_correction(active_correction: ActiveCorrection | None) -> ContactCorrection:
    """Return what a person wants of a contact, an empty correction by default."""
    change = None if active_correction is None else active_correction.change
    return change if isinstance(change, ContactCorrection) else NOTHING


def photograph_correction(active_correction: ActiveCorrection | None) -> PhotographCorrection:
    """Return what a person wants of a photograph, an empty correction by default."""
    change = None if active_correction is None else active_correction.change
    return change if isinstance(change, PhotographCorrection) else PhotographCorrection()


class ManualPhases(NamedTuple):
    """Phases of a sequence that a person set."""

    correction: PhaseCorrection
    who: str
    when: str


def manual_phases(active_corrections: Mapping[str, ActiveCorrection], sequence: str) -> ManualPhases | None:
    """Return the phases of a sequence that a person set, None where no person did."""
    active = active_corrections.get(phases_item(sequence))
    if active is None or not isinstance(active.change, SequenceCorrection) or active.change.phases is None:
        return None
    return ManualPhases(active.change.phases, active.who, active.when)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CorrectedContactImage:
    """A contact as corrected, and as measured automatically."""

    contact_image: image.ContactImageResult | None  # the one that holds
    reason: str | None
    automatic: image.ContactImageResult | None


def contact_options(
    contact: Contact, folder: Path, correction: ContactCorrection = NOTHING
) -> image.ContactImageOptions:
    """Return how a contact's picture is measured, as the manifest and a person say."""
    wanted = {key: value for key in CORRECTIONS if (value := getattr(correction, key)) is not None}
    said = contact.model_copy(update=wanted)
    window, seed = said.region_of_interest_px, said.seed_px
    return {
        "background": _background(contact, folder),
        "seed": None if seed is None else (seed[0], seed[1]),
        "mask": said.mask_px,
        "region_of_interest": None if window is None else (window[0], window[1], window[2], window[3]),
        "dark_on_light": said.dark_on_light,
        "threshold": said.threshold,
        "surface": contact.surface,
    }


def measured_under(
    prepared: image.PreparedContactImage, correction: ContactCorrection
) -> image.ContactImageResult:
    """Measure a prepared contact image with what a person drew, or what was carried from key frames."""
    found = prepared.measure([stroke.edit for stroke in correction.strokes], correction.manual_ellipse)
    return correction.widened(found) if isinstance(correction, InterpolatedCorrection) else found


@dataclass(frozen=True, slots=True, eq=False)
class ContactPicture:
    """A picture of a contact, and how the manifest says that it is measured."""

    pixels: npt.ArrayLike
    scale: image.Scale
    contact: Contact
    folder: Path
    settings: image.ContactImageOptions | None = None  # by which all frames of a sequence are read

    def prepared(self, correction: ContactCorrection = NOTHING) -> image.PreparedContactImage:
        """Tell the ridges, as the manifest and a person say; a person's polarity goes before the settings.

        Strokes and ellipse of the correction are for `PreparedContactImage.measure`.
        """
        options, settings = contact_options(self.contact, self.folder, correction), self.settings
        if settings is not None:
            polarity = options["dark_on_light"]
            # Frames of a sequence share a relative level: the manifest's threshold has gone into learning it.
            options = {**options, **settings, "threshold": correction.threshold}
            if polarity is not None and polarity is not settings["dark_on_light"]:
                # Learnt the other way round, the contrast is of something else.
                options = {**options, "dark_on_light": polarity, "contrast": None}
        return image.prepare_contact_image(self.pixels, self.scale, **options)

    def measured(self, correction: ContactCorrection = NOTHING) -> CorrectedContactImage:
        """Measure the contact as a person wants it, and automatically."""
        automatic, plain, reason = None, None, None
        try:
            plain = self.prepared()
            automatic = plain.measure()
        except ImageError as error:
            reason = str(error)
        found = automatic
        if correction.edits:
            found = reason = None
            try:
                prepared = plain
                # Changes of these detect the ridges again; strokes and ellipse need only those before.
                if prepared is None or CORRECTIONS & correction.edits.keys():
                    prepared = self.prepared(correction)
                found = measured_under(prepared, correction)
            except ImageError as error:
                reason = str(error)
        return CorrectedContactImage(contact_image=found, reason=reason, automatic=automatic)


def corrected_photograph(
    pixels: npt.ArrayLike,
    photograph: Photograph,
    scale: image.Scale,
    correction: PhotographCorrection | None = None,
) -> image.PhotographFit:
    """Measure a photograph as a person wants it; with an ellipse placed manually it is not looked at."""
    wanted = correction or PhotographCorrection()
    tip = wanted.tip or photograph.tip
    # A tip that a person turned turns what the manifest says of the palmar side.
    palmar = wanted.palmar_side or (photograph.palmar_side if wanted.tip is None else None)
    if wanted.ellipse_px is not None:
        (row, column), (across, along) = wanted.ellipse_px.centre, wanted.ellipse_px.semi_axes
        return image.photograph_from_ellipse(
            photograph.face,
            scale,
            centre=(row, column),
            semi_axes=(across, along),
            tilt=float(np.radians(wanted.ellipse_px.tilt_deg)),
            tip=tip,
            palmar=palmar,
        )
    window = wanted.region_of_interest_px or photograph.region_of_interest_px
    found = image.measure_photograph(
        pixels,
        photograph.face,
        scale,
        tip=tip,
        palmar=palmar,
        region_of_interest=None if window is None else (window[0], window[1], window[2], window[3]),
    )
    erased = [(stroke.points_px, stroke.radius_px) for stroke in wanted.erased]
    return image.with_marked_points(replace(found, picture=None), added=wanted.added_points_px, erased=erased)


def _background(contact: Contact, folder: Path) -> npt.ArrayLike | None:
    """Return the picture of the empty view; of smooth contacts in a sequence its first frame."""
    smooth = contact.surface == "smooth"
    if contact.background is not None:
        path, read = folder / contact.background, _coloured if smooth else levels_of
    elif smooth and isinstance(contact, ContactSequence):
        path, read = folder / contact.file, _first_frame
    else:
        return None
    if not path.is_file():  # a folder of frames, or nothing
        return read(path)
    return _read_once(read, path, content_stamp(path))


@lru_cache(maxsize=1)
def _read_once(read: Callable[[Path], npt.ArrayLike], path: Path, _stamp: str) -> npt.ArrayLike:
    """Read the picture that all frames share, again only where its file has changed."""
    return read(path)


def _coloured(path: Path) -> npt.ArrayLike:
    return levels_of(path, colour=True)


def _first_frame(path: Path) -> Any:
    return with_first_frame(image.open_frames(path, colour=True), {"surface": "smooth"})["background"]
