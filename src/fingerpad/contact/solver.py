"""Frictionless contact of any smooth gap, on an elastic half-space or on a layer bonded to a rigid base.

Grids are nested: each follows the contact found on the one before, of half as many cells along each side, and
the change from the last but one to the last estimates the error.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, TypeAlias

import numpy as np
from scipy.ndimage import binary_dilation

from fingerpad._arrays import FloatArray, as_float_array, check_all, finite_angle
from fingerpad.contact.contact import AnyPlacement, Contact, Form, Tissue, check_pressed, only_given
from fingerpad.contact.grid import FILLED, ContactGrid, ContactOutline, contact_outline
from fingerpad.contact.hertz import hertz_contact
from fingerpad.contact.influence import Convolution, influence
from fingerpad.contact.pressure import solve_pressure
from fingerpad.exceptions import ConvergenceError, GeometryError
from fingerpad.geometry import Placement

GapHeight: TypeAlias = Callable[[FloatArray, FloatArray], FloatArray]

_MOVES = 30  # of a grid, before it is given up
_COARSEST = 32  # cells along each side of the first grid
_FINEST = 4096  # of the last one, for which transforms take gigabytes
_FEWEST = 20  # cells of the first grid in contact
_AREA_TOLERANCE = 1e-6
_SECANTS = 8
_EDGE_ERROR = 0.3  # of the area, with the cells along a semi-axis to the power −1.5; seen in Hertz contacts
_THINNEST = 0.1  # thickness over the contact's mean radius


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class SolvedContact(Contact):
    """A contact that was solved on a grid.

    Attributes
    ----------
    load, indentation, area, flag_code : ndarray
        As of any `Contact`, one number each.
    tissue : Tissue
        What is pressed.
    grid : ContactGrid
        Grid of `pressure`. The plane's first coordinate points along the finger, its second across.
    pressure : ndarray, shape (points, points)
        Contact pressure, zero outside the contact.
    long_axis_angle : float
        From the plane's first coordinate to the ellipse's long axis, in (−π/2, π/2], radians.
    centre : ndarray, shape (2,)
        Centroid of the contact, in the plane.
    outline : ndarray, shape (n, 2)
        Edge of the contact, a closed polygon in the plane.
    elastic_energy : float
        ½∫pu dA, which is also the work ∫W dξ of pressing.
    relative_error : float
        Estimated bound: the largest relative change of load, indentation and area from a grid half as fine,
        or the uncertainty of the edge of a Hertz contact if that is larger. It bounds the error of the area;
        those of load and indentation are far smaller.
    """

    tissue: Tissue
    grid: ContactGrid
    pressure: FloatArray
    long_axis_angle: float
    centre: FloatArray
    outline: FloatArray
    elastic_energy: float
    relative_error: float

    def _shown(self) -> list[tuple[str, Any]]:
        return [*Contact._shown(self), ("relative_error", self.relative_error)]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Pressed:
    """Solution on one grid; forces divided by E*."""

    grid: ContactGrid
    pressure: FloatArray
    indentation: float
    gap: FloatArray
    outline: ContactOutline

    @property
    def load(self) -> float:
        return float(self.pressure.sum()) * self.grid.cell_area

    @property
    def values(self) -> FloatArray:
        return np.array([self.load, self.indentation, self.outline.area])

    @property
    def touches_border(self) -> bool:
        p = self.pressure
        return bool(p[[0, -1]].any() or p[:, [0, -1]].any())


def solve_contact(
    placement: AnyPlacement,
    tissue: Tissue,
    *,
    load: float | None = None,
    area: float | None = None,
    indentation: float | None = None,
    points: int = 256,
) -> SolvedContact:
    """Press one whole pad against a plate or another rigid body, without friction, and solve on a grid.

    Parameters
    ----------
    placement : Placement or Paraboloid
        Where one pad touches.
    tissue : Tissue
        What is pressed: deep, or a layer bonded to rigid bone.
    load, area, indentation : float
        Exactly one of normal force W, contact area A and mutual approach ξ.
    points : int
        Cells along each side of the finest grid, 64 to 4096.

    Returns
    -------
    SolvedContact
        With pressure, grid and an estimate of its error.

    Raises
    ------
    GeometryError
        If there are several pads, the given quantity is not positive and finite, the contact reaches the
        silhouette, or the layer is pressed through or too thin beside the contact.
    ConvergenceError
        If the pressure is not found.

    Examples
    --------
    The pad of Dzidek et al. (2017) at 2 N. On 8 mm of tissue over bone Hertz theory reads a higher modulus
    from the indentation than from the area:

    >>> from fingerpad.contact import hertz_contact
    >>> from fingerpad.geometry import Ellipsoid, Placement
    >>> place = Placement(Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8), wedge_angle=np.radians(30))
    >>> tissue = Tissue(youngs_modulus=0.1, thickness=8.0)
    >>> solved = solve_contact(place, tissue, load=2.0, points=64)
    >>> hertz = hertz_contact(place, tissue, load=2.0)
    >>> print(f"area × {solved.area / hertz.area:.2f}, ξ × {solved.indentation / hertz.indentation:.2f}")
    area × 0.87, ξ × 0.60
    """
    name, value = check_pressed(placement, tissue, load=load, area=area, indentation=indentation)
    if placement.shape or tissue.shape or value.shape:
        raise GeometryError(
            f"one contact is solved at a time, found placements of shape {placement.shape}, tissue of shape "
            f"{tissue.shape} and {name} of shape {value.shape}: loop over them, as with place[0], or take "
            "fast_contact, which broadcasts"
        )
    check_all(np.isfinite(value) & (value > 0), name, value, "positive and finite", GeometryError)
    guess = hertz_contact(placement, tissue, **{name: value})
    # A grid far wider than the pad would miss it.
    widest = placement.ellipsoid.semi_axes.max() if isinstance(placement, Placement) else math.inf
    semi_axes = min(float(guess.semi_major), widest), min(float(guess.semi_minor), widest)
    gap = placement.gap
    return solve_gap(
        gap.height,
        tissue,
        half_widths=semi_axes if guess.along else semi_axes[::-1],
        angle=float(gap.angle),
        points=points,
        **{name: float(value)},
    )


def solve_gap(
    gap: GapHeight,
    tissue: Tissue,
    *,
    half_widths: tuple[float, float],
    angle: float = 0.0,
    load: float | None = None,
    area: float | None = None,
    indentation: float | None = None,
    points: int = 256,
) -> SolvedContact:
    """Press a rigid body and tissue together whose gap is any smooth function, without friction.

    Parameters
    ----------
    gap : callable
        Gap of the undeformed surfaces at plane coordinates (x, y), arrays; NaN where there is no surface.
        Zero at its lowest point.
    tissue : Tissue
        What is pressed.
    half_widths : tuple of float
        A first guess of the contact's semi-axes along the grid's sides.
    angle : float
        From the plane's first coordinate to the grid's first side, radians. Elongated contacts are solved
        best on a grid that lies along them.
    load, area, indentation, points
        As for `solve_contact`.

    Returns
    -------
    SolvedContact
        On the finest grid.

    Raises
    ------
    GeometryError, ConvergenceError
        As `solve_contact`.

    Examples
    --------
    A sphere of radius 10 mm on tissue of E* = 0.1 MPa, 5 mm thick, carries more than on deep tissue:

    >>> sphere = lambda x, y: (x**2 + y**2) / 20
    >>> loads = [
    ...     solve_gap(sphere, Tissue(0.075, thickness=t), half_widths=(3, 3), indentation=1.0, points=64).load
    ...     for t in (np.inf, 5.0)
    ... ]
    >>> print(f"{loads[0]:.3f} N, {loads[1]:.3f} N")
    0.422 N, 1.158 N
    """
    name, number = only_given(load=load, area=area, indentation=indentation)
    value = float(number)
    check_all(np.isfinite(value) and value > 0, name, value, "positive and finite", GeometryError)
    if not 2 * _COARSEST <= points <= _FINEST or points % 1:
        raise GeometryError(
            f"points must be a whole number from {2 * _COARSEST} to {_FINEST}, found {points}"
        )
    points = int(points)
    if not callable(gap):
        raise GeometryError(f"gap must be a function of x and y, found {type(gap).__name__}")
    if np.shape(half_widths) != (2,) or not (as_float_array(half_widths, "half_widths") > 0).all():
        raise GeometryError(f"half_widths must be two positive lengths, found {half_widths}")
    angle = finite_angle("angle", angle)
    if name == "area":  # on a layer far too thin no pressure might be found
        _check_thickness(float(tissue.thickness), value)
    problem = _Problem(gap, tissue, name, value / float(tissue.reduced_modulus) if name == "load" else value)
    levels = [points >> shift for shift in range(3, 0, -1) if points >> shift >= _COARSEST]
    found = [problem.first(half_widths, angle, levels[0])]
    for count in [*levels[1:], points]:
        found.append(problem.finer(found[-1], count))
    return _solution(tissue, found[-2], found[-1])


class _Problem:
    """One contact, solved on grid after grid."""

    def __init__(self, gap: GapHeight, tissue: Tissue, given: str, target: float) -> None:
        self._gap, self._given, self._target = gap, given, target
        self._thickness, self._poisson_ratio = float(tissue.thickness), float(tissue.poisson_ratio)

    def first(self, half_widths: tuple[float, float], angle: float, points: int) -> _Pressed:
        """Solve on a coarse grid, moved until the contact fills it."""
        widths = np.asarray(half_widths, dtype=float) / FILLED
        grid = ContactGrid(centre=np.zeros(2), half_widths=widths, angle=angle, points=points)
        side = ((2 * np.arange(points) + 1) / points - 1) / FILLED
        grid = self._over_contact(grid)
        start, guess = np.sqrt(np.maximum(1 - side[:, None] ** 2 - side**2, 0)), None
        for _ in range(_MOVES):
            found = self._pressed(grid, start, guess)
            moved = grid.around(found.outline, points)
            if found.touches_border:
                moved = replace(grid, half_widths=1.5 * grid.half_widths)
            elif (moved.half_widths > 0.85 * grid.half_widths).all():
                return found
            start, guess, grid = grid.sample(found.pressure, moved.cells), found.indentation, moved
        raise ConvergenceError(
            "the grid did not settle on the contact: check the gap and the guess of its size"
        )

    def _over_contact(self, grid: ContactGrid) -> ContactGrid:
        """Return a grid that holds the gap's lowest point, and more than a few cells of the contact.

        Under a load they may be fewer.
        """
        for _ in range(2 * _MOVES):
            gap = self._gap(*grid.coordinates)
            gap = np.where(np.isnan(gap), np.inf, gap)
            if not np.isfinite(gap.min()):
                break
            if gap.min() < gap[1:-1, 1:-1].min():
                grid = replace(grid, centre=grid.cells[np.unravel_index(np.argmin(gap), gap.shape)])
            elif self._is_too_wide(grid, gap):
                grid = replace(grid, half_widths=grid.half_widths / 2)
            else:
                return grid
        raise GeometryError(
            f"no contact was found at this {self._given}: the gap must be zero at its lowest point, and this "
            "lie near the origin, within some half_widths"
        )

    def _is_too_wide(self, grid: ContactGrid, gap: FloatArray) -> bool:
        """Return whether the contact would be a few cells of a grid at most."""
        if self._given == "indentation":
            return int(np.sum(gap < self._target)) < _FEWEST
        return self._given == "area" and self._target / grid.cell_area < _FEWEST

    def finer(self, before: _Pressed, points: int) -> _Pressed:
        """Solve on a finer grid, from what a coarser one gave."""
        grid = before.grid.around(before.outline, points)
        for _ in range(_MOVES):
            found = self._pressed(grid, before.grid.sample(before.pressure, grid.cells), before.indentation)
            if not found.touches_border:
                return found
            grid = replace(grid, half_widths=1.2 * grid.half_widths)
        raise ConvergenceError(f"the contact does not fit a grid of {points} cells a side")

    def _pressed(self, grid: ContactGrid, start: FloatArray, guess: float | None) -> _Pressed:
        """Solve on one grid, for the given load, indentation or area."""
        gap = self._gap(*grid.coordinates)
        missing = np.isnan(gap)
        gap[missing] = 10 * grid.half_widths.max()
        convolution = Convolution(influence(grid.spacing, gap.shape, self._thickness, self._poisson_ratio))
        near_silhouette = binary_dilation(missing, np.ones((3, 3)))

        def solved(start: FloatArray, load: float | None, indentation: float | None = None) -> _Pressed:
            total = None if load is None else load / grid.cell_area
            pressure, approach = solve_pressure(convolution, gap, start, total=total, indentation=indentation)
            if (pressure[near_silhouette] > 0).any():
                raise GeometryError(
                    f"the {self._given} would flatten the pad to its silhouette, or that of the body it is "
                    "pressed against: check load, modulus and sizes"
                )
            outline = contact_outline(*grid.sides, pressure, decay_length=self._thickness)
            return _Pressed(grid=grid, pressure=pressure, indentation=approach, gap=gap, outline=outline)

        if self._given == "load":
            return solved(start, self._target)
        if self._given == "indentation":
            return solved(start, None, self._target)
        if guess is None:  # Hertz theory: the gap at the edge is half the indentation
            cells = min(int(self._target / grid.cell_area), gap.size - 1)
            guess = 2 * float(np.sort(gap, axis=None)[cells])
            # A thin layer deforms less: the exact ratio is not needed, but twice it can reach the silhouette.
            guess /= 1 + math.sqrt(self._target / math.pi) / self._thickness
        return _at_area(partial(solved, start, None), guess, self._target)


def _at_area(solved: Callable[[float], _Pressed], indentation: float, area: float) -> _Pressed:
    """Return the contact of an area, by secants of its logarithm over the indentation's."""
    slope, last = 1.0, None
    for _ in range(_SECANTS):
        found = solved(indentation)
        here = np.log([indentation, found.outline.area / area])
        if abs(here[1]) < _AREA_TOLERANCE or found.touches_border:
            break
        if last is not None and here[0] != last[0]:
            slope = float(np.clip((here[1] - last[1]) / (here[0] - last[0]), 0.3, 3))
        indentation, last = float(np.exp(here[0] - here[1] / slope)), here
    return found


def _check_thickness(thickness: float, area: float) -> None:
    """Raise a GeometryError if a layer is so thin that the grid cannot resolve it."""
    mean_radius = math.sqrt(area / math.pi)
    if not thickness >= _THINNEST * mean_radius:
        raise GeometryError(
            f"thickness must be at least a tenth of the contact's mean radius {mean_radius:g}, "
            f"found {thickness:g}"
        )


def _solution(tissue: Tissue, coarser: _Pressed, finest: _Pressed) -> SolvedContact:
    """Return the finest grid's results, with the error estimated from the coarser one."""
    outline, thickness = finest.outline, float(tissue.thickness)
    if not finest.indentation < thickness:
        raise GeometryError(
            f"an indentation of {finest.indentation:g} would press through the layer's thickness of "
            f"{thickness:g}: check load, modulus and thickness"
        )
    _check_thickness(thickness, outline.area)
    change = float(np.abs(coarser.values / finest.values - 1).max())
    cells = FILLED * finest.grid.points / 2
    displacement = finest.indentation - finest.gap
    energy = 0.5 * float(np.sum(finest.pressure * displacement)) * finest.grid.cell_area
    modulus, angle = float(tissue.reduced_modulus), finest.grid.angle
    load, turn = modulus * finest.load, outline.long_axis_angle
    direction = turn + angle
    pressure = modulus * finest.pressure
    return SolvedContact(
        load=as_float_array(load)[()],
        indentation=as_float_array(finest.indentation)[()],
        area=as_float_array(outline.area)[()],
        flag_code=np.zeros((), dtype=np.int8)[()],
        _find_form=partial(
            Form,
            semi_major=as_float_array(outline.semi_major)[()],
            semi_minor=as_float_array(outline.semi_minor)[()],
            along=np.array(abs(math.cos(turn)) >= abs(math.sin(turn)))[()],
            peak_over_mean_pressure=as_float_array(float(pressure.max()) * outline.area / load)[()],
        ),
        tissue=tissue,
        grid=finest.grid,
        pressure=pressure,
        long_axis_angle=math.pi / 2 - (math.pi / 2 - direction) % math.pi,
        centre=finest.grid.to_plane(outline.centre),
        outline=finest.grid.to_plane(outline.points),
        elastic_energy=modulus * energy,
        relative_error=max(change, _EDGE_ERROR / cells**1.5),
    )
