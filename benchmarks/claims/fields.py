"""Stress under contacts against point loads."""

import math
import time

import numpy as np
from tests.contact.point_loads import point_load_stress

from fingerpad._arrays import FloatArray
from fingerpad.contact import HertzPressure, SolvedContact, SolvedStress, Tissue, hertz_stress, solve_contact
from fingerpad.geometry import Ellipsoid, Placement

_PLACEMENT = Placement(
    Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8),
    wedge_angle=np.radians(30),
    roll_angle=np.radians(10),
)
_MODULUS = 0.0933
_DEPTHS = 0.3, 0.5, 1.0, 3.0, 10.0
_MILLION = 1_000_000


def _integrated(place: FloatArray, axis_ratio: float, poisson_ratio: float) -> FloatArray:
    """Return the stress under unit peak pressure over an ellipse, by Gauss's and the trapezoidal rule."""
    node, weight = np.polynomial.legendre.leggauss(400)
    angle, turn = np.pi / 4 * (node + 1), 2 * np.pi * np.arange(1200) / 1200
    radius = np.sin(angle)
    force = (np.pi / 4 * weight * radius * np.cos(angle) ** 2)[:, None] * (axis_ratio * 2 * np.pi / 1200)
    x, y = place[0] - radius[:, None] * np.cos(turn), place[1] - axis_ratio * radius[:, None] * np.sin(turn)
    stress = point_load_stress(x, y, np.full_like(x, place[2]), poisson_ratio)
    total: FloatArray = np.sum(stress * force, axis=(-2, -1))
    return total


def closed_forms() -> None:
    """Print the errors of `hertz_stress` over the peak pressure, and its time."""
    print("\nhertz_stress against an integral of point loads: largest error over the peak pressure")
    random = np.random.default_rng(2)
    for ratio in (1.0, 1 - 1e-9, 0.99, 0.7, 0.3, 0.1):
        worst = 0.0
        for poisson_ratio in (0.0, 0.3, 0.5):
            for place in random.uniform([-2, -2, 0.15], [2, 2, 2], (8, 3)):
                found = hertz_stress(
                    *place, semi_x=1, semi_y=ratio, peak_pressure=1, poisson_ratio=poisson_ratio
                ).tensor
                worst = max(worst, float(np.abs(found - _integrated(place, ratio, poisson_ratio)).max()))
        print(f"    axis ratio {ratio:<14.10g}{worst:.1e}")
    z = np.linspace(0, 3, 301)[1:]
    found = hertz_stress(0, 0, z, semi_x=1, semi_y=1, peak_pressure=1, poisson_ratio=0.3).tensor
    radial = -1.3 * (1 - z * np.arctan(1 / z)) + 0.5 / (1 + z**2)
    error = max(np.abs(found[:, 0, 0] - radial).max(), np.abs(found[:, 2, 2] + 1 / (1 + z**2)).max())
    print(f"    axis of a circle (Johnson, Eqs 3.45): {error:.1e}")
    points = random.uniform([-3, -3, 0], [3, 3, 3], (_MILLION, 3)).T
    start = time.perf_counter()
    field = hertz_stress(*points, semi_x=1.5, semi_y=1, peak_pressure=1, poisson_ratio=0.45)
    middle = time.perf_counter()
    field.principal  # noqa: B018
    end = time.perf_counter()
    print(f"    a million points: {middle - start:.1f} s; principal stresses: {end - middle:.1f} s")


def _solved(points: int, thickness: float, poisson_ratio: float) -> SolvedContact:
    tissue = Tissue.of_reduced_modulus(_MODULUS, poisson_ratio, thickness)
    return solve_contact(_PLACEMENT, tissue, load=2.0, points=points)


def half_space() -> None:
    """Print the errors of `SolvedStress` for the whole pad, no bone."""
    print("\nWhole pad on a half-space, 2 N, 30°: errors against the sum of its cells as point loads")
    heads = "".join(f"{f'z = {depth:g} mm':>12}" for depth in _DEPTHS)
    print(f"    {'cells':>6}{heads}")
    random = np.random.default_rng(1)
    for points in (64, 128, 256):
        solution = _solved(points, math.inf, 0.3)
        stress = SolvedStress.of(solution)
        cell_x, cell_y = (side[solution.pressure > 0] for side in solution.grid.coordinates)
        force = solution.pressure[solution.pressure > 0] * solution.grid.cell_area
        errors = []
        for depth in _DEPTHS:
            x, y = random.uniform(-9, 9, (2, 40))
            away_x, away_y = x[:, None] - cell_x, y[:, None] - cell_y
            each = point_load_stress(away_x, away_y, np.full_like(away_x, depth), 0.3)
            difference = stress.at(x, y, depth).tensor - np.einsum("ijkl,l->kij", each, force)
            errors.append(np.abs(difference).max() / solution.peak_pressure)
        print(f"    {points:>6}" + "".join(f"{error:12.1e}" for error in errors))
        if points == 256:
            hertz = HertzPressure.of_moments(solution.grid, solution.pressure)
            x, y = np.linspace(-9, 9, 60), np.zeros(60)
            closed = hertz.stress(x, y, 0.7, poisson_ratio=0.3).tensor
            apart = closed - stress.at(x, y, 0.7).tensor
            share = np.abs(apart).max() / solution.peak_pressure
            print(f"    the Hertzian pressure of the same moments would be {share:.2f} off at 0.7 mm")


def layer() -> None:
    """Print how the stress in a layer changes with the grid, and what a section costs."""
    print("\nWhole pad on a layer: largest change of the stress over the peak pressure, 128 to 256 cells")
    heads = "".join(f"{f'{where}, {depth} mm':>17}" for where in ("axis", "section") for depth in (0.5, 2.0))
    print(f"    {'mm':>6}{heads}{'level, s':>10}")
    along = np.linspace(-9, 9, 61)
    for thickness in (3.0, 5.0, 8.0, 12.0):
        coarse, fine = (_solved(points, thickness, 0.5) for points in (128, 256))
        stresses = [SolvedStress.of(found) for found in (coarse, fine)]
        changes = []
        for place in (np.zeros(1), along):
            for depth in (0.5, 2.0):
                one, other = (stress.at(place, 0.0, depth).tensor for stress in stresses)
                changes.append(np.abs(one - other).max() / fine.peak_pressure)
        start = time.perf_counter()
        SolvedStress.of(fine).at(along, 0.0, np.linspace(0, thickness, 21)[:, None])
        level = (time.perf_counter() - start) / 21
        row = "".join(f"{change:17.1e}" for change in changes)
        print(f"    {thickness:>6g}{row}{level:10.2f}")


def report() -> None:
    """Print all tables."""
    closed_forms()
    half_space()
    layer()
