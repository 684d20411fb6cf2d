"""Accuracy and coverage of the measurement of photographs.

A broad population of rendered fingers: four faces, sizes, skins, backdrops of another colour than the skin,
light, shadow, blur, noise, tilt in the image and of the camera, JPEG, 0.03 to 0.07 mm per pixel; departures
beyond the arc.
"""

from concurrent.futures import ProcessPoolExecutor
from functools import partial

import cv2
import numpy as np

from benchmarks.arrays import Array
from benchmarks.tables import Row, or_none, percent, rows_of, share, stated, table
from fingerpad.image import Face, PhotographFit, Scale, measure_photograph
from fingerpad.simulate import Backdrop, SyntheticFinger, render_finger

FACES: tuple[Face, ...] = ("palmar", "distal", "radial", "ulnar")
BACKDROPS: tuple[Backdrop, ...] = ("white", "grey", "black", "blue", "green", "cork")
ARCS_DEG = ((60, 90), (90, 120), (120, 150), (150, 180))


def random_finger(seed: int, least_arc_deg: float, greatest_arc_deg: float = 180) -> SyntheticFinger:
    """Render one finger of the population."""
    rng = np.random.default_rng([seed, 99])
    face = FACES[seed % 4]
    along = (5.5, 9.0) if face == "distal" else (10.0, 16.0)
    across = (8.0, 13.0) if face in ("palmar", "distal") else (5.5, 9.0)
    skin, backdrop = rng.uniform(0, 1), BACKDROPS[rng.integers(6)]
    return render_finger(
        face,
        semi_axes=(rng.uniform(*across), rng.uniform(*along)),
        arc_deg=rng.uniform(least_arc_deg, greatest_arc_deg),
        departure=rng.uniform(-0.7, 0.7),
        palmar=None if face == "palmar" else "down" if face == "distal" else "right",
        tilt_deg=rng.uniform(-5, 5),
        skin=skin,
        # Cork has the colour of light and middle skins: that edge is invisible.
        backdrop="white" if backdrop == "cork" and skin < 0.65 else backdrop,
        light_deg=rng.uniform(20, 160),
        shadow=rng.uniform(0, 0.3),
        texture_mm=rng.uniform(0.005, 0.025),
        blur_px=rng.uniform(0.6, 2.2),
        noise_std=rng.uniform(1, 5),
        camera_tilt_deg=rng.uniform(0, 1.5),
        jpeg_quality=(None, 95, 90, 80)[rng.integers(4)],
        mm_per_px=rng.uniform(0.03, 0.07),
        seed=seed,
    )


def measure(finger: SyntheticFinger, *, marked: bool) -> PhotographFit | None:
    """Return the measurement of a finger with nine marks or none, None where it is refused."""
    palmar = None if finger.face == "palmar" else finger.palmar
    points = finger.arc_points(9) if marked else None
    scale = Scale(finger.mm_per_px)
    return or_none(measure_photograph, finger.pixels, finger.face, scale, palmar=palmar, points=points)


def trial(seed: int, *, marked: bool) -> tuple[float, list[Row]]:
    """Measure one finger, and return the extent of its arc, degrees, and errors, none where it is refused."""
    cv2.setNumThreads(1)
    truth = random_finger(seed, 60 if marked else 120)
    found = measure(truth, marked=marked)
    rows = rows_of(found.semi_axes, truth.semi_axes, found.covariance, found.flags) if found else []
    return float(np.degrees(truth.arc[1] - truth.arc[0])), rows


def _interval(size: Array) -> tuple[float, float]:
    """Return the 95 % interval of what 95 % of the errors are within, by drawing photographs again."""
    rng = np.random.default_rng(0)
    drawn = size[rng.integers(len(size), size=(2000, len(size)))].reshape(2000, -1)
    low, high = np.quantile(np.quantile(drawn, 0.95, axis=1), [0.025, 0.975])
    return float(low), float(high)


def photograph_accuracy(count: int, first: int, *, marked: bool) -> None:
    """Print errors, stated uncertainties and coverage by the arc's extent."""
    with ProcessPoolExecutor(2) as pool:
        trials = list(pool.map(partial(trial, marked=marked), range(first, first + count), chunksize=8))
    done = [(arc_deg, rows) for arc_deg, rows in trials if rows]
    cells: list[tuple[object, ...]] = []
    for low, high in (*ARCS_DEG, (60, 180)):
        some = np.array([rows for arc_deg, rows in done if low <= arc_deg <= high])
        if some.size:
            errors, stds, flagged = np.moveaxis(some, -1, 0)
            size = np.abs(errors)
            middle, most = (percent(float(np.quantile(size, part))) for part in (0.5, 0.95))
            between = " to ".join(map(percent, _interval(size)))
            of = f"{low}–{high}°", len(some), middle, most, between
            cells.append((*of, stated(errors, stds), share(flagged)))
    way = "Nine marks, the arc's ends among them" if marked else "Arc found automatically, from 120°"
    columns = "arc", "faces", "median error", "95 % within", "known to", "stated, held", "flagged"
    table(columns, cells, f"{way}: {count} photographs, {count - len(done)} refused")


def report(count: int = 192, first: int = 75_000) -> None:
    """Print the table with marked ends, and without."""
    photograph_accuracy(count, first, marked=True)
    photograph_accuracy(count, first, marked=False)
