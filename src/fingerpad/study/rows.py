"""One row of results per observation, with its columns, units and uncertainties."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.contact import youngs_modulus
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.study.fingers import FingerResult
from fingerpad.study.manifest import CORRECTIONS, Contact, Observation, Study
from fingerpad.study.measure import Measurement
from fingerpad.uncertainty import PAD_INPUTS, PAD_OUTPUTS, Propagated, pad_model, propagate
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

# Every column of results.csv, in order, with what it means.
COLUMNS: Final[Mapping[str, str]] = {
    "observation": "name of the observation, or of the sequence with the frame's number behind a #",
    "finger": "name of the finger",
    "status": "measured or failed",
    "reason": "why the row failed",
    "synthetic": "whether picture, ellipse or finger was rendered or simulated",
    "flags": "doubts about the picture, separated by spaces",
    "measured_by": "program, program with corrections, or person (an ellipse that was given)",
    "pooled": "whether the row counts in pooled radii: not if its picture is cut or its scale in doubt; "
    "of a sequence loading frames of a large enough ellipse",
    "range_notes": "where the model is out of its range, separated by spaces",
    "wedge_angle_deg": "angle of the wedge on which the finger rests",
    "roll_angle_deg": "roll of the finger about its own long axis",
    "load_N": "normal force W",
    "sequence": "name of the sequence of which this is a frame; empty for single observations",
    "frame": "number of the frame, from 0",
    "time_s": "time of the frame on the clock of its force",
    "phase": "loading, hold or unloading, by the force",
    "image": "contact image or sequence measured; empty where the ellipse was given",
    "scale": "name of the scale; rows of one name share one uncertain scale. Empty: a scale of its own",
    "mm_per_px": "scale of the picture",
    "mm_per_px_std": "its standard uncertainty",
    "semi_major_mm": "semi-major axis of the contact ellipse",
    "semi_major_mm_std": "its standard uncertainty",
    "semi_minor_mm": "semi-minor axis of the contact ellipse",
    "semi_minor_mm_std": "its standard uncertainty",
    "aspect_ratio": "semi-major over semi-minor axis",
    "long_axis": "along or across the finger",
    "predicted_aspect_ratio": "of elliptical Hertz theory for the undeformed pad",
    "predicted_long_axis": "along or across the finger, of elliptical Hertz theory",
    "orientation_deg": "long axis from the finger's axis, counter-clockwise",
    "gross_area_mm2": "area inside the outline of the contact",
    "gross_area_mm2_std": "its standard uncertainty",
    "ridge_area_mm2": "area of the ridges in contact",
    "ridge_area_mm2_std": "its standard uncertainty",
    "ridge_period_mm": "median distance between ridges",
    "ellipse_iou": "intersection over union of ellipse and contact region",
    "centroid_row_px": "row of the contact's centroid",
    "centroid_column_px": "column of the contact's centroid",
    "u_deg": "parametric angle u of the place of contact",
    "v_deg": "parametric angle v of the place of contact",
    "in_plane_radius_mm": "principal radius along the finger at the place of contact",
    "transverse_radius_mm": "principal radius across the finger at the place of contact",
    "mean_curvature_radius_mm": "R_0g = 1/H of the undeformed pad",
    "mean_curvature_radius_mm_std": "its standard uncertainty",
    "geometric_mean_radius_mm": "R_e = sqrt(R'R'') of the undeformed pad",
    "geometric_mean_radius_mm_std": "its standard uncertainty",
    "radius_from_indentation_mm": "corrected radius R_0g F2^-3, the source's R_g^corr",
    "radius_from_indentation_mm_std": "its standard uncertainty",
    "radius_from_indentation_mm_std_given_geometry": "the same with R_0g held exact, as the source does",
    "radius_from_area_mm": "equivalent sphere of the same area, R_0g F1^3",
    "radius_from_area_mm_std": "its standard uncertainty",
    "radius_from_compliance_mm": "equivalent sphere of A/(pi xi), R_0g F1^2/F2: the one to compare with R_g",
    "radius_from_compliance_mm_std": "its standard uncertainty",
    "geometric_radius_from_indentation_mm": "R_e F2^-3",
    "geometric_radius_from_indentation_mm_std": "its standard uncertainty",
    "geometric_radius_from_area_mm": "R_e F1^3",
    "geometric_radius_from_area_mm_std": "its standard uncertainty",
    "geometric_radius_from_compliance_mm": "R_e F1^2/F2",
    "geometric_radius_from_compliance_mm_std": "its standard uncertainty",
    "indentation_mm": "xi of elliptical Hertz theory from the observed ellipse",
    "indentation_mm_std": "its standard uncertainty",
    "reduced_modulus_kpa": "E* of elliptical Hertz theory from load and observed ellipse",
    "reduced_modulus_kpa_std": "its standard uncertainty",
    "youngs_modulus_kpa": "E = E*(1 - nu^2)",
    "youngs_modulus_kpa_std": "its standard uncertainty",
    "mean_pressure_kpa": "W over the area of the ellipse",
    "mean_pressure_kpa_std": "its standard uncertainty",
    "contact_size": "sqrt(l_d l_e)/R_e, which Hertz theory takes to be small",
    "indentation_over_thickness": "indentation over the pad's thickness, where that is given",
    "overlay": "picture of the measurement",
}

_NO_ANSWER: Final = "the model has no finite answer for these values; check their units"
# The first inputs of the model belong to the finger on its wedge: all its observations there share them.
_SHARED_INPUTS: Final = PAD_INPUTS.index("image_scale")
_AT_ONCE: Final = 1000
_IN_MM: Final = tuple(name for name in PAD_OUTPUTS if "radius" in name or name == "indentation")
_IN_KPA: Final = ("reduced_modulus", "mean_pressure")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Rows:
    """All rows of a study, with what pooling needs.

    Attributes
    ----------
    rows : list of Row
        One per observation and frame, in the manifest's order.
    good : list of int
        Places in `rows` of those that were measured.
    value : ndarray, shape (good, outputs)
        Model outputs of the good rows.
    shared : ndarray, shape (good, outputs, parts)
        What comes of the inputs that rows of one finger at one angle share, as independent parts: the
        product of two rows' parts is their shared covariance.
    own_std : ndarray, shape (good, outputs)
        Standard uncertainty from the inputs that they do not share.
    """

    rows: list[Row]
    good: list[int]
    value: FloatArray
    shared: FloatArray
    own_std: FloatArray


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
    # So many rows at a time that the model's derivatives, far larger than rows, stay small.
    parts = [_some_rows(study, fingers, seen[k : k + _AT_ONCE]) for k in range(0, len(seen), _AT_ONCE)]
    if not parts:
        parts = [_some_rows(study, fingers, [])]
    return Rows(
        rows=[row for part in parts for row in part.rows],
        good=[k * _AT_ONCE + index for k, part in enumerate(parts) for index in part.good],
        value=np.concatenate([part.value for part in parts]),
        shared=np.concatenate([part.shared for part in parts]),
        own_std=np.concatenate([part.own_std for part in parts]),
    )


def _some_rows(
    study: Study, fingers: Mapping[str, FingerResult], seen: Sequence[tuple[Contact, Measurement]]
) -> Rows:
    rows, good, means, covariances = [], [], [], []
    for index, (contact, measured) in enumerate(seen):
        finger = fingers[contact.finger]
        reason = measured.reason or finger.reason
        rows.append(_described(contact, finger, measured, reason))
        if reason is None:
            mean, covariance = pad_inputs(study, contact, finger, measured)
            good.append(index)
            means.append(mean)
            covariances.append(covariance)
    size = len(PAD_INPUTS)
    mean, covariance = np.reshape(means, (-1, size)), np.reshape(covariances, (-1, size, size))
    propagated = propagate(pad_model, mean, covariance)
    shared, own_std = _parted(propagated, covariance)
    finite = np.isfinite(propagated.covariance.sum(axis=(-2, -1)))
    for place, index in enumerate(good):
        contact, measured = seen[index]
        if not finite[place]:
            rows[index] |= {"status": "failed", "reason": _NO_ANSWER, "pooled": False}
            continue
        rows[index] |= _modelled(
            contact,
            fingers[contact.finger],
            measured,
            value=dict(zip(PAD_OUTPUTS, propagated.value[place], strict=True)),
            std=dict(zip(PAD_OUTPUTS, propagated.std[place], strict=True)),
            own_std=dict(zip(PAD_OUTPUTS, own_std[place], strict=True)),
            poisson_ratio=study.poisson_ratio,
        )
    return Rows(
        rows=[{name: row.get(name) for name in COLUMNS} for row in rows],
        good=[index for index, kept in zip(good, finite, strict=True) if kept],
        value=propagated.value[finite],
        shared=shared[finite],
        own_std=own_std[finite],
    )


def _parted(propagated: Propagated, covariance: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the parts of the uncertainty that rows share, and the standard uncertainty of the rest."""
    mine, theirs = slice(_SHARED_INPUTS, None), slice(_SHARED_INPUTS)
    with np.errstate(all="ignore"):
        size, direction = np.linalg.eigh(covariance[:, theirs, theirs])
        factor = direction * np.sqrt(np.maximum(size, 0))[:, None, :]
        shared = np.concatenate(
            [propagated.jacobian[..., theirs] @ factor, propagated.second_order[..., theirs]], axis=-1
        )
        own = propagated.jacobian[..., mine] @ covariance[:, mine, mine]
        variance = (own * propagated.jacobian[..., mine]).sum(axis=-1)
        variance += np.square(propagated.second_order[..., mine]).sum(axis=-1)
        return shared, np.sqrt(variance)


def pad_inputs(
    study: Study, contact: Contact, finger: FingerResult, measured: Measurement
) -> tuple[FloatArray, FloatArray]:
    """Return mean and covariance of the model's inputs for one contact."""
    angles = np.radians([contact.wedge_angle_deg, contact.roll_angle_deg])
    major, minor = measured.semi_major, measured.semi_minor
    size = np.sqrt(major * minor)
    mean = np.array(
        [
            *finger.semi_axes,
            *angles,
            study.poisson_ratio,
            1.0,
            measured.load,
            size,
            np.log(major / minor),
        ]
    )
    covariance = np.zeros((len(PAD_INPUTS), len(PAD_INPUTS)))
    covariance[:3, :3] = finger.covariance
    covariance[3, 3] = np.radians(study.uncertainty.wedge_angle_std_deg) ** 2
    covariance[4, 4] = np.radians(study.uncertainty.roll_angle_std_deg) ** 2
    covariance[7, 7] = (study.uncertainty.load_relative_std * measured.load) ** 2
    to_size_and_elongation = np.array([[0.5 * size / major, 0.5 * size / minor], [1 / major, -1 / minor]])
    covariance[8:, 8:] = to_size_and_elongation @ measured.covariance @ to_size_and_elongation.T
    return mean, covariance


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
    own_std: Mapping[str, float],
    poisson_ratio: float,
) -> Row:
    """Return the columns that follow from the model; `value` and the others by the model's output."""
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
    for suffix in ("", "_std"):
        reduced = row[f"reduced_modulus_kpa{suffix}"]
        row[f"youngs_modulus_kpa{suffix}"] = youngs_modulus(reduced, poisson_ratio)
    row["radius_from_indentation_mm_std_given_geometry"] = own_std["radius_from_indentation"]
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
