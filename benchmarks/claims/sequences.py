"""Coins and sequences against their truth, speed and memory."""

import multiprocessing
import tempfile
import time
from pathlib import Path

import numpy as np
import tifffile

from benchmarks.memory import peak_mb
from fingerpad._arrays import FloatArray
from fingerpad.exceptions import CalibrationError
from fingerpad.image import (
    ForceSignal,
    FrameRate,
    Scale,
    estimate_settings,
    measure_coin,
    measure_contact_image,
    measure_sequence,
    open_frames,
)
from fingerpad.simulate import render_coin, render_sequence

PPI, FPS = 300.0, 50.0


def coin_accuracy(count: int = 60) -> None:
    """Print errors of the radius of rendered coins, and how often the stated interval holds the truth."""
    print(f"Coins of 60-190 px radius, tilted up to 23 deg, {count} for each depth of shadow")
    print("    shadow  refused  flagged  median error   95 % within      worst   95 % intervals hold")
    for shadow in (0.0, 0.1, 0.2, 0.3):
        rng = np.random.default_rng(11)
        found = [_coin_error(rng, shadow, seed) for seed in range(count)]
        errors = np.array([row for row in found if row is not None])
        size = 100 * np.abs(errors[:, 0])
        print(
            f"    {shadow:6.1f}  {count - len(errors):7d}  {int(errors[:, 2].sum()):7d}  "
            f"{np.median(size):10.2f} %  {np.quantile(size, 0.95):10.2f} %  {size.max():7.2f} %  "
            f"{100 * np.mean(np.abs(errors[:, 1]) < 1.96):10.0f} %"
        )


def _coin_error(rng: np.random.Generator, shadow: float, seed: int) -> tuple[float, float, bool] | None:
    """Return the relative error, the error over the standard uncertainty, and whether it is flagged."""
    truth = render_coin(
        radius=rng.uniform(60, 190),
        tilt=rng.choice([0.0, rng.uniform(0, 0.4)]),
        orientation=rng.uniform(-1.5, 1.5),
        level=rng.uniform(90, 140),
        ground=rng.uniform(200, 235),
        relief=rng.uniform(3, 15),
        shadow=shadow,
        noise_std=rng.uniform(2, 10),
        blur=rng.uniform(0.6, 1.4),
        centre=(240 + rng.uniform(-20, 20), 320 + rng.uniform(-60, 60)),
        seed=seed,
    )
    try:
        coin = measure_coin(truth.pixels)
    except CalibrationError:
        return None
    error = coin.semi_major - float(truth.ellipse.semi_major)
    return error / float(truth.ellipse.semi_major), error / coin.semi_major_std, bool(coin.flags)


def press_accuracy() -> None:
    """Print area errors through a press and release, one reading against one for each frame."""
    times = np.arange(0, 4, 1 / FPS)
    load = np.interp(times, [0, 0.5, 1.5, 2.5, 3.5, 4], [0, 0, 2, 2, 0, 0])
    print(f"\nA press and release to 2 N, {times.size} frames at {PPI:.0f} ppi, light flickering by 2 %")
    print("    look      phase      frames  mean area error    spread   step to step")
    scale = Scale.of_ppi(PPI)
    for look in ("livescan", "prism", "ink"):
        press = render_sequence(load, look=look, flicker=0.02, ppi=PPI, seed=3)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "press.tif"
            with tifffile.TiffWriter(path) as tiff:
                for index in range(times.size):
                    tiff.write(press.pixels(index), photometric="minisblack", contiguous=False)
            frames = open_frames(path)
            signal = ForceSignal(times, load)
            start = time.perf_counter()
            results = list(measure_sequence(frames, scale, clock=FrameRate(FPS), force=signal))
            spent = time.perf_counter() - start
            held: list[int] = []
            for phase in ("loading", "hold", "unloading"):
                chosen = [r for r in results if r.phase == phase and r.measures is not None]
                areas = np.array([r.measures["gross_area_mm2"] for r in chosen if r.measures is not None])
                errors = 100 * (areas / press.gross_area[[r.index for r in chosen]] - 1)
                _print_errors(look, phase, errors)
                held = [r.index for r in chosen] if phase == "hold" else held
            alone = [
                measure_contact_image(frame.pixels, scale).gross_area
                for frame in frames
                if frame.index in held and frame.pixels is not None
            ]
            _print_errors(look, "hold, each", 100 * (np.array(alone) / press.gross_area[held] - 1))
            print(f"    {look:<9} {len(results) / spent:.0f} frames per second, learning included")


def _print_errors(look: str, phase: str, errors: FloatArray) -> None:
    steps = np.diff(errors).std()
    print(
        f"    {look:<9} {phase:<10} {errors.size:6d}  {errors.mean():+13.2f} %  {errors.std():8.2f} %"
        f"  {steps:10.2f} %"
    )


def sequence_memory() -> None:
    """Print the peak memory of a process that measures a short sequence and a long one of the same frames."""
    print("\nPeak memory of a process, frames of 32 x 48 px from a TIFF file")
    context = multiprocessing.get_context("spawn")
    with tempfile.TemporaryDirectory() as folder:
        for count in (200, 5000):
            path = Path(folder) / f"{count}.tif"
            noise = np.random.default_rng(0).integers(190, 210, (32, 48)).astype(np.uint8)
            noise[8:24, 12:36:4] = noise[8:24, 13:36:4] = 60
            with tifffile.TiffWriter(path) as tiff:
                for _ in range(count):
                    tiff.write(noise, photometric="minisblack", contiguous=False)
            with context.Pool(1) as pool:
                peak, seconds, measured = pool.apply(_measure_sequence, (path,))
            print(
                f"    {count:5d} frames: {peak:6.1f} MB, {count / seconds:5.0f} frames/s, {measured} measured"
            )


def _measure_sequence(path: Path) -> tuple[float, float, int]:
    frames, scale = open_frames(path), Scale(0.12)
    start = time.perf_counter()
    settings = estimate_settings(frames, scale)
    measured = sum(r.measures is not None for r in measure_sequence(frames, scale, settings=settings))
    seconds = time.perf_counter() - start
    return peak_mb(), seconds, measured


def report() -> None:
    """Print errors of coins and sequences, speed, and memory."""
    coin_accuracy()
    press_accuracy()
    sequence_memory()
