"""Pictures and arguments that nothing can be measured on: an error that names them, no traceback."""

from contextlib import suppress
from functools import cache

import numpy as np
import pytest

from fingerpad import image
from fingerpad.exceptions import FingerpadError, ImageError
from fingerpad.simulate import render_contact_image, render_finger

SCALE = image.Scale.of_ppi(500)
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
    return image.measure_contact_image(contact(), SCALE)


@cache
def finger():
    return render_finger("palmar", semi_axes=(8.0, 9.0), mm_per_px=0.05, seed=1).pixels


@pytest.mark.parametrize("name", PICTURES)
@pytest.mark.parametrize("dark_on_light", [None, False])
def test_pictures_without_a_contact(name, dark_on_light):
    with pytest.raises(ImageError):
        image.measure_contact_image(PICTURES[name], SCALE, dark_on_light=dark_on_light)


@pytest.mark.parametrize("name", PICTURES)
def test_pictures_of_nothing(name):
    for measure in (
        image.guess_subject,
        image.measure_coin,
        lambda picture: image.measure_grid(picture, (3, 3), 1.0),
        lambda picture: image.draw_overlay(picture, whole_contact()),
        lambda picture: image.measure_contact_image(picture, SCALE, surface="smooth"),
    ):
        with suppress(FingerpadError):  # a guess may be made of any picture, but no other error raised
            measure(PICTURES[name])


@pytest.mark.parametrize("name", PICTURES)
def test_pictures_without_a_finger(name):
    with pytest.raises(FingerpadError):
        image.measure_photograph(PICTURES[name], "palmar", SCALE)


@pytest.mark.parametrize("name", [name for name in PICTURES if name != "ragged"])
def test_frames_without_a_contact(name):
    frames = [image.Frame(index=0, pixels=np.asarray(PICTURES[name]))]
    with pytest.raises(ImageError, match="no frame can be read|no contact found"):
        list(image.measure_sequence(frames, SCALE))


@pytest.mark.parametrize("region", REGIONS, ids=lambda region: str(region)[:20])
def test_invalid_regions(region):
    frames = [image.Frame(index=0, pixels=contact())]
    for measure in (
        lambda: image.measure_contact_image(contact(), SCALE, region_of_interest=region),
        lambda: list(image.measure_sequence(frames, SCALE, region_of_interest=region)),
    ):
        with pytest.raises(ImageError, match="region_of_interest"):
            measure()
    with pytest.raises(FingerpadError, match="region_of_interest"):
        image.measure_photograph(finger(), "palmar", SCALE, region_of_interest=region)


@pytest.mark.parametrize(
    ("argument", "value"),
    [
        *(
            (name, value)
            for name in ("threshold", "contrast", "ridge_period")
            for value in (0, np.nan, 1e300, 1e-300, "x", 10**400)
        ),
        *(("ridge_period", value) for value in (1e9, 100.0)),  # larger than the picture
        *(("seed", value) for value in ((1e300, 0), (np.nan, 1), (5,), 5, "ab", (None, None))),
        *(
            ("mask", value)
            for value in ([], [(0, 0), (1e300, 0), (0, 1e300)], [(np.nan, 0), (5, 5), (0, 5)], "x")
        ),
        *(("background", level) for level in (0.0, 1e-300, np.nan)),
    ],
    ids=lambda value: str(value)[:20],
)
def test_invalid_options(argument, value):
    value = np.full(contact().shape, value) if argument == "background" else value
    with pytest.raises(ImageError, match=argument):
        image.measure_contact_image(contact(), SCALE, **{argument: value})


def test_overlay_of_very_large_picture_is_reduced():
    tall = np.full((9000, contact().shape[1]), contact()[0, 0], np.uint8)
    tall[4000 : 4000 + len(contact())] = contact()
    found = image.measure_contact_image(tall, SCALE)
    canvas = image.draw_overlay(tall, found)
    assert max(canvas.shape) == 8000
    assert canvas.shape[1] == round(contact().shape[1] * 8000 / 9000)
