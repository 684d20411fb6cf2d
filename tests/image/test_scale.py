"""Scale: constructors against each other, and what they refuse."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fingerpad.exceptions import CalibrationError
from fingerpad.image import Picture, Scale, measure_contact_image
from fingerpad.simulate import render_contact_image


def test_500_ppi_is_the_fingerprint_standards_pixel():
    assert Scale.of_ppi(500).mm_per_px == pytest.approx(0.0508)


@given(st.floats(1, 1e4), st.floats(0, 0.1))
def test_constructors_agree(ppi, relative):
    by_ppi = Scale.of_ppi(ppi, ppi * relative)
    inch = Scale.of_line(25.4, (3.0, 4.0), (3.0, 4.0 + ppi), length_mm_std=25.4 * relative)
    assert by_ppi.mm_per_px == pytest.approx(inch.mm_per_px, rel=1e-9)
    assert by_ppi.relative_std == pytest.approx(inch.relative_std, abs=1e-12)


def test_line_length_is_measured_along_the_line():
    assert Scale.of_line(10, (0, 0), (30, 40)).mm_per_px == pytest.approx(0.2)


def test_careless_ends_make_the_scale_uncertain():
    careful = Scale.of_line(10, (0, 0), (0, 100), point_px_std=0.1)
    careless = Scale.of_line(10, (0, 0), (0, 100), point_px_std=1.0)
    assert careless.relative_std == pytest.approx(10 * careful.relative_std)


@pytest.mark.parametrize("bad", [0, -1, math.nan, math.inf, -math.inf])
@pytest.mark.parametrize(
    "make",
    [
        Scale.of_ppi,
        Scale,
        lambda value: Scale(mm_per_px=value),
        lambda value: Scale.of_line(value, (0, 0), (0, 9)),
    ],
)
def test_impossible_scales_are_refused(make, bad):
    with pytest.raises(CalibrationError, match=r"positive and finite, found"):
        make(bad)


@pytest.mark.parametrize("bad", [-1, math.nan, math.inf])
def test_impossible_uncertainties_are_refused(bad):
    with pytest.raises(CalibrationError, match="ppi_std"):
        Scale.of_ppi(500, bad)
    with pytest.raises(CalibrationError, match="mm_per_px_std"):
        Scale(0.05, bad)


def test_a_line_without_length_is_refused():
    with pytest.raises(CalibrationError, match="two different ends"):
        Scale.of_line(10, (5, 5), (5, 5))


def test_a_line_to_nowhere_is_refused():
    with pytest.raises(CalibrationError, match="end"):
        Scale.of_line(10, (5, 5), (5, math.nan))


def picture(ppi, pixels=None):
    return Picture(pixels=np.zeros((9, 9), np.uint8) if pixels is None else pixels, dots_per_inch=ppi)


def test_a_files_own_resolution():
    scale = Scale.of_picture(picture(500))
    assert scale.mm_per_px == pytest.approx(0.0508)
    # Half a dot per inch either way, rectangular.
    assert scale.relative_std == pytest.approx(0.5 / math.sqrt(3) / 500)


@pytest.mark.parametrize(
    ("ppi", "words"), [(None, "states no resolution"), (72, "72 dots"), (96.0, "96 dots")]
)
def test_no_resolution_and_placeholders_are_refused(ppi, words):
    with pytest.raises(CalibrationError, match=words):
        Scale.of_picture(picture(ppi))


def test_a_files_wrong_resolution_makes_the_print_doubtful():
    pixels = render_contact_image(semi_major=7, semi_minor=6, seed=1).pixels
    for ppi, doubtful in ((500, False), (1200, True), (150, True)):
        contact_image = measure_contact_image(pixels, Scale.of_picture(picture(ppi, pixels)))
        assert ("scale_doubtful" in contact_image.flags) == doubtful
