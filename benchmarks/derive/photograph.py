"""What photographed fingers that are no ellipses add to the uncertainty of semi-axes and radii.

Shape and lengths: fingertips of known curvature, three-dimensional ones, ellipses with marks and without, and
outlines given as points, whose arcs are found once. Radii: side faces of known curvature, at four wedges.
"""

from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from functools import lru_cache
from types import ModuleType
from typing import Any, TypeAlias
from unittest.mock import patch

import numpy as np

from benchmarks.arrays import Array
from benchmarks.claims import anatomic_fingers, fingertips, outlines, photographs
from benchmarks.derive.fit import Compared, Problem
from benchmarks.truth.anatomic_fingers import fingers
from fingerpad.exceptions import FitError
from fingerpad.image import PhotographFit
from fingerpad.image.ellipse_fit import fit_aligned_ellipse
from fingerpad.image.photograph import result, shape
from fingerpad.image.photograph.arc import FaceArc
from fingerpad.image.photograph.calibration import DOUBT, LENGTHS, RADIUS
from fingerpad.image.photograph.manual import _arc

_WEDGES_DEG = (15.0, 30.0, 45.0, 60.0)
# Errors count no more than this, nor less where a radius is not seen.
_MOST, _UNSEEN = 0.5, 0.3

_fitted = lru_cache(maxsize=None)(result._fitted)
_shapes_averaged = lru_cache(maxsize=None)(shape.average_over_shapes)


# The arc of a face, and its true semi-axes, mm.
SeenFace: TypeAlias = tuple[FaceArc, Array]


def _arcs(count: int, seed: int) -> Iterator[SeenFace]:
    """Yield faces of all kinds of truth, each with the arc of its outline."""
    for _, truth, found in fingertips.measured(count, seed):
        if found is not None:
            yield found._arc, np.asarray(truth.semi_axes)
    for finger in fingers(max(count // 3, 2), seed):
        for face, found in anatomic_fingers.measure(finger).items():
            yield found._arc, np.asarray(finger.semi_axes[face])
    for marked in (False, True):
        for number in range(12 * count):
            ellipse = photographs.random_finger(seed * 1000 + number, 60 if marked else 120)
            found = photographs.measure(ellipse, marked=marked)
            if found is not None:
                yield found._arc, np.asarray(ellipse.semi_axes)
    for _, face, points, semi_axes in outlines.drawn(4 * count, seed):
        yield _arc(face, points, fit_aligned_ellipse(points).ellipse), semi_axes


@lru_cache(maxsize=2)
def faces(count: int, seed: int) -> tuple[SeenFace, ...]:
    """Return the faces whose arc determines an ellipse."""
    seen = []
    for arc, true in _arcs(count, seed):
        try:
            _fitted(arc)
            result.face_from_arc(arc)
        except FitError:
            continue
        seen.append((arc, true))
    return tuple(seen)


def _compared(seen: Sequence[SeenFace], name: str, model: Any, *modules: ModuleType) -> Compared:
    """Fit semi-axes from each arc with another model in place of the one that the modules call so."""
    with ExitStack() as stack:
        stack.enter_context(patch.object(result, "_fitted", _fitted))
        for module in modules:
            stack.enter_context(patch.object(module, name, model))
        found = [result.face_from_arc(arc) for arc, _ in seen]
    true = np.stack([semi_axes for _, semi_axes in seen])
    errors = np.stack([one.semi_axes for one in found]) / true - 1
    stds = np.sqrt([np.diagonal(one.edge_covariance) for one in found]) / true
    return Compared(errors.clip(-_MOST, _MOST).ravel(), stds.ravel())


def compare_shapes(model: Any, seen: Sequence[SeenFace]) -> Compared:
    """Average over ellipse and superellipse under other numbers."""
    return _compared(seen, "DOUBT", model, result, shape)


def compare_lengths(model: Any, seen: Sequence[SeenFace]) -> Compared:
    """Compare lengths with ellipses under other numbers; the average over shapes stays."""
    with patch.object(shape, "average_over_shapes", _shapes_averaged):
        return _compared(seen, "LENGTHS", model, result, shape)


# A side face, the angle of its normal, radians, and the true radius there, mm.
SeenRadius: TypeAlias = tuple[PhotographFit, float, float]


def radii(count: int, seed: int) -> list[SeenRadius]:
    """Return the places where wedges touch side faces."""
    return [
        (found, angle, truth.radius(angle))
        for _, truth, found in fingertips.measured(count, seed, ("radial",))
        if found is not None
        for angle in np.radians(_WEDGES_DEG).tolist()
    ]


def compare_radii(model: Any, seen: Sequence[SeenRadius]) -> Compared:
    """Fit radii under other numbers."""
    with patch.object(shape, "RADIUS", model):
        found = np.array([face.outline_radius(angle) for face, angle, _ in seen])
    errors, stds = (found / [[radius] for *_, radius in seen] - [1, 0]).T
    return Compared(np.nan_to_num(errors, nan=_UNSEEN).clip(-_MOST, _MOST), np.nan_to_num(stds, nan=_UNSEEN))


_OF_SEMI_AXES = "error of the semi-axes, as a share"
_FLAGGED, _SEEN = "choice: what is flagged", "choice: where the outline is looked at"
_LENGTHS = (
    "side_across_std", "side_along_std", "front_across_std", "front_along_std", "side_axis_std", "shaft",
    "hidden", "height_by_width", "of_tilt_std",
)  # fmt: skip
_OF_LENGTHS = {"no_ellipse": _FLAGGED, "window": _SEEN, "seen": _SEEN}
_OF_DOUBT = dict.fromkeys(("least_px", "far", "most_alike"), "choice: how points count") | {
    "significant": _FLAGGED,
    "least_significant": _FLAGGED,
    "edge_std": "rms of 56 axes of fingertips ray-traced in 14 skins, backdrops and lights: 0.42",
}
PROBLEMS = (
    Problem(
        RADIUS, "error of the radius, as a share", radii, compare_radii,
        places=("window",), stds=("missed_std", "axis_std"), kept=dict.fromkeys(("degree", "seen"), _SEEN),
    ),
    Problem(
        LENGTHS, _OF_SEMI_AXES, faces, compare_lengths, tuned=_LENGTHS, stds=("added",), kept=_OF_LENGTHS
    ),
    Problem(
        DOUBT, _OF_SEMI_AXES, faces, compare_shapes, kept=_OF_DOUBT, stds=("widening", "floor", "rough_std"),
        tuned=("exponent_std", "quadrant_std", "log_odds", "width_std"),
    ),
)  # fmt: skip
