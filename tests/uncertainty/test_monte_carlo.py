"""Monte Carlo against distributions known in closed form, its stopping rule, and the first order's check."""

import tracemalloc

import numpy as np
import pytest
import scipy
from numpy.testing import assert_allclose
from tests.uncertainty.pads import LENGTHS, PAD, PLACED

from fingerpad.uncertainty import (
    Inputs,
    MonteCarloResult,
    layer_model,
    pad_model,
    pad_uncertainty,
    placement_model,
    propagate,
    run_monte_carlo,
    sobol_indices,
    validate_linear_approximation,
)
from fingerpad.uncertainty.models import indentation_model

NORMAL = Inputs.of(x=(0.0, 1.0))


def exponential(x: np.ndarray) -> dict[str, np.ndarray]:
    return {"y": np.exp(x)}


def test_chi_square() -> None:
    result = run_monte_carlo(
        lambda a, b, c: {"y": a**2 + b**2 + c**2},
        Inputs.of(a=(0.0, 1.0), b=(0.0, 1.0), c=(0.0, 1.0)),
        min_draws=400_000,
    )["y"]
    assert_allclose(result.value, 3, rtol=0.01)
    assert_allclose(result.std, np.sqrt(6), rtol=0.01)
    assert_allclose(result.interval, scipy.stats.chi2(3).ppf([0.025, 0.975]), rtol=0.015)


def test_stops_at_wanted_digits() -> None:
    first = pad_uncertainty(**PAD)
    rough, fine = (run_monte_carlo(pad_model, first.inputs, digits=digits) for digits in (1, 2))
    assert rough.draws < fine.draws <= 1_000_000
    assert all(rough.converged.values())
    assert (fine.tolerance < rough.tolerance).all()
    assert np.max(np.abs(fine.std / first.std - 1)) < 0.02


def test_tolerance_matches_repeats() -> None:
    def found(seed: int) -> MonteCarloResult:
        inputs = Inputs.of(x=(0.0, 0.3))
        return run_monte_carlo(exponential, inputs, min_draws=50_000, max_draws=50_000, seed=seed)

    repeats = [found(seed) for seed in range(30)]
    ends = [(*one.value, *one.std, *one["y"].interval) for one in repeats]
    tolerance = np.median([one.tolerance for one in repeats])
    assert 0.7 < tolerance / (2 * np.std(ends, axis=0).max()) < 1.4
    assert_allclose(np.mean(ends, axis=0)[2:], np.exp(0.3 * scipy.stats.norm.ppf([0.025, 0.975])), rtol=1e-4)


LAYER = pad_uncertainty(**{**PAD, "poisson_ratio": (0.47, 0.01)}, thickness=(8.0, 0.8)).inputs
PRESS = {"load": (2.0, 0.04), "indentation": (1.7, 0.05), "contact_shift": 0.1, "thickness": (8.0, 0.8)}


@pytest.mark.parametrize(
    ("model", "inputs"),
    [
        (placement_model, Inputs.of(**PLACED)),
        (layer_model, LAYER),
        (
            indentation_model,
            Inputs.of(**LENGTHS, **PRESS, wedge_angle=(0.6, 0.01), roll_angle=0.0, poisson_ratio=0.49),
        ),
    ],
)
def test_first_order_of_the_models_agrees_with_monte_carlo(model, inputs: Inputs) -> None:
    drawn = run_monte_carlo(model, inputs, seed=1, max_draws=100_000)
    assert_allclose(propagate(model, inputs).std, drawn.std, rtol=0.03)
    assert drawn.undefined == 0


def test_max_draws_reached_is_reported() -> None:
    result = run_monte_carlo(exponential, NORMAL, digits=3, max_draws=40_000)
    assert result.draws == 40_960  # five whole batches
    assert result.converged == {"y": False}


def test_undefined_draws_are_counted() -> None:
    result = run_monte_carlo(lambda x: {"y": np.sqrt(x)}, Inputs.of(x=(1.0, 1.0)))
    assert_allclose(result.undefined / (result.draws + result.undefined), scipy.stats.norm.cdf(-1), rtol=0.05)
    assert np.isfinite(result.std).all()


@pytest.mark.parametrize(("digits", "wanted"), [(1, [0.005, 50.0, 0.0]), (2, [0.0005, 5.0, 0.0])])
def test_tolerance_is_half_a_unit_of_the_last_digit(digits: int, wanted: list[float]) -> None:
    def scaled(x: np.ndarray) -> dict[str, np.ndarray]:
        return {"small": 0.032 * x, "large": 250 * x, "exact": 0 * x + 7.0}

    simulated = run_monte_carlo(scaled, NORMAL, digits=digits)
    assert_allclose(simulated.wanted_tolerance, wanted, rtol=1e-12)
    assert simulated.converged["exact"]
    compared = validate_linear_approximation(propagate(scaled, NORMAL), simulated, digits=digits)
    assert_allclose([one.tolerance for one in compared.values()], wanted, rtol=1e-12)
    assert compared["exact"].valid


def test_points_of_many_draws_are_not_kept() -> None:
    inputs = Inputs.of(**dict.fromkeys("abcdefghij", (1.0, 0.1)))
    tracemalloc.start()
    sobol_indices(lambda **given: {"sum": sum(given.values())}, inputs, draws=2**14)
    held, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert held < 2**21  # the eight sequences take 21 MB
