"""Monte Carlo against distributions known in closed form, its stopping rule, and the first order's check."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import stats

from fingerpad.exceptions import UncertaintyError
from fingerpad.uncertainty import pad_model, propagate, run_monte_carlo, validate_linear_approximation

PAD = np.array([7.9, 13.8, 11.8, np.radians(30), 0.05, 0.5, 1.0, 2.0, 6.08, 0.39])
PAD_COVARIANCE = np.diag(
    np.square([0.1, 0.12, 0.08, np.radians(0.5), np.radians(1), 0.01, 0.01, 0.02, 0.07, 0.02])
)


def test_chi_square() -> None:
    result = run_monte_carlo(
        lambda x: np.square(x).sum(axis=-1, keepdims=True), np.zeros(3), np.eye(3), min_draws=400_000
    )
    assert_allclose(result.value, 3, rtol=0.01)
    assert_allclose(result.std, np.sqrt(6), rtol=0.01)
    assert_allclose(result.interval[0], stats.chi2(3).ppf([0.025, 0.975]), rtol=0.015)


def test_correlated_inputs() -> None:
    covariance = np.array([[4.0, -1.9], [-1.9, 1.0]])
    result = run_monte_carlo(lambda x: np.stack([x.sum(axis=-1), x[..., 0]], axis=-1), [1.0, 2.0], covariance)
    assert_allclose(result.covariance, [[1.2, 2.1], [2.1, 4.0]], rtol=0.04)


def test_the_wanted_digits_decide_when_it_stops() -> None:
    rough = run_monte_carlo(pad_model, PAD, PAD_COVARIANCE, digits=1)
    fine = run_monte_carlo(pad_model, PAD, PAD_COVARIANCE, digits=2)
    assert rough.draws < fine.draws <= 1_000_000
    assert rough.converged.all()
    assert (fine.tolerance < rough.tolerance).all()
    assert np.max(np.abs(fine.std / propagate(pad_model, PAD, PAD_COVARIANCE).std - 1)) < 0.02


def test_tolerance_is_that_of_repeats() -> None:
    def ends(seed: int) -> np.ndarray:
        return run_monte_carlo(
            np.exp, [0.0], [[1.0]], min_draws=50_000, max_draws=50_000, seed=seed
        ).interval[0, 1]

    tolerance = run_monte_carlo(np.exp, [0.0], [[1.0]], min_draws=50_000, max_draws=50_000).tolerance[0]
    scatter = np.std([ends(seed) for seed in range(30)])
    assert 0.5 < tolerance / (2 * scatter) < 2.5


def test_the_cap_is_kept_and_told() -> None:
    result = run_monte_carlo(np.exp, [0.0], [[1.0]], digits=3, max_draws=40_000)
    assert result.draws == 40_000
    assert not result.converged.any()


def test_same_seed_same_result() -> None:
    one, other, third = (run_monte_carlo(np.exp, [0.0], [[0.1]], seed=seed).value for seed in (5, 5, 6))
    assert one == other != third


def test_draws_without_an_answer_are_counted() -> None:
    with np.errstate(invalid="ignore"):
        result = run_monte_carlo(np.sqrt, [1.0], [[1.0]])
    assert_allclose(result.undefined / (result.draws + result.undefined), stats.norm.cdf(-1), rtol=0.05)
    assert np.isfinite(result.std).all()


@pytest.mark.parametrize(
    ("mean", "covariance", "options", "message"),
    [
        ([-3.0], [[1.0]], {}, "no answer for .* draws"),
        ([1.0], np.eye(2), {}, "do not fit a covariance"),
        ([1.0], [[-1.0]], {}, "variance must be positive or zero"),
        ([1.0], [[1.0]], {"digits": 0}, "digits must be at least 1"),
        ([1.0], [[1.0]], {"min_draws": 10, "max_draws": 5}, "at most max_draws, found 2, 10, 5"),
    ],
)
def test_refuses(mean: list[float], covariance: np.ndarray, options: dict[str, int], message: str) -> None:
    with pytest.raises(UncertaintyError, match=message):
        run_monte_carlo(np.sqrt, mean, covariance, **options)


def test_first_order_is_valid_where_the_model_is_straight() -> None:
    first, simulated = (
        propagate(pad_model, PAD, PAD_COVARIANCE),
        run_monte_carlo(pad_model, PAD, PAD_COVARIANCE),
    )
    assert validate_linear_approximation(first, simulated).valid.all()
    wide = 900 * PAD_COVARIANCE[2:3, 2:3]

    def one_radius(x: np.ndarray) -> np.ndarray:
        others = np.broadcast_to(PAD, (*x.shape[:-1], 10)).astype(x.dtype)
        return pad_model(np.concatenate([others[..., :2], x, others[..., 3:]], axis=-1))

    with np.errstate(all="ignore"):  # draws of negative axes
        first, simulated = propagate(one_radius, PAD[2:3], wide), run_monte_carlo(one_radius, PAD[2:3], wide)
    assert not validate_linear_approximation(first, simulated).valid[0]
