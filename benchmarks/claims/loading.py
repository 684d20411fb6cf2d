"""Loading curves of known truth."""

import time
from typing import Any

import numpy as np

from benchmarks.tables import table
from fingerpad.exceptions import FingerpadError
from fingerpad.loading import fit_loading_curve
from fingerpad.simulate import simulate_loading_curve

# Force noise that forgets within 20 ms, and white noise of a stage and of areas.
NOISE: dict[str, Any] = {
    "force_std": 0.005,
    "correlation_time": 0.02,
    "displacement_std": 0.005,
    "area_std": 1.0,
}
PAD: dict[str, Any] = {"loading_radius": 15.0, "initial_modulus": 0.04}
QUANTITIES = ("loading_radius", "reduced_modulus", "initial_modulus", "load_coefficient", "contact_offset")


def report(repeats: int = 1000, first_seed: int = 10_000) -> None:
    """Print how often stated 95 % intervals hold the truth, and the bias, by number of points."""
    for beta, name in ((0.0, "Hertz, E = 40 kPa"), (0.02, "E_0g = 40 kPa, β = 20 kPa/N")):
        table(
            ("points", "refused", "seconds a fit", *QUANTITIES),
            (_cells(points, beta, repeats, first_seed) for points in (20, 50, 100, 500, 2000)),
            f"{name}, R_g = 15 mm, {repeats} curves each to 2 N: held, bias over the stated uncertainty",
        )


def _cells(points: int, beta: float, repeats: int, first_seed: int) -> list[object]:
    rows, refused, start = [], 0, time.perf_counter()
    for seed in range(first_seed, first_seed + repeats):
        try:
            rows.append(coverage_row(points, beta, seed))
        except FingerpadError:
            refused += 1
    cells: list[object] = [points, refused, f"{(time.perf_counter() - start) / repeats:.2f}"]
    for inside, error, std in np.array(rows).transpose(1, 2, 0):
        cells.append(f"{100 * np.nanmean(inside):.1f} %, {np.nanmean(error) / np.nanmedian(std):+.2f}")
    return cells


def coverage_row(points: int, beta: float, seed: int) -> list[tuple[float, float, float]]:
    """Return, of each quantity, whether its interval holds the truth, its error, and its uncertainty."""
    rng = np.random.default_rng(seed)
    place, zero, tilt = rng.uniform(-2, 2), rng.uniform(-0.1, 0.1), rng.uniform(-0.02, 0.02)
    curve = simulate_loading_curve(
        **PAD,
        **NOISE,
        load_coefficient=beta,
        contact_offset=place,
        force_offset=zero,
        force_tilt=tilt,
        approach=0.8,
        points=points,
        seed=seed,
    )
    fit = fit_loading_curve(curve)
    secant = (PAD["initial_modulus"] + beta * fit.modulus_load) / 0.75
    truth = {**PAD, "load_coefficient": beta, "contact_offset": place, "reduced_modulus": secant}
    row = []
    for name in QUANTITIES:
        found = getattr(fit, name)
        if found.known:
            inside = found.lower <= truth[name] <= found.upper
            row.append((float(inside), found.value - truth[name], found.std))
        else:
            row.append((np.nan, np.nan, np.nan))
    return row
