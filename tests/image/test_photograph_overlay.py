"""The photograph's overlay: what is drawn lies where it was measured."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from PIL import Image

from fingerpad.exceptions import ImageError
from fingerpad.image import (
    Scale,
    draw_overlay,
    measure_photograph,
    overlay,
    write_overlay,
)
from fingerpad.image.overlay import POINT_COLOUR, write_text
from fingerpad.simulate import render_finger


@cache
def truth():
    return render_finger("palmar", arc_deg=160, mm_per_px=0.08, seed=2)


@cache
def found():
    return measure_photograph(truth().pixels, "palmar", Scale(0.08))


def near(canvas, colour, tolerance=12):
    return np.abs(canvas.astype(int) - colour).max(axis=-1) < tolerance


def test_points_on_outline():
    canvas = draw_overlay(truth().pixels, found())
    assert canvas.dtype == np.uint8
    assert max(canvas.shape) == 1100
    zoom = canvas.shape[0] / truth().pixels.shape[0]
    place = np.argwhere(near(canvas, POINT_COLOUR))
    place = (place[place[:, 0] > 130] + 0.5) / zoom - 0.5
    true = truth().arc_points(2000)
    away = np.linalg.norm(place[:, None] - true[::10], axis=2).min(axis=1)
    assert len(place) > 500
    assert np.quantile(away, 0.95) < 4 / zoom + 1.5


def test_scale_bar_length():
    canvas = draw_overlay(np.full_like(truth().pixels, 255), found())
    dark = near(canvas[-40:], (20, 20, 20))
    longest = max(int(row.sum()) for row in dark)
    assert longest * 0.08 * truth().pixels.shape[0] / canvas.shape[0] == pytest.approx(5, abs=0.1)


def test_label_and_large_deep_pictures():
    large = np.repeat(np.repeat(truth().pixels.astype(np.uint16) * 257, 3, axis=0), 3, axis=1)
    canvas = draw_overlay(large, found(), label="synthetic")
    assert max(canvas.shape) == 1100
    plain = draw_overlay(large, found())
    changed = np.argwhere((plain != canvas).any(axis=-1))
    assert changed.size
    assert (changed.max(axis=0) < (200, 600)).all()


def test_words_are_plain_and_as_large_as_the_report_needs(monkeypatch):
    written = []

    def write(canvas, text, corner, width, colour=overlay.INK):
        written.append(text)
        write_text(canvas, text, corner, width, colour)

    monkeypatch.setattr(overlay, "write_text", write)
    blank = np.zeros_like(truth().pixels)
    canvas = draw_overlay(blank, replace(found(), flags=frozenset({"not_an_ellipse"})))
    assert "not an ellipse" in written
    assert not any("_" in text for text in written)
    assert sum(" mm" in text and ("±" in text) == (not overlay._ASCII) for text in written) == 2
    # Letters of the first line are at least 7 px high where the picture is 300 px wide.
    rows = np.flatnonzero(near(canvas[: overlay._LINE_PX + 4], overlay.INK, 40).any(axis=1))
    assert np.ptp(rows) * 300 / canvas.shape[1] >= 7


def test_other_picture_refused():
    with pytest.raises(ImageError, match="the photograph that was measured"):
        draw_overlay(truth().pixels[:150], found())


def test_written_file_equals_drawing(tmp_path):
    path = write_overlay(tmp_path / "overlay.png", truth().pixels, found())
    np.testing.assert_array_equal(np.asarray(Image.open(path)), draw_overlay(truth().pixels, found()))
    with pytest.raises(ImageError, match="cannot be written"):
        write_overlay(tmp_path / "overlay.nothing", truth().pixels, found())
