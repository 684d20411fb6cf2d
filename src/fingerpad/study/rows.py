"""One row of results per contact: what was seen of it, and what the model says."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

import numpy as np
import numpy.typing as npt

from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.study.columns import COLUMNS
from fingerpad.study.fingers import FingerResult
from fingerpad.study.manifest import CORRECTIONS, Contact, Observation, Study
from fingerpad.study.measure import Measurement
from fingerpad.study.model import GEOMETRY, Modelled, pad_inputs
from fingerpad.uncertainty import PAD_OUTPUTS, PAD_SOURCES
from fingerpad.units import KPA_PER_MPA

Row: TypeAlias = dict[str, Any]

# Beyond these Hertz theory is out of its range; the report says so in words.
SMALL_CONTACT: Final = 0.3
SMALL_INDENTATION: Final = 0.1
SAME_SHAPE: Final = 0.1

# A contact that is cut, or whose scale is in doubt, is kept and shown but not pooled.
NOT_POOLED: Final = frozenset(("touches_border", "cut_by_mask", "scale_doubtful"))

RANGE_NOTES: Final = {
    "faces_disagree": "the finger's photographs disagree about its semi-axes (p < 0.01)",
    "implausible_size": "a semi-axis of the pad lies outside 2–40 mm: check the units",
    "implausible_modulus": "Young's modulus lies outside 1–5000 kPa: check load and scale",
    "deeper_than_pad": "the indentation exceeds the palmar semi-axis: check load, scale and units",
    "contact_not_small": f"the contact radius exceeds {SMALL_CONTACT:g} of the radius of curvature",
    "indentation_not_small": f"the indentation exceeds {SMALL_INDENTATION:.0%} of the pad's thickness",
    "aspect_ratio_disagrees": f"measured and predicted aspect ratio differ by more than {SAME_SHAPE:.0%}",
    "long_axis_disagrees": "the long axis lies across the direction that Hertz theory predicts",
}

_NO_ANSWER: Final = "the model has no finite answer for these values; check their units"
_OF_THE_CONTACT: Final = tuple(source for source in PAD_SOURCES if source not in GEOMETRY)
_IN_MM: Final = tuple(name for name in PAD_OUTPUTS if "radius" in name or name == "indentation")
_IN_KPA: Final = ("reduced_modulus", "youngs_modulus", "mean_pressure")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Rows:
    """All rows of a study, with what pooling needs.

    Attributes
    ----------
    rows : list of Row
        One per observation and frame, in the manifest's order.
    good : ndarray of int
        Places in `rows` of those that the model has an answer for.
    modelled : Modelled
        That answer, for the good rows.
    scales : list of str or None
        Names of the scales that good rows share with others.
    """

    rows: list[Row]
    good: npt.NDArray[np.intp]
    modelled: Modelled
    scales: list[str | None]


def make_rows(
    study: Study, fingers: Mapping[str, FingerResult], seen: Sequence[tuple[Contact, Measurement]]
) -> Rows:
    """Turn measurements into rows: placement, model and uncertainty.

    Parameters
    ----------
    study : Study
        The manifest.
    fingers : mapping
        Semi-axes by finger.
    seen : sequence of (Contact, Measurement)
        Each contact that was seen, with the table of the manifest that it belongs to.
    """
    reasons = [measured.reason or fingers[contact.finger].reason for contact, measured in seen]
    sound = np.array([place for place, reason in enumerate(reasons) if reason is None], dtype=np.intp)
    modelled = Modelled.of(
        (
            pad_inputs(study, contact, fingers[contact.finger], measured)
            for contact, measured in map(seen.__getitem__, sound)
        ),
        study.uncertainty.method,
    )
    answered = modelled.answered
    reasons = [
        _NO_ANSWER if reason is None and place in unanswered else reason
        for unanswered in [set(sound[~answered])]
        for place, reason in enumerate(reasons)
    ]
    rows = [
        _described(contact, fingers[contact.finger], measured, reason)
        for (contact, measured), reason in zip(seen, reasons, strict=True)
    ]
    good, modelled = sound[answered], modelled.only(answered)
    given_geometry = modelled.std_of("radius_from_indentation", _OF_THE_CONTACT)
    for place, index in enumerate(good):
        contact, measured = seen[index]
        rows[index] |= _modelled(
            contact,
            fingers[contact.finger],
            measured,
            value=dict(zip(PAD_OUTPUTS, modelled.value[place], strict=True)),
            std=dict(zip(PAD_OUTPUTS, modelled.std[place], strict=True)),
        )
        rows[index]["radius_from_indentation_mm_std_given_geometry"] = float(given_geometry[place])
    return Rows(
        rows=[{name: row.get(name) for name in COLUMNS} for row in rows],
        good=good,
        modelled=modelled,
        scales=[seen[index][1].scale for index in good],
    )


def _described(contact: Contact, finger: FingerResult, measured: Measurement, reason: str | None) -> Row:
    """Return the columns known before any model."""
    row: Row = {
        "observation": measured.name,
        "finger": contact.finger,
        "status": "measured" if reason is None else "failed",
        "reason": reason,
        "synthetic": contact.synthetic or finger.synthetic,
        "flags": " ".join(measured.flags),
        "measured_by": _measured_by(contact),
        "pooled": reason is None and measured.counts and NOT_POOLED.isdisjoint(measured.flags),
        "wedge_angle_deg": contact.wedge_angle_deg,
        "roll_angle_deg": contact.roll_angle_deg,
        "load_N": measured.load if np.isfinite(measured.load) else None,
        "image": contact.image if isinstance(contact, Observation) else contact.path,
        "overlay": measured.overlay,
        **measured.columns,
    }
    if measured.reason is None:
        row |= {
            "semi_major_mm": measured.semi_major,
            "semi_major_mm_std": np.sqrt(measured.covariance[0][0]),
            "semi_minor_mm": measured.semi_minor,
            "semi_minor_mm_std": np.sqrt(measured.covariance[1][1]),
            "aspect_ratio": measured.semi_major / measured.semi_minor,
            "long_axis": measured.long_axis,
        }
    return row


def _measured_by(contact: Contact) -> str:
    if isinstance(contact, Observation) and contact.ellipse_mm is not None:
        return "person"
    corrected = any(getattr(contact, key) is not None for key in CORRECTIONS)
    return "program with corrections" if corrected else "program"


def _modelled(
    contact: Contact,
    finger: FingerResult,
    measured: Measurement,
    *,
    value: Mapping[str, float],
    std: Mapping[str, float],
) -> Row:
    """Return the columns that follow from the model; `value` and `std` by the model's output."""
    placement = Placement.of(
        Ellipsoid.of(*finger.semi_axes),
        wedge_angle=np.radians(contact.wedge_angle_deg),
        roll_angle=np.radians(contact.roll_angle_deg),
    )
    row: Row = {
        "u_deg": np.degrees(placement.u),
        "v_deg": np.degrees(placement.v),
        "in_plane_radius_mm": placement.curvature.in_plane_radius,
        "transverse_radius_mm": placement.curvature.transverse_radius,
        "contact_size": value["contact_size"],
        "predicted_aspect_ratio": np.exp(abs(value["predicted_elongation"])),
        "predicted_long_axis": _side(value["predicted_elongation"]),
    }
    for names, unit, factor in ((_IN_MM, "mm", 1.0), (_IN_KPA, "kpa", KPA_PER_MPA)):
        for name in names:
            row[f"{name}_{unit}"], row[f"{name}_{unit}_std"] = factor * value[name], factor * std[name]
    if finger.pad_thickness is not None:
        row["indentation_over_thickness"] = value["indentation"] / finger.pad_thickness
    row["range_notes"] = " ".join(_range_notes(row, finger, measured))
    return {
        name: float(item) if isinstance(item, np.ndarray | np.floating) else item
        for name, item in row.items()
    }


def _side(elongation: float) -> str | None:
    return None if elongation == 0 else "along" if elongation > 0 else "across"


def _range_notes(row: Row, finger: FingerResult, measured: Measurement) -> Sequence[str]:
    notes = []
    if finger.outlines is not None and finger.outlines.p_value < 0.01:
        notes.append("faces_disagree")
    if not ((finger.semi_axes >= 2) & (finger.semi_axes <= 40)).all():
        notes.append("implausible_size")
    if not 1 <= row["youngs_modulus_kpa"] <= 5000:
        notes.append("implausible_modulus")
    if row["indentation_mm"] > finger.semi_axes[0]:
        notes.append("deeper_than_pad")
    if row["contact_size"] > SMALL_CONTACT:
        notes.append("contact_not_small")
    if row.get("indentation_over_thickness", 0) > SMALL_INDENTATION:
        notes.append("indentation_not_small")
    if measured.long_axis and row["predicted_long_axis"] not in {measured.long_axis, None}:
        notes.append("long_axis_disagrees")
    ratio = measured.semi_major / measured.semi_minor
    if abs(ratio / row["predicted_aspect_ratio"] - 1) > SAME_SHAPE:
        notes.append("aspect_ratio_disagrees")
    return notes
