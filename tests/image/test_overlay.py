"""The overlay: what is drawn lies where it was measured."""

import math

import numpy as np
import pytest
from PIL import Image

from fingerpad.exceptions import ImageError
from fingerpad.image import Scale, draw_overlay, measure_contact_image, write_overlay
from fingerpad.image.contact_image.overlay import ELLIPSE_COLOUR
from fingerpad.simulate import render_contact_image

TRUTH = render_contact_image(seed=1, orientation=0.4)
FOUND = measure_contact_image(TRUTH.pixels, Scale.of_ppi(500))


def near(canvas, colour, tolerance=40):
    return np.abs(canvas.astype(int) - colour).max(axis=-1) < tolerance


def test_small_images_enlarged():
    canvas = draw_overlay(TRUTH.pixels, FOUND)
    assert canvas.dtype == np.uint8
    zoom = canvas.shape[0] // TRUTH.pixels.shape[0]
    assert canvas.shape == (zoom * TRUTH.pixels.shape[0], zoom * TRUTH.pixels.shape[1], 3)
    assert max(canvas.shape) >= 1000


def test_ellipse_position():
    canvas = draw_overlay(TRUTH.pixels, FOUND, ridge_tint=0)
    zoom = canvas.shape[0] // TRUTH.pixels.shape[0]
    place = np.argwhere(near(canvas, ELLIPSE_COLOUR)) / zoom - np.array(FOUND.centroid)
    tip = place[np.linalg.norm(place, axis=1).argmax()]
    length = np.linalg.norm(tip) * TRUTH.mm_per_px
    assert length == pytest.approx(float(FOUND.ellipse.semi_major), abs=0.15)
    # Leaning left when positive: up and left, or down and right, go together.
    assert math.sin(math.atan2(tip[1], tip[0]) - FOUND.orientation) == pytest.approx(0, abs=0.03)


def test_scale_bar_length():
    white = np.full_like(TRUTH.pixels, 255)
    canvas = draw_overlay(white, FOUND, ridge_tint=0)
    zoom = canvas.shape[0] // TRUTH.pixels.shape[0]
    dark = near(canvas[-40:], (20, 20, 20), 10)
    longest = max(sum(row) for row in dark)
    assert longest * TRUTH.mm_per_px / zoom == pytest.approx(2, abs=0.05)


def test_label_in_corner():
    plain, labelled = draw_overlay(TRUTH.pixels, FOUND), draw_overlay(TRUTH.pixels, FOUND, label="synthetic")
    changed = np.argwhere((plain != labelled).any(axis=-1))
    assert changed.size
    assert (changed.max(axis=0) < np.array(plain.shape[:2]) / 2).all()


@pytest.mark.parametrize("dtype", [np.uint16, np.float32])
def test_overlay_independent_of_depth(dtype):
    deep = TRUTH.pixels.astype(dtype) * 257
    off = draw_overlay(deep, FOUND).astype(int) - draw_overlay(TRUTH.pixels, FOUND)
    assert np.abs(off).mean() < 8


def test_written_file_equals_drawing(tmp_path):
    path = write_overlay(tmp_path / "overlay.png", TRUTH.pixels, FOUND, label="synthetic")
    np.testing.assert_array_equal(
        np.asarray(Image.open(path)), draw_overlay(TRUTH.pixels, FOUND, label="synthetic")
    )


def test_other_picture_refused():
    with pytest.raises(ImageError, match="shape"):
        draw_overlay(TRUTH.pixels[5:], FOUND)


@pytest.mark.parametrize("name", ["none/overlay.png", "overlay.unknown"])
def test_unwritable_path(tmp_path, name):
    with pytest.raises(ImageError, match="cannot be written"):
        write_overlay(tmp_path / name, TRUTH.pixels, FOUND)
