"""Grids through the camera of `benchmarks.truth.grids`: scale, rectification, and their uncertainty."""

import math

import numpy as np
import pytest
from benchmarks.truth.grids import Scene

from fingerpad.exceptions import CalibrationError
from fingerpad.image import measure_grid

POINTS, SPACING = (7, 9), 4.0
SCENES = {
    "square on": Scene(),
    "tilted": Scene(tilt=0.35, turn=0.7),
    "through a prism": Scene(tilt=0.1, turn=0.3, squeeze=0.7),
}


def true_scale(scene: Scene, place: np.ndarray) -> float:
    return math.sqrt(scene.area_per_pixel(*place))


@pytest.mark.parametrize(
    ("name", "pattern"),
    [
        ("square on", "dots"),
        ("tilted", "checkerboard"),
        ("tilted", "dots"),
        ("through a prism", "checkerboard"),
    ],
)
def test_scale_in_the_middle_and_points(name: str, pattern: str) -> None:
    scene = SCENES[name]
    grid = measure_grid(scene.picture(POINTS, SPACING, pattern), POINTS, SPACING, pattern=pattern)
    truth = true_scale(scene, grid.points[3, 4])
    assert grid.rectified_scale.mm_per_px == pytest.approx(truth, rel=5e-4)
    assert grid.residual < 0.15
    # Each point shows the place of the plane that it should, whichever corner is the first.
    x, y = scene.plane_of(grid.points[..., 0], grid.points[..., 1])
    j, i = np.meshgrid(np.arange(9) - 4, np.arange(7) - 3)
    off = min(np.hypot(x - s * SPACING * j, y - s * SPACING * i).max() for s in (-1, 1))
    assert off < 0.3 * truth
    assert ("grid_tilted" in grid.flags) == (name != "square on")
    assert "grid_bent" not in grid.flags
    # Without rectification the uncertainty holds what the scale differs by with place and direction.
    x0, x1 = (true_scale(scene, grid.points[k]) for k in ((0, 0), (-1, -1)))
    assert grid.scale.relative_std >= 0.5 * abs(x1 - x0) / truth


def test_rectified_pictures_have_one_scale_everywhere() -> None:
    scene = SCENES["through a prism"]
    pixels = scene.picture(POINTS, SPACING, "dots")
    grid = measure_grid(pixels, POINTS, SPACING, pattern="dots")
    seen, scale = grid.rectified(pixels)
    again = measure_grid(seen, POINTS, SPACING, pattern="dots")
    assert again.scale.mm_per_px == pytest.approx(scale.mm_per_px, rel=1e-3)
    assert again.anisotropy < 2e-3
    assert again.variation < 2e-3
    assert again.flags == ()
    with pytest.raises(CalibrationError, match="pixels must be grey"):
        grid.rectified("other.png")


@pytest.mark.parametrize("turns", range(4))
@pytest.mark.parametrize(
    ("pattern", "points"), [("checkerboard", POINTS), ("dots", POINTS), ("dots", POINTS[::-1])]
)
def test_rectified_pictures_are_not_turned(pattern: str, points: tuple[int, int], turns: int) -> None:
    pixels = np.rot90(Scene().picture(POINTS, SPACING, pattern), turns).copy()
    pixels[:25, :25] = 0
    seen, _ = measure_grid(pixels, points, SPACING, pattern=pattern).rectified(pixels)
    rows, columns = seen.shape
    corners = [
        seen[row : row + 30, column : column + 30].mean()
        for row in (0, rows - 30)
        for column in (0, columns - 30)
    ]
    assert seen.shape == pytest.approx(pixels.shape, abs=4)
    assert np.argmin(corners) == 0


def test_uncertainty_covers_spacing_noise_tilt_and_lens() -> None:
    rng = np.random.default_rng(5)
    errors = []
    for seed in range(5):
        scene = Scene(
            rows=360,
            columns=480,
            focal=1050,
            tilt=rng.uniform(0, 0.4),
            turn=rng.uniform(0, 3),
            squeeze=rng.uniform(0.7, 1),
            bend=rng.choice([0.0, 0.3]),
        )
        true_spacing = SPACING * (1 + 0.002 * rng.normal())
        picture = scene.picture(POINTS, true_spacing, "dots", noise=rng.uniform(0, 10), seed=seed)
        grid = measure_grid(picture, POINTS, SPACING, spacing_mm_std=0.002 * SPACING, pattern="dots")
        found = grid.rectified_scale
        errors.append((found.mm_per_px / true_scale(scene, grid.points[3, 4]) - 1) / found.relative_std)
    assert np.abs(errors).max() < 2.6
    assert np.sqrt(np.mean(np.square(errors))) > 0.3


def test_a_lens_that_bends_lines_is_flagged() -> None:
    grid = measure_grid(Scene(bend=0.3).picture(POINTS, SPACING, "dots"), POINTS, SPACING, pattern="dots")
    assert grid.flags == ("grid_bent",)
    assert grid.unevenness > 0.005


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"points": (7, 8)}, "no grid of 7 × 8 inner corners found"),
        ({"points": (2, 9)}, "3 or more"),
        ({"spacing_mm": 0.0}, "spacing_mm must be positive"),
        ({"spacing_mm": math.nan}, "spacing_mm must be positive"),
        ({"pattern": "circles"}, "checkerboard, dots, found 'circles'"),
    ],
)
def test_refused(changed: dict, words: str) -> None:
    picture = Scene(rows=240, columns=320, focal=700).picture(POINTS, SPACING, "checkerboard")
    with pytest.raises(CalibrationError, match=words):
        measure_grid(picture, **{"points": POINTS, "spacing_mm": SPACING, **changed})
