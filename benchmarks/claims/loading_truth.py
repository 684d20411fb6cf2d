"""Fits of loading curves where their model is wrong.

The curves are made of `benchmarks.truth.loading_physics` and share no model with the fit.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from benchmarks.arrays import Array, Rng
from benchmarks.tables import not_refused, percent, share, table
from benchmarks.truth import loading_physics as physics
from benchmarks.truth.loading_physics import Contact, Pad, pink
from fingerpad import Estimate
from fingerpad.loading import LoadingCurve, fit_loading_curve

# Flags that say what the pad is like, not that a number is in doubt.
DESCRIPTIVE = {"modulus_depends_on_load", "modulus_falls_with_load"}
QUANTITIES = ("initial_modulus", "loading_radius", "area_exponent", "contact_offset")
TOP = 2.0
SPEED = 1.0
APPROACH = 0.8


@dataclass(frozen=True, kw_only=True)
class Condition:
    """Contact and faults of a curve: by default a Hertzian paraboloid, and white noise in all columns."""

    contact: Callable[[Pad, float], Contact] = physics.hertz
    slope: float = 0.0  # β over E_0g, 1/N
    spectrum: Callable[[Array], Array] | None = None  # of the force's noise of 5 mN, none for white
    compliance: float = 0.0  # of the stage, mm/N
    lag: float = 0.0  # of the areas, s
    warm_up: float = 0.0  # level to which the force warms up within 2 s, N
    friction: float = 0.0  # deviation of each of about three friction steps per second, N
    area_exponent: float = np.nan  # n of A ∝ W^n, where there is one
    points: int = 200
    given: bool = False  # whether compliance (within a tenth) and lag are given to the fit
    baseline: bool = True  # whether the record begins before contact, or at a tenth of the way in contact
    areas: bool = True  # whether there are areas; without them the radius is given within 3 %


CONDITIONS: Mapping[str, Condition] = {
    "Hertz, white noise": Condition(area_exponent=2 / 3),
    "Hertz, white noise, 30 rows": Condition(area_exponent=2 / 3, points=30),
    "Hertz, white noise, 1000 rows": Condition(area_exponent=2 / 3, points=1000),
    "Hertz, noise of 20 ms": Condition(area_exponent=2 / 3, spectrum=physics.short_memory),
    "Hertz, 1/f noise": Condition(area_exponent=2 / 3, spectrum=pink),
    "growing modulus, white noise": Condition(slope=0.5),
    "growing modulus, 1/f noise": Condition(slope=0.5, spectrum=pink),
    "growing modulus, 1/f noise, 1000 rows": Condition(slope=0.5, spectrum=pink, points=1000),
    "ellipse, R'/R'' = 1.3": Condition(contact=physics.ellipsoid(1.3), area_exponent=2 / 3),
    "exact sphere": Condition(contact=physics.exact_sphere),
    "layer of 8 mm on bone": Condition(contact=physics.layer(8.0)),
    "layer of 5 mm on bone": Condition(contact=physics.layer(5.0)),
    "layer of 2 mm on bone": Condition(contact=physics.layer(2.0)),
    "sphere on a layer of 15 mm": Condition(contact=physics.layer(15.0, sphere=True)),
    "sphere on a layer of 8 mm": Condition(contact=physics.layer(8.0, sphere=True)),
    "sphere on a layer of 5 mm": Condition(contact=physics.layer(5.0, sphere=True)),
    "A ∝ W^0.42": Condition(contact=physics.free_area(0.42), area_exponent=0.42),
    "A ∝ W^0.55, growing modulus": Condition(contact=physics.free_area(0.55), slope=0.5, area_exponent=0.55),
    "stage yields 0.06 mm/N": Condition(compliance=0.06, area_exponent=2 / 3),
    "stage yields 0.06 mm/N, given": Condition(compliance=0.06, area_exponent=2 / 3, given=True),
    "area 100 ms late, given": Condition(lag=0.1, area_exponent=2 / 3, given=True),
    "area 30 ms late": Condition(lag=0.03, area_exponent=2 / 3),
    "area 100 ms late": Condition(lag=0.1, area_exponent=2 / 3),
    "force warms up by 40 mN": Condition(warm_up=0.04, area_exponent=2 / 3),
    "friction steps of 10 mN": Condition(friction=0.01, area_exponent=2 / 3),
    "Hertz, no baseline": Condition(area_exponent=2 / 3, baseline=False),
    "growing modulus, no baseline": Condition(slope=0.5, baseline=False),
    "Hertz, no baseline, no areas": Condition(baseline=False, areas=False),
    "Hertz, no areas": Condition(areas=False),
    "growing modulus, no areas": Condition(slope=0.5, areas=False),
    "layer of 8 mm on bone, no areas": Condition(contact=physics.layer(8.0), areas=False),
    "stage yields 0.06 mm/N, no areas": Condition(compliance=0.06, areas=False),
}


def random_pad(condition: Condition, rng: Rng) -> Pad:
    """Return a pad of 10 to 20 mm and 30 to 80 kPa."""
    modulus = rng.uniform(0.03, 0.08)
    return Pad(radius=rng.uniform(10, 20), modulus=modulus, slope=condition.slope * modulus)


def make_curve(condition: Condition, pad: Pad, place: float, rng: Rng) -> LoadingCurve:
    """Return a press at 1 mm/s to 2 N with contact at a place (mm), and a random zero and drift."""
    xi, load, area = condition.contact(pad, TOP)
    platen = xi + condition.compliance * load
    end = (APPROACH + np.interp(TOP, load, platen)) / SPEED
    clock = np.linspace(0, end, condition.points)
    step = clock[1]
    travel = SPEED * clock - APPROACH
    force = np.interp(travel, platen, load) + rng.uniform(-0.1, 0.1) + rng.uniform(-0.02, 0.02) * clock
    force += condition.warm_up * (1 - np.exp(-clock / 2))
    jumps = rng.poisson(3 * step, len(clock)) * rng.normal(0, condition.friction, len(clock))
    force += np.cumsum(jumps)
    if condition.spectrum is None:
        force += rng.normal(0, 0.005, len(clock))
    else:
        force += 0.005 * physics.coloured_noise(rng, len(clock), step, condition.spectrum)
        force += rng.normal(0, 0.001, len(clock))
    indentation = travel + place + rng.normal(0, 0.005, len(clock))
    areas = np.interp(travel - condition.lag * SPEED, platen, area) + rng.normal(0, 1, len(clock))
    kept = travel > (-np.inf if condition.baseline else 0.1 * travel[-1])
    return LoadingCurve(load=force[kept], indentation=indentation[kept], area=areas[kept], time=clock[kept])


def fit_errors(condition: Condition, seed: int) -> dict[str, float]:
    """Fit one curve; compare with E of the tissue, the radius of curvature, and the exponent of area.

    Returned are the relative error of each quantity that is known, and whether its interval holds the truth.
    """
    rng = np.random.default_rng(seed)
    pad = random_pad(condition, rng)
    place = rng.uniform(-2, 2)
    known: dict[str, Any] = {}
    if condition.given:
        assumed = rng.normal(condition.compliance, 0.1 * condition.compliance)
        known["stage_compliance"] = Estimate.symmetric(assumed, 0.1 * condition.compliance)
        known["area_delay"] = condition.lag
    curve = make_curve(condition, pad, place, rng)
    if not condition.areas:
        curve = replace(curve, area=None)
        std = 0.03 * pad.radius
        known["loading_radius"] = Estimate.symmetric(rng.normal(pad.radius, std), std)
    fit = fit_loading_curve(curve, **known)
    truth = dict(zip(QUANTITIES, (pad.modulus, pad.radius, condition.area_exponent, place), strict=True))
    found: dict[str, float] = {"flagged": bool(set(fit.flags) - DESCRIPTIVE)}
    for name, true in truth.items():
        estimate = getattr(fit, name)
        if estimate.known and np.isfinite(true):
            found[name] = (estimate.value - true) / true
            found[f"{name} held"] = estimate.lower <= true <= estimate.upper
    return found


def report(repeats: int = 24, first_seed: int = 50_000) -> None:
    """Print, of each condition and quantity, the error, coverage and flags."""
    columns = "condition", "flagged", "refused", *(name.replace("_", " ") for name in QUANTITIES)
    rows: list[tuple[object, ...]] = []
    for name, condition in CONDITIONS.items():
        fits, refused = not_refused(partial(fit_errors, condition), range(first_seed, first_seed + repeats))
        cells = (_cell(fits, quantity) for quantity in QUANTITIES)
        rows.append((name, share(fits["flagged"]), refused, *cells))
    title = f"{repeats} curves each: median error; held by 95 % intervals (by those of curves without a flag)"
    table(columns, rows, title)


def _cell(fits: pd.DataFrame, name: str) -> str:
    if name not in fits:
        return "–"
    error, held, flagged = fits.dropna(subset=name)[[name, f"{name} held", "flagged"]].to_numpy(dtype=float).T
    return f"{percent(float(np.median(error)), '+')}; {share(held)} ({share(held[flagged == 0])})"
