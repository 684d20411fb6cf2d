"""What each term of the uncertainty of a photographed face is worth: errors and coverage with it and without.

The arcs of independent shapes are found once; then each face is fitted from its arc again with one term
switched off. Finding the arcs takes most of the time.
"""

import math
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from typing import Any, TypeAlias
from unittest import mock

import numpy as np

from benchmarks.arrays import Array
from benchmarks.claims import anatomic_fingers, finger_shapes, outlines, photographs
from benchmarks.tables import percent, share, table
from benchmarks.truth.anatomic_fingers import fingers
from fingerpad.exceptions import FingerpadError
from fingerpad.image.ellipse_fit import fit_aligned_ellipse
from fingerpad.image.photograph import face_arc
from fingerpad.image.photograph.manual import _arc
from fingerpad.image.photograph.shape import ShapeAverage

Face: TypeAlias = tuple[str, Array, face_arc.FaceArc]

# Longest error that counts, so that one lost face does not decide a root mean square.
_MOST = 0.5


def faces(count: int, seed: int) -> Iterator[Face]:
    """Yield the family of each face, its true semi-axes and the arc of its outline."""
    for family in finger_shapes.FAMILIES:
        for _, truth, found in finger_shapes.measured(family, count, seed):
            if found is not None:
                yield family, np.asarray(truth.semi_axes), found._arc
    for finger in fingers(max(count // 3, 2), seed):
        for face, found in anatomic_fingers.measure(finger).items():
            yield "three-dimensional", np.asarray(finger.semi_axes[face]), found._arc
    for marked in (False, True):
        for number in range(12 * count):
            ellipse = photographs.random_finger(seed * 1000 + number, 60 if marked else 120)
            found = photographs.measure(ellipse, marked=marked)
            if found is not None:
                family = "ellipses, marked" if marked else "ellipses"
                yield family, np.asarray(ellipse.semi_axes), found._arc
    for place, kind in enumerate(outlines.KINDS):
        for number in range(4 * count):
            face = outlines.FACES[number % 3]
            points, semi_axes = outlines.draw(kind, face, np.random.default_rng([seed, place, number]))
            yield "outlines", semi_axes, _arc(face, points, fit_aligned_ellipse(points).ellipse)


# What takes a function's or a constant's place when a term is off.
WITHOUT: dict[str, dict[str, Any]] = {
    "all terms": {},
    "without the outline beyond the arc": {"extend_arc": lambda *given: given[2]},
    "without shape": {
        "_average_over_shapes": lambda _, fit: ShapeAverage(
            fit.ellipse, fit.covariance[2:4, 2:4], 0.0, math.nan, math.nan
        )
    },
    "without lengths": {"_contradicted": lambda *_: (np.zeros(2), 0.0)},
}


@contextmanager
def switched_off(term: str) -> Iterator[None]:
    """Fit faces without a term."""
    with mock.patch.multiple(face_arc, **WITHOUT[term]) if WITHOUT[term] else nullcontext():
        yield


def fitted_again(measured: list[Face]) -> dict[str, Array]:
    """Return (error, standard uncertainty) of both semi-axes of each face, by family."""
    rows: dict[str, list[Array]] = {}
    for family, truth, arc in measured:
        try:
            again = face_arc.face_from_arc(arc)
        except FingerpadError:
            continue
        off = again.semi_axes / truth - 1
        std = np.sqrt(np.diagonal(again.edge_covariance)) / again.semi_axes
        rows.setdefault(family, []).append(np.stack([off, std], axis=1))
    return {family: np.concatenate(some) for family, some in rows.items()}


def report(count: int = 4, first_seed: int = 75, seeds: int = 1) -> None:
    """Print errors with all terms, and without each."""
    measured = [face for seed in range(first_seed, first_seed + seeds) for face in faces(count, seed)]
    by_term = {}
    for term in WITHOUT:
        with switched_off(term):
            by_term[term] = fitted_again(measured)
    table(
        ("shapes", "n", *WITHOUT),
        (
            (family, len(some), *(_cell(rows[family]) for rows in by_term.values()))
            for family, some in by_term["all terms"].items()
        ),
        "Semi-axes: median error, rms error, held at 95 %",
    )


def _cell(rows: Array) -> str:
    size, stds = np.abs(rows).T
    rms = float(np.sqrt(np.mean(np.minimum(size, _MOST) ** 2)))
    return f"{percent(float(np.median(size)))}, {percent(rms)}, {share(size < 1.96 * stds)}"
