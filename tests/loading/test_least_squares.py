"""The one fitting function: certified problems of NIST, other libraries, and data that determine nothing."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import scipy
from numpy.testing import assert_allclose

from fingerpad.exceptions import FitError
from fingerpad.loading.least_squares import effective_count, fit_least_squares

X = np.linspace(0, 3, 40)


def decay(p, x):
    return p[0] * np.exp(-p[1] * x) + p[2]


def data(seed: int) -> np.ndarray:
    return decay((2.0, 1.3, 0.5), X) + np.random.default_rng(seed).normal(0, 0.05, X.size)


def fitted(y):
    return fit_least_squares(lambda p: decay(p, X) - y, [1, 1, 0], ["size", "rate", "level"])


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


def test_fewer_independent_residuals_widen_the_interval() -> None:
    fit = fitted(data(0))
    fewer = fit.with_effective_count(20)
    assert_allclose(fewer.covariance, fit.covariance * 37 / 17)
    assert (fewer.effective_count, fewer.degrees_of_freedom) == (20, 17)
    wide, narrow = (one.estimate("level") for one in (fewer, fit))
    assert wide.upper - wide.lower > 1.4 * (narrow.upper - narrow.lower)


def test_more_parameters_than_independent_residuals() -> None:
    with pytest.raises(FitError, match="count as 2.5 independent"):
        fitted(data(0)).with_effective_count(2.5)


def test_aicc_differences_agree_with_statsmodels() -> None:
    """Of seven points, where the correction for few points is most of it."""
    eval_measures = pytest.importorskip("statsmodels.tools.eval_measures")
    x = np.linspace(-1, 1, 7)
    y = 1 + x + 0.1 * np.random.default_rng(0).standard_normal(7)

    def polynomial(degree: int) -> tuple[float, float]:
        def residuals(p: np.ndarray) -> np.ndarray:
            return np.polynomial.polynomial.polyval(x, p) - y

        fit = fit_least_squares(residuals, np.zeros(degree + 1), [f"c{k}" for k in range(degree + 1)])
        likelihood = scipy.stats.norm.logpdf(fit.residuals, scale=np.sqrt(np.mean(fit.residuals**2))).sum()
        return fit.aicc, eval_measures.aicc(likelihood, 7, degree + 2)

    ours, theirs = np.transpose([polynomial(degree) for degree in (1, 2, 3)])
    assert_allclose(np.diff(ours), np.diff(theirs), rtol=1e-9)


FOLDER = Path(__file__).parent / "nist"
exp, pi = np.exp, np.pi


def gauss(b, x):
    hill = b[2] * exp(-((x - b[3]) ** 2) / b[4] ** 2) + b[5] * exp(-((x - b[6]) ** 2) / b[7] ** 2)
    return b[0] * exp(-b[1] * x) + hill


def enso(b, x):
    def wave(a, c, period):
        return a * np.cos(2 * pi * x / period) + c * np.sin(2 * pi * x / period)

    return b[0] + wave(b[1], b[2], 12) + wave(b[4], b[5], b[3]) + wave(b[7], b[8], b[6])


def ratio(over: int) -> Callable:
    def model(b, x):
        return np.polyval(b[over - 1 :: -1], x) / (1 + x * np.polyval(b[: over - 1 : -1], x))

    return model


def lanczos(b, x):
    return sum(b[k] * exp(-b[k + 1] * x) for k in (0, 2, 4))


MODELS = {
    "BoxBOD": lambda b, x: b[0] * (1 - exp(-b[1] * x)),
    "ENSO": enso,
    "Eckerle4": lambda b, x: b[0] / b[1] * exp(-0.5 * ((x - b[2]) / b[1]) ** 2),
    "Gauss3": gauss,
    "Hahn1": ratio(4),
    "Lanczos3": lanczos,
    "MGH09": lambda b, x: b[0] * (x**2 + x * b[1]) / (x**2 + x * b[2] + b[3]),
    "MGH17": lambda b, x: b[0] + b[1] * exp(-x * b[3]) + b[2] * exp(-x * b[4]),
    "Rat43": lambda b, x: b[0] / (1 + exp(b[1] - b[2] * x)) ** (1 / b[3]),
    "Thurber": ratio(4),
}


def certified(name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return rows (start 1, start 2, value, standard deviation) and data rows (y, x)."""
    text = (FOLDER / f"{name}.dat").read_text(encoding="ascii")
    rows = re.findall(r"^\s*b\d+ =(.*)$", text, re.MULTILINE)
    data = text[re.search(r"^Data: +y +x", text, re.MULTILINE).end() :]
    return np.array([row.split() for row in rows], float), np.array(data.split(), float).reshape(-1, 2)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # trial steps overflow on the way
@pytest.mark.parametrize("start", [1, 2])
@pytest.mark.parametrize("name", MODELS)
def test_certified_values(name: str, start: int) -> None:
    parameters, (y, x) = certified(name)[0], certified(name)[1].T
    values, stds = parameters[:, 2], parameters[:, 3]
    names = [f"b{k + 1}" for k in range(values.size)]

    def residuals(b):
        return MODELS[name](b, x) - y

    if (name, start) == ("BoxBOD", 1):
        # The first step leaps to where the model is flat: no result, rather than a wrong one.
        with pytest.raises(FitError, match="do not depend on b2"):
            fit_least_squares(residuals, parameters[:, 0], names)
        return
    fit = fit_least_squares(residuals, parameters[:, start - 1], names)
    assert_allclose(fit.values, values, rtol=1e-6)
    assert_allclose(np.sqrt(np.diag(fit.covariance)), stds, rtol=1e-6)


def test_aicc_without_rows_to_spare_is_infinite() -> None:
    def line(rows: int) -> float:
        x = np.arange(float(rows))
        return fit_least_squares(lambda p: p[0] + p[1] * x - x**2, [0, 1], ["level", "slope"]).aicc

    assert line(4) == np.inf
    assert np.isfinite(line(5))
