"""Propagation through the pad's model: accuracy of derivatives, and the cost of a million draws."""

import numpy as np
from scipy.special import ellipe, ellipk

from benchmarks.memory import peak_mb
from benchmarks.timing import best
from fingerpad.uncertainty import pad_model, pad_uncertainty, propagate, run_monte_carlo

INPUTS = pad_uncertainty(
    palmar=(7.9, 0.1),
    distal=(13.8, 0.12),
    radial_ulnar=(11.8, 0.08),
    wedge_angle=(np.radians(30), np.radians(0.5)),
    roll_angle=(0.05, np.radians(1)),
    image_scale=(1.0, 0.01),
    edge_offset=(0.0, 0.06),
    load=(2.0, 0.02),
    semi_major=(7.4, 0.11),
    semi_minor=(5.0, 0.08),
).inputs
DRAWS = 1_000_000


def monte_carlo_speed() -> None:
    """Print the cost of a million draws of the whole chain as a multiple of SciPy's two integrals."""
    m = np.random.default_rng(0).uniform(0.01, 0.9, DRAWS)
    floor = best(lambda: (ellipk(m), ellipe(m)), 9)
    whole = best(lambda: run_monte_carlo(pad_model, INPUTS, min_draws=DRAWS, max_draws=DRAWS), 5)
    print(f"\n{DRAWS:,} draws of all inputs through the pad's model, with means, covariance and intervals")
    print(f"    {whole / floor:.1f} x SciPy's ellipk + ellipe on as many values (asked: 40)")
    print(f"    peak memory of the process {peak_mb():.0f} MB (asked: 500)")


def first_order_against_simulation() -> None:
    """Print by how much first-order and simulated standard uncertainties differ."""
    first = propagate(pad_model, INPUTS)
    simulated = run_monte_carlo(pad_model, INPUTS, min_draws=DRAWS, max_draws=DRAWS)
    off = np.max(np.abs(first.std / simulated.std - 1))
    print(f"    first-order against simulated standard uncertainties: within {100 * off:.2f} %")


def report() -> None:
    """Print the cost of a million draws, and how far first order is from them."""
    monte_carlo_speed()
    first_order_against_simulation()
