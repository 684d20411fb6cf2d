"""Coverage of corrected and pooled radii in simulated studies."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from benchmarks.arrays import Array, Rng
from benchmarks.simulated import contact, finger, study_of
from benchmarks.tables import table
from fingerpad.contact import equivalent_radius_from_indentation, size_factor
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.study.manifest.models import Observation
from fingerpad.study.measuring.contacts import Measurement
from fingerpad.study.results.pooling import pool_contacts
from fingerpad.study.results.rows import Rows

LOADS = (0.25, 0.5, 1.0, 2.0, 4.0)
AXES_STD, WEDGE_STD, LOAD_STD, SCALE_STD, EDGE_STD = 0.1, 0.5, 0.02, 0.01, 0.05


class Scores(NamedTuple):
    """Errors over stated standard uncertainties of one simulated study."""

    corrected: float
    modulus: float
    pooled: float
    random: bool


def simulated_study(seed: int) -> Scores:
    """Measure a pad of known truth with errors of every input, and compare what the study says of it."""
    rng = np.random.default_rng([seed, 5])
    wedge, axes = rng.uniform(15, 60), rng.uniform([6, 11, 9], [9, 16, 13])
    elongation = rng.uniform(0.02, 0.5)
    true_wedge = np.radians(wedge + rng.normal(0, WEDGE_STD))
    curvature = Placement(Ellipsoid(*axes), wedge_angle=true_wedge).curvature
    truth = float(equivalent_radius_from_indentation(curvature.mean_curvature_radius, np.exp(-elongation)))
    study = study_of({"f": None}, axes, AXES_STD, wedge_angle_deg_std=WEDGE_STD, load_relative_std=LOAD_STD)
    seen_axes = axes + rng.normal(0, AXES_STD, 3)
    seen = list(_contacts(rng, wedge, elongation))
    rows = Rows(study, {"f": finger("f", seen_axes, AXES_STD)}, seen)
    (summary,) = pool_contacts(rows)
    pooled = summary.corrected_radius
    assert pooled is not None  # nothing simulated is doubtful
    row = rows.table.iloc[3]
    low, high = pooled.random.interval
    true_modulus = _modulus(curvature.geometric_mean_radius, elongation)
    return Scores(
        corrected=(row["radius_from_indentation_mm"] - truth) / row["radius_from_indentation_mm_std"],
        modulus=(row["reduced_modulus_kpa"] - true_modulus) / row["reduced_modulus_kpa_std"],
        pooled=(pooled.fixed.value - truth) / pooled.fixed.total_std,
        random=low <= truth <= high,
    )


def _size(load: float) -> float:
    return float(5.0 * load**0.3)


def _modulus(radius: Array, elongation: float) -> float:
    """Return E*, kPa, of the row under 2 N, from the true contact."""
    shape = float(size_factor(np.exp(-elongation)) ** 3)
    return 1000 * 0.75 * LOADS[3] * float(radius) * shape / _size(LOADS[3]) ** 3


def _contacts(rng: Rng, wedge: float, elongation: float) -> Iterator[tuple[Observation, Measurement]]:
    scale = 1 + rng.normal(0, SCALE_STD)
    for number, load in enumerate(LOADS):
        true = _size(load) * np.exp([0.5 * elongation, -0.5 * elongation])
        axes = scale * (true + rng.normal(0, EDGE_STD, 2))
        yield contact(
            f"c{number}",
            load,
            axes,
            EDGE_STD**2 * np.eye(2),
            measured_load=load * (1 + rng.normal(0, LOAD_STD)),
            wedge_deg=wedge,
            relative_scale_std=SCALE_STD,
        )


def study_coverage(repeats: int, first_seed: int) -> dict[str, tuple[float, float]]:
    """Return coverage and bias (in stated uncertainties) of radii and modulus."""
    *scores, random = np.array([simulated_study(first_seed + k) for k in range(repeats)], dtype=float).T
    words = "corrected radius of one contact", "E* of one contact", "pooled radius, inverse variance"
    found = {
        name: (float(np.mean(np.abs(off) < 1.96)), off.mean())
        for name, off in zip(words, scores, strict=True)
    }
    return found | {"pooled radius, random effects": (random.mean(), 0.0)}


def report(repeats: int = 400, first_seed: int = 0) -> None:
    """Print coverage and bias."""
    table(
        ("quantity", "held by the 95 % interval", "bias, in stated uncertainties"),
        (
            (name, f"{100 * held:.1f} %", f"{bias:+.2f}")
            for name, (held, bias) in study_coverage(repeats, first_seed).items()
        ),
        f"{repeats:,} simulated studies of one pad under five loads",
    )
