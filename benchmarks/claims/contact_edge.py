"""Pooled results of several images of one device, which share the place of the contact's edge."""

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import NamedTuple

import numpy as np

from benchmarks.arrays import Array
from benchmarks.simulated import contact, finger, study_of
from benchmarks.tables import share, table
from benchmarks.truth import image_sets
from benchmarks.truth.true_image import TrueImage
from fingerpad.contact import equivalent_radius_from_indentation
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.image import ContactImageResult, measure_contact_image
from fingerpad.study.results.pooling import pool_contacts
from fingerpad.study.results.rows import Rows
from fingerpad.uncertainty import pool

ELLIPSE = np.array([7.4, 5.0])
WEDGE_DEG = 30.0
AXES = np.array([7.9, 13.8, 11.8])
STUDY, EXACT = study_of({"f": None}, AXES), finger("f", AXES)
_MEAN = Placement(Ellipsoid(*AXES), wedge_angle=np.radians(WEDGE_DEG)).curvature.mean_curvature_radius
TRUE_RADIUS = float(equivalent_radius_from_indentation(_MEAN, ELLIPSE[1] / ELLIPSE[0]))


class Measured(NamedTuple):
    """An independent image, and what was measured in it."""

    truth: TrueImage
    found: ContactImageResult


def sets_of_one_device(count: int, size: int, seed: int) -> Iterator[list[Measured]]:
    """Yield sets of so many images of one condition, of ``count`` of each."""
    images = image_sets.images(count, seed, ("independent images",))
    for _, same in groupby(images, key=lambda one: one[1]):
        some = [Measured(truth, measure_contact_image(truth.pixels, truth.mm_per_px)) for *_, truth in same]
        for start in range(0, count - size + 1, size):
            yield some[start : start + size]


def pooled_area_score(some: Sequence[Measured], *, shared: bool) -> float:
    """Return the error of the mean of relative gross areas over its stated standard uncertainty."""
    true = np.array([one.truth.gross_area for one in some])
    found = np.array([one.found.gross_area for one in some])
    total = np.array([one.found.gross_area_std for one in some])
    edge = np.array([one.found.edge_effect[2] for one in some]) * shared
    pooled = pool(found / true, np.sqrt(total**2 - edge**2) / true, np.outer(edge / true, edge / true))
    return (pooled.value - 1) / pooled.total_std


def pooled_radius_score(some: Sequence[Measured], *, shared: bool) -> float:
    """Return the error of the pooled corrected radius over its stated standard uncertainty.

    Each image's errors of the semi-axes are those of contacts with one true ellipse, on an exact pad.
    """
    seen = []
    for k, one in enumerate(some):
        found, edge_std = one.found.ellipse, one.found.edge_offset_std if shared else 0.0
        errors = np.array([float(found.semi_major), float(found.semi_minor)]) - one.truth.semi_axes
        axes, covariance = ELLIPSE + errors, one.found.covariance[:2, :2]
        seen.append(contact(f"c{k}", 1.0, axes, covariance, wedge_deg=WEDGE_DEG, edge_offset_mm_std=edge_std))
    rows = Rows(STUDY, {"f": EXACT}, seen)
    (summary,) = pool_contacts(rows)
    assert summary.corrected_radius is not None  # nothing fails
    pooled = summary.corrected_radius
    return (pooled.value - TRUE_RADIUS) / pooled.total_std


def scores_of(sets: Sequence[Sequence[Measured]], *, shared: bool) -> Array:
    """Return errors over stated standard uncertainties of area and radius, shape (sets, 2)."""
    scores = pooled_area_score, pooled_radius_score
    return np.array([[score(some, shared=shared) for score in scores] for some in sets])


def report(count: int = 6, size: int = 6, seed: int = 7) -> None:
    """Print how many 95 % intervals of pooled results hold, with the edge as noise and as shared."""
    sets = list(sets_of_one_device(count, size, seed))
    rows = []
    for words, shared in (("noise of each image", False), ("shared by all", True)):
        scores = scores_of(sets, shared=shared)
        rms = np.sqrt(np.mean(scores**2, axis=0))
        cells = [f"{share(np.abs(z) < 1.96)}, {r:.2f}" for z, r in zip(scores.T, rms, strict=True)]
        rows.append((words, len(sets), *cells))
    head = "place of the edge", "sets", "mean area: held, error over uncertainty", "pooled radius: the same"
    table(head, rows, f"Sets of {size} images of one device, {len(sets) // (count // size)} conditions")
