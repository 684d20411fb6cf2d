"""Photographs of three-dimensional fingertips of known curvature, from three sides."""

import math
from collections import defaultdict
from typing import Final

import numpy as np

from benchmarks.arrays import Array
from benchmarks.claims.fingertips import SIDES
from benchmarks.tables import Row, errors_table, or_none, rows_of
from benchmarks.truth.anatomic_fingers import FACES, WEDGES_DEG, AnatomicFinger, fingers
from fingerpad.image import Face, PhotographFit, Scale, combine_faces, measure_photograph
from fingerpad.image.photograph.faces import SEMI_AXES
from fingerpad.study.measuring.fingers import ELLIPSOID_STD, radius_deviation
from fingerpad.uncertainty import Inputs, placement_model, propagate

TITLES: Final = ("Radius along the finger, faces combined", "Mean radius of curvature, 1/H, faces combined")


def measure(truth: AnatomicFinger) -> dict[Face, PhotographFit]:
    """Return the measurements of a finger's photographs, without those that are refused."""
    found = {
        face: or_none(measure_photograph, pixels, face, Scale(truth.mm_per_px), palmar=SIDES[face])
        for face, pixels in truth.photographs.items()
    }
    return {face: fit for face, fit in found.items() if fit is not None}


def joint_radii(found: dict[Face, PhotographFit]) -> Array:
    """Return the radius along the finger and 1/H on each wedge, each with its standard uncertainty."""
    joint = combine_faces(fit.face_semi_axes for fit in found.values())
    axes = dict(zip(SEMI_AXES, joint.semi_axes.tolist(), strict=True))
    rows = []
    for wedge in np.radians(WEDGES_DEG):
        inputs = Inputs.of(**axes, wedge_angle=wedge, roll_angle=0.0)
        outputs = propagate(placement_model, inputs.with_covariance(list(SEMI_AXES), joint.covariance))
        along, across = outputs["in_plane_radius"], outputs["transverse_radius"]
        seen = found["radial"].outline_radius(wedge) if "radial" in found else (math.nan, math.nan)
        moved, std = radius_deviation(float(along.value), float(along.std), *seen)
        radius, share = along.value * math.exp(moved), 1 / (1 + along.value * math.exp(moved) / across.value)
        whole = outputs["mean_curvature_radius"]
        mean = 2 / (1 / radius + 1 / across.value)
        more = math.hypot(share * std, (1 - share) * ELLIPSOID_STD)
        stds = math.hypot(std, along.std / along.value), math.hypot(more, whole.std / whole.value)
        rows.append([(radius, radius * stds[0]), (mean, mean * stds[1])])
    return np.array(rows, dtype=np.float64)


def report(count: int = 4, seed: int = 75) -> None:
    """Print errors, stated uncertainties and coverage of semi-axes and radii."""
    tables: dict[str, dict[str, list[Row]]] = defaultdict(lambda: defaultdict(list))
    refused = 0
    for truth in fingers(count, seed):
        found = measure(truth)
        refused += len(FACES) - len(found)
        for face, fit in found.items():
            tables["Semi-axes"][truth.name] += rows_of(
                fit.semi_axes, truth.semi_axes[face], fit.covariance, fit.flags
            )
        if "radial" in found:
            rows = tables["Radius along the finger, by the outline alone"][truth.name]
            for wedge, true in zip(WEDGES_DEG, truth.radii[:, 0], strict=True):
                value, one = found["radial"].outline_radius(math.radians(wedge))
                if math.isfinite(value):
                    rows.append((value / true - 1, one / value, False))
        if (radii := or_none(joint_radii, found)) is None:
            continue
        flagged = any(fit.flags for fit in found.values())
        for place, title in enumerate(TITLES):
            rows = tables[title][truth.name]
            for (value, one), true in zip(radii[:, place], truth.radii[:, 2 * place], strict=True):
                rows.append((value / true - 1, one / value, flagged))
    for title, of_kind in tables.items():
        errors_table(f"{title}; {refused} photographs refused", of_kind, "kind")
