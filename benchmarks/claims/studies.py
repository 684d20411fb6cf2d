"""Coverage of corrected and pooled radii in simulated studies of pads that follow Hertz theory."""

import numpy as np

from benchmarks.claims.validity import Truth, measured
from benchmarks.tables import table
from benchmarks.truth.hertz import hertz_ellipse
from fingerpad.study.results.pooling import pool_contacts

TRUTH = Truth(loads=(0.0625, 0.125, 0.25, 0.5, 1.0))


def simulated_study(seed: int) -> tuple[float, float, float, bool]:
    """Return errors over their stated uncertainties, and whether the mean of random effects holds the truth.

    The errors are those of the corrected radius and E* of one contact, and of the pooled corrected radius.
    """
    *_, rows, (along, across) = measured(TRUTH, np.random.default_rng([seed, 5]))
    ratio = max(along, across) / min(along, across)
    radius = 2 / (1 / along + 1 / across) / hertz_ellipse(ratio)[2] ** 3
    (summary,) = pool_contacts(rows)
    pooled = summary.corrected_radius
    assert pooled is not None  # nothing simulated is doubtful
    row = rows.table.iloc[3]
    low, high = pooled.interval
    return (
        (row["radius_from_indentation_mm"] - radius) / row["radius_from_indentation_mm_std"],
        (row["reduced_modulus_kpa"] - 1000 * TRUTH.modulus) / row["reduced_modulus_kpa_std"],
        (pooled.fixed.value - radius) / pooled.fixed.total_std,
        low <= radius <= high,
    )


def study_coverage(repeats: int, first_seed: int) -> dict[str, tuple[float, float]]:
    """Return coverage and bias (in stated uncertainties) of radii and modulus."""
    *scores, random = np.array([simulated_study(first_seed + k) for k in range(repeats)], dtype=float).T
    words = "corrected radius of one contact", "E* of one contact", "pooled radius, inverse variance"
    shares = ((float(np.mean(np.abs(off) < 1.96)), off.mean()) for off in scores)
    return dict(zip(words, shares, strict=True)) | {"pooled radius, random effects": (random.mean(), 0.0)}


def report(repeats: int = 400, first_seed: int = 0) -> None:
    """Print coverage and bias."""
    found = study_coverage(repeats, first_seed)
    rows = ((name, f"{100 * held:.1f} %", f"{bias:+.2f}") for name, (held, bias) in found.items())
    head = "quantity", "held by the 95 % interval", "bias, in stated uncertainties"
    table(head, rows, f"{repeats:,} simulated studies of one pad under five loads")
