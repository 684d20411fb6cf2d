"""Contact images of known truth: errors, coverage of the stated intervals, and speed."""

import time
from collections.abc import Iterable, Iterator
from itertools import pairwise
from typing import Literal

import cv2
import numpy as np
import numpy.typing as npt

from benchmarks.claims.contact_edge import Measured
from benchmarks.tables import off, share, table
from fingerpad.exceptions import ImageError
from fingerpad.image import ContactImageResult, Scale, measure_contact_image
from fingerpad.simulate import SyntheticContactImage, render_contact_image

SIZES = (100, 170, 240, 300)
LOOKS: tuple[Literal["ink", "livescan", "prism"], ...] = ("ink", "livescan", "prism")
PATTERNS: tuple[Literal["arch", "loop", "whorl"], ...] = ("arch", "loop", "whorl")
NOISES = (4.0, 12.0, 25.0)
QUANTITIES = ("semi-major", "semi-minor", "gross area", "ridge area")
SCALE = Scale.of_ppi(500)

Numbers = npt.NDArray[np.float64]


def population(
    count: int,
    seed: int = 1,
    *,
    noise_std: float | None = None,
    smudges: int = 0,
    blur: tuple[float, float] = (0, 0.08),
) -> Iterator[SyntheticContactImage]:
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
            noise_std=NOISES[rng.integers(3)] if noise_std is None else noise_std,
            blur=rng.uniform(*blur),
            lighting=rng.uniform(0, 0.4),
            irregularity=rng.choice([0, rng.uniform(0, 0.04)]),
            creases=int(rng.integers(0, 4)),
            smudges=smudges,
            jpeg_quality=int(rng.integers(60, 96)),
            seed=int(rng.integers(1 << 31)),
            ridge_seed=int(1000 * seed + k // 8),
        )


def values_of(item: ContactImageResult | SyntheticContactImage) -> Numbers:
    """Return semi-major, semi-minor, gross and ridge area."""
    ellipse = item.ellipse
    return np.array([float(ellipse.semi_major), float(ellipse.semi_minor), item.gross_area, item.ridge_area])


def measured(
    rendered: Iterable[SyntheticContactImage],
) -> tuple[list[tuple[int, SyntheticContactImage]], Numbers, Numbers, Numbers, list[tuple[str, ...]]]:
    """Return number and truth, relative errors, errors over uncertainty, turns (deg) and flags of each."""
    truths, errors, scores, turns, flags = [], [], [], [], []
    for number, truth in enumerate(rendered):
        try:
            found = measure_contact_image(truth.pixels, SCALE)
        except ImageError as error:
            print(f"    refused: {error}")
            continue
        truths.append((number, truth))
        off = values_of(found) - values_of(truth)
        errors.append(100 * off / values_of(truth))
        scores.append(off / np.sqrt(np.diag(found.covariance)))
        turn = np.degrees(found.orientation - truth.orientation + np.pi / 2) % 180 - 90
        turns.append(turn if float(truth.ellipse.axis_ratio) < 1 / 1.2 else np.nan)
        flags.append(found.flags)
    return truths, np.array(errors), np.array(scores), np.array(turns), flags


def _groups_of(number: int, truth: SyntheticContactImage, noise: float) -> tuple[str, ...]:
    """Return the names of the groups that a picture of the population belongs to."""
    size = int(np.searchsorted(SIZES[1:-1], truth.gross_area))
    return f"noise {noise:.0f}", LOOKS[number % 3], f"{SIZES[size]}-{SIZES[size + 1]} mm2", "all"


def accuracy_and_coverage(count: int) -> None:
    """Print errors and coverage of the 95 % intervals on rendered pictures, by noise and by look."""
    order = ["all", *LOOKS, *(f"noise {noise:.0f}" for noise in NOISES)]
    order += [f"{low}-{high} mm2" for low, high in pairwise(SIZES)]
    groups: dict[str, list[list[Numbers]]] = {name: [] for name in [*order, "smudged", "no ridges"]}
    for noise in NOISES:
        populations = {
            "": population(count, seed=100 + int(noise), noise_std=noise),
            "smudged": population(count // 2, seed=200 + int(noise), noise_std=noise, smudges=3),
            "no ridges": population(count // 2, seed=300 + int(noise), noise_std=noise, blur=(0.2, 0.35)),
        }
        for kind, rendered in populations.items():
            truths, errors, scores, turns, flags = measured(rendered)
            flagged = [bool(f) for f in flags]
            for truth, *row in zip(truths, errors, scores, turns, flagged, strict=True):
                for name in (kind,) if kind else _groups_of(*truth, noise):
                    groups[name].append(row)
    table(
        (
            "images",
            "n",
            *(f"{q}: bias, rms error, held" for q in QUANTITIES),
            "turned by",
            "flagged",
        ),
        (_cells(name, rows) for name, rows in groups.items() if rows),
        f"Rendered contact images, 500 ppi, 100-300 mm², irregular, creased, {count} of each level of noise",
    )


def _cells(name: str, rows: list[list[Numbers]]) -> tuple[object, ...]:
    errors, scores, turns, flagged = (np.array(part) for part in zip(*rows, strict=True))
    each = [f"{off(e)}, {share(np.abs(z) < 1.96)}" for e, z in zip(errors.T / 100, scores.T, strict=True)]
    return name, len(rows), *each, f"{np.nanquantile(np.abs(turns), 0.95):.1f}°", share(flagged)


def independent_errors(images: Iterable[Measured]) -> tuple[Numbers, Numbers, list[str]]:
    """Return relative errors, errors over uncertainty and conditions, on independently rendered images."""
    errors, scores, names = [], [], []
    for name, truth, found in images:
        true = np.array([truth.semi_major, truth.semi_minor, truth.gross_area, truth.ridge_area])
        off = values_of(found) - true
        errors.append(off / true)
        scores.append(off / np.sqrt(np.diag(found.covariance)))
        names.append(name)
    return np.array(errors), np.array(scores), names


def speed(repeats: int = 60) -> None:
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


def report(images: int = 24) -> None:
    """Print errors and coverage on the library's own renders, and speed."""
    accuracy_and_coverage(images)
    speed()
