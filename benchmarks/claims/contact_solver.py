"""The contact solver against exact solutions and beside others.

Tamaas is a dependency of the tests; ContactMechanics is timed where it is installed
(``pip install ContactMechanics``).
"""

import math
from collections.abc import Callable
from functools import partial
from importlib.metadata import version
from importlib.util import find_spec
from typing import Any, TypeAlias

import numpy as np
import tamaas

from benchmarks.arrays import Array
from benchmarks.cost import best
from benchmarks.simulated import TABLE_1
from benchmarks.tables import table
from fingerpad.contact import ContactField, SolvedContact, Tissue, hertz_contact, solve_contact, solve_gap
from fingerpad.geometry import Paraboloid, Placement

_RADIUS, _MODULUS = 10.0, 0.1
_HALF_SPACE = Tissue.of_reduced_modulus(_MODULUS)
_BALL = Paraboloid(_RADIUS, _RADIUS)

_GRIDS = 64, 128, 256
_THIRD = find_spec("ContactMechanics") is not None


def _sphere(x: Array, y: Array) -> Array:
    with np.errstate(invalid="ignore"):
        return _RADIUS - np.sqrt(_RADIUS**2 - x**2 - y**2)


def exact_solutions() -> None:
    """Print errors of area, load or indentation, and peak pressure, where they are known."""
    cases: dict[str, tuple[Callable[..., SolvedContact], dict[str, float]]] = {}
    for ratio in (1.0, 1.3, 3.0, 10.0, 30.0):
        bodies = Paraboloid(_RADIUS, ratio * _RADIUS)
        hertz = hertz_contact(bodies, _HALF_SPACE, load=0.5)
        exact = {name: float(getattr(hertz, name)) for name in ("area", "indentation", "peak_pressure")}
        cases[f"Hertz, R''/R' = {ratio:g}"] = partial(solve_contact, bodies, _HALF_SPACE, load=0.5), exact
    for radius in (2.0, 5.0, 8.0):
        log = math.log((_RADIUS + radius) / (_RADIUS - radius))
        load = _MODULUS / 2 * ((_RADIUS**2 + radius**2) * log - 2 * radius * _RADIUS)
        known: dict[str, Any] = {"half_widths": (radius, radius), "indentation": radius / 2 * log}
        exact = {"area": math.pi * radius**2, "load": load}
        solve = partial(solve_gap, _sphere, _HALF_SPACE, **known)
        cases[f"sphere, a/R = {radius / _RADIUS:g}"] = solve, exact

    def cells(name: str, points: int) -> tuple[str, ...]:
        solve, exact = cases[name]
        found = solve(points=points)
        errors = (f"{float(getattr(found, of)) / true - 1:.1e}" for of, true in exact.items())
        return name, f"{points}²", *errors, *(3 - len(exact)) * ("–",), f"{found.relative_error:.1e}"

    rows = (cells(name, points) for name in cases for points in _GRIDS)
    columns = "contact", "cells", "area", "W or ξ", "peak pressure", "estimate of the area's error"
    table(columns, rows, "Relative errors of the solver, against exact solutions")


def speed() -> None:
    """Print the time of the solver and of others on the half-space, and of the solver on a layer."""
    placement, layer = Placement(TABLE_1, wedge_angle=0.5, roll_angle=0.2), Tissue(0.09, thickness=8.0)
    hertz = hertz_contact(_BALL, _HALF_SPACE, load=0.5)
    radius, exact = float(hertz.semi_major), (float(hertz.area), float(hertz.indentation))
    runs: dict[str, list[tuple[float, float, float]]] = {}
    own = []
    for points in _GRIDS:
        solve = partial(solve_contact, placement, layer, load=2.0, points=points)
        search = ContactField.of_solution(solve()).highest_shear_on_axis
        own.append((f"{points}²", f"{best(solve, 3):.2f} s", f"{best(search, 3):.2f} s"))
        for name, solved in SOLVERS.items():
            area, indentation = solved(points, radius, 0.5)
            errors = abs(area / exact[0] - 1), abs(indentation / exact[1] - 1)
            spent = best(partial(solved, points, radius, 0.5), 3)
            runs.setdefault(name, []).append((spent, *errors))
    columns = "solver of a sphere's contact", *(f"{points}² cells" for points in _GRIDS), "to 0.5 %, to 0.1 %"
    rows = (
        (name, *(f"{t:.2f} s ({a:.1e}, {x:.0e})" for t, a, x in found), _reached(found))
        for name, found in runs.items()
    )
    table(columns, rows, "Seconds of one processor (relative error of area, of indentation)")
    title = "Seconds for the whole pad on a layer, and for its highest shear"
    table(("cells", "whole pad on a layer", "its highest shear"), own, title)
    third = version("ContactMechanics") if _THIRD else "not installed (pip install ContactMechanics)"
    print(f"\nTamaas {version('tamaas')}, ContactMechanics {third}.")


def _reached(found: list[tuple[float, float, float]]) -> str:
    """Return the shortest times to an area within 0.5 % and within 0.1 %."""
    least = [min((t for t, error, _ in found if error <= limit), default=None) for limit in (0.005, 0.001)]
    return ", ".join("not reached" if t is None else f"{t:.2f} s" for t in least)


# Solvers of a sphere's contact under a load on a grid of so many cells a side: area and indentation.
Solver: TypeAlias = Callable[[int, float, float], tuple[float, float]]


def _by_fingerpad(points: int, radius: float, load: float) -> tuple[float, float]:
    found = solve_gap(_BALL.gap.height, _HALF_SPACE, half_widths=(radius, radius), load=load, points=points)
    return float(found.area), float(found.indentation)


def _by_contact_mechanics(points: int, radius: float, load: float) -> tuple[float, float]:
    from ContactMechanics import FreeFFTElasticHalfSpace  # noqa: PLC0415 (optional)
    from ContactMechanics.Systems import NonSmoothContactSystem  # noqa: PLC0415 (optional)
    from SurfaceTopography import Topography  # noqa: PLC0415 (optional)

    width, gap = _window(points, radius)
    system = NonSmoothContactSystem(
        substrate=FreeFFTElasticHalfSpace((points, points), _MODULUS, (width, width)),
        surface=Topography(-gap, (width, width)),
    )
    found = system.minimize_proxy(external_force=load, pentol=1e-7)
    return float(system.compute_contact_area()), float(found["offset"])


def _window(points: int, radius: float) -> tuple[float, Array]:
    """Return the side of a grid a little wider than a contact, and the gap on it."""
    width = 2.2 * radius
    along = (np.arange(points) + 0.5) * width / points - width / 2
    return width, _BALL.gap.height(along[:, None], along)


def solved_by_tamaas(gap: Array, width: float, load: float, tolerance: float = 1e-8) -> tuple[Array, float]:
    """Return the pressures on a square grid over the half-space under a gap, and the indentation."""
    tamaas.set_log_level(tamaas.LogLevel.error)
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [width] * 2, list(gap.shape))
    model.E, model.nu = _MODULUS, 0.0
    tamaas.ModelFactory.registerNonPeriodic(model, "dcfft")
    solver = tamaas.PolonskyKeerRey(model, -gap, tolerance)
    solver.setIntegralOperator("dcfft")
    solver.solve(load / width**2)
    pressure, displacement = np.array(model.traction), np.zeros(gap.shape)
    model.operators["dcfft"](pressure, displacement)
    return pressure, float((displacement + gap)[pressure > 0].mean())


def _by_tamaas(points: int, radius: float, load: float) -> tuple[float, float]:
    width, gap = _window(points, radius)
    pressure, indentation = solved_by_tamaas(gap, width, load)
    return float((pressure > 0).mean()) * width**2, indentation


SOLVERS: dict[str, Solver] = {"fingerpad": _by_fingerpad, "Tamaas": _by_tamaas}
SOLVERS |= {"ContactMechanics": _by_contact_mechanics} if _THIRD else {}


def report() -> None:
    """Print all tables."""
    exact_solutions()
    speed()
