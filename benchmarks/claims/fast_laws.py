"""Hertz theory, the fast laws and the solver side by side."""

import time
from collections.abc import Callable
from functools import partial

import numpy as np

from benchmarks.derive.solved_contacts import AREA_BIAS, KEPT, circular_contacts
from fingerpad._arrays import FloatArray
from fingerpad.contact import Tissue, fast_contact, hertz_contact, solve_contact
from fingerpad.contact.contact import AnyPlacement
from fingerpad.contact.fast_laws import plate_gap, press
from fingerpad.geometry import Ellipsoid, Paraboloid, Placement

_NAMES = "load", "area", "indentation"


def circles() -> None:
    """Print errors for circular contacts on a layer, which one integral equation solves to ten digits."""
    print("\nCircular contact on a bonded layer: A/(πRξ), W over Hertz at ξ and at A; then relative errors")
    print("    of A at W · ξ at W: Hertz, fast law, solver with 256² cells")
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
            found = (
                (hertz.area[i], hertz.indentation[i]),
                (fast.area[i], fast.indentation[i]),
                (solved.area, solved.indentation),
            )
            errors = "".join(f"  {a / area[i] - 1:+9.1e} · {x / indentation[i] - 1:+.1e}" for a, x in found)
            ratios = 1 / depth[i], load[i] / depth[i] ** 1.5, load[i]
            print(f"    a/t {size:<5g} ν {nu:<5g}" + "".join(f"{each:9.4f}" for each in ratios) + errors)


def held_out() -> None:
    """Print the laws' largest errors in contacts that nothing was fitted to, and Hertz theory's."""
    kept = np.load(KEPT)
    print("\nContacts held out, largest (and 95 %) relative error within the laws' range; Hertz: largest")
    for title, name in (
        ("elliptical paraboloid on a layer", "elliptical_held_out"),
        ("whole pad on deep tissue", "pads_held_out"),
        ("whole pad on a layer", "layered_held_out"),
    ):
        rows = kept[name]
        placement, tissue = kept_contacts(rows, is_pad=not name.startswith("elliptical"))
        load, area, depth, ratio, peak = rows[:, -5:].T
        solved = {"load": load, "area": area / AREA_BIAS, "indentation": depth}
        for given in _NAMES:
            fast = fast_contact(placement, tissue, **{given: solved[given]})
            hertz = hertz_contact(placement, tissue, **{given: solved[given]})
            wanted = [each for each in _NAMES if each != given]
            inside = fast.flag_code == 0
            print(f"    {title}, by {given} ({inside.sum()} of {len(rows)} within)")
            for each in wanted:
                _print(each, getattr(fast, each)[inside], solved[each][inside], getattr(hertz, each)[inside])
        form = fast_contact(placement, tissue, area=solved["area"])
        inside = np.isfinite(form.semi_major)
        hertz = hertz_contact(placement, tissue, area=solved["area"])
        print(f"    {title}, by area")
        _print(
            "aspect ratio",
            form.aspect_ratio[inside],
            1 / ratio[inside],
            hertz.aspect_ratio[inside],
        )
        mean = load / solved["area"]
        _print(
            "peak pressure",
            (form.peak_pressure / form.mean_pressure * mean)[inside],
            peak[inside],
            (1.5 * mean)[inside],
        )


def kept_contacts(rows: FloatArray, *, is_pad: bool) -> tuple[AnyPlacement, Tissue]:
    """Return placements and tissue of kept contacts, of E* = 1."""
    if not is_pad:
        return Paraboloid(1000.0, rows[:, 2]), Tissue.of_reduced_modulus(1.0, rows[:, 0], thickness=1.0)
    pads = Placement(Ellipsoid(*rows[:, :3].T), wedge_angle=rows[:, 3], roll_angle=rows[:, 4])
    return pads, Tissue.of_reduced_modulus(1.0, rows[:, 6], thickness=rows[:, 5])


def _print(name: str, fast: FloatArray, solved: FloatArray, hertz: FloatArray) -> None:
    error = np.abs(fast / solved - 1)
    beside = np.abs(hertz / solved - 1).max()
    print(f"        {name:<14}{error.max():8.2%}  ({np.percentile(error, 95):.2%})    Hertz {beside:.0%}")


def cost(count: int = 400_000) -> None:
    """Print the laws' time over that of Hertz theory, side by side."""
    rng = np.random.default_rng(0)
    first = rng.uniform(8, 20, count)
    second, load, thickness = (
        first * rng.uniform(0.6, 1, count),
        rng.uniform(0.1, 2, count),
        rng.uniform(5, 12, count),
    )
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
    print(f"\n{count:,} contacts, one thread: time over that of `hertz_contact` (asked: 2)")
    for title, seconds in shortest.items():
        print(f"    {title:<40}{seconds / shortest['Hertz']:.1f}")


def report() -> None:
    """Print all tables."""
    circles()
    held_out()
    cost()
