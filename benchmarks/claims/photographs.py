"""Accuracy and coverage of the measurement of photographs.

A broad population of rendered fingers: four faces, sizes, skins, backdrops of another colour than the skin,
light, shadow, blur, noise, tilt in the image and of the camera, JPEG, 0.03 to 0.07 mm per pixel; departures
beyond the arc.
"""

import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial

import cv2
import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.exceptions import FitError, ImageError
from fingerpad.image import Face, Scale, measure_photograph
from fingerpad.simulate import Backdrop, SyntheticFinger, render_finger

FACES: tuple[Face, ...] = ("palmar", "distal", "radial", "ulnar")
BACKDROPS: tuple[Backdrop, ...] = ("white", "grey", "black", "blue", "green", "cork")
ARCS_DEG = ((60, 90), (90, 120), (120, 150), (150, 180))


@dataclass(frozen=True, slots=True)
class Trial:
    """One measurement: true extent of the arc, relative errors and stated relative uncertainties."""

    arc_deg: float
    errors: FloatArray
    stds: FloatArray
    flagged: bool


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


def trial(seed: int, *, marked: bool) -> Trial | None:
    """Measure one finger, None where that is refused."""
    cv2.setNumThreads(1)
    truth = random_finger(seed, 60 if marked else 120)
    try:
        found = measure_photograph(
            truth.pixels,
            truth.face,
            Scale(truth.mm_per_px),
            palmar=None if truth.face == "palmar" else truth.palmar,
            points=truth.arc_points(9) if marked else None,
        )
    except (ImageError, FitError):
        return None
    return Trial(
        arc_deg=float(np.degrees(truth.arc[1] - truth.arc[0])),
        errors=found.semi_axes / np.array(truth.semi_axes) - 1,
        stds=np.sqrt(np.diagonal(found.covariance)) / found.semi_axes,
        flagged=bool(found.flags),
    )


def photograph_accuracy(count: int = 240, *, marked: bool) -> None:
    """Print errors, stated uncertainties and coverage by the arc's extent."""
    start = time.perf_counter()
    with ProcessPoolExecutor(2) as pool:
        trials = list(pool.map(partial(trial, marked=marked), range(count), chunksize=8))
    done = [one for one in trials if one is not None]
    way = "arc from marks at its ends" if marked else "arc found automatically"
    print(f"\nPhotographs of known truth, {way}: {count}, refused {count - len(done)},", end=" ")
    print(f"{time.perf_counter() - start:.0f} s")
    print("    arc, deg     n   median   95 % within   stated   held by 95 % intervals   flagged")
    for low, high in (*ARCS_DEG, (120, 180), (60, 180)):
        some = [one for one in done if low <= one.arc_deg <= high]
        if not some:
            continue
        off, std = (np.array([getattr(one, name) for one in some]) for name in ("errors", "stds"))
        held = np.mean(np.abs(off) < 1.96 * std)
        print(f"    {low:3}-{high:3}   {len(some):5}   {100 * np.median(np.abs(off)):5.2f} %", end="")
        print(f"   {100 * np.quantile(np.abs(off), 0.95):9.2f} %   {100 * np.median(std):5.2f} %", end="")
        print(f"   {100 * held:18.1f} %   {np.mean([one.flagged for one in some]):12.0%}")


def report(count: int = 240) -> None:
    """Print the table with marked ends, and without."""
    photograph_accuracy(count, marked=True)
    photograph_accuracy(count, marked=False)
