"""Overlays of contacts and of photographs: what is drawn lies where it was measured."""

import math
from functools import cache

import numpy as np
import pytest
from PIL import Image

from fingerpad.exceptions import ImageError
from fingerpad.image import (
    Scale,
    draw_overlay,
    measure_contact_image,
    measure_photograph,
    read_image,
    write_overlay,
)
from fingerpad.image.overlay import ELLIPSE_COLOUR, POINT_COLOUR, draw_scale_bar
from fingerpad.simulate import render_contact_image, render_finger


@cache
def contact():
    truth = render_contact_image(seed=1, orientation=0.4)
    return truth, measure_contact_image(truth.pixels, Scale.of_ppi(500))


@cache
def photograph():
    truth = render_finger("palmar", arc_deg=160, mm_per_px=0.08, seed=2)
    return truth, measure_photograph(truth.pixels, "palmar", Scale(0.08))


both = pytest.mark.parametrize("made", [contact, photograph])


def near(canvas, colour, tolerance=12):
    return np.abs(canvas.astype(int) - colour).max(axis=-1) < tolerance


def test_ellipse_position():
    truth, found = contact()
    canvas = draw_overlay(truth.pixels, found)
    zoom = canvas.shape[0] // truth.pixels.shape[0]
    assert canvas.dtype == np.uint8
    assert canvas.shape == (zoom * truth.pixels.shape[0], zoom * truth.pixels.shape[1], 3)
    assert max(canvas.shape) >= 1000  # a small image is enlarged
    place = np.argwhere(near(canvas, ELLIPSE_COLOUR, 40)) / zoom - np.array(found.centroid)
    tip = place[np.linalg.norm(place, axis=1).argmax()]
    length = np.linalg.norm(tip) * truth.mm_per_px
    assert length == pytest.approx(float(found.ellipse.semi_major), abs=0.15)
    # Tilted left when positive: up and left, or down and right, go together.
    assert math.sin(math.atan2(tip[1], tip[0]) - found.orientation) == pytest.approx(0, abs=0.03)


def test_points_on_outline():
    truth, found = photograph()
    canvas = draw_overlay(truth.pixels, found)
    assert canvas.dtype == np.uint8
    assert max(canvas.shape) == 1100
    zoom = canvas.shape[0] / truth.pixels.shape[0]
    place = np.argwhere(near(canvas, POINT_COLOUR))
    place = (place[place[:, 0] > 130] + 0.5) / zoom - 0.5
    true = truth.arc_points(2000)
    away = np.linalg.norm(place[:, None] - true[::10], axis=2).min(axis=1)
    assert len(place) > 500
    assert np.quantile(away, 0.95) < 4 / zoom + 1.5


@pytest.mark.parametrize(("made", "length"), [(contact, 2), (photograph, 5)])
def test_scale_bar_length(made, length):
    truth, found = made()
    canvas = draw_overlay(np.full_like(truth.pixels, 255), found)
    longest = near(canvas[-40:], (20, 20, 20)).sum(axis=1).max()
    bar = longest * truth.mm_per_px * truth.pixels.shape[0] / canvas.shape[0]
    assert bar == pytest.approx(length, abs=0.1)


def test_a_scale_bar_where_a_quarter_of_the_width_is_just_below_a_power_of_ten():
    canvas = np.zeros((200, 512, 3), np.uint8)
    draw_scale_bar(canvas, 4 * math.nextafter(0.1, 0) / 512, 2)
    assert canvas.any()


@pytest.mark.parametrize(("made", "within"), [(contact, (500, 500)), (photograph, (200, 600))])
def test_label_in_corner(made, within):
    truth, found = made()
    plain, labelled = (draw_overlay(truth.pixels, found, label=label) for label in (None, "synthetic"))
    changed = np.argwhere((plain != labelled).any(axis=-1))
    assert changed.size
    assert (changed.max(axis=0) < within).all()


@both
def test_a_file_is_drawn_over_as_its_pixels_are(tmp_path, made):
    truth, found = made()
    Image.fromarray(truth.pixels).save(path := tmp_path / "measured.png")
    for same in (path, str(path), read_image(path, colour=True)):
        np.testing.assert_array_equal(draw_overlay(same, found), draw_overlay(truth.pixels, found))


@both
def test_written_file_equals_drawing(tmp_path, made):
    truth, found = made()
    path = write_overlay(tmp_path / "overlay.png", truth.pixels, found, label="synthetic")
    drawn = draw_overlay(truth.pixels, found, label="synthetic")
    np.testing.assert_array_equal(np.asarray(Image.open(path)), drawn)
    for name in ("none/overlay.png", "overlay.unknown"):
        with pytest.raises(ImageError, match="cannot be written"):
            write_overlay(tmp_path / name, truth.pixels, found)


@both
def test_other_picture_refused(made):
    truth, found = made()
    with pytest.raises(ImageError, match=r"shape|the photograph that was measured"):
        draw_overlay(truth.pixels[:150], found)
    with pytest.raises(ImageError, match=r"shape|the photograph that was measured"):
        draw_overlay(np.repeat(truth.pixels, 2, axis=1), found)
    with pytest.raises(ImageError, match="found must be a ContactImageResult or PhotographFit, found str"):
        draw_overlay(truth.pixels, "found")
