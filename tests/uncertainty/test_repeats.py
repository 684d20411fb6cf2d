"""Nominal loads, and by how much contacts scatter beyond the noise of their images."""

import numpy as np
import pytest

from fingerpad.uncertainty.repeats import ContactRepeatability, nominal_loads


@pytest.mark.parametrize(
    ("loads", "expected"),
    [
        ([2.0, 0.5, 1.0], [2, 0, 1]),
        ([0.95, 1.0, 1.05], [0, 0, 0]),
        ([1.0, 1.06], [0, 0]),
        ([1.0, 1.12], [0, 1]),
        ([1.0, 1.04, 1.08, 1.12, 1.16], [0, 1, 2, 3, 4]),  # a ramp
        ([1.0, 1.04, 1.08, 1.12, 1.04, 5.0, 5.1], [0, 1, 2, 3, 1, 4, 4]),
        ([], []),
    ],
)
def test_nominal_loads(loads: list[float], expected: list[int]) -> None:
    assert nominal_loads(loads).tolist() == expected


def test_noise_is_not_counted_twice() -> None:
    """What repeats scatter by beyond their noise is theirs; noise alone makes no repeatability."""
    rng, group = np.random.default_rng(3), np.repeat(np.arange(300), 4)
    noise = np.diag([0.02**2, 0.04**2])
    axes = rng.normal(0, (0.02, 0.04), (1200, 2))
    more = axes + rng.normal(0, (0.03, 0.01), (1200, 2))
    alone, both = (ContactRepeatability.of(of, [noise] * 1200, group) for of in (axes, more))
    assert both.area_std == pytest.approx(0.06, rel=0.1)
    assert alone.area_std < 0.02
    assert (both.freedom, both.groups, both.count) == (900, 300, 1200)
