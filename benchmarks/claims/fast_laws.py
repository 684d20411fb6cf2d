"""Hertz theory, the fast laws and the solver side by side."""

import time
from collections.abc import Callable
from functools import partial

import numpy as np

from benchmarks.derive.solved_contacts import AREA_BIAS, KEPT, circular_contacts, kept_contacts
from benchmarks.tables import table
from fingerpad._arrays import FloatArray
from fingerpad.contact import Tissue, fast_contact, hertz_contact, solve_contact
from fingerpad.contact.fast_laws import plate_gap, press
from fingerpad.geometry import Ellipsoid, Paraboloid, Placement

_NAMES = "load", "area", "indentation"


def circles() -> None:
    """Print errors for circular contacts on a layer, which one integral equation solves to ten digits."""
    rows = []
    sizes = np.array([0.05, 0.1, 0.3, 0.5, 1.0, 2.0, 3.0])
    ball = Paraboloid(10.0, 10.0)
    for nu in (0.5, 0.48, 0.45, 0.3):
        load, depth, _ = circular_contacts(sizes, nu).T
        force, area, indentation = 0.4 / 3 * sizes**3 / 10 * load, np.pi * sizes**2, sizes**2 / 10 * depth
        tissue = Tissue.of_reduced_modulus(0.1, nu, thickness=1.0)
        hertz = hertz_contact(ball, tissue, load=force)
        fast = fast_contact(ball, tissue, load=force)
        for i, size in enumerate(sizes):
            solved = solve_contact(ball, tissue, load=float(force[i]))
            found = [(one.area[i], one.indentation[i]) for one in (hertz, fast)]
            found.append((solved.area, solved.indentation))
            errors = [f"{a / area[i] - 1:+.0e}, {x / indentation[i] - 1:+.0e}" for a, x in found]
            ratios = (f"{one:.3f}" for one in (1 / depth[i], load[i] / depth[i] ** 1.5, load[i]))
            rows.append((f"{size:g}", f"{nu:g}", *ratios, *errors))
    columns = (
        "a/t", "ν", "A/(πRξ)", "W over Hertz at ξ", "at A", "Hertz: errors of A, ξ at W", "fast law",
        "solver",
    )  # fmt: skip
    table(columns, rows, "A circular contact on a bonded layer, by one integral equation to ten digits")


def held_out() -> None:
    """Print the laws' largest errors in contacts that nothing was fitted to, and Hertz theory's."""
    kept = np.load(KEPT)
    rows: list[tuple[object, ...]] = []
    for title, name in (
        ("elliptical paraboloid on a layer", "elliptical_held_out"),
        ("whole pad on deep tissue", "pads_held_out"),
        ("whole pad on a layer", "layered_held_out"),
    ):
        contacts = kept[name]
        placement, tissue = kept_contacts(contacts, is_pad=not name.startswith("elliptical"))
        load, area, depth, ratio, peak = contacts[:, -5:].T
        solved = {"load": load, "area": area / AREA_BIAS, "indentation": depth}
        for given in _NAMES:
            fast = fast_contact(placement, tissue, **{given: solved[given]})
            hertz = hertz_contact(placement, tissue, **{given: solved[given]})
            inside = fast.flag_code == 0
            errors = [
                _cell(getattr(fast, each)[inside], solved[each][inside], getattr(hertz, each)[inside])
                if each != given
                else "given"
                for each in _NAMES
            ]
            rows.append((title, given, f"{inside.sum()} of {len(contacts)}", *errors, "", ""))
        form = fast_contact(placement, tissue, area=solved["area"])
        inside = np.isfinite(form.semi_major)
        hertz = hertz_contact(placement, tissue, area=solved["area"])
        mean = load / solved["area"]
        shape = _cell(form.aspect_ratio[inside], 1 / ratio[inside], hertz.aspect_ratio[inside])
        peaks = (form.peak_pressure / form.mean_pressure * mean)[inside]
        highest = _cell(peaks, peak[inside], (1.5 * mean)[inside])
        rows.append((title, "area", f"{inside.sum()} of {len(contacts)}", "", "", "", shape, highest))
    table(
        ("contacts", "given", "within range", *_NAMES, "aspect ratio", "peak pressure"),
        rows,
        "Largest error on contacts that nothing was fitted to (Hertz theory's)",
    )


def _cell(fast: FloatArray, solved: FloatArray, hertz: FloatArray) -> str:
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
    placement = Placement(
        pads, wedge_angle=rng.uniform(0, 1.5, count), roll_angle=rng.uniform(-0.5, 0.5, count)
    )
    whole = plate_gap(placement)
    calls: dict[str, Callable[[], object]] = {"Hertz": partial(hertz_contact, bodies, soft, load=load)}
    for title, of, given in (
        ("layer, one ν, by area", gap, {"area": 40 * load, "thickness": thickness}),
        ("layer, by area", gap, {"area": 40 * load, "thickness": thickness, "poisson_ratio": nu}),
        ("layer, by load", gap, {"load": load, "thickness": thickness, "poisson_ratio": nu}),
        ("whole pad, by area", whole, {"area": 40 * load}),
        ("whole pad, by load", whole, {"load": load}),
        ("whole pad on a layer, by load", whole, {"load": load, "thickness": thickness, "poisson_ratio": nu}),
    ):
        calls[title] = partial(press, of, reduced_modulus=0.1, **given)
    on_layer = Tissue(youngs_modulus=0.075, poisson_ratio=nu, thickness=thickness)
    calls["the same from placements, with its gap"] = partial(fast_contact, placement, on_layer, load=load)
    shortest = dict.fromkeys(calls, np.inf)
    for _ in range(9):
        for title, call in calls.items():
            start = time.process_time()
            call()
            shortest[title] = min(shortest[title], time.process_time() - start)
    table(
        ("law", "time over that of `hertz_contact`"),
        ((title, f"{seconds / shortest['Hertz']:.1f}") for title, seconds in shortest.items()),
        f"{count:,} contacts, one thread",
    )


def report() -> None:
    """Print all tables."""
    held_out()
    cost()
    circles()
