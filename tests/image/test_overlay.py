"""The overlay: what is drawn lies where it was measured."""

import math
from functools import cache

import numpy as np
import pytest
from PIL import Image

from fingerpad.exceptions import ImageError
from fingerpad.image import Scale, draw_overlay, measure_contact_image, write_overlay
from fingerpad.image.overlay import ELLIPSE_COLOUR
from fingerpad.simulate import render_contact_image


@cache
def truth():
    return render_contact_image(seed=1, orientation=0.4)


@cache
def found():
    return measure_contact_image(truth().pixels, Scale.of_ppi(500))


def near(canvas, colour, tolerance=40):
    return np.abs(canvas.astype(int) - colour).max(axis=-1) < tolerance


def test_small_images_enlarged():
    canvas = draw_overlay(truth().pixels, found())
    assert canvas.dtype == np.uint8
    zoom = canvas.shape[0] // truth().pixels.shape[0]
    assert canvas.shape == (zoom * truth().pixels.shape[0], zoom * truth().pixels.shape[1], 3)
    assert max(canvas.shape) >= 1000


def test_ellipse_position():
    canvas = draw_overlay(truth().pixels, found())
    zoom = canvas.shape[0] // truth().pixels.shape[0]
    place = np.argwhere(near(canvas, ELLIPSE_COLOUR)) / zoom - np.array(found().centroid)
    tip = place[np.linalg.norm(place, axis=1).argmax()]
    length = np.linalg.norm(tip) * truth().mm_per_px
    assert length == pytest.approx(float(found().ellipse.semi_major), abs=0.15)
    # Tilted left when positive: up and left, or down and right, go together.
    assert math.sin(math.atan2(tip[1], tip[0]) - found().orientation) == pytest.approx(0, abs=0.03)


def test_scale_bar_length():
    white = np.full_like(truth().pixels, 255)
    canvas = draw_overlay(white, found())
    zoom = canvas.shape[0] // truth().pixels.shape[0]
    dark = near(canvas[-40:], (20, 20, 20), 10)
    longest = max(sum(row) for row in dark)
    assert longest * truth().mm_per_px / zoom == pytest.approx(2, abs=0.05)


def test_label_in_corner():
    plain, labelled = (
        draw_overlay(truth().pixels, found()),
        draw_overlay(truth().pixels, found(), label="synthetic"),
    )
    changed = np.argwhere((plain != labelled).any(axis=-1))
    assert changed.size
    assert (changed.max(axis=0) < np.array(plain.shape[:2]) / 2).all()


@pytest.mark.parametrize("dtype", [np.uint16, np.float32])
def test_overlay_independent_of_depth(dtype):
    deep = truth().pixels.astype(dtype) * 257
    off = draw_overlay(deep, found()).astype(int) - draw_overlay(truth().pixels, found())
    assert np.abs(off).mean() < 8


def test_written_file_equals_drawing(tmp_path):
    path = write_overlay(tmp_path / "overlay.png", truth().pixels, found(), label="synthetic")
    np.testing.assert_array_equal(
        np.asarray(Image.open(path)), draw_overlay(truth().pixels, found(), label="synthetic")
    )


def test_other_picture_refused():
    with pytest.raises(ImageError, match="shape"):
        draw_overlay(truth().pixels[5:], found())


@pytest.mark.parametrize("name", ["none/overlay.png", "overlay.unknown"])
def test_unwritable_path(tmp_path, name):
    with pytest.raises(ImageError, match="cannot be written"):
        write_overlay(tmp_path / name, truth().pixels, found())


def test_scale_of_a_small_contact():
    small = render_contact_image(semi_major=1.2, semi_minor=1.0, ppi=300, seed=2)
    # The pixels inside the outline differ from its area by as much as their number is small.
    assert measure_contact_image(small.pixels, Scale.of_ppi(300)).mm_per_px == Scale.of_ppi(300).mm_per_px
