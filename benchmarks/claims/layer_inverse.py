"""Thickness and modulus from loading curves.

Circular contacts are solutions of the integral equation in `benchmarks.truth.loading_physics`, whole pads
those of the contact solver; none of the curves is made by the fast laws that are fitted.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache, partial

import numpy as np
import pandas as pd
from scipy.interpolate import CubicSpline

from benchmarks.arrays import Array
from benchmarks.claims.loading_truth import Condition, make_curve
from benchmarks.simulated import PLACED, TABLE_1
from benchmarks.tables import not_refused, share, table
from benchmarks.truth.loading_physics import POISSON, Contact, Pad, hertz, layer, pink
from fingerpad.contact import Tissue, solve_contact
from fingerpad.contact.contact import AnyPlacement
from fingerpad.geometry import Ellipsoid, Paraboloid
from fingerpad.loading import fit_layer_thickness

DEEP = math.inf


@dataclass(frozen=True)
class Case:
    """Curves of one kind: a thickness (mm), noise, and how well the radius is known."""

    thickness: float
    spectrum: Callable[[Array], Array] | None = None  # of the force's noise, none for white
    radius_relative_std: float = 0.03
    whole: bool = False  # the pad of Table 1, in place of a paraboloid
    lag: float = 0.0  # of the areas, s


CASES: Mapping[str, Case] = {
    **{f"{t:g} mm, white noise": Case(t) for t in (3.0, 5.0, 8.0, 12.0, 15.0)},
    **{f"{t:g} mm, 1/f noise": Case(t, pink) for t in (3.0, 5.0, 8.0, 12.0, 15.0)},
    "8 mm, radius exact": Case(8.0, radius_relative_std=0.0),
    "8 mm, radius to 10 %": Case(8.0, radius_relative_std=0.1),
    "8 mm, areas 30 ms late": Case(8.0, lag=0.03),
    "8 mm, pad of Table 1": Case(8.0, whole=True),
    "12 mm, pad of Table 1, 1/f noise": Case(12.0, pink, whole=True),
    "deep, white noise": Case(DEEP),
    "deep, 1/f noise": Case(DEEP, pink),
    "deep, radius to 10 %": Case(DEEP, radius_relative_std=0.1),
    "deep, pad of Table 1": Case(DEEP, whole=True),
}


@cache
def solved_pad(thickness: float) -> tuple[CubicSpline, CubicSpline]:
    """Return load over E* and area of the pad of Table 1 against indentation, by the contact solver."""
    depths = 2.6 * np.linspace(0, 1, 15)[1:] ** 1.3
    tissue = Tissue.of_reduced_modulus(1.0, POISSON, thickness)
    solved = [solve_contact(PLACED, tissue, indentation=float(depth), points=64) for depth in depths]
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


def fit_once(case: Case, seed: int) -> dict[str, float]:
    """Fit one curve of a pad of 30 to 80 kPa, and of 10 to 20 mm unless it is that of Table 1.

    Returned is whether intervals hold the truth, NaN where there is none, and how wide that of t is.
    """
    rng = np.random.default_rng(seed)
    table_radius = float(PLACED.curvature.mean_curvature_radius)
    radius = table_radius if case.whole else rng.uniform(10, 20)
    pad, place = Pad(radius=radius, modulus=rng.uniform(0.03, 0.08)), rng.uniform(-2, 2)
    on_bone = whole_pad if case.whole else layer
    contact = on_bone(case.thickness) if case.whole or case.thickness < DEEP else hertz
    curve = make_curve(Condition(contact=contact, spectrum=case.spectrum, lag=case.lag), pad, place, rng)
    scale = rng.normal(1, case.radius_relative_std)
    known: AnyPlacement = Paraboloid(scale * radius, scale * radius)
    if case.whole:
        known = replace(PLACED, ellipsoid=Ellipsoid(*(scale * TABLE_1.semi_axes)))
    fit = fit_layer_thickness(curve, placement=known, radius_std=case.radius_relative_std * scale * radius)
    t = fit.thickness
    pairs = (t, case.thickness), (fit.youngs_modulus, pad.modulus), (fit.contact_offset, place)
    held = (float(one.lower <= true <= one.upper) if one.known else math.nan for one, true in pairs)
    closed = t.known and t.upper < DEEP > case.thickness
    return dict(zip(("t held", "E held", "x₀ held"), held, strict=True)) | {
        "width of t over t": (t.upper - t.lower) / case.thickness if closed else math.nan,
        "open above": t.known and t.upper == DEEP,
        "undetermined": not t.known,
        "weight of a layer": fit.layer_weight,
    }


def report(repeats: int = 10, first_seed: int = 90_000) -> None:
    """Print, of each case, the share of intervals that hold, and how wide t is."""
    seeds = range(first_seed, first_seed + repeats)
    fits = {name: not_refused(partial(fit_once, case), seeds) for name, case in CASES.items()}

    def cells(name: str) -> Iterator[object]:
        found, refused = fits[name]
        *held, width, open_, undetermined, weight = (found[column].dropna() for column in found)
        yield from (name, *map(share, held), f"{width.median():.2f}" if width.size else "–")
        yield from (share(open_), share(undetermined), f"{weight.median():.3f}", refused)

    columns = ("curves", *next(iter(fits.values()))[0], "refused")
    table(columns, map(list, map(cells, CASES)), f"Thickness and modulus from loading curves, {repeats} each")
    every = pd.concat([fits[name][0] for name, case in CASES.items() if not case.lag])
    shares = (share(every[column].dropna()) for column in columns[1:4])
    print(f"| all but late areas | {' | '.join(shares)} |" + " |" * 5)
