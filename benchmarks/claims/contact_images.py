"""Time of measuring a contact image beside that of decoding it; and the renders that others measure."""

import time
from collections.abc import Iterator
from typing import Literal

import cv2
import numpy as np

from benchmarks.tables import table
from fingerpad.image import Scale, measure_contact_image
from fingerpad.simulate import SyntheticContactImage, render_contact_image

LOOKS: tuple[Literal["ink", "livescan", "prism"], ...] = ("ink", "livescan", "prism")
PATTERNS: tuple[Literal["arch", "loop", "whorl"], ...] = ("arch", "loop", "whorl")
NOISES = (4.0, 12.0, 25.0)
SCALE = Scale.of_ppi(500)


def population(count: int, seed: int = 1) -> Iterator[SyntheticContactImage]:
    """Render a broad population: sizes, outlines, looks, patterns, noise, blur, light, compression."""
    rng = np.random.default_rng(seed)
    for k in range(count):
        area, ratio = rng.uniform(100, 300), rng.uniform(1.0, 1.8)
        semi_minor = np.sqrt(area / np.pi / ratio)
        yield render_contact_image(
            semi_major=semi_minor * ratio,
            semi_minor=semi_minor,
            orientation=rng.uniform(-np.pi / 2, np.pi / 2),
            ridge_period=rng.uniform(0.38, 0.55),
            pattern=PATTERNS[k // 8 % 3],
            look=LOOKS[k % 3],
            noise_std=NOISES[rng.integers(3)],
            blur=rng.uniform(0, 0.08),
            lighting=rng.uniform(0, 0.4),
            irregularity=rng.choice([0, rng.uniform(0, 0.04)]),
            creases=int(rng.integers(0, 4)),
            jpeg_quality=int(rng.integers(60, 96)),
            seed=int(rng.integers(1 << 31)),
            ridge_seed=int(1000 * seed + k // 8),
        )


def report(repeats: int = 60) -> None:
    """Print the processor time of one measurement against that of decoding its PNG, side by side."""
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    rows = []
    for ridge_period in (0.38, 0.45, 0.55):
        truth = render_contact_image(
            semi_major=12.0, semi_minor=10.0, ridge_period=ridge_period, margin=14.0, seed=1
        )
        pixels = np.asarray(cv2.resize(truth.pixels, (1024, 1024)), dtype=np.uint8)
        encoded = cv2.imencode(".png", pixels)[1]
        times = []
        for _ in range(repeats):
            start = time.thread_time()
            cv2.imdecode(encoded, cv2.IMREAD_GRAYSCALE)
            decoded = time.thread_time()
            measure_contact_image(pixels, SCALE)
            times.append((decoded - start, time.thread_time() - decoded))
        decoding, measuring = 1e3 * np.min(times, axis=0)
        each = f"{ridge_period} mm", f"{measuring:.0f} ms", f"{decoding:.1f} ms"
        rows.append((*each, f"{measuring / decoding:.1f}"))
    title = "Processor time of one image of 1024 × 1024 px that its contact nearly fills, one thread"
    table(("ridges apart", "measured in", "its PNG decoded in", "ratio (asked: 2)"), rows, title)
    cv2.setNumThreads(threads)
