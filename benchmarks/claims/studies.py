"""Coverage of corrected and pooled radii in simulated studies."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.contact import equivalent_radius_from_indentation, size_factor
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.study.manifest import Observation, Study
from fingerpad.study.measuring.contacts import Measurement
from fingerpad.study.measuring.fingers import FingerResult
from fingerpad.study.results.pooling import pool_contacts
from fingerpad.study.results.rows import model_contacts

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
    study = Study.model_validate(
        {
            "title": "simulated",
            "fingers": [{"name": "f", **_given(axes)}],
            "uncertainty": {"wedge_angle_deg_std": WEDGE_STD, "load_relative_std": LOAD_STD},
        }
    )
    finger = FingerResult(
        name="f",
        semi_axes=axes + rng.normal(0, AXES_STD, 3),
        covariance=AXES_STD**2 * np.eye(3),
        source="given",
    )
    seen = list(_contacts(rng, wedge, elongation))
    rows = model_contacts(study, {"f": finger}, seen)
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


def _given(axes: FloatArray) -> dict[str, dict[str, float]]:
    names = ("palmar", "distal", "radial_ulnar")
    return {
        "semi_axes_mm": dict(zip(names, map(float, axes), strict=True)),
        "semi_axes_mm_std": dict.fromkeys(names, AXES_STD),
    }


def _size(load: float) -> float:
    return float(5.0 * load**0.3)


def _modulus(radius: FloatArray, elongation: float) -> float:
    """Return E*, kPa, of the row under 2 N, from the true contact."""
    shape = float(size_factor(np.exp(-elongation)) ** 3)
    return 1000 * 0.75 * LOADS[3] * float(radius) * shape / _size(LOADS[3]) ** 3


def _contacts(
    rng: np.random.Generator, wedge: float, elongation: float
) -> Iterator[tuple[Observation, Measurement]]:
    scale = 1 + rng.normal(0, SCALE_STD)
    for number, load in enumerate(LOADS):
        true = _size(load) * np.exp([0.5 * elongation, -0.5 * elongation])
        major, minor = sorted(scale * (true + rng.normal(0, EDGE_STD, 2)), reverse=True)
        observation = Observation(
            name=f"c{number}", finger="f", wedge_angle_deg=wedge, load_N=load, file="x.png", scale="s"
        )
        yield (
            observation,
            Measurement(
                observation=observation.name,
                load_N=load * (1 + rng.normal(0, LOAD_STD)),
                semi_major_mm=major,
                semi_minor_mm=minor,
                covariance_mm2=EDGE_STD**2 * np.eye(2)
                + SCALE_STD**2 * np.outer([major, minor], [major, minor]),
                scale="s",
                relative_scale_std=SCALE_STD,
            ),
        )


def study_coverage(repeats: int = 1000, first_seed: int = 0) -> dict[str, tuple[float, float]]:
    """Print and return coverage and bias (in stated uncertainties) of radii and modulus."""
    scores = [simulated_study(first_seed + k) for k in range(repeats)]
    print(f"\nSimulated studies of five loads, {repeats}: asked 93-97 %, bias below 0.2 of the uncertainty")
    found = {}
    for name in ("corrected", "modulus", "pooled"):
        off = np.array([getattr(one, name) for one in scores])
        found[name] = float(np.mean(np.abs(off) < 1.96)), float(off.mean())
    found["random"] = float(np.mean([one.random for one in scores])), 0.0
    words = {
        "corrected": "corrected radius of one contact",
        "modulus": "E* of one contact",
        "pooled": "pooled radius, inverse variance",
        "random": "pooled radius, random effects",
    }
    for name, (held, bias) in found.items():
        print(f"    {words[name]:<34} {100 * held:5.1f} %   bias {bias:+.2f}")
    return found


def report() -> None:
    """Print coverage and bias."""
    study_coverage()
