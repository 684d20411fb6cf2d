"""Coins: known radius, tilt and place, and what is said where there is no one whole coin."""

import math
import re

import numpy as np
import pytest
from benchmarks.truth.coins import scene

from fingerpad.exceptions import CalibrationError
from fingerpad.image import PlaneEllipse, measure_coin
from fingerpad.image.coin import fit_edge
from fingerpad.simulate import render_coin


@pytest.fixture(scope="module")
def measured():
    """Coins of all sizes, tilts and looks, found and true."""
    rng = np.random.default_rng(11)
    pairs = []
    for seed in range(2, 10):
        truth = render_coin(
            radius=rng.uniform(60, 150),
            tilt=rng.choice([0.0, rng.uniform(0, 0.4)]),
            orientation=rng.uniform(-1.5, 1.5),
            shape=(380, 480),
            level=rng.uniform(90, 140),
            ground=rng.uniform(200, 235),
            relief=rng.uniform(3, 15),
            shadow=rng.uniform(0, 0.12),
            noise_std=rng.uniform(2, 10),
            blur=rng.uniform(0.6, 1.4),
            centre=(190 + rng.uniform(-20, 20), 240 + rng.uniform(-40, 40)),
            seed=seed,
        )
        pairs.append((measure_coin(truth.pixels), truth))
    return pairs


def test_radius_subpixel_accuracy(measured):
    errors = np.array([coin.semi_major - float(truth.ellipse.semi_major) for coin, truth in measured])
    assert np.abs(errors).max() < 0.6
    assert np.median(np.abs(errors)) < 0.2


def test_place_and_tilt(measured):
    for coin, truth in measured:
        assert math.dist(coin.centre, truth.centre) < 0.7
        assert coin.semi_minor == pytest.approx(float(truth.ellipse.semi_minor), rel=0.01)
        if float(truth.ellipse.axis_ratio) < 0.95:
            turn = (coin.orientation - truth.orientation + math.pi / 2) % math.pi - math.pi / 2
            assert abs(turn) < 0.05
            assert coin.tilt == pytest.approx(math.acos(float(truth.ellipse.axis_ratio)), abs=0.04)
            assert "coin_tilted" in coin.flags


def test_scale_uncertainty():
    coin = measure_coin(render_coin(radius=90, shape=(260, 280)).pixels)
    scale = coin.scale(23.25, 0.05)
    assert scale.mm_per_px == pytest.approx(23.25 / (2 * coin.semi_major))
    assert scale.relative_std == pytest.approx(
        math.hypot(0.05 / 23.25, coin.semi_major_std / coin.semi_major), rel=1e-9
    )
    with pytest.raises(CalibrationError, match="diameter_mm must be positive"):
        coin.scale(0.0)


def test_area_beside_a_tilted_coin_is_uncertain_by_what_is_shortened():
    coin = measure_coin(render_coin(radius=90, tilt=0.6, shape=(260, 280)).pixels)
    assert "coin_tilted" in coin.flags
    assert 2 * coin.scale(23.25).relative_std == pytest.approx(1 - math.cos(0.6), abs=0.02)


def test_shadow_is_flagged():
    plain, shaded = (
        measure_coin(render_coin(radius=100, shape=(320, 320), shadow=s, seed=6).pixels) for s in (0.02, 0.2)
    )
    assert plain.flags == ()
    assert shaded.flags == ("coin_shadow",)
    assert shaded.semi_major_std > 2 * plain.semi_major_std


def test_edge_outliers_left_out():
    image = render_coin(radius=100, shape=(300, 300), relief=0, shadow=0, noise_std=1, blur=1).pixels
    # A strip overlaid on a fifth of the edge: its own steep edges lie up to 4 px off the circle.
    image[140:175, 243:256] = 220
    image[140:175, 240:243] = 20
    outline = fit_edge(image.astype(np.float32), PlaneEllipse(149.5, 149.5, 101.0, 100.0, 0.3), 6.0, 6.0)
    # With the outliers the centre moves by 0.1 px.
    assert outline.ellipse.x == pytest.approx(149.5, abs=0.05)
    assert outline.ellipse.size == pytest.approx(100, abs=0.1)
    off = np.abs(outline.ellipse.offsets(outline.points))
    assert off.max() > 2
    assert off[outline.kept].max() < 0.8
    assert outline.support > 0.8


def test_two_coins_are_named_by_their_places_in_the_picture():
    coin = render_coin(radius=200, shape=(1000, 500)).pixels
    with pytest.raises(CalibrationError, match="2 coins found") as caught:
        measure_coin(np.hstack([coin, coin]))
    places = re.findall(r"row (\d+), column (\d+)", str(caught.value))
    found = sorted(([int(row), int(column)] for row, column in places), key=lambda place: place[1])
    np.testing.assert_allclose(found, [[500, 250], [500, 750]], atol=3)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: scene("two coins", 0).pixels, "2 coins found"),
        (lambda: scene("cut by the frame", 0).pixels, "coin"),
        (lambda: scene("a square", 0).pixels, "no coin found"),
        (lambda: np.zeros((200, 200), np.uint8), "no coin found"),
        (lambda: np.random.default_rng(0).normal(120, 20, (300, 300)), "no coin found"),
        (lambda: render_coin(radius=90, shape=(300, 300), level=200, ground=205, relief=4).pixels, "no coin"),
        (lambda: np.ones((1, 1)), "48 px or more"),
        (lambda: np.ones((60, 60, 3)), "grey"),
        (lambda: np.array(["a"]), "grey"),
        (lambda: np.full((100, 100), np.nan), "NaN"),
    ],
)
def test_no_single_whole_coin(make, words):
    with pytest.raises(CalibrationError, match=words):
        measure_coin(make())
