"""Scale: constructors against each other, and what they refuse."""

import math
from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fingerpad.exceptions import CalibrationError
from fingerpad.image import Picture, Scale


@given(st.floats(1, 1e4), st.floats(0, 0.1))
def test_constructors_agree(ppi, relative):
    by_ppi = Scale.of_ppi(ppi, ppi * relative)
    inch = Scale.of_line(25.4, (3.0, 4.0), (3.0, 4.0 + ppi), length_mm_std=25.4 * relative)
    assert by_ppi.mm_per_px == pytest.approx(inch.mm_per_px, rel=1e-9)
    assert by_ppi.relative_std == pytest.approx(inch.relative_std, abs=1e-12)


def test_length_of_a_line_between_other_places():
    scale = Scale.of_line(50.0, (0, 0), (300, 400), length_mm_std=0.5)
    # The line itself, to what it was given.
    assert scale.length((0, 0), (300, 400)) == (pytest.approx(50.0), pytest.approx(0.5))
    assert scale.length((7, 7), (7, 7), point_px_std=1.0) == (0.0, pytest.approx(math.sqrt(2) * 0.1))
    assert scale.ppi == pytest.approx(254.0)


WRONG = (0, -1, math.nan, math.inf, -math.inf)


def line(length_mm=10.0, end=(0, 9)):
    return Scale.of_line(length_mm, (0, 0), end)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        *(
            (partial(make, bad), "positive and finite, found")
            for make in (Scale.of_ppi, Scale, line)
            for bad in WRONG
        ),
        *((partial(Scale.of_ppi, 500, bad), "ppi_std") for bad in WRONG[1:4]),
        *(
            (partial(Scale, 0.05, bad), "mm_per_px_std must be zero or positive, and finite")
            for bad in WRONG[1:4]
        ),
        (partial(line, end=(0, 0)), "two different ends"),
        (partial(line, end="ab"), "end must be numeric"),
        (partial(line, end=(0, math.nan)), "end"),
        (lambda: Scale.of_picture("print.png"), "as read_image reads it, found str"),
        (lambda: Scale.of_picture(picture(None)), "states no resolution"),
        (lambda: Scale.of_picture(picture(72)), "72 dots"),
        (lambda: Scale.of_picture(picture(96.0)), "96 dots"),
        (lambda: Scale.of_circle(20, ["a", "b", "c"]), "points must be numeric"),
        (lambda: Scale.of_circle(20, [(0, 0), (1, 1)]), "three points"),
        (lambda: Scale.of_circle(20, [(0, 0), (5, 5), (9, 9)]), "three points"),
        (lambda: Scale.of_circle(20, [(0, 0), (0, 0), (9, 3)]), "three points"),
    ],
)
def test_what_is_no_scale_is_refused(make, words):
    with pytest.raises(CalibrationError, match=words):
        make()


def picture(ppi):
    return Picture(pixels=np.zeros((9, 9), np.uint8), dots_per_inch=ppi)


def test_resolution_of_file():
    scale = Scale.of_picture(picture(500))
    assert scale.mm_per_px == pytest.approx(0.0508)
    # Half a dot per inch either way, rectangular.
    assert scale.relative_std == pytest.approx(0.5 / math.sqrt(3) / 500)


def rim(angles, radius=150.0, centre=(200.0, 260.0)):
    return [(centre[0] + radius * math.cos(t), centre[1] + radius * math.sin(t)) for t in angles]


@given(st.floats(0.3, 2.5), st.floats(0.3, 2.5), st.floats(0, 6))
def test_three_points_of_a_circle(first, second, start):
    found = Scale.of_circle(23.25, rim([start, start + first, start + first + second]))
    assert found.mm_per_px == pytest.approx(23.25 / 300, rel=1e-9)
    assert found.mm_per_px_std == 0


@pytest.mark.parametrize("angles", [(0, 2.1, 4.2), (0, 0.5, 1.0), (0, 1.5, 3.5)])
def test_points_by_an_unsteady_hand_scatter_as_the_scale_says(angles):
    rng = np.random.default_rng(2)
    points = np.array(rim(angles))
    found = [Scale.of_circle(20, points + rng.normal(0, 0.5, (3, 2))).mm_per_px for _ in range(2000)]
    stated = Scale.of_circle(20, points, point_px_std=0.5).mm_per_px_std
    assert np.std(found) == pytest.approx(stated, rel=0.07)
    with_diameter = Scale.of_circle(20, points, diameter_mm_std=0.2, point_px_std=0.5)
    assert with_diameter.relative_std == pytest.approx(math.hypot(0.01, stated * 15), rel=1e-6)
