"""Elliptical Hertz contact against fifty digits, and its cost beside SciPy's elliptic integrals."""

import mpmath as mp
import numpy as np
from scipy.special import ellipe, ellipk

from benchmarks.cost import best
from benchmarks.tables import table
from benchmarks.truth.hertz import RATIOS, exact_contact
from fingerpad.contact import Tissue, hertz_contact, solve_contact_ellipse
from fingerpad.geometry import Paraboloid

NAMES = "semi-major axis", "semi-minor axis", "indentation", "peak pressure"


def hertz_accuracy() -> None:
    """Print the largest relative error of each quantity over all curvature ratios."""
    worst = np.zeros(4)
    for ratio in RATIOS:
        contact = hertz_contact(Paraboloid(8.0, 8.0 * ratio), Tissue.of_reduced_modulus(0.1365), load=2.0)
        found = (contact.semi_major, contact.semi_minor, contact.indentation, contact.peak_pressure)
        exact = exact_contact(ratio, 8.0, 2.0, 0.1365)
        error = [abs(float(mp.mpf(float(a)) / b - 1)) for a, b in zip(found, exact, strict=True)]
        worst = np.maximum(worst, error)
    table(
        ("quantity", "largest relative error"),
        zip(NAMES, (f"{one:.1e}" for one in worst), strict=True),
        "Against 50 digits, ratios of curvature of 1, 1 + 1e-15 to 1 + 1e-1, and on to 1e7",
    )


def hertz_speed(count: int = 1_000_000) -> None:
    """Print the time of distinct contacts as multiples of SciPy's two elliptic integrals."""
    rng = np.random.default_rng(0)
    first = rng.uniform(5, 20, count)
    second = first * np.exp(rng.uniform(0, np.log(1e7), count))
    load, modulus = rng.uniform(0.1, 4, count), rng.uniform(0.05, 0.2, count)
    m = 1 - solve_contact_ellipse(first, second)[0] ** 2
    bodies, tissue = Paraboloid(first, second), Tissue(modulus)
    floor = best(lambda: (ellipk(m), ellipe(m)))
    calls = {
        "`hertz_contact`, bodies and tissue made at each call": lambda: hertz_contact(
            Paraboloid(first, second), Tissue(modulus), load=load
        ),
        "the same of known bodies and tissue": lambda: hertz_contact(bodies, tissue, load=load),
    }
    table(
        ("call", "time over that of `ellipk` + `ellipe`"),
        ((name, f"{best(call) / floor:.1f}") for name, call in calls.items()),
        f"{count:,} distinct contacts, one thread; SciPy's two integrals take {1e3 * floor:.0f} ms",
    )


def report() -> None:
    """Print both tables."""
    hertz_accuracy()
    hertz_speed()
