"""Thickness and modulus from loading curves.

Circular contacts are solutions of the integral equation in `benchmarks.truth.loading_physics`, whole pads
those of the contact solver; none of the curves is made by the fast laws that are fitted.
"""

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from benchmarks.claims.loading_truth import Condition, make_curve
from benchmarks.tables import share, table
from benchmarks.truth.loading_physics import POISSON, Array, Contact, Pad, hertz, layer, pink
from fingerpad import Estimate
from fingerpad.contact import Tissue, solve_contact
from fingerpad.exceptions import FingerpadError
from fingerpad.geometry import Ellipsoid, Paraboloid, Placement
from fingerpad.loading import fit_layer_thickness

TABLE_1 = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
PLACED = Placement(TABLE_1, wedge_angle=math.radians(30))
DEEP = math.inf


@dataclass(frozen=True, kw_only=True)
class Case:
    """Curves of one kind: a thickness (mm), noise, and how well the radius is known."""

    thickness: float
    press: Condition = field(default_factory=Condition)
    radius_relative_std: float = 0.03
    whole: bool = False


def of_layer(
    thickness: float, spectrum: Callable[[Array], Array] | None = None, radius_relative_std: float = 0.03
) -> Case:
    """Return a case of circular contacts; a half-space where the thickness is infinite."""
    contact = layer(thickness) if thickness < DEEP else hertz
    press = Condition(contact=contact, spectrum=spectrum)
    return Case(thickness=thickness, press=press, radius_relative_std=radius_relative_std)


CASES: Mapping[str, Case] = MappingProxyType(
    {
        **{f"{t:g} mm, white noise": of_layer(t) for t in (3.0, 5.0, 8.0, 12.0, 15.0)},
        **{f"{t:g} mm, 1/f noise": of_layer(t, pink) for t in (3.0, 5.0, 8.0, 12.0, 15.0)},
        "8 mm, radius exact": of_layer(8.0, radius_relative_std=0.0),
        "8 mm, radius to 10 %": of_layer(8.0, radius_relative_std=0.1),
        "8 mm, areas 30 ms late": Case(thickness=8.0, press=Condition(contact=layer(8.0), lag=0.03)),
        "8 mm, pad of Table 1": Case(thickness=8.0, whole=True),
        "12 mm, pad of Table 1, 1/f noise": Case(thickness=12.0, whole=True, press=Condition(spectrum=pink)),
        "deep, white noise": of_layer(DEEP),
        "deep, 1/f noise": of_layer(DEEP, pink),
        "deep, radius to 10 %": of_layer(DEEP, radius_relative_std=0.1),
        "deep, pad of Table 1": Case(thickness=DEEP, whole=True),
    }
)


class Found(NamedTuple):
    """What one fit says: whether intervals hold the truth, and how wide that of t is."""

    thickness_held: float
    modulus_held: float
    offset_held: float
    width: float
    one_sided: bool
    undetermined: bool
    weight: float


@cache
def solved_pad(thickness: float, points: int = 64) -> tuple[CubicSpline, CubicSpline]:
    """Return load over E* and area of the pad of Table 1 against indentation, by the contact solver."""
    depths = 2.6 * np.linspace(0, 1, 15)[1:] ** 1.3
    tissue = Tissue.of_reduced_modulus(1.0, POISSON, thickness)
    solved = [solve_contact(PLACED, tissue, indentation=float(depth), points=points) for depth in depths]
    # W/ξ^(3/2) and A/ξ vary little, and are what is interpolated.
    load = CubicSpline(np.sqrt(depths), [one.load / one.indentation**1.5 for one in solved])
    return load, CubicSpline(np.sqrt(depths), [one.area / one.indentation for one in solved])


def whole_pad(thickness: float) -> Callable[[Pad, float], Contact]:
    """Press the pad of Table 1, its size scaled to the radius asked for."""
    of_load, of_area = solved_pad(thickness)

    def contact(pad: Pad, top: float) -> Contact:
        xi = np.append(0, np.linspace(0.02, 2.6, 600))
        load = pad.reduced * xi**1.5 * of_load(np.sqrt(xi))
        keep = load < 1.1 * top
        return xi[keep], load[keep], (xi * of_area(np.sqrt(xi)))[keep]

    return contact


def fit_once(case: Case, seed: int) -> Found:
    """Fit one curve of a pad of 30 to 80 kPa, and of 10 to 20 mm unless it is that of Table 1."""
    rng = np.random.default_rng(seed)
    table_radius = float(PLACED.curvature.mean_curvature_radius)
    radius = table_radius if case.whole else rng.uniform(10, 20)
    pad, place = Pad(radius=radius, modulus=rng.uniform(0.03, 0.08)), rng.uniform(-2, 2)
    press = case.press
    if case.whole:
        press = Condition(contact=whole_pad(case.thickness), spectrum=press.spectrum)
    curve = make_curve(press, pad, place, rng)
    scale = rng.normal(1, case.radius_relative_std)
    known = (
        replace(PLACED, ellipsoid=Ellipsoid(*(scale * TABLE_1.semi_axes)))
        if case.whole
        else Paraboloid(scale * radius, scale * radius)
    )
    fit = fit_layer_thickness(curve, placement=known, radius_std=case.radius_relative_std * scale * radius)
    t = fit.thickness
    there = t.known
    return Found(
        thickness_held=_held(t, case.thickness),
        modulus_held=_held(fit.youngs_modulus, pad.modulus),
        offset_held=_held(fit.contact_offset, place),
        width=(t.upper - t.lower) / case.thickness
        if t.known and t.upper < DEEP > case.thickness
        else math.nan,
        one_sided=t.known and t.upper == DEEP,
        undetermined=not there,
        weight=fit.layer_weight,
    )


def _held(quantity: Estimate, truth: float) -> float:
    if not quantity.known:
        return math.nan
    return float(quantity.lower <= truth <= quantity.upper)


def report(repeats: int = 40, words: str = "", first_seed: int = 90_000) -> None:
    """Print, of each case named with some words, the share of intervals that hold, and how wide t is."""
    pooled = []

    def cells(name: str, case: Case) -> tuple[object, ...]:
        start, found, refused = time.perf_counter(), [], 0
        for seed in range(first_seed, first_seed + repeats):
            try:
                found.append(fit_once(case, seed))
            except FingerpadError:
                refused += 1
        spent = 1000 * (time.perf_counter() - start) / repeats
        rows = np.array(found, dtype=float)
        if "late" not in name:
            pooled.append(rows)
        width = np.nanmedian(rows[:, 3]) if np.isfinite(rows[:, 3]).any() else math.nan
        above, none = share(rows[:, 4]), share(rows[:, 5])
        weight = f"{np.median(rows[:, 6]):.3f}"
        return name, *_held_shares(rows), f"{width:.2f}", above, none, weight, refused, f"{spent:.0f}"

    columns = ("curves", "t held", "E held", "x₀ held", "width of t over t", "open above", "undetermined")
    table(
        (*columns, "weight of a layer", "refused", "ms"),
        (cells(name, case) for name, case in CASES.items() if words in name),
        f"Thickness and modulus from loading curves, {repeats} each",
    )
    if pooled:
        every = np.concatenate(pooled)
        print(f"| all but late areas | {' | '.join(_held_shares(every))} |" + " |" * 6)


def _held_shares(rows: Array) -> list[str]:
    return [share(column[np.isfinite(column)]) for column in rows[:, :3].T]
