"""Contact images of known truth: errors, coverage of the stated intervals, and speed."""

import time
from collections.abc import Iterable, Iterator
from itertools import pairwise
from typing import Literal

import cv2
import numpy as np
import numpy.typing as npt

from benchmarks.claims.contact_edge import Measured, measured_images
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
    print(
        f"\nContact images of known truth, 500 ppi, 100-300 mm2, irregular, creased, {count} per noise level"
    )
    print("    asked: gross area bias 1 %, 95 % within 3 %; axes 2 %; orientation 2 deg; coverage 93-97 %")
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
            print(f"    noise {noise:.0f} {kind}:", end=" ")
            truths, errors, scores, turns, flags = measured(rendered)
            flagged = sum(bool(f) for f in flags)
            print(f"{flagged} of {len(flags)} flagged", sorted({x for f in flags for x in f}))
            for truth, *row in zip(truths, errors, scores, turns, strict=True):
                for name in (kind,) if kind else _groups_of(*truth, noise):
                    groups[name].append(row)
    print("    group        quantity      mean error  95 % within   worst   coverage  rms score")
    for name, rows in groups.items():
        if not rows:
            continue
        errors, scores, turns = (np.array(part) for part in zip(*rows, strict=True))
        for k, quantity in enumerate(QUANTITIES):
            e, z = errors[:, k], scores[:, k]
            print(f"    {name:<12} {quantity:<11} {e.mean():+9.2f} %", end=" ")
            print(f"{np.quantile(np.abs(e), 0.95):9.2f} % {np.abs(e).max():8.2f} %", end=" ")
            print(f"{100 * np.mean(np.abs(z) < 1.96):7.1f} % {np.sqrt(np.mean(z**2)):8.2f}")
        turns = np.abs(turns[np.isfinite(turns)])
        print(
            f"    {name:<12} orientation {'':11} {np.quantile(turns, 0.95):9.2f} deg {turns.max():6.2f} deg"
        )


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


def independent_accuracy(count: int) -> None:
    """Print errors and coverage on images that share no model with the measurement, by condition."""
    errors, scores, names = independent_errors(measured_images(count, seed=7))
    print(
        f"\nIndependently rendered contact images, {count} of each condition: mean error, intervals of 95 %"
    )
    print(f"    {'condition':<38} {'gross area':>19} {'ridge area':>19}   axes")
    for name in [*dict.fromkeys(names), "all"]:
        chosen = np.array([name in {each, "all"} for each in names])
        held = 100 * np.mean(np.abs(scores[chosen]) < 1.96, axis=0)
        mean = 100 * np.mean(errors[chosen], axis=0)
        print(f"    {name:<38}", *(f"{mean[k]:+7.2f} % {held[k]:7.0f} %  " for k in (2, 3)), end=" ")
        print(*(f"{held[k]:.0f} %" for k in (0, 1)))
    print(
        "    rms error",
        *(
            f"{q} {100 * e:.2f} %"
            for q, e in zip(QUANTITIES, np.sqrt(np.mean(errors**2, axis=0)), strict=True)
        ),
    )


def speed(repeats: int = 60) -> None:
    """Print the processor time of one measurement against that of decoding its PNG, side by side."""
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    print("\nOne 1024 x 1024 contact image, one thread, and the decoding of its PNG (asked: 2 x)")
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
        print(f"    ridges {ridge_period:.2f} mm apart: {measuring:.1f} and {decoding:.1f} ms,", end=" ")
        print(f"{measuring / decoding:.2f} x")
    cv2.setNumThreads(threads)


def report(images: int = 72, independent: int = 12) -> None:
    """Print errors and coverage on both kinds of images, and speed."""
    accuracy_and_coverage(images)
    independent_accuracy(independent)
    speed()
