"""Solve the contacts that the fast laws are fitted to: ``python -m benchmarks.derive.solved_contacts``.

Circular contacts on a layer follow to ten digits from one integral equation (`benchmarks.truth.layers`).
Elliptical ones on a layer and whole ellipsoids, solved on grids, are kept in ``solved_contacts.npz``.
"""

import math
from pathlib import Path

import numpy as np

from benchmarks.arrays import Array
from benchmarks.truth.layers import circular_contacts
from fingerpad.contact import SolvedContact, Tissue, hertz_contact, solve_contact
from fingerpad.contact.contact import AnyPlacement
from fingerpad.contact.elliptic import curvature_ratio
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Ellipsoid, Paraboloid, Placement

KEPT = Path(__file__).with_name("solved_contacts.npz")
AREA_BIAS = 1.000545  # of the solver's area at 128² cells, from circular contacts; the median
_POINTS = 128
RATIOS_OF_AXES = 1.0, 0.85, 0.7, 0.58, 0.48
_SIZES = 0.15, 0.3, 0.5, 0.75, 1.05, 1.4, 1.9, 2.5, 3.1
_POISSON_RATIOS = 0.3, 0.36, 0.42, 0.46, 0.49, 0.5


def kept_contacts(rows: Array, *, is_pad: bool) -> tuple[AnyPlacement, Tissue]:
    """Return placements and tissue of kept contacts, of E* = 1."""
    if not is_pad:
        return Paraboloid(1000.0, rows[:, 2]), Tissue.of_reduced_modulus(1.0, rows[:, 0], thickness=1.0)
    return kept_pads(rows), Tissue.of_reduced_modulus(1.0, rows[:, 6], thickness=rows[:, 5])


def kept_pads(rows: Array) -> Placement:
    """Return the pads of kept contacts on their plates."""
    return Placement(Ellipsoid(*rows[:, :3].T), wedge_angle=rows[:, 3], roll_angle=rows[:, 4])


def _row(found: SolvedContact, *inputs: float) -> tuple[float, ...]:
    E = found.tissue.reduced_modulus
    results = found.load / E, found.area, found.indentation, 1 / found.aspect_ratio, found.peak_pressure / E
    return *inputs, *map(float, results)


def elliptical(size: float, poisson_ratio: float, axis_ratio: float) -> tuple[float, ...]:
    """Solve an elliptical paraboloid on a layer of thickness 1; √(ℓd ℓe)/t and ℓe/ℓd are Hertz theory's.

    Returned are ν, ℓe/ℓd and the smaller radius, then load over E*, area, indentation, axis ratio and peak
    pressure over E*. The larger radius is 1000.
    """
    large = 1000.0
    small = large / float(curvature_ratio(axis_ratio))
    bodies = Paraboloid(large, small)
    tissue = Tissue.of_reduced_modulus(1.0, poisson_ratio, thickness=1.0)
    hertz = hertz_contact(bodies, tissue, area=np.pi * size**2)
    _, indentation, _ = circular_contacts(np.array([size]), poisson_ratio)[0]
    found = solve_contact(bodies, tissue, indentation=indentation * float(hertz.indentation), points=_POINTS)
    return _row(found, poisson_ratio, axis_ratio, small)


def pads(count: int, seed: int, *, on_layer: bool) -> Array:
    """Solve random pads of the sizes of fingers, at random placements, on deep tissue or on a random layer.

    Of each it returns semi-axes, wedge and roll, thickness and ν, then the results as `elliptical` has them.
    """
    rng = np.random.default_rng(seed)
    rows: list[tuple[float, ...]] = []
    while len(rows) < count:
        axes = rng.uniform([6.0, 10.0, 6.5], [11.0, 18.0, 13.0])
        wedge, roll = np.radians(rng.uniform([0, -30], [90, 30]))
        relative = rng.uniform(0.05, 0.65)  # to the silhouette
        ratio, poisson_ratio = (rng.uniform(0.05, 3.2), rng.uniform(0.3, 0.5)) if on_layer else (0.0, 0.5)
        placement = Placement(Ellipsoid(*axes), wedge_angle=wedge, roll_angle=roll)
        normal = np.array([np.cos(wedge) * np.cos(roll), np.sin(wedge), np.cos(wedge) * np.sin(roll)])
        silhouette = np.pi * np.prod(axes) * np.sqrt(np.sum((normal / axes) ** 2))
        size = relative * math.sqrt(silhouette / np.pi)
        thickness = size / ratio if on_layer else math.inf
        tissue = Tissue.of_reduced_modulus(1.0, poisson_ratio, thickness)
        hertz = hertz_contact(placement, tissue, area=np.pi * size**2)
        stiffer = circular_contacts(np.array([ratio]), poisson_ratio)[0, 0] if on_layer else 1.0
        try:
            found = solve_contact(placement, tissue, load=stiffer * float(hertz.load), points=_POINTS)
        except GeometryError:  # it reaches the silhouette
            continue
        rows.append(_row(found, *axes, wedge, roll, thickness, poisson_ratio))
    return np.array(rows)


def main() -> None:
    """Solve everything and keep it."""
    rng = np.random.default_rng(4)
    grid = [(x, nu, k) for x in _SIZES for nu in _POISSON_RATIOS for k in RATIOS_OF_AXES]
    drawn = rng.uniform([0.1, 0.3, 0.5], [3.0, 0.5, 1.0], (120, 3))
    np.savez_compressed(
        KEPT,
        elliptical=np.array([elliptical(*each) for each in grid]),
        elliptical_held_out=np.array([elliptical(*each) for each in drawn]),
        pads=pads(700, 1, on_layer=False),
        pads_held_out=pads(250, 2, on_layer=False),
        layered=pads(500, 3, on_layer=True),
        layered_held_out=pads(250, 4, on_layer=True),
    )


if __name__ == "__main__":
    main()
