"""R_g from simulated curves of known truth."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fingerpad.contact import HertzGeometry, equivalent_radius_from_compliance
from fingerpad.exceptions import FitError
from fingerpad.loading import LoadingCurve, fit_contact_compliance

GEOMETRY = HertzGeometry(12.955, 14.330)
TRUE_RADIUS = float(equivalent_radius_from_compliance(GEOMETRY.geometric_mean_radius, GEOMETRY.axis_ratio))


def simulated(
    rng: np.random.Generator, *, count: int = 40, noise: float = 0.0, offset: float = 0.0
) -> LoadingCurve:
    # A modulus that grows with load: R_g must not notice.
    load = np.linspace(0.05, 4, count)
    contact = GEOMETRY.under_load(load, reduced_modulus=0.05 + 0.02 * load)
    area = contact.area * (1 + noise * rng.standard_normal(count))
    return LoadingCurve(load=load, indentation=contact.indentation + offset, area=area)


def test_equivalent_radius_at_any_displacement_zero() -> None:
    for offset in (0.0, 0.7, -3.0):
        fit = fit_contact_compliance(simulated(np.random.default_rng(0), offset=offset))
        assert_allclose(fit.loading_radius, TRUE_RADIUS, rtol=1e-12)
        assert_allclose(fit.area_at_zero, -np.pi * TRUE_RADIUS * offset, atol=1e-9)


def test_std_coverage() -> None:
    rng = np.random.default_rng(5)
    # Noise of one size at all loads, as least squares takes it to be.
    hits = 0
    for _ in range(400):
        curve = simulated(rng)
        noisy = LoadingCurve(
            load=curve.load,
            indentation=curve.indentation,
            area=curve.area + rng.normal(0, 3, curve.load.size),
        )
        fit = fit_contact_compliance(noisy)
        hits += abs(fit.loading_radius - TRUE_RADIUS) <= 2.024 * fit.loading_radius_std  # t, 38 d.o.f.
    assert 0.92 <= hits / 400 <= 0.98


def test_points_without_load_are_left_out() -> None:
    curve = simulated(np.random.default_rng(0))
    padded = LoadingCurve(
        load=np.append(curve.load, [0.0, -0.1]),
        indentation=np.append(curve.indentation, [50.0, 60.0]),
        area=np.append(curve.area, [0.0, 0.0]),
    )
    fit = fit_contact_compliance(padded)
    assert fit.count == curve.load.size
    assert_allclose(fit.loading_radius, TRUE_RADIUS, rtol=1e-12)


@pytest.mark.parametrize(
    ("curve", "message"),
    [
        (LoadingCurve(load=np.ones(5), indentation=np.arange(5.0), area=None), "no contact area"),
        (LoadingCurve(load=np.zeros(5), indentation=np.arange(5.0), area=np.ones(5)), "0 points under load"),
        (
            LoadingCurve(load=np.ones(5), indentation=np.ones(5), area=np.arange(5.0)),
            "displacement is the same",
        ),
        (
            LoadingCurve(load=np.ones(5), indentation=np.arange(5.0), area=-np.arange(5.0)),
            "contact area falls",
        ),
        (LoadingCurve(load=np.ones(5), indentation=np.arange(5.0), area=np.ones(5)), "contact area falls"),
    ],
)
def test_insufficient_curves_refused(curve: LoadingCurve, message: str) -> None:
    with pytest.raises(FitError, match=message):
        fit_contact_compliance(curve)


def test_the_line_is_that_of_least_squares() -> None:
    curve = simulated(np.random.default_rng(3), count=12, noise=0.02)
    design = np.stack([np.pi * curve.indentation, np.ones(12)], axis=-1)
    parts, (squares,), *_ = np.linalg.lstsq(design, curve.area)
    covariance = squares / (12 - 2) * np.linalg.inv(design.T @ design)
    fit = fit_contact_compliance(curve)
    assert_allclose([fit.loading_radius, fit.area_at_zero], parts)
    assert_allclose(fit.loading_radius_std, np.sqrt(covariance[0, 0]))
    assert_allclose(fit.residual_std, np.sqrt(squares / 10))
    assert fit.count == 12


def test_three_points_are_the_fewest_for_a_line() -> None:
    values = np.array([1.0, 2.0, 3.0])
    assert fit_contact_compliance(LoadingCurve(load=values, indentation=values, area=values)).count == 3
    with pytest.raises(FitError, match="2 points under load"):
        fit_contact_compliance(LoadingCurve(load=values - 1, indentation=values, area=values))
