"""The place of first contact of a press, from force and displacement."""

import numpy as np
import pytest

from fingerpad.exceptions import LoadingError
from fingerpad.image import ForceSignal
from fingerpad.loading.contact_point import first_contact


def displacement_of(signal: ForceSignal) -> float:
    return first_contact(signal.time, signal.load, signal.displacement)


def press(approach: float, rows: int = 400, noise: float = 0.0, exponent: float = 1.5) -> ForceSignal:
    """A platen that starts so far above the pad, whose surface is at 3 mm, presses it and goes back."""
    depth = np.interp(np.linspace(0, 1, rows), [0, 0.5, 0.7, 1], [-approach, 1.5, 1.5, -approach])
    load = 1.1 * np.maximum(depth, 0) ** exponent + np.random.default_rng(1).normal(0, noise, rows)
    return ForceSignal(np.linspace(0, 5, rows), load, displacement=3 + depth)


@pytest.mark.parametrize(("noise", "off"), [(0.0, 0.02), (0.005, 0.02), (0.02, 0.05)])
def test_contact_is_where_the_force_begins_to_rise(noise: float, off: float) -> None:
    for approach in (0.1, 0.5, 2.0):
        assert displacement_of(press(approach, noise=noise)) == pytest.approx(3, abs=off)
    # A pad that stiffens faster or more slowly than a sphere.
    assert displacement_of(press(0.5, noise=noise, exponent=1.8)) == pytest.approx(3, abs=2 * off + 0.05)


@pytest.mark.parametrize(
    ("signal", "words"),
    [
        (press(-0.3), "the record begins in contact"),
        (press(0.5, rows=12), "after 5 rows; 6 are needed"),
        (ForceSignal([0, 1], [0, 1]), "no displacement was recorded"),
    ],
)
def test_without_an_approach_contact_is_unknown(signal: ForceSignal, words: str) -> None:
    with pytest.raises(LoadingError, match=words):
        displacement_of(signal)
