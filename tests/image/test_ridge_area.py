"""Ridge areas of drawn stripes of known width, and of moist prints."""

import numpy as np
import pytest

from fingerpad.image import ContactImageResult, measure_contact_image

MM_PER_PX, PERIOD, SEMI_AXES = 0.05, 0.5, (6.0, 5.0)
GROSS_AREA = np.pi * np.prod(SEMI_AXES)


def measured_stripes(share: float) -> ContactImageResult:
    """Measure an ellipse of wavy stripes that fill this share of the period; a pixel is the mean of 6 × 6."""
    step = MM_PER_PX / 6
    y, x = (np.arange(-n, n, step) + step / 2 for n in (8.0, 7.0))
    x, y = np.meshgrid(x, y)
    phase = (y + 0.6 * np.sin(x / 2.5)) / PERIOD % 1
    dark = (np.abs(phase - 0.5) < share / 2) & ((y / SEMI_AXES[0]) ** 2 + (x / SEMI_AXES[1]) ** 2 < 1)
    rows, columns = (n // 6 for n in dark.shape)
    pixels = 230 - 180 * dark.reshape(rows, 6, columns, 6).mean(axis=(1, 3))
    noise = np.random.default_rng(5).normal(0, 2, pixels.shape)
    return measure_contact_image(np.rint(pixels + noise).clip(0, 255).astype(np.uint8), MM_PER_PX)


def test_the_border_says_how_much_a_film_beside_ridges_adds() -> None:
    dry, film = measured_stripes(0.42), 0.02
    inked = measured_stripes(0.42 + 2 * film / PERIOD)
    # Two borders in a period, longer by the waves.
    slope = 0.6 / 2.5 * np.cos(np.linspace(-2, 2, 200))
    assert dry.ridge_border == pytest.approx(2 * GROSS_AREA / PERIOD * np.hypot(1, slope).mean(), rel=0.05)
    assert inked.ridge_area - film * dry.ridge_border == pytest.approx(dry.ridge_area, rel=0.02)
    assert dry.as_record()["ridge_border_mm"] == dry.ridge_border


def test_more_ridge_than_dry_skin_shows_is_flagged_and_less_certain() -> None:
    usual, many = measured_stripes(0.45), measured_stripes(0.7)
    assert "ridges_merge" not in usual.flags
    assert "ridges_merge" in many.flags
    assert many.ridge_area_std / many.ridge_area > 0.1 > 3 * usual.ridge_area_std / usual.ridge_area


def test_few_narrow_ridges_have_a_less_certain_area() -> None:
    usual, few = measured_stripes(0.45), measured_stripes(0.25)
    assert few.ridge_area_std / few.ridge_area > 0.1 > 3 * usual.ridge_area_std / usual.ridge_area


def test_without_resolved_ridges_no_border_is_known() -> None:
    y, x = np.mgrid[-140:140, -120:120]
    pixels = np.where((y / 100) ** 2 + (x / 80) ** 2 < 1, 60.0, 220.0)
    pixels += np.random.default_rng(2).normal(0, 2, pixels.shape)
    found = measure_contact_image(pixels, MM_PER_PX)
    assert np.isnan(found.ridge_border)
    assert "ridges_merge" not in found.flags
