"""Hertz theory, the fast laws and the solver side by side: ``python -m benchmarks.contact_law_errors``."""

import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from benchmarks.contact_law_data import KEPT, circular_contacts
from benchmarks.contact_laws import AREA_BIAS
from fingerpad._arrays import FloatArray
from fingerpad.contact import (
    ElasticBody,
    HertzGeometry,
    PadGap,
    fast_contact,
    fast_ellipse,
    hertz_contact,
    solve_contact,
)
from fingerpad.geometry import Ellipsoid

_NAMES = "load", "area", "indentation"


def circles() -> None:
    """Print errors for circular contacts on a layer, which one integral equation solves to ten digits."""
    print("\nCircular contact on a bonded layer: A/(πRξ), W over Hertz at ξ and at A; then relative errors")
    print("    of A at W · ξ at W: Hertz, fast law, solver with 256² cells")
    sizes = np.array([0.05, 0.1, 0.3, 0.5, 1.0, 2.0, 3.0])
    gap = PadGap.paraboloid(10.0, 10.0)
    for nu in (0.5, 0.48, 0.45, 0.3):
        load, depth, _ = circular_contacts(sizes, nu).T
        force, area, indentation = 0.4 / 3 * sizes**3 / 10 * load, np.pi * sizes**2, sizes**2 / 10 * depth
        hertz = hertz_contact(10.0, 10.0, force, reduced_modulus=0.1)
        fast = fast_contact(gap, load=force, thickness=1.0, poisson_ratio=nu, reduced_modulus=0.1)
        for i, size in enumerate(sizes):
            solved = solve_contact(
                lambda x, y: (x**2 + y**2) / 20,
                ElasticBody(reduced_modulus=0.1, thickness=1.0, poisson_ratio=nu),
                half_widths=(size, size),
                load=float(force[i]),
            )
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
        gap, layer = kept_gaps(rows, is_pad=not name.startswith("elliptical"))
        load, area, depth, ratio, peak = rows[:, -5:].T
        solved = {"load": load, "area": area / AREA_BIAS, "indentation": depth}
        for given in _NAMES:
            fast = fast_contact(gap, reduced_modulus=1.0, **layer, **{given: solved[given]})
            hertz = hertz_contacts(gap, given, solved[given])
            wanted = [each for each in _NAMES if each != given]
            inside = fast.flag_code == 0
            print(f"    {title}, by {given} ({inside.sum()} of {len(rows)} within)")
            for each in wanted:
                _print(each, getattr(fast, each)[inside], solved[each][inside], getattr(hertz, each)[inside])
        form = fast_ellipse(gap, area=solved["area"], **layer)
        inside = np.isfinite(form.semi_major)
        hertz = hertz_contacts(gap, "area", solved["area"])
        print(f"    {title}, by area")
        _print(
            "aspect ratio",
            (form.semi_major / form.semi_minor)[inside],
            1 / ratio[inside],
            (hertz.semi_major / hertz.semi_minor)[inside],
        )
        mean = load / solved["area"]
        _print(
            "peak pressure",
            (form.peak_over_mean_pressure * mean)[inside],
            peak[inside],
            (1.5 * mean)[inside],
        )


def kept_gaps(rows: FloatArray, *, is_pad: bool) -> tuple[PadGap, dict[str, Any]]:
    """Return gaps and tissue of kept contacts, as `fast_contact` takes them."""
    if not is_pad:
        return PadGap.paraboloid(1000.0, rows[:, 2]), {"thickness": 1.0, "poisson_ratio": rows[:, 0]}
    gap = PadGap.of(Ellipsoid(*rows[:, :3].T), wedge_angle=rows[:, 3], roll_angle=rows[:, 4])
    return gap, {} if np.isinf(rows[:, 5]).all() else {"thickness": rows[:, 5], "poisson_ratio": rows[:, 6]}


def hertz_contacts(gap: PadGap, given: str, value: FloatArray) -> Any:
    """Return Hertz contacts, E* = 1, by load, area or indentation."""
    geometry = HertzGeometry(gap.first_radius, gap.second_radius)
    by: dict[str, Callable[..., Any]] = {
        "load": geometry.under_load,
        "area": geometry.at_area,
        "indentation": geometry.at_indentation,
    }
    return by[given](value, reduced_modulus=1.0)


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
    gap = PadGap.paraboloid(first, second)
    whole = PadGap.of(pads, wedge_angle=rng.uniform(0, 1.5, count), roll_angle=rng.uniform(-0.5, 0.5, count))
    calls: dict[str, Callable[[], object]] = {
        "Hertz": partial(hertz_contact, first, second, load, reduced_modulus=0.1)
    }
    for title, of, given in (
        ("layer, one ν, by area", gap, {"area": 40 * load, "thickness": thickness}),
        ("layer, by area", gap, {"area": 40 * load, "thickness": thickness, "poisson_ratio": nu}),
        ("layer, by load", gap, {"load": load, "thickness": thickness, "poisson_ratio": nu}),
        ("whole pad, by area", whole, {"area": 40 * load}),
        ("whole pad, by load", whole, {"load": load}),
        ("whole pad on a layer, by load", whole, {"load": load, "thickness": thickness, "poisson_ratio": nu}),
    ):
        calls[title] = partial(fast_contact, of, reduced_modulus=0.1, **given)
    shortest = dict.fromkeys(calls, np.inf)
    for _ in range(9):
        for title, call in calls.items():
            start = time.process_time()
            call()
            shortest[title] = min(shortest[title], time.process_time() - start)
    print(f"\n{count:,} contacts, one thread: time over that of `hertz_contact` (asked: 2)")
    for title, seconds in shortest.items():
        print(f"    {title:<32}{seconds / shortest['Hertz']:.1f}")


def report() -> None:
    """Print all tables."""
    circles()
    held_out()
    cost()


if __name__ == "__main__":
    report()
