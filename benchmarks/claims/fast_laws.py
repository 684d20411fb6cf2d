"""Hertz theory, the fast laws and the solver side by side."""

import time
from collections.abc import Callable
from functools import partial

import numpy as np
import pandas as pd

from benchmarks.arrays import Array
from benchmarks.derive.solved_contacts import AREA_BIAS, KEPT, kept_contacts, kept_pads
from benchmarks.tables import table
from benchmarks.truth.layers import circular_contacts
from fingerpad.contact import Contact, Tissue, fast_contact, hertz_contact, solve_contact
from fingerpad.contact.fast_laws import plate_gap, press
from fingerpad.geometry import Ellipsoid, Paraboloid, Placement

_NAMES = "load", "area", "indentation"
_RADIUS, _MODULUS = 10.0, 0.1
_BALL = Paraboloid(_RADIUS, _RADIUS)
# Powers of √(Rξ)/t in the load over that of Hertz theory at one indentation, ν = 0.5.
SERIES = {
    "García 2018": (1, 1.133, 1.497, 1.469, 0.755),
    "Dimitriadis 2002": (1, 1.133, 1.283, 0.769, 0.0975),
}


class Circles:
    """Circular contacts of a paraboloid on a bonded layer of thickness 1, by the integral equation."""

    def __init__(self, sizes: Array, poisson_ratio: float) -> None:
        load, depth, _ = circular_contacts(sizes, poisson_ratio).T
        self.tissue = Tissue.of_reduced_modulus(_MODULUS, poisson_ratio, thickness=1.0)
        self.area, self.indentation = np.pi * sizes**2, sizes**2 / _RADIUS * depth
        self.load = 4 / 3 * _MODULUS * sizes**3 / _RADIUS * load
        self.area_ratio, self.load_at_area, self.load_at_depth = 1 / depth, load, load / depth**1.5

    def series(self, name: str) -> Array:
        """Return the load over that of Hertz theory at one indentation, by a published series."""
        return np.polynomial.polynomial.polyval(np.sqrt(_RADIUS * self.indentation), SERIES[name])

    def pressed(self, law: Callable[..., Contact], given: str) -> Contact:
        """Return the same contacts by Hertz theory or a fast law, from their loads or their indentations."""
        return law(_BALL, self.tissue, **{given: getattr(self, given)})

    def solved(self, given: str) -> pd.DataFrame:
        """Return load, area and indentation of the same contacts on 256² cells, by loads or indentations."""
        solved = (solve_contact(_BALL, self.tissue, **{given: one}) for one in getattr(self, given).tolist())
        return pd.DataFrame([{name: float(getattr(one, name)) for name in _NAMES} for one in solved])


def circles() -> None:
    """Print errors for circular contacts on a layer, which one integral equation solves to ten digits."""
    rows = []
    sizes = np.array([0.03, 0.05, 0.1, 0.2, 0.3, 0.5, 1.0, 2.0, 3.0])
    for nu in (0.5, 0.48, 0.45, 0.3):
        exact = Circles(sizes, nu)
        ways = *(exact.pressed(law, "load") for law in (hertz_contact, fast_contact)), exact.solved("load")
        for i, size in enumerate(sizes):
            found = [(one.area[i], one.indentation[i]) for one in ways]
            errors = [f"{a / exact.area[i] - 1:+.0e}, {x / exact.indentation[i] - 1:+.0e}" for a, x in found]
            ratios = (f"{one[i]:.3f}" for one in (exact.area_ratio, exact.load_at_depth, exact.load_at_area))
            rows.append((f"{size:g}", f"{nu:g}", *ratios, *errors))
    columns = "a/t", "ν", "A/(πRξ)", "W over Hertz at ξ", "at A", "Hertz: errors of A, ξ at W"
    title = "A circular contact on a bonded layer, by one integral equation to ten digits"
    table((*columns, "fast law", "solver"), rows, title)
    sizes = np.array([0.05, 0.1, 0.15, 0.2, 0.25, 0.5, 0.7])
    exact, head = Circles(sizes, 0.5), ("series", *(f"a/t = {size:g}" for size in sizes))
    errors_of = {name: exact.series(name) / exact.load_at_depth - 1 for name in SERIES}
    cells = ((name, *(f"{one:+.2%}" for one in errors)) for name, errors in errors_of.items())
    table(head, cells, "Errors of published series: load at an indentation, ν = 0.5")


def silhouette_radius(pads: Placement) -> Array:
    """Return the mean radius of the pads' silhouettes seen along the plate's normal."""
    axes = pads.ellipsoid.semi_axes
    across = np.sqrt(((pads.normal / axes) ** 2).sum(axis=-1))
    return np.sqrt(axes.prod(axis=-1) * across)


def hertz_by_size() -> None:
    """Print by how much Hertz theory misses whole pads on deep tissue, by the size of the contact."""
    kept = np.load(KEPT)["pads_held_out"]
    pads, tissue = kept_pads(kept), Tissue.of_reduced_modulus(1.0)
    load, area, depth = kept[:, -5], kept[:, -4] / AREA_BIAS, kept[:, -3]
    radius, at_load = np.sqrt(area / np.pi), hertz_contact(pads, tissue, load=load)
    errors = {
        "E from load and area": load / hertz_contact(pads, tissue, area=area).load - 1,
        "E from load and indentation": load / hertz_contact(pads, tissue, indentation=depth).load - 1,
        "area at a load": at_load.area / area - 1,
        "indentation at a load": at_load.indentation / depth - 1,
    }
    rows = []
    for of, size in (
        ("mean radius of its silhouette", radius / silhouette_radius(pads)),
        ("radius of curvature (a/R)", radius / pads.curvature.geometric_mean_radius),
    ):
        for low in (0.1, 0.2, 0.3, 0.4, 0.5):
            inside = (low <= size) & (size < low + 0.1)
            parts = (100 * np.quantile(one[inside], [0, 0.5, 1]) for one in errors.values())
            ranges = (f"{middle:+.1f} % ({least:+.0f} to {most:+.0f})" for least, middle, most in parts)
            rows.append((f"{low:g} to {low + 0.1:g} of the {of}", inside.sum(), *ranges))
    title = "Errors of Hertz theory for whole pads on deep tissue: median (range)"
    table(("contact radius", "pads", *errors), rows, title)


def held_out() -> None:
    """Print the laws' largest errors in contacts that nothing was fitted to, and Hertz theory's."""
    kept = np.load(KEPT)
    rows: list[tuple[object, ...]] = []
    titles = "elliptical paraboloid on a layer", "whole pad on deep tissue", "whole pad on a layer"
    for title, name in zip(titles, ("elliptical", "pads", "layered"), strict=True):
        contacts = kept[f"{name}_held_out"]
        placement, tissue = kept_contacts(contacts, is_pad=name != "elliptical")
        load, area, depth, ratio, peak = contacts[:, -5:].T
        solved = {"load": load, "area": area / AREA_BIAS, "indentation": depth}
        for given in _NAMES:
            fast = fast_contact(placement, tissue, **{given: solved[given]})
            hertz = hertz_contact(placement, tissue, **{given: solved[given]})
            inside = fast.flag_code == 0
            three = ((getattr(fast, each), solved[each], getattr(hertz, each)) for each in _NAMES)
            errors = dict(zip(_NAMES, (_cell(*(one[inside] for one in some)) for some in three), strict=True))
            errors[given] = "given"
            rows.append((title, given, f"{inside.sum()} of {len(contacts)}", *errors.values(), "", ""))
        form = fast_contact(placement, tissue, area=solved["area"])
        inside = np.isfinite(form.semi_major)
        hertz = hertz_contact(placement, tissue, area=solved["area"])
        mean = load / solved["area"]
        peaks = form.peak_pressure / form.mean_pressure * mean
        pair = (form.aspect_ratio, 1 / ratio, hertz.aspect_ratio), (peaks, peak, 1.5 * mean)
        cells = (_cell(*(one[inside] for one in some)) for some in pair)
        rows.append((title, "area", f"{inside.sum()} of {len(contacts)}", "", "", "", *cells))
    columns = "contacts", "given", "within range", *_NAMES, "aspect ratio", "peak pressure"
    table(columns, rows, "Largest error on contacts that nothing was fitted to (Hertz theory's)")


def at_two_limits(count: int = 50) -> None:
    """Print the laws' largest errors where contacts near both the width and the thickness that end them."""
    rng, errors, left_out = np.random.default_rng(0), [], 0
    for _ in range(count):
        pad = Ellipsoid(*rng.uniform([6, 9, 8], [10, 16, 13]))
        placement = Placement(pad, wedge_angle=rng.uniform(0, 1.5), roll_angle=rng.uniform(-0.5, 0.5))
        radius = 0.59 * float(silhouette_radius(placement))
        tissue = Tissue.of_reduced_modulus(_MODULUS, 0.5, thickness=radius / 2.95)
        if fast_contact(placement, tissue, area=np.pi * radius**2).flag_code:
            left_out += 1
            continue
        solved = solve_contact(placement, tissue, area=np.pi * radius**2, points=128)
        true = {"load": solved.load, "area": solved.area / AREA_BIAS, "indentation": solved.indentation}
        fast = [fast_contact(placement, tissue, **{name: true[name]}) for name in _NAMES]
        errors.append([[getattr(one, name) / true[name] - 1 for name in _NAMES] for one in fast])
    least, most = np.min(errors, axis=0), np.max(errors, axis=0)
    rows = [
        [
            given,
            *(
                "given" if name == given else f"{a:+.1%} to {b:+.1%}"
                for name, a, b in zip(_NAMES, low, high, strict=True)
            ),
        ]
        for given, low, high in zip(_NAMES, least, most, strict=True)
    ]
    title = (
        f"Errors of {len(errors)} random pads at 0.59 of the silhouette and 2.95 times the thickness, ν = 0.5"
    )
    table(("given", *_NAMES), rows, f"{title}; {left_out} more are out of range")


def _cell(fast: Array, solved: Array, hertz: Array) -> str:
    return f"{np.abs(fast / solved - 1).max():.2%} ({np.abs(hertz / solved - 1).max():.0%})"


def cost(count: int = 400_000) -> None:
    """Print the laws' time over that of Hertz theory, side by side."""
    rng = np.random.default_rng(0)
    first = rng.uniform(8, 20, count)
    second = first * rng.uniform(0.6, 1, count)
    load, thickness = rng.uniform(0.1, 2, count), rng.uniform(5, 12, count)
    nu = rng.uniform(0.3, 0.5, count)
    pads = Ellipsoid(*rng.uniform([7, 11, 9], [9, 15, 12], (count, 3)).T)
    bodies, soft = Paraboloid(first, second), Tissue(youngs_modulus=0.075)
    gap = bodies.gap
    wedge, roll = rng.uniform(0, 1.5, count), rng.uniform(-0.5, 0.5, count)
    placement = Placement(pads, wedge_angle=wedge, roll_angle=roll)
    whole, area, on_layer = plate_gap(placement), {"area": 40 * load}, {"thickness": thickness}
    calls: dict[str, Callable[[], object]] = {"Hertz": partial(hertz_contact, bodies, soft, load=load)}
    for title, of, given in (
        ("layer, one ν, by area", gap, area | on_layer),
        ("layer, by area", gap, area | on_layer | {"poisson_ratio": nu}),
        ("layer, by load", gap, {"load": load} | on_layer | {"poisson_ratio": nu}),
        ("whole pad, by area", whole, area),
        ("whole pad, by load", whole, {"load": load}),
        ("whole pad on a layer, by load", whole, {"load": load} | on_layer | {"poisson_ratio": nu}),
    ):
        calls[title] = partial(press, of, reduced_modulus=0.1, **given)
    tissue = Tissue(youngs_modulus=0.075, poisson_ratio=nu, thickness=thickness)
    calls["the same from placements, with its gap"] = partial(fast_contact, placement, tissue, load=load)
    shortest = dict.fromkeys(calls, np.inf)
    for _ in range(9):
        for title, call in calls.items():
            start = time.process_time()
            call()
            shortest[title] = min(shortest[title], time.process_time() - start)
    rows = ((title, f"{seconds / shortest['Hertz']:.1f}") for title, seconds in shortest.items())
    table(("law", "time over that of `hertz_contact`"), rows, f"{count:,} contacts, one thread")


def report() -> None:
    """Print all tables."""
    held_out()
    at_two_limits()
    hertz_by_size()
    cost()
    circles()
