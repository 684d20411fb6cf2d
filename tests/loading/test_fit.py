"""R_g from simulated curves of known truth."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fingerpad.contact import Tissue, hertz_contact
from fingerpad.exceptions import FitError, LoadingError
from fingerpad.geometry import Paraboloid
from fingerpad.loading import LoadingCurve, find_cycles, fit_contact_compliance
from fingerpad.simulate import simulate_loading_curve

BODIES = Paraboloid(12.955, 14.330)
TRUE_RADIUS = float(hertz_contact(BODIES, Tissue(0.1), load=1.0).area_over_pi_indentation)


def simulated(
    rng: np.random.Generator, *, count: int = 40, noise: float = 0.0, offset: float = 0.0
) -> LoadingCurve:
    # A modulus that grows with load: R_g must not notice.
    load = np.linspace(0.05, 4, count)
    contact = hertz_contact(BODIES, Tissue(0.05 + 0.02 * load), load=load)
    area = contact.area * (1 + noise * rng.standard_normal(count))
    return LoadingCurve(load=load, indentation=contact.indentation + offset, area=area)


def test_equivalent_radius_at_any_displacement_zero() -> None:
    for offset in (0.0, 0.7, -3.0):
        fit = fit_contact_compliance(simulated(np.random.default_rng(0), offset=offset))
        assert_allclose(fit.value, TRUE_RADIUS, rtol=1e-12)


@pytest.mark.parametrize("approach", [0.1, 0.6, 6.0])
@pytest.mark.parametrize("force_offset", [0.0, 0.05])
def test_rows_before_contact_do_not_count(approach: float, force_offset: float) -> None:
    """Their force is noise, above or below zero, and their area is none."""
    given = {"points": 200, "approach": approach, "force_offset": force_offset}
    noise = {"force_std": 0.005, "area_std": 0.5}
    found = [
        fit_contact_compliance(simulate_loading_curve(**given, **noise, seed=seed)) for seed in range(10)
    ]
    errors = np.array([(one.value - 15) / one.std for one in found])
    assert abs(errors.mean()) < 1
    assert np.sqrt(np.mean(errors**2)) < 1.6


def test_the_way_out_and_other_presses_do_not_count() -> None:
    curve = simulate_loading_curve(points=900, cycles=3, hold=0.5, unloading=True, area_std=0.5, seed=3)
    third = np.arange(900) // 300
    spoiled = replace(curve, area=np.where(third == 1, curve.area, 2 * curve.area))
    assert abs(fit_contact_compliance(spoiled, cycle=1).value - 15) < 0.2
    assert abs(fit_contact_compliance(spoiled, cycle=2).value - 30) < 0.4
    with pytest.raises(LoadingError, match="the record has 3 cycles, numbered from 0; there is no 3"):
        fit_contact_compliance(spoiled, cycle=3)


@pytest.mark.parametrize(
    ("area", "message"),
    [(None, "no contact area"), (-np.arange(9.0), "contact area falls"), (np.ones(9), "contact area falls")],
)
def test_insufficient_curves_refused(area: np.ndarray | None, message: str) -> None:
    depth = np.arange(9.0)
    with pytest.raises(FitError, match=message):
        fit_contact_compliance(LoadingCurve(load=depth**1.5, indentation=depth, area=area))


def test_the_line_is_that_of_least_squares() -> None:
    curve = simulated(np.random.default_rng(3), count=12, noise=0.02)
    fit = fit_contact_compliance(curve)
    last = find_cycles(curve)[0].loading.stop
    lines = [line_through(curve, slice(last - count, last)) for count in range(8, 13)]
    assert any(np.allclose([fit.value, fit.std], line) for line in lines)


def line_through(curve: LoadingCurve, rows: slice) -> tuple[float, float]:
    """Return the slope of area against πξ, and its standard uncertainty from the residuals."""
    x = np.pi * curve.indentation[rows]
    design = np.stack([x, np.ones_like(x)], axis=-1)
    parts, (squares,), *_ = np.linalg.lstsq(design, curve.area[rows])
    covariance = squares / (x.size - 2) * np.linalg.inv(design.T @ design)
    return parts[0], np.sqrt(covariance[0, 0])


def test_three_rows_in_contact_are_the_fewest_for_a_line() -> None:
    depth = np.array([-3.0, -2, -1, 0, 1.2, 2])
    curve = LoadingCurve(load=np.maximum(depth, 0) ** 1.5, indentation=depth, area=np.maximum(depth, 0))
    with pytest.raises(FitError, match="[12] rows in contact while the load grows; at least 3"):
        fit_contact_compliance(curve)
