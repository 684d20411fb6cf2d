"""The noise in as many steps as rows, against its covariance written out as a matrix."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.signal import lfilter

from fingerpad.loading.noise import Drift, Noise, NoiseUncertainty, estimate_noise, noise_uncertainty

RNG = np.random.default_rng(0)
COUNT = 40
TIME = np.sort(RNG.uniform(0, 1, COUNT))
SLOPE = np.maximum(np.linspace(-1, 3, COUNT), 0)
WITH_AREA = np.arange(COUNT) > 15
G = np.pi * 15.0


def noise(drift_std: float) -> Noise:
    stds = {"force_std": 0.003, "displacement_std": 0.005, "area_std": 1.0, "drift_std": drift_std}
    return noise_of(stds, 0.1, SLOPE, np.diff(TIME), WITH_AREA)


def noise_of(stds, drift_time, slope, steps, with_area) -> Noise:
    return Noise(**stds, drift_time=drift_time, slope=slope, radius=15.0, steps=steps, with_area=with_area)


def white_record(seed: int, count: int = 200) -> tuple[Noise, tuple, tuple]:
    """Return noise to begin with, and residuals and jacobians of a force and a displacement without drift."""
    rng, slope = np.random.default_rng(seed), np.linspace(0, 3, count)
    line = np.stack([np.ones(count), np.linspace(0, 1, count)], axis=-1)
    e = 0.005 * rng.standard_normal(count)
    force, area = 0.004 * rng.standard_normal(count) + slope * e, rng.standard_normal(count) - G * e
    stds = {"force_std": 0.01, "displacement_std": 0.001, "area_std": 0.5, "drift_std": 0.004}
    start = noise_of(stds, 5.0, slope, np.ones(count - 1), np.ones(count, dtype=bool))
    return start, (force, area), (line, line)


def written_out(drift_std: float) -> np.ndarray:
    """Return the covariance of residuals of force and area from f + w + s e and a - g e."""
    rows = np.flatnonzero(WITH_AREA)
    displacement = np.concatenate([np.diag(SLOPE), -G * np.eye(COUNT)[rows]])
    whole = 0.005**2 * displacement @ displacement.T
    lags = np.abs(TIME[:, None] - TIME)
    whole[:COUNT, :COUNT] += drift_std**2 * np.exp(-lags / 0.1) + 0.003**2 * np.eye(COUNT)
    whole[COUNT:, COUNT:] += np.eye(rows.size)
    return whole


@pytest.mark.parametrize("drift_std", [0.0, 0.006])
def test_likelihood_equals_dense_matrix(drift_std: float) -> None:
    covariance = written_out(drift_std)
    columns = np.random.default_rng(1).standard_normal((len(covariance), 4))
    residual, jacobian = columns[:, 0], columns[:, 1:]
    inverse = np.linalg.inv(covariance)
    information = jacobian.T @ inverse @ jacobian
    left = residual - jacobian @ np.linalg.solve(information, jacobian.T @ inverse @ residual)
    expected = sum(np.linalg.slogdet(each)[1] for each in (covariance, information)) + left @ inverse @ left
    assert_allclose(
        noise(drift_std).negative_log_likelihood(columns[:COUNT], columns[COUNT:]), expected / 2, rtol=1e-9
    )


@pytest.mark.parametrize(
    "drift", [Drift.of(kind, 0.01, 1.0, np.diff(TIME)) for kind in ("long_range", "random_walk")]
)
def test_slow_drift_equals_dense_matrix(drift: Drift) -> None:
    lags = np.abs(TIME[:, None] - TIME)
    dense = sum(s**2 * np.exp(-lags / t) for s, t in zip(drift.stds, drift.times, strict=True))
    columns = np.random.default_rng(1).standard_normal((COUNT, 4))
    assert_allclose(drift.covariance_of(columns), columns.T @ dense @ columns, rtol=1e-8)
    whole = dense + np.diag(white := np.linspace(1e-6, 1e-4, COUNT))
    product, volume = drift.information(white, columns)
    assert_allclose(product, columns.T @ np.linalg.solve(whole, columns), rtol=1e-7)
    assert_allclose(volume, np.linalg.slogdet(whole)[1] / 2, rtol=1e-9)


@pytest.mark.parametrize("drift_std", [0.0, 0.006])
def test_covariance_equals_dense_sandwich(drift_std: float) -> None:
    covariance, seen = written_out(drift_std), noise(drift_std)
    jacobian = np.random.default_rng(2).standard_normal((len(covariance), 3))
    identity = np.eye(len(covariance))
    scaling = seen.scaling()(identity[:COUNT], identity[COUNT:])
    weighed = scaling @ jacobian
    estimator = np.linalg.solve(weighed.T @ weighed, weighed.T @ scaling)
    found = seen.parameter_covariance(jacobian[:COUNT], jacobian[COUNT:])
    assert_allclose(found, estimator @ covariance @ estimator.T, rtol=1e-8)


def test_estimated_weights_follow_kenward_roger() -> None:
    """Their own form, Φ + 2 Φ Σ C_ij (Q_ij − P_i Φ P_j) Φ, in variances and with the matrix written out."""
    names, parts = ("force_std", "displacement_std", "area_std"), []
    for name in names:
        alone = replace(noise(0.0), **{other: 0.0 for other in names if other != name})
        parts.append(2 * alone.covariance_of(*np.split(np.eye(written_out(0.0).shape[0]), [COUNT])))
    covariance = written_out(0.0)
    assert_allclose(sum(parts), 2 * covariance, rtol=1e-9)
    root = np.random.default_rng(5).standard_normal((3, 3))
    of_logs = 0.3 * root @ root.T
    jacobian = np.random.default_rng(6).standard_normal((len(covariance), 3))
    inverse = np.linalg.inv(covariance)
    plain = np.linalg.inv(jacobian.T @ inverse @ jacobian)
    change = [-inverse @ part @ inverse for part in parts]
    first = [jacobian.T @ each @ jacobian for each in change]
    middle = np.zeros((3, 3))
    for i in range(3):
        for k in range(3):
            second = jacobian.T @ change[i] @ covariance @ change[k] @ jacobian
            middle += of_logs[i, k] * (second - first[i] @ plain @ first[k])
    known = NoiseUncertainty(names=names, covariance=of_logs)
    found = known.parameter_covariance(noise(0.0), (jacobian[:COUNT], jacobian[COUNT:]))
    added = 2 * plain @ middle @ plain
    assert_allclose(found - plain, added, atol=0.03 * np.abs(added).max())
    assert np.linalg.norm(added) > 0.05 * np.linalg.norm(plain)


def test_noise_stds_recovered() -> None:
    found = []
    for seed in range(6):
        start, (force, area), jacobians = white_record(seed, 1500)
        steps = 0.004 * np.random.default_rng([3, seed]).standard_normal(1500)
        drift = lfilter([1], [1, -0.9], steps)
        seen = estimate_noise(replace(start, drift_std=0.0), (force + drift, area), jacobians)
        found.append((seen.force_std, seen.displacement_std, seen.area_std, seen.drift_std, seen.drift_time))
    expected = (0.004, 0.005, 1.0, 0.004 / np.sqrt(1 - 0.81), -1 / np.log(0.9))
    assert_allclose(np.median(found, axis=0), expected, rtol=0.2)  # the time is known to 9 %


def test_drift_is_found_only_where_it_is_looked_for_and_is_then_uncertain_too() -> None:
    start, (force, area), jacobians = white_record(1)
    drift = np.repeat(np.random.default_rng(2).normal(0, 0.02, 10), 20)
    residuals = (force + drift, area)
    assert estimate_noise(start, residuals, jacobians, ("white",)).drift_std == 0
    found = estimate_noise(start, residuals, jacobians)
    assert 0.01 < found.drift_std < 0.04
    white = ("force_std", "displacement_std", "area_std")
    assert noise_uncertainty(found, residuals, jacobians).names == (*white, "drift_std", "drift_time")
    plain = replace(found, drift_std=0.0)
    assert noise_uncertainty(plain, residuals, jacobians).names == white


def test_of_likely_drifts_the_least_favourable_is_taken() -> None:
    """A random walk that 1/f noise fits as well, whose slow part is a tenth: it would be understated."""
    start, (force, area), jacobians = white_record(11)
    walk = 0.02 * np.cumsum(np.random.default_rng(11).standard_normal(200)) / np.sqrt(200)
    residuals = (force + walk, area)
    found = estimate_noise(start, residuals, jacobians)
    other = estimate_noise(start, residuals, jacobians, ("long_range",))
    columns = [np.column_stack(pair) for pair in zip(residuals, jacobians, strict=True)]
    assert other.negative_log_likelihood(*columns) < found.negative_log_likelihood(*columns)
    truth = Drift.of("random_walk", 0.02, 1.0, np.ones(199)).slow_variance
    assert 0.5 < found.slow_variance / truth < 2
    assert other.slow_variance < 0.2 * truth


@pytest.mark.parametrize(("kind", "time"), [("exponential", 3.0), ("long_range", 1.0), ("random_walk", 1.0)])
def test_simulated_drift_has_its_covariance(kind, time: float) -> None:
    drift = Drift.of(kind, 0.02, time, np.ones(11))
    rng = np.random.default_rng(4)
    drawn = np.array([drift.simulated(rng) for _ in range(2000)])
    expected = drift.covariance_of(np.eye(12))
    assert_allclose(drawn.T @ drawn / len(drawn), expected, atol=0.12 * expected[0, 0])


def test_of_one_deviation_the_degrees_of_freedom_are_those_of_its_chi_square() -> None:
    """The logarithm of a standard deviation of ν degrees of freedom has the variance 1/(2 ν)."""
    white = replace(noise(0.0), displacement_std=0.0, with_area=np.zeros(COUNT, dtype=bool))
    jacobians = np.stack([np.ones(COUNT), TIME], axis=-1), np.zeros((0, 2))
    known = NoiseUncertainty(names=("force_std",), covariance=np.array([[1 / (2 * 17)]]))
    moved = known.moved_covariances(white, jacobians)
    for gradient in np.eye(2):
        assert_allclose(known.degrees_of_freedom(moved, gradient), 17)


def test_long_range_drift_has_the_spectrum_of_one_over_f() -> None:
    """Its correlation written out, in a periodic record longer than any of its times."""
    drift = Drift.of("long_range", 1.0, 1.0, np.ones(1000))
    lags = np.minimum(np.arange(2**17), 2**17 - np.arange(2**17))
    correlation = sum(s**2 * np.exp(-lags / t) for s, t in zip(drift.stds, drift.times, strict=True))
    frequency = np.geomspace(2e-3, 0.05, 9)
    power = np.fft.rfft(correlation).real[(frequency * 2**17).astype(int)]
    assert_allclose(power * frequency / np.mean(power * frequency), 1, atol=0.15)
