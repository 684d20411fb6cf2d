"""Pictures and arguments that nothing can be measured on: an error that names them, no traceback."""

from contextlib import suppress
from functools import cache

import numpy as np
import pytest

from fingerpad.exceptions import FingerpadError, ImageError, LoadingError
from fingerpad.image import (
    Frame,
    Scale,
    draw_overlay,
    ellipse_of_polygon,
    fit_aligned_ellipse,
    fit_ellipse,
    guess_subject,
    measure_coin,
    measure_contact_image,
    measure_grid,
    measure_photograph,
    measure_sequence,
    phase_intervals,
    phases_of,
)
from fingerpad.simulate import render_contact_image, render_finger

SCALE = Scale.of_ppi(500)
RNG = np.random.default_rng(0)
PICTURES = {
    "3 × 3": RNG.integers(0, 255, (3, 3)).astype(np.uint8),
    "one row": RNG.integers(0, 255, (1, 300)).astype(np.uint8),
    "one column": RNG.integers(0, 255, (300, 1)).astype(np.uint8),
    "none": np.zeros((0, 0)),
    "one level": np.full((100, 100), 7, np.uint8),
    "nan": np.full((100, 100), np.nan),
    "infinite": np.full((50, 50), np.inf),
    "beyond single precision": RNG.random((100, 100)) * 1e308,
    "squares beyond single precision": RNG.random((100, 100)) * 1e38,
    "below single precision": RNG.random((100, 100)) * 1e-300,
    "nearly one level": RNG.random((100, 100)) * 1e-40,
    "text": np.array([["a"] * 40] * 40),
    "complex": np.ones((40, 40), complex),
    "ragged": [[1, 2], [3]],
    "one dimension": np.zeros(5),
    "number": 3,
}
REGIONS = [
    (1e300, 0, 5, 5),
    (np.nan, 0, 50, 50),
    (5, 5, 0, 0),
    (0, 0, 3, 3),
    (1, 2, 3),
    (None,) * 4,
    "abcd",
    5,
    (10**400, 0, 5, 5),
]


@cache
def contact():
    return render_contact_image(semi_major=4.0, semi_minor=3.0, seed=3).pixels


@cache
def whole_contact():
    return measure_contact_image(contact(), SCALE)


@cache
def finger():
    return render_finger("palmar", semi_axes=(8.0, 9.0), mm_per_px=0.05, seed=1).pixels


@pytest.mark.parametrize("name", PICTURES)
@pytest.mark.parametrize("dark_on_light", [None, False])
def test_pictures_without_a_contact(name, dark_on_light):
    with pytest.raises(ImageError):
        measure_contact_image(PICTURES[name], SCALE, dark_on_light=dark_on_light)


@pytest.mark.parametrize("name", PICTURES)
def test_pictures_of_nothing(name):
    for measure in (
        guess_subject,
        measure_coin,
        lambda picture: measure_grid(picture, (3, 3), 1.0),
        lambda picture: draw_overlay(picture, whole_contact()),
        lambda picture: measure_contact_image(picture, SCALE, surface="smooth"),
    ):
        with suppress(FingerpadError):  # a guess may be made of any picture, but no other error raised
            measure(PICTURES[name])


@pytest.mark.parametrize(
    ("time", "values"), [([0, 1], [1]), ([1, 0], [0, 1]), ([0, 1], [0, np.nan]), ("ab", [0, 1]), (0, 1)]
)
def test_invalid_records_of_phases(time, values):
    with pytest.raises(LoadingError, match="time|values"):
        phases_of(time, values)


@pytest.mark.parametrize("fit", [fit_ellipse, fit_aligned_ellipse, ellipse_of_polygon])
def test_outlines_of_no_numbers(fit):
    with pytest.raises(FingerpadError, match="must be numeric, found 'abc'"):
        fit("abc")


def test_no_record_has_no_phases():
    assert phases_of([], []).size == 0
    assert phase_intervals([], []).phase == ()


@pytest.mark.parametrize("name", PICTURES)
def test_pictures_without_a_finger(name):
    with pytest.raises(FingerpadError):
        measure_photograph(PICTURES[name], "palmar", SCALE)


@pytest.mark.parametrize("name", [name for name in PICTURES if name != "ragged"])
def test_frames_without_a_contact(name):
    frames = [Frame(index=0, pixels=np.asarray(PICTURES[name]))]
    with pytest.raises(ImageError, match="no frame can be read|no contact found"):
        list(measure_sequence(frames, SCALE))


@pytest.mark.parametrize("region", REGIONS, ids=lambda region: str(region)[:20])
def test_invalid_regions(region):
    frames = [Frame(index=0, pixels=contact())]
    for measure in (
        lambda: measure_contact_image(contact(), SCALE, region_of_interest=region),
        lambda: list(measure_sequence(frames, SCALE, region_of_interest=region)),
    ):
        with pytest.raises(ImageError, match="region_of_interest"):
            measure()
    with pytest.raises(FingerpadError, match="region_of_interest"):
        measure_photograph(finger(), "palmar", SCALE, region_of_interest=region)


@pytest.mark.parametrize(
    ("argument", "value"),
    [
        *(
            (name, value)
            for name in ("threshold", "contrast", "ridge_period")
            for value in (0, np.nan, 1e300, 1e-300, "x", 10**400)
        ),
        *(("seed", value) for value in ((1e300, 0), (np.nan, 1), (5,), 5, "ab", (None, None))),
        *(
            ("mask", value)
            for value in ([], [(0, 0), (1e300, 0), (0, 1e300)], [(np.nan, 0), (5, 5), (0, 5)], "x")
        ),
        ("background", np.zeros(contact().shape)),
        ("background", np.full(contact().shape, 1e-300)),
        ("background", np.full(contact().shape, np.nan)),
    ],
    ids=lambda value: str(value)[:20],
)
def test_invalid_options(argument, value):
    with pytest.raises(ImageError, match=argument):
        measure_contact_image(contact(), SCALE, **{argument: value})


@pytest.mark.parametrize("ridge_period", [1e9, 100.0])
def test_ridge_period_larger_than_picture(ridge_period):
    with pytest.raises(ImageError, match="check scale and ridge_period"):
        measure_contact_image(contact(), SCALE, ridge_period=ridge_period)


@pytest.mark.parametrize(
    "points", ["x", [(0, 0)], [(np.nan, 0), (5, 5)], [(1e300, 0), (5, 5)], [(10**400, 0), (5, 5)]]
)
def test_invalid_marks(points):
    with pytest.raises(ImageError, match="points"):
        measure_photograph(finger(), "palmar", SCALE, points=points)


def test_overlay_of_very_large_picture_is_reduced():
    tall = np.full((9000, contact().shape[1]), contact()[0, 0], np.uint8)
    tall[4000 : 4000 + len(contact())] = contact()
    found = measure_contact_image(tall, SCALE)
    canvas = draw_overlay(tall, found)
    assert max(canvas.shape) == 8000
    assert canvas.shape[1] == round(contact().shape[1] * 8000 / 9000)
