"""The one fitting function against other libraries, and what it says of data that determine nothing."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import stats

from fingerpad.exceptions import FitError
from fingerpad.loading.least_squares import effective_count, fit_least_squares

X = np.linspace(0, 3, 40)


def decay(p, x):
    return p[0] * np.exp(-p[1] * x) + p[2]


def data(seed: int) -> np.ndarray:
    return decay((2.0, 1.3, 0.5), X) + np.random.default_rng(seed).normal(0, 0.05, X.size)


def fitted(y):
    return fit_least_squares(lambda p: decay(p, X) - y, [1, 1, 0], ["size", "rate", "level"])


def test_agrees_with_statsmodels_on_a_line() -> None:
    api = pytest.importorskip("statsmodels.api")
    rng = np.random.default_rng(1)
    y = 3 - 2 * X + rng.normal(0, 0.3, X.size)
    fit = fit_least_squares(lambda p: y - p[0] - p[1] * X, [0, 0], ["level", "slope"])
    other = api.OLS(y, api.add_constant(X)).fit()
    assert_allclose(fit.values, other.params, rtol=1e-6)
    assert_allclose(np.sqrt(np.diag(fit.covariance)), other.bse, rtol=1e-6)
    ends = np.array([[e.lower, e.upper] for e in (fit.estimate("level"), fit.estimate("slope"))])
    assert_allclose(ends, other.conf_int(), rtol=2e-3)  # a line's profile is its t interval


def test_profile_agrees_with_lmfit() -> None:
    lmfit = pytest.importorskip("lmfit")
    y = data(2)
    fit = fitted(y)
    parameters = lmfit.create_params(size=1, rate=1, level=0)
    problem = lmfit.Minimizer(lambda p: decay((p["size"], p["rate"], p["level"]), X) - y, parameters)
    other = lmfit.conf_interval(problem, problem.minimize(), sigmas=[0.95])
    for name in ("size", "rate", "level"):
        found = fit.estimate(name)
        (_, low), _, (_, high) = other[name]
        assert_allclose([found.lower, found.upper], [low, high], rtol=5e-3)


@pytest.mark.parametrize("kept", [0.0, 0.5, 0.9])
def test_effective_count_of_correlated_residuals(kept: float) -> None:
    rng = np.random.default_rng(3)
    worth = []
    for _ in range(20):
        values = rng.standard_normal(1500)
        for k in range(1, values.size):
            values[k] += kept * values[k - 1]
        worth.append(effective_count(values))
    assert_allclose(np.median(worth), 1500 * (1 - kept) / (1 + kept), rtol=0.15)


def test_interval_coverage_of_correlated_data() -> None:
    rng, hits = np.random.default_rng(4), 0
    x = np.linspace(0, 1, 300)
    for _ in range(200):
        noise = rng.standard_normal(x.size)
        for k in range(1, x.size):
            noise[k] += 0.8 * noise[k - 1]
        fit = fit_least_squares(lambda p, n=noise: p[0] + p[1] * x - n, [0.1, 0.1], ["level", "slope"])
        assert fit.with_effective_count(effective_count(fit.residuals)).effective_count < 150
        slope = fit.with_effective_count(effective_count(fit.residuals)).estimate("slope")
        hits += slope.lower <= 0 <= slope.upper
    assert 0.89 <= hits / 200 <= 0.985


@pytest.mark.parametrize(
    ("residuals", "start", "message"),
    [
        (lambda p: np.ones(2) * p[0] - p[1] + p[2], [1, 1, 1], "2 data for 3 parameters"),
        (lambda p: np.ones(9) * (p[0] + p[1] - 1), [1, 1], "do not determine a, b separately"),
        (lambda p: np.arange(9.0) - p[0] + 0 * p[1], [1, 1], "do not depend on b"),
        (lambda p: np.full(9, np.nan) * p[0], [1, 1], "not finite"),
    ],
)
def test_undetermined_parameters_named(residuals, start, message: str) -> None:
    with pytest.raises(FitError, match=message):
        fit_least_squares(residuals, start, ["a", "b", "c"][: len(start)])


def test_more_parameters_than_independent_residuals() -> None:
    with pytest.raises(FitError, match="count as 2.5 independent"):
        fitted(data(0)).with_effective_count(2.5)


def test_aicc_without_rows_to_spare_is_infinite() -> None:
    def line(rows: int) -> float:
        x = np.arange(float(rows))
        return fit_least_squares(lambda p: p[0] + p[1] * x - x**2, [0, 1], ["level", "slope"]).aicc

    assert line(4) == np.inf
    assert np.isfinite(line(5))


def test_aicc_differences_agree_with_statsmodels() -> None:
    """Of seven points, where the correction for few points is most of it."""
    eval_measures = pytest.importorskip("statsmodels.tools.eval_measures")
    x = np.linspace(-1, 1, 7)
    y = 1 + x + 0.1 * np.random.default_rng(0).standard_normal(7)

    def polynomial(degree: int) -> tuple[float, float]:
        def residuals(p: np.ndarray) -> np.ndarray:
            return np.polynomial.polynomial.polyval(x, p) - y

        fit = fit_least_squares(residuals, np.zeros(degree + 1), [f"c{k}" for k in range(degree + 1)])
        likelihood = stats.norm.logpdf(fit.residuals, scale=np.sqrt(np.mean(fit.residuals**2))).sum()
        return fit.aicc, eval_measures.aicc(likelihood, 7, degree + 2)

    ours, theirs = np.transpose([polynomial(degree) for degree in (1, 2, 3)])
    assert_allclose(np.diff(ours), np.diff(theirs), rtol=1e-9)
