"""Accuracy and speed, measured here and now: ``make bench``.

Ratios compare runs side by side in one process; seconds depend on the machine.
"""

import time
from collections.abc import Callable

import cv2
import mpmath as mp
import numpy as np
from scipy.special import ellipe, ellipk

from benchmarks.exact import RATIOS, exact_contact
from fingerpad.contact import HertzGeometry, hertz_contact, solve_contact_ellipse
from fingerpad.image import Imprint, Scale, SyntheticImprint, measure_imprint, render_imprint


def best(function: Callable[[], object], repeats: int = 9) -> float:
    """Return the shortest of several run times, in seconds."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        function()
        times.append(time.perf_counter() - start)
    return min(times)


def hertz_accuracy() -> None:
    """Print the largest relative error of each quantity over all curvature ratios."""
    worst = np.zeros(4)
    for ratio in RATIOS:
        contact = hertz_contact(8.0, 8.0 * ratio, 2.0, reduced_modulus=0.1365)
        found = (contact.semi_major, contact.semi_minor, contact.indentation, contact.peak_pressure)
        exact = exact_contact(ratio, 8.0, 2.0, 0.1365)
        error = [abs(float(mp.mpf(float(a)) / b - 1)) for a, b in zip(found, exact, strict=True)]
        worst = np.maximum(worst, error)
    print("Elliptical Hertz contact against 50 digits, curvature ratios 1, 1 + 1e-15 ... 1e7")
    print("  largest relative error (asked: 4e-15)")
    for name, largest in zip(
        ("semi_major", "semi_minor", "indentation", "peak_pressure"), worst, strict=True
    ):
        print(f"    {name:<14} {largest:.1e}")


def hertz_speed(count: int = 1_000_000) -> None:
    """Print the time of distinct contacts as multiples of SciPy's two elliptic integrals."""
    rng = np.random.default_rng(0)
    first = rng.uniform(5, 20, count)
    second = first * np.exp(rng.uniform(0, np.log(1e7), count))
    load, modulus = rng.uniform(0.1, 4, count), rng.uniform(0.05, 0.2, count)
    m = 1 - solve_contact_ellipse(first, second)[0] ** 2
    geometry = HertzGeometry.of(first, second)
    floor = best(lambda: (ellipk(m), ellipe(m)))
    print(f"\n{count:,} contacts, one thread; floor: SciPy ellipk + ellipe, {1e3 * floor:.0f} ms")
    for name, call in (
        (
            "hertz_contact, all distinct (asked: 3)",
            lambda: hertz_contact(first, second, load, reduced_modulus=modulus),
        ),
        ("HertzGeometry.of(...)", lambda: HertzGeometry.of(first, second)),
        ("under_load on a solved geometry", lambda: geometry.under_load(load, reduced_modulus=modulus)),
    ):
        print(f"    {name:<40} {best(call) / floor:.2f} x floor")


def imprint_accuracy(count: int = 72) -> None:
    """Print errors of the measurement of contact images on rendered ones, three noise levels."""
    rng = np.random.default_rng(1)
    print(f"\nContact images of known truth, 500 ppi, 100-300 mm2, {count} per noise level")
    print("    noise  quantity        mean error   95 % within   worst")
    for noise in (4.0, 12.0, 25.0):
        errors = np.array([_imprint_errors(rng, noise) for _ in range(count)])
        for name, column, unit in zip(
            ("gross area", "semi-major", "semi-minor", "orientation"),
            errors.T,
            ("%", "%", "%", "deg"),
            strict=True,
        ):
            good = column[np.isfinite(column)]
            within, worst = np.quantile(np.abs(good), 0.95), np.abs(good).max()
            print(f"    {noise:5.0f}  {name:<14} {good.mean():+9.2f} {unit:<4}", end="")
            print(f" {within:8.2f} {unit:<4} {worst:6.2f} {unit}")


def _imprint_errors(rng: np.random.Generator, noise: float) -> tuple[float, float, float, float]:
    area, ratio = rng.uniform(100, 300), rng.uniform(1.0, 1.7)
    major = np.sqrt(area * ratio / np.pi)
    truth = render_imprint(
        semi_major=major,
        semi_minor=major / ratio,
        orientation=rng.uniform(-np.pi / 2, np.pi / 2),
        pattern=rng.choice(["arch", "loop", "whorl"]),
        look=rng.choice(["ink", "livescan", "prism"]),
        noise_std=noise,
        seed=int(rng.integers(1 << 31)),
    )
    found = measure_imprint(truth.pixels, Scale.of_ppi(500))
    turn = np.degrees((found.orientation - truth.orientation + np.pi / 2) % np.pi - np.pi / 2)
    return (*_relative_errors(found, truth), turn if ratio >= 1.2 else np.nan)


def _relative_errors(found: Imprint, truth: SyntheticImprint) -> tuple[float, float, float]:
    return (
        100 * (found.gross_area / truth.gross_area - 1),
        100 * (float(found.ellipse.semi_major / truth.ellipse.semi_major) - 1),
        100 * (float(found.ellipse.semi_minor / truth.ellipse.semi_minor) - 1),
    )


def imprint_speed() -> None:
    """Print the time of one measurement against the decoding of its PNG."""
    cv2.setNumThreads(1)
    truth = render_imprint(semi_major=12.0, semi_minor=10.0, margin=14.0, seed=1)
    pixels = cv2.resize(truth.pixels, (1024, 1024))
    encoded = cv2.imencode(".png", pixels)[1]
    floor = best(lambda: cv2.imdecode(encoded, cv2.IMREAD_GRAYSCALE))
    measuring = best(lambda: measure_imprint(pixels, Scale.of_ppi(500)), 5)
    print(f"\nOne 1024 x 1024 contact image, one thread: {1e3 * measuring:.0f} ms,", end=" ")
    print(f"{measuring / floor:.1f} x the decoding of its PNG")


if __name__ == "__main__":
    hertz_accuracy()
    hertz_speed()
    imprint_accuracy()
    imprint_speed()
