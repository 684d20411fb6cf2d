"""Sequences against their truth, and speed."""

import tempfile
import time
from pathlib import Path

import numpy as np
import tifffile

import fingerpad as fp
from benchmarks.arrays import Array
from benchmarks.tables import table
from fingerpad.simulate import render_sequence

PPI, FPS = 300.0, 50.0


def report() -> None:
    """Print area errors through a press and release, one reading against one for each frame, and speed."""
    times = np.arange(0, 4, 1 / FPS)
    load = np.interp(times, [0, 0.5, 1.5, 2.5, 3.5, 4], [0, 0, 2, 2, 0, 0])
    rows: list[tuple[object, ...]] = []
    speeds = []
    scale = fp.Scale.of_ppi(PPI)
    for look in ("livescan", "prism", "ink"):
        press = render_sequence(load, look=look, flicker=0.02, ppi=PPI, seed=3)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "press.tif"
            with tifffile.TiffWriter(path) as tiff:
                for index in range(times.size):
                    tiff.write(press.pixels(index), photometric="minisblack", contiguous=False)
            frames = fp.open_frames(path)
            signal = fp.ForceSignal(times, load)
            start = time.perf_counter()
            results = list(fp.measure_sequence(frames, scale, clock=fp.FrameRate(FPS), force=signal))
            spent = time.perf_counter() - start
            held: list[int] = []
            for phase in ("loading", "hold", "unloading"):
                chosen = [r for r in results if r.phase == phase and r.measures is not None]
                areas = [r.measures["gross_area_mm2"] for r in chosen if r.measures is not None]
                rows.append(_cells(look, phase, areas, press.gross_area[[r.index for r in chosen]]))
                held = [r.index for r in chosen] if phase == "hold" else held
            alone = [
                fp.measure_contact_image(frame.pixels, scale).gross_area
                for frame in frames
                if frame.index in held and frame.pixels is not None
            ]
            rows.append(_cells(look, "hold, each alone", alone, press.gross_area[held]))
            speeds.append(f"{look} {len(results) / spent:.0f}")
    head = "look", "phase", "frames", "mean error of the area", "spread", "step to step"
    title = f"A press and release to 2 N, {times.size} frames at {PPI:.0f} ppi, light flickering by 2 %"
    table(head, rows, title)
    print(f"\nFrames a second, learning included: {', '.join(speeds)}.")


def _cells(look: str, phase: str, areas: list[float], truth: Array) -> tuple[object, ...]:
    errors = 100 * (areas / truth - 1)
    spread, steps = f"{errors.std():.2f} %", f"{np.diff(errors).std():.2f} %"
    return look, phase, errors.size, f"{errors.mean():+.2f} %", spread, steps
