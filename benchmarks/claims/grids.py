"""Scale from rendered checkerboards and grids of dots: error, residual and coverage.

The scenes come from a pinhole camera of their own, `benchmarks.truth.grids`: tilted, foreshortened as by a
prism, noisy, and some through a lens that bends lines. The true spacing scatters about the stated one by its
standard uncertainty.
"""

import math

import numpy as np

from benchmarks.tables import percent, share, table
from benchmarks.truth.grids import Scene
from fingerpad.image import measure_grid
from fingerpad.image.grid import Pattern

COUNT, POINTS, SPACING, RELATIVE_STD = 24, (7, 9), 3.2, 0.002
PATTERNS: tuple[Pattern, ...] = ("checkerboard", "dots")


def report() -> None:
    """Print the table."""
    rows = []
    rng = np.random.default_rng(3)
    for pattern in PATTERNS:
        errors, ratios, residuals = [], [], []
        for seed in range(COUNT):
            tilt, turn, squeeze = rng.uniform(0, 0.4), rng.uniform(0, 3.1), rng.uniform(0.7, 1)
            scene = Scene(tilt=tilt, turn=turn, squeeze=squeeze, bend=rng.choice([0, 0, 0.1, 0.3]))
            spacing = SPACING * (1 + rng.normal(0, RELATIVE_STD))
            picture = scene.picture(POINTS, spacing, pattern, noise=rng.uniform(0, 12), seed=seed)
            known = {"spacing_mm_std": RELATIVE_STD * SPACING}
            grid = measure_grid(picture, POINTS, SPACING, pattern=pattern, **known)
            truth = math.sqrt(scene.area_per_pixel(*grid.points[3, 4]))
            found = grid.rectified_scale
            errors.append(found.mm_per_px / truth - 1)
            ratios.append(abs(errors[-1]) / found.relative_std)
            residuals.append(grid.residual)
        rms, within = math.sqrt(float(np.mean(np.square(errors)))), share(np.array(ratios) < 1.96)
        rows.append((pattern, COUNT, percent(rms), f"{np.median(residuals):.2f} px", within))
    table(("pattern", "n", "rms error", "residual, median", "held"), rows)
