"""One contact: from its picture, or the ellipse given, to a measurement, and whether that counts.

Pictures that two persons outlined, the second without seeing what the first drew, tell how these agree.
"""

import hashlib
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Final

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad._files import file_stem, make_folder
from fingerpad._records import fields_from, from_record
from fingerpad.flags import FLAGS
from fingerpad.image import ContactImageResult, write_overlay
from fingerpad.image.read import levels_of
from fingerpad.study.corrections import apply
from fingerpad.study.corrections.changes import ContactCorrection
from fingerpad.study.corrections.log import ActiveCorrection, is_rejected
from fingerpad.study.engine.runner import Perform
from fingerpad.study.engine.task import Record, Task, Work, in_study
from fingerpad.study.manifest.models import Contact, ContactEllipse, Direction, Observation, ScaleKey
from fingerpad.study.measuring.context import FoundScale, OneTaskItem, RunContext, require_scale


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Measurement:
    """What was seen of one contact, from image to table; fields that are columns are named as these."""

    observation: str = ""
    load_N: float = np.nan  # noqa: N815 (the unit's own letter)
    reason: str | None = None
    semi_major_mm: float = np.nan
    semi_minor_mm: float = np.nan
    # Of the semi-axes: noise, edge and scale.
    covariance_mm2: FloatArray = field(default_factory=lambda: np.full((2, 2), np.nan))
    # By which both semi-axes are displaced alike, of all images of one scale; 0 without an image.
    edge_offset_mm_std: float = 0.0
    long_axis: Direction | None = None
    orientation_deg: float = np.nan
    gross_area_mm2: float = np.nan
    gross_area_mm2_std: float = np.nan
    gross_area_mm2_noise_std: float = np.nan
    gross_area_mm2_edge_std: float = np.nan
    ridge_area_mm2: float = np.nan
    ridge_area_mm2_std: float = np.nan
    ridge_border_mm: float = np.nan
    ridge_period_mm: float = np.nan
    ellipse_iou: float = np.nan
    centroid_row_px: float = np.nan
    centroid_column_px: float = np.nan
    scale: str | None = None
    relative_scale_std: float = 0.0  # which the covariance contains
    mm_per_px: float = np.nan
    mm_per_px_std: float = np.nan
    automatic_semi_major_mm: float = np.nan
    automatic_semi_minor_mm: float = np.nan
    flags: tuple[str, ...] = ()
    overlay: str | None = None
    measured_by: str | None = None
    reviewed: str | None = None
    reviewed_by: str | None = None
    counts: bool = True  # its flags apart: not every frame of a press may be pooled
    rejected: str | None = None  # why a person does not want it: no failure, and never counts
    pooling: bool | None = None  # as corrected manually, whatever its flags
    pooling_corrected_by: str | None = None
    pooling_reason: str | None = None
    sequence: str | None = None
    frame: int | None = None
    time_s: float = np.nan
    phase: str | None = None
    phase_corrected_by: str | None = None
    measured_indentation_mm: float = np.nan


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ObservationItem(OneTaskItem[Observation]):
    """One contact at one load."""

    def work(self) -> Work:
        """Return what measures it."""
        return partial(
            measure_observation, self.table, self.scale, correction=apply.contact_correction(self.correction)
        )

    def result(self) -> Measurement:
        """Return what was measured, as a person reviewed it."""
        # The load may have changed since it was measured; of the name one copy is enough.
        record = {**self.record, "observation": self.name, "load_N": self.table.load_N}
        return reviewed(from_record(Measurement, record), self.correction)


def repeated_pictures(context: RunContext) -> Iterator[tuple[list[Contact], bool]]:
    """Yield contacts that show one part of one picture or sequence, and whether they state one press.

    One that a person rejected says nothing of the others.
    """
    pictures: dict[tuple[str, str], list[Contact]] = {}
    given: list[Contact] = [*context.study.observations, *context.study.sequences]
    for one in given:
        if one.file is not None and not context.is_rejected(one.name):
            part = str((one.seed_px, one.region_of_interest_px, one.mask_px))
            pictures.setdefault((context.digest(context.folder / one.file), part), []).append(one)
    for same in pictures.values():
        if len(same) > 1:
            yield same, len({_press_of(one, context) for one in same}) == 1


def _press_of(one: Contact, context: RunContext) -> tuple[object, ...]:
    """Return what the manifest says of a press."""
    if isinstance(one, Observation):
        under: tuple[object, ...] = (one.load_N,)
    else:
        under = context.digest(context.folder / one.force), one.start_s, one.contact_load_N
    return one.finger, one.wedge_angle_deg, one.roll_angle_deg, *under


def measure_observation(
    observation: Observation,
    scale: FoundScale | str | None,
    folder: Path,
    out: Path,
    correction: ContactCorrection = apply.NOTHING,
) -> Measurement:
    """Measure one observation and write its overlay; the person's verdict is added by `reviewed`."""
    if observation.ellipse_mm is not None:
        return _given_ellipse(observation.ellipse_mm, None if scale is None else require_scale(scale))
    assert scale is not None  # the manifest's own rule
    found = require_scale(scale)
    picture = _picture(observation, found, folder)
    seen = picture.measured(correction)
    if seen.contact_image is None:
        assert seen.reason is not None  # one of the two
        return with_automatic_axes(Measurement(reason=in_study(seen.reason, folder)), seen)
    overlay = Path("overlays") / f"{file_stem(observation.name)}.png"
    make_folder((out / overlay).parent)
    write_overlay(
        out / overlay,
        picture.pixels,
        seen.contact_image,
        label="synthetic" if observation.synthetic else None,
    )
    measured = from_contact_image(seen.contact_image, observation, found)
    return replace(with_automatic_axes(measured, seen), overlay=str(overlay))


def _picture(observation: Observation, found: FoundScale, folder: Path) -> apply.ContactPicture:
    """Return the picture of an observation, which has one, with its colours where these count."""
    assert observation.file is not None  # as its task was made
    pixels = levels_of(folder / observation.file, colour=observation.surface == "smooth")
    return apply.ContactPicture(pixels, found.scale, observation, folder)


def with_automatic_axes(measured: Measurement, seen: apply.CorrectedContactImage) -> Measurement:
    """Return a measurement with the automatic semi-axes beside the corrected ones."""
    if seen.automatic is None:
        return measured
    return replace(
        measured,
        automatic_semi_major_mm=float(seen.automatic.ellipse.semi_major),
        automatic_semi_minor_mm=float(seen.automatic.ellipse.semi_minor),
    )


def reviewed(measured: Measurement, active_correction: ActiveCorrection | None) -> Measurement:
    """Return a measurement with its manual correction, and who made it."""
    if active_correction is None:
        return measured
    change = active_correction.change
    edits, rejected = change.edits, change.rejected
    verdict = "accepted" if change.accepted else "corrected" if edits else None
    if rejected is not None:
        verdict = "rejected"
    by = "manual" if "ellipse_px" in edits else "corrected"
    pooling = active_correction.pooling
    return replace(
        measured,
        reviewed=verdict,
        reviewed_by=active_correction.who if verdict else None,
        measured_by=by if edits else None,
        rejected=rejected,
        counts=measured.counts and rejected is None,
        pooling=pooling.include if pooling else None,
        pooling_corrected_by=pooling.who if pooling else None,
        pooling_reason=pooling.why if pooling else None,
    )


def from_contact_image(contact_image: ContactImageResult, contact: Contact, found: FoundScale) -> Measurement:
    """Return the measurement of a contact image."""
    turn = np.degrees(contact_image.orientation) - contact.finger_axis_deg
    orientation = float(90 - (90 - turn) % 180)
    row, column = contact_image.centroid
    return replace(
        Measurement(**fields_from(Measurement, contact_image.as_record())),
        covariance_mm2=contact_image.covariance[:2, :2],
        long_axis="along" if abs(orientation) <= 45 else "across",
        orientation_deg=orientation,
        centroid_row_px=row,
        centroid_column_px=column,
        scale=found.name,
        relative_scale_std=found.scale.relative_std,
        mm_per_px=found.scale.mm_per_px,
        mm_per_px_std=found.scale.mm_per_px_std,
        # Manual corrections have a column.
        flags=(*(flag for flag in contact_image.flags if flag != "edited_manually"), *found.flags),
    )


def _given_ellipse(ellipse: ContactEllipse, made_with: FoundScale | None) -> Measurement:
    """Return an ellipse measured elsewhere; both axes share the error of its scale."""
    axes = np.array([ellipse.semi_major, ellipse.semi_minor])
    relative = made_with.scale.relative_std if made_with else 0.0
    area = math.pi * ellipse.semi_major * ellipse.semi_minor
    noise = area * ellipse.std * math.hypot(1 / ellipse.semi_major, 1 / ellipse.semi_minor)
    return Measurement(
        semi_major_mm=ellipse.semi_major,
        semi_minor_mm=ellipse.semi_minor,
        covariance_mm2=ellipse.std**2 * np.eye(2) + relative**2 * np.outer(axes, axes),
        gross_area_mm2=area,
        gross_area_mm2_std=math.hypot(noise, 2 * relative * area),
        gross_area_mm2_noise_std=noise,
        gross_area_mm2_edge_std=0.0,
        long_axis=ellipse.long_axis,
        scale=made_with.name if made_with else None,
        relative_scale_std=relative,
    )


# The picture does not show all of a contact at a known scale, or its load is not known: nothing that a
# person says of its outline helps.
NEVER_POOLED: Final = frozenset(
    flag.code for flag in (*FLAGS["contact"].values(), *FLAGS["frame"].values()) if flag.excludes == "pooling"
)
# What was measured may be a part of the contact, or more than it: a person who has looked can tell.
POOLED_IF_REVIEWED: Final = frozenset(
    flag.code for flag in FLAGS["contact"].values() if flag.excludes == "pooling unless reviewed"
)
# The ridge area is an upper bound; area and ellipse of the contact are no less sure.
RIDGES_MERGE: Final = "ridges_merge"
# Which press it shows is not known, or it shows one that counts already.
REPEATED_PICTURE: Final = "repeated_picture"
# Range notes: with a pad of no finger's size, no radius is one; with a modulus of none, the load is doubtful.
IMPLAUSIBLE_SIZE: Final = "implausible_size"
_EXCLUDING_NOTES: Final = tuple(flag.code for flag in FLAGS["row"].values() if flag.excludes == "pooling")


def excluding_flags(contact: Contact, measured: Measurement, notes: Iterable[str] = ()) -> frozenset[str]:
    """Return the flags of a contact, and the range notes, that keep it out of pooled results."""
    excluding = NEVER_POOLED
    if measured.reviewed not in {"accepted", "corrected"}:
        chosen = any((contact.seed_px, contact.mask_px, contact.region_of_interest_px))
        excluding |= POOLED_IF_REVIEWED - ({"several_regions"} if chosen else set())
    return excluding.intersection(measured.flags).union(note for note in notes if note in _EXCLUDING_NOTES)


def is_pooled(measured: Measurement, excluding: frozenset[str]) -> bool:
    """Return whether a contact counts in pooled results: as corrected manually, or else by its flags."""
    if measured.reason is not None or measured.rejected is not None:
        return False
    return measured.counts and not excluding if measured.pooling is None else measured.pooling


# By which the measurements of two persons are compared.
QUANTITIES: Final = ("semi_major_mm", "semi_minor_mm", "gross_area_mm2", "ridge_area_mm2")


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatorPair:
    """A contact image measured under the outlines of two persons."""

    observation: str
    first_operator: str
    second_operator: str
    synthetic: bool
    # By the names of `QUANTITIES`, empty where a measurement failed.
    first: dict[str, float] = field(default_factory=dict)
    second: dict[str, float] = field(default_factory=dict)
    iou: float | None = None  # of the two regions
    reason: str | None = None

    def as_record(self) -> dict[str, object]:
        """Return it as a line of ``second_operator.csv``."""
        measured = {"first": self.first, "second": self.second}
        return {
            "observation": self.observation,
            "synthetic": self.synthetic,
            "first_operator": self.first_operator,
            "second_operator": self.second_operator,
            **{f"{who}_{name}": of.get(name) for who, of in measured.items() for name in QUANTITIES},
            "iou": self.iou,
            "reason": self.reason,
        }


def blind_order(names: Sequence[str]) -> list[str]:
    """Return names in a random order, the same everywhere, whose first few are a random sample."""
    return sorted(names, key=lambda name: hashlib.sha256(name.encode(errors="surrogatepass")).hexdigest())


def operator_pairs(context: RunContext, perform: Perform) -> list[OperatorPair]:
    """Return the images that two persons outlined, in the manifest's order; those not stored are measured.

    What either rejected is left out, and what the first has not looked at; so is a second look by the first.
    """
    outlined = list(_outlined(context))
    records = perform(
        Task(
            name=f"/second operator {observation.name}",  # no item's name begins like this
            item=observation.name,
            file=observation.file or "",
            key=context.key(observation, one.change.edits, other.change.edits),
            work=partial(_compare, observation, context.scale(scale), one, other),
            inputs=context.inputs_of(observation),
        )
        for observation, scale, one, other in outlined
    )
    return [
        OperatorPair(
            observation=observation.name,
            first_operator=one.who,
            second_operator=other.who,
            synthetic=observation.synthetic,
            **record,
        )
        for (observation, _, one, other), record in zip(outlined, records.values(), strict=True)
    ]


def _outlined(
    context: RunContext,
) -> Iterator[tuple[Observation, ScaleKey, ActiveCorrection, ActiveCorrection]]:
    """Yield contact images with their scale and what two persons made of them."""
    for observation in context.study.observations:
        name = observation.name
        one, other = context.active_corrections.get(name), context.second_operator.get(name)
        if observation.file is None or observation.scale is None or one is None or other is None:
            continue
        looked = (each.change.accepted or each.change.edits for each in (one, other))
        if one.who != other.who and all(looked) and not any(map(is_rejected, (one, other))):
            yield observation, observation.scale, one, other


def _compare(
    observation: Observation,
    scale: FoundScale | str,
    one: ActiveCorrection,
    other: ActiveCorrection,
    folder: Path,
    _out: Path,
) -> Record:
    picture = _picture(observation, require_scale(scale), folder)
    regions, record = [], Record()
    for name, active in {"first": one, "second": other}.items():
        seen = picture.measured(apply.contact_correction(active)).contact_image
        if seen is None:
            return {"reason": in_study(f"the {name} operator's correction leaves no contact", folder)}
        record[name] = dict(zip(QUANTITIES, seen.values.tolist(), strict=True))
        regions.append(seen.region)
    both, either = np.logical_and(*regions), np.logical_or(*regions)
    return record | {"iou": np.count_nonzero(both) / np.count_nonzero(either)}
