"""Limits and published series of the contacts that benchmarks take for the truth."""

import numpy as np
import pytest
from benchmarks.truth.layers import circular_contacts
from benchmarks.truth.loading_physics import (
    Pad,
    coloured_noise,
    ellipsoid,
    exact_sphere,
    hertz,
    layer,
    pink,
)
from scipy.interpolate import CubicSpline

PAD = Pad(radius=15.0, modulus=0.04)


def layer_ratios(a, nodes=48):
    load, indentation, _ = circular_contacts([a], 0.5, nodes)[0]
    return indentation, load


@pytest.mark.parametrize("chi", [0.05, 0.15, 0.25])
def test_a_layer_agrees_with_the_series_of_garcia_and_garcia(chi):
    """García & García (2018), a bonded incompressible layer, χ = √(Rξ)/t."""
    a = np.linspace(0.01, 0.4, 12)
    indentation, load = np.array([layer_ratios(one) for one in a]).T
    factor = CubicSpline(a * np.sqrt(indentation), load / indentation**1.5)(chi)
    series = 1 + 1.133 * chi + 1.497 * chi**2 + 1.469 * chi**3 + 0.755 * chi**4
    assert factor == pytest.approx(series, rel=2e-3)


@pytest.mark.parametrize(("a", "area", "load"), [(0.1, 1.086, 1.0), (0.5, 1.447, 1.07), (2.0, 2.20, 2.55)])
def test_a_layer_agrees_with_a_boundary_element_solution(a, area, load):
    """A/(πRξ), and the load over Hertz's at the same area, of a coarse grid (within 2 %)."""
    assert layer_ratios(a) == pytest.approx((1 / area, load), rel=0.02)
    assert layer_ratios(a) == pytest.approx(layer_ratios(a, 80), rel=1e-8)
    assert layer_ratios(1e-3) == pytest.approx((1, 1), abs=2e-3)


@pytest.mark.parametrize("contact", [exact_sphere, layer(1e4), ellipsoid(1.001)])
def test_contacts_become_that_of_hertz(contact):
    loads = np.array([0.002, 0.01])
    for column in (0, 2):
        of = [np.interp(loads, found[1], found[column]) for found in (contact(PAD, 0.02), hertz(PAD, 0.02))]
        assert of[0] == pytest.approx(of[1], rel=0.01)


def test_pink_noise_has_the_same_power_in_each_octave():
    rng = np.random.default_rng(3)
    noise = np.array([coloured_noise(rng, 512, 0.01, pink) for _ in range(300)])
    assert noise.std(axis=1).mean() == pytest.approx(1, abs=0.1)
    power = (np.abs(np.fft.rfft(noise * np.hanning(512))) ** 2).mean(axis=0)
    octaves = [power[2**k : 2 ** (k + 1)].sum() for k in range(2, 8)]
    assert max(octaves) / min(octaves) < 1.3
