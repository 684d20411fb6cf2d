"""A person's edits of a contact region, against rendered contacts whose truth is known."""

import math
from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fingerpad import image
from fingerpad.exceptions import ImageError
from fingerpad.simulate import render_contact_image

PPI_500 = image.Scale.of_ppi(500)
TRUTH = render_contact_image(semi_major=8.0, semi_minor=6.0, margin=4.0, seed=5)
PREPARED = image.prepare_contact_image(TRUTH.pixels, PPI_500)
PLAIN = PREPARED.measure()
CENTRE = PLAIN.centroid


def stroke(action, *points, radius=20):
    return image.BrushStroke(action=action, points=points, radius=radius)


def polygon(action, points):
    return image.RegionPolygon(action=action, points=[tuple(point) for point in points])


def with_smudge():
    """A broad smudge of ridge-like stripes that grows out of the lower right of the contact."""
    pixels = TRUTH.pixels.astype(float)
    rows, columns = np.indices(pixels.shape)
    row, column = CENTRE[0] + 95, CENTRE[1] + 105
    smudge = np.hypot(rows - row, columns - column) < 62
    outside = ~cv2.dilate(PLAIN.region.astype(np.uint8), np.ones((5, 5))).astype(bool)
    stripes = np.where(np.sin(2 * np.pi * columns / 9) > 0, pixels.min(), pixels.max())
    pixels[smudge & outside] = stripes[smudge & outside]
    return pixels


def test_smudge_removed():
    pixels = with_smudge()
    prepared = image.prepare_contact_image(pixels, PPI_500)
    dirty = prepared.measure()
    assert dirty.gross_area > 1.1 * TRUTH.gross_area
    # A person follows the true outline with a small brush, then clears what lies beyond.
    edge = PLAIN.outline
    away = (edge - CENTRE) / np.linalg.norm(edge - CENTRE, axis=1, keepdims=True)
    near = np.linalg.norm(edge - [CENTRE[0] + 95, CENTRE[1] + 105], axis=1) < 80
    strokes = [stroke("remove", *map(tuple, (edge + 12 * away)[near]), radius=12)]
    strokes += [stroke("remove", *map(tuple, (edge + 50 * away)[near][::5]), radius=42)]
    clean = prepared.measure(strokes)
    assert "edited_manually" in clean.flags
    assert abs(clean.gross_area - TRUTH.gross_area) < 2 * clean.gross_area_std
    assert abs(clean.ellipse.semi_major - 8.0) < 2 * clean.semi_major_std
    assert abs(clean.ellipse.semi_minor - 6.0) < 2 * clean.semi_minor_std
    # The hand's own error, besides the place of the edge, which it sees no better than the program.
    assert clean.gross_area_std > PLAIN.gross_area_std
    assert clean.noise_covariance[2, 2] > 1.5 * PLAIN.noise_covariance[2, 2]
    assert clean.edge_offset_std > 0.9 * PLAIN.edge_offset_std
    # What the hand did not touch is where the program put it.
    far = np.linalg.norm(clean.outline - [CENTRE[0] + 95, CENTRE[1] + 105], axis=1) > 140
    off = np.abs(clean.outline[far][:, None] - dirty.outline).sum(axis=2).min(axis=1)
    assert off.max() < 1.5


def test_no_edits_equal_automatic():
    assert PREPARED.measure().as_record() == image.measure_contact_image(TRUTH.pixels, PPI_500).as_record()


@given(radius=st.floats(15, 60), row=st.floats(-60, 60), column=st.floats(-40, 40), other=st.floats(-30, 30))
@settings(max_examples=6)
def test_remove_then_add(radius, row, column, other):
    place = (CENTRE[0] + row, CENTRE[1] + column)
    path = (place, (place[0] + other, place[1]))
    back = PREPARED.measure([stroke("remove", *path, radius=radius), stroke("add", *path, radius=radius)])
    assert back.gross_area == pytest.approx(PLAIN.gross_area, rel=3e-3)


@pytest.mark.parametrize("orientation_deg", [30, -60])
def test_manual_ellipse(orientation_deg):
    hand = image.ImageEllipse(
        centre=(CENTRE[0] + 3.3, CENTRE[1] - 2.6),
        semi_axes=(120.5, 80.25),
        orientation=math.radians(orientation_deg),
    )
    found = PREPARED.measure(ellipse=hand)
    size = PPI_500.mm_per_px
    assert found.ellipse.semi_major == pytest.approx(120.5 * size, rel=1e-3)
    assert found.ellipse.semi_minor == pytest.approx(80.25 * size, rel=1e-3)
    assert found.centroid == pytest.approx(hand.centre, abs=0.01)
    assert math.sin(found.orientation - hand.orientation) == pytest.approx(0, abs=1e-3)
    # A hand knows the edge to a share of a ridge period, not to parts of a pixel.
    assert 0.1 < found.semi_major_std / found.ridge_period < 0.4
    assert found.ridge_area < found.gross_area
    # A manual outline is too wide or too narrow all round: errors of the axes correlate, not fully.
    assert 0.8 < found.covariance[0, 1] / (found.semi_major_std * found.semi_minor_std) < 0.99


def test_manual_contact_where_none_found():
    faint = np.random.default_rng(1).normal(120, 3, (300, 300))
    prepared = image.prepare_contact_image(faint, PPI_500)
    assert "no contact found" in prepared.reason
    with pytest.raises(ImageError, match="no contact found"):
        prepared.measure()
    drawn = prepared.measure(ellipse=image.ImageEllipse(centre=(150, 150), semi_axes=(90, 70)))
    assert drawn.gross_area == pytest.approx(math.pi * 90 * 70 * PPI_500.mm_per_px**2, rel=1e-3)
    painted = prepared.measure([stroke("add", (150, 150), radius=60)])
    assert painted.gross_area == pytest.approx(math.pi * 60**2 * PPI_500.mm_per_px**2, rel=0.02)


def true_outline(count=120):
    """The truth's ellipse, written out: (row, column)."""
    t = np.linspace(0, 2 * np.pi, count, endpoint=False)
    row, column = TRUTH.centroid
    size = TRUTH.mm_per_px
    return np.stack([row + 8 / size * np.cos(t), column + 6 / size * np.sin(t)], axis=1)


def test_a_polygon_replaces_the_region():
    outline = true_outline()
    drawn = PREPARED.measure([stroke("remove", CENTRE, radius=60), polygon("replace", outline)])
    assert drawn.gross_area == pytest.approx(TRUTH.gross_area, rel=3e-3)
    assert drawn.ellipse.semi_major == pytest.approx(8, rel=3e-3)
    assert "edited_manually" in drawn.flags
    # The hand's error: that of an ellipse placed manually, which is drawn all round as well.
    ellipse = image.ImageEllipse(centre=TRUTH.centroid, semi_axes=(8 / TRUTH.mm_per_px, 6 / TRUTH.mm_per_px))
    assert drawn.gross_area_std == pytest.approx(PREPARED.measure(ellipse=ellipse).gross_area_std, rel=0.02)
    larger = true_outline() + 0.1 * (true_outline() - TRUTH.centroid)
    assert PREPARED.measure([polygon("replace", larger)]).gross_area == pytest.approx(
        1.21 * TRUTH.gross_area, rel=3e-3
    )


def test_polygons_add_and_remove_what_they_enclose():
    row, column = CENTRE
    box = [(row - 90, column - 25), (row - 90, column + 25), (row - 40, column + 25), (row - 40, column - 25)]
    hole = PREPARED.measure([polygon("remove", box)])
    assert hole.gross_area == pytest.approx(PLAIN.gross_area, rel=2e-3)  # a contact has no holes
    notch = np.array([(row - 400, column - 25), (row - 400, column + 25), *box[2:]])
    cut = PREPARED.measure([polygon("remove", notch)])
    top = PLAIN.outline[np.abs(PLAIN.outline[:, 1] - column) < 25][:, 0].min()
    lost = 50 * (row - 40 - top) * PPI_500.mm_per_px**2
    assert PLAIN.gross_area - cut.gross_area == pytest.approx(lost, rel=0.05)
    back = PREPARED.measure([polygon("remove", notch), polygon("add", notch.clip(top, None))])
    assert back.gross_area == pytest.approx(PLAIN.gross_area, rel=0.01)
    around = PREPARED.measure([polygon("replace", [(-50, -50), (-50, 900), (900, 900), (900, -50)])])
    assert around.gross_area > 1.5 * PLAIN.gross_area


def test_histogram_counts_the_levels_that_a_threshold_parts():
    counts, edges = PREPARED.level_histogram()
    above = counts[edges[:-1] > PLAIN.threshold].sum() / counts.sum()
    ridges = TRUTH.ridge_area / TRUTH.mm_per_px**2 / TRUTH.pixels.size
    assert above == pytest.approx(ridges, rel=0.1)
    part = image.prepare_contact_image(TRUTH.pixels, PPI_500, region_of_interest=(0, 0, 300, 300))
    assert part.level_histogram()[0].sum() < counts.sum()


@pytest.mark.parametrize(
    ("edit", "words"),
    [
        (polygon("add", [(9000, 9000), (9000, 9050), (9050, 9000)]), "outside the picture"),
        (stroke("remove", CENTRE, radius=390), "leave no contact"),
        (stroke("add", (-50, 20), radius=10), "lies outside the picture"),
        (stroke("add", CENTRE, radius=1e6), "no more than the picture"),
        (stroke("add", (1e12, 0), CENTRE, radius=5), "must not reach 1e\\+12 px"),
        (image.ImageEllipse(centre=(-5, 10), semi_axes=(60, 50)), "lies outside"),
        (image.ImageEllipse(centre=CENTRE, semi_axes=(1e200, 50)), "must not reach 1e\\+200 px"),
    ],
)
def test_invalid_edits(edit, words):
    drawn = {"ellipse": edit} if isinstance(edit, image.ImageEllipse) else {"strokes": [edit]}
    with pytest.raises(ImageError, match=words):
        PREPARED.measure(**drawn)


def test_the_edge_and_a_manual_threshold_are_independent():
    prepared = image.prepare_contact_image(TRUTH.pixels, PPI_500, threshold=90.0)
    edge_alone = replace(prepared, _nearby=()).measure()
    low, high = (
        image.measure_contact_image(TRUTH.pixels, PPI_500, threshold=level).values
        for level in (0.8 * 90, 1.2 * 90)
    )
    expected = edge_alone.covariance + np.outer(low - high, low - high) / 4
    assert prepared.measure().covariance == pytest.approx(expected, rel=1e-9)
    assert prepared.measure().edge_offset_std > edge_alone.edge_offset_std


def test_an_equal_offset_of_both_axes_stands_for_the_shared_effect_on_the_area():
    """What studies subtract for it from the covariance of the axes leaves the other errors of the area."""
    truth = render_contact_image(semi_major=4.5, semi_minor=2.9, seed=1)
    found = image.measure_contact_image(truth.pixels, truth.mm_per_px, threshold=90.0)
    assert found.edge_effect[0] > 1.1 * found.edge_effect[1]
    relative = 1 / found.values[:2]
    shared = relative @ found.edge_effect[:2]
    assert found.edge_offset_std * relative.sum() == pytest.approx(shared, rel=1e-12)
    own = found.covariance[:2, :2] - found.edge_offset_std**2
    variances, directions = np.linalg.eigh(own)
    kept = directions * np.maximum(variances, 0) @ directions.T
    assert relative @ kept @ relative + shared**2 == pytest.approx(
        relative @ found.covariance[:2, :2] @ relative, rel=0.01
    )
