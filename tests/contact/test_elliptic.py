"""Elliptic integrals and contact functions against mpmath, SciPy and printed numbers."""

import mpmath as mp
import numpy as np
import pytest
from numpy.testing import assert_allclose

from fingerpad.contact import complete_integrals, indentation_factor, size_factor
from fingerpad.contact.elliptic import curvature_ratio

RATIOS = np.concatenate([[1.0, 1 - 1e-16, 1 - 1e-12, 1 - 1e-6], np.geomspace(1e-12, 0.999, 40)])


@pytest.mark.parametrize("k", RATIOS)
def test_integrals_agree_with_mpmath(k: float) -> None:
    with mp.workdps(90):
        m = 1 - mp.mpf(k) ** 2
        K, E = mp.ellipk(m), mp.ellipe(m)
        D = (K - E) / m if m else mp.pi / 4
        exact = (K, K - D, D)
        found = complete_integrals(k)
        for value, reference in zip(found, exact, strict=True):
            assert abs(mp.mpf(float(value)) / reference - 1) <= 1e-15


@pytest.mark.parametrize(
    ("axes", "K", "E", "F1", "F2"),
    [
        ((5.3, 4.2), 1.758597354, 1.412511757, 0.998314185, 0.998311346),
        ((7.4, 5.0), 1.892759475, 1.328427072, 0.995238751, 0.995216154),
    ],
)
def test_published_ellipses(axes: tuple[float, float], K: float, E: float, F1: float, F2: float) -> None:
    k = axes[1] / axes[0]
    first, b, d = complete_integrals(k)
    assert_allclose([first, b + k**2 * d], [K, E], atol=6e-10)
    assert_allclose([size_factor(k), indentation_factor(k)], [F1, F2], atol=6e-10)


@pytest.mark.parametrize("function", [size_factor, indentation_factor, curvature_ratio])
def test_nan_outside_domain(function) -> None:
    values = function([0.5, 0.0, -1.0, 1.5, np.nan])
    assert np.isfinite(values).tolist() == [True, False, False, False, False]
