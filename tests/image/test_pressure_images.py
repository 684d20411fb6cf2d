"""Contact images from a pressure field, which shares nothing with the measurement."""

import numpy as np
import pytest
from benchmarks.claims.contact_areas import compare
from benchmarks.truth.pressed_pad import Press, Skin, boundary_of, press_pad
from benchmarks.truth.pressure_images import pressure_image

_RIDGES = {"kind": "whorl", "seed": 0, "growth_periods": 26, "period": 0.45}


def test_the_intervals_hold_areas_and_semi_axes():
    """On one image what `benchmarks.claims.contact_areas` measures on many, of four simulators."""
    found = compare(pressure_image("prism, Hertz pressure", 1, area=45.0, **_RIDGES))
    assert found.held.all()
    assert abs(found.errors[0]) < 0.06
    assert abs(found.errors[1]) < 0.1
    assert not found.flags


def test_the_truth_is_that_of_an_ellipse():
    press = Press(area=30.0, aspect=1.5)
    skin = Skin(**_RIDGES)
    contact = press_pad(press, skin, mm=0.02, shape=(420, 360), rng=np.random.default_rng(0))
    assert np.pi * contact.semi_major * contact.semi_minor == pytest.approx(30.0, rel=1e-9)
    assert contact.semi_major / contact.semi_minor == pytest.approx(1.5, rel=1e-6)
    assert np.abs(boundary_of(press)).max(axis=0) == pytest.approx([contact.semi_minor, contact.semi_major])
    # ∫p dA is the load of the law from which the mean pressure comes.
    load = contact.pressure.sum() * 0.02**2 * 1e-3
    assert load == pytest.approx((30 / 110) ** (1 / 0.45), rel=2e-3)
    assert contact.ridge_area < contact.hull_area < contact.gross_area
    assert not contact.touching[contact.outside > 0].any()
