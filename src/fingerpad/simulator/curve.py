"""Load and area of a pad by depth, and what a rigid plate overlaps of the undeformed pad."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from scipy.interpolate import CubicSpline

from fingerpad._arrays import FloatArray
from fingerpad.contact import Tissue, solve_contact
from fingerpad.contact.contact import AnyPlacement, reduced_modulus
from fingerpad.contact.fast_laws import press
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Gap, Placement
from fingerpad.geometry.ellipsoid import support_function
from fingerpad.geometry.gap import gap_kernel
from fingerpad.geometry.placement import platen_normal
from fingerpad.uncertainty import Inputs, propagate

_SOLVED: Final = 12  # contacts between which the solver's answer is interpolated
_BELOW: Final = 0.3  # of the lowest load, from which on the solver is asked
_POINTS: Final = 128
_STEP: Final = 0.01  # of the logarithm of the depth, whose fourth power is the error of the slope
_AXES: Final = ("palmar", "distal", "radial_ulnar")
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(24)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Curve:
    """Load and area of pads by depth, along the last axis, by the fast laws.

    Arrays of pads have a last axis of one. Complex steps give derivatives.
    """

    gap: Gap
    height: FloatArray  # of the pad's centre over the plate at touch; infinite for a paraboloid
    reduced_modulus: FloatArray
    thickness: FloatArray
    poisson_ratio: FloatArray

    @property
    def radius(self) -> FloatArray:
        """R_e."""
        return np.asarray(np.sqrt(self.gap.first_radius * self.gap.second_radius))

    def depth(self, load: FloatArray) -> FloatArray:
        """Return ξ under loads; NaN beyond the range of the laws."""
        return self._pressed(load=load)[0]

    def load(self, depth: FloatArray) -> FloatArray:
        """Return F at depths."""
        return self._pressed(indentation=depth)[1]

    def area(self, depth: FloatArray) -> FloatArray:
        """Return A at depths."""
        return self._pressed(indentation=depth)[2]

    def _pressed(self, **given: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        deep = np.isinf(np.real(self.thickness)).all()
        contact = press(
            self.gap,
            reduced_modulus=self.reduced_modulus,
            thickness=None if deep else self.thickness,
            poisson_ratio=self.poisson_ratio,
            **given,
        )
        return contact.indentation, contact.load, contact.area

    def _loads(self, depth: FloatArray, factors: FloatArray) -> FloatArray:
        """Return F at multiples of depths, along a first axis, by one call of the laws."""
        axes = np.broadcast(depth, self.radius).ndim
        return self.load(depth * factors.reshape(-1, *[1] * axes))

    def stiffness(self, depth: FloatArray) -> FloatArray:
        """Return dF/dξ."""
        steps = np.array([-2, -1, 1, 2])
        logarithm = np.log(self._loads(depth, np.exp(_STEP * steps)))
        slope = np.tensordot(np.array([1, -8, 8, -1]), logarithm, axes=1) / (12 * _STEP)
        return np.asarray(self.load(depth) / depth * slope)

    def section(self, depth: FloatArray) -> FloatArray:
        """Return the area in which the plate's plane cuts the undeformed pad."""
        return np.pi * self.radius * depth * (2 - depth / self.height)

    def overlap(self, depth: FloatArray) -> FloatArray:
        """Return the volume of the undeformed pad beyond the plate's plane."""
        return np.pi * self.radius * depth**2 * (1 - depth / (3 * self.height))

    def extent(self, depth: FloatArray) -> FloatArray:
        """Return ∫ e dA over the section, e falling evenly from 1 at the pad's centre to 0 on its surface."""
        part = depth / self.height
        return np.pi * self.radius * depth * part * (1 - 2 * part / 3)

    def pressure(self, depth: FloatArray) -> FloatArray:
        """Return p by depth with F(ξ) = ∫ p(d) S'(ξ − d) dd, S being the section.

        With G = F/(2πR_e) and P = ∫p it is P' − P/h = G', so that P = G + (1/h) ∫ G(s) exp((ξ − s)/h) ds.
        """
        scale = 2 * np.pi * self.radius
        nodes = (1 + _NODES) / 2
        held, part = self.load(depth), depth / self.height
        for node, weight, load in zip(nodes, _WEIGHTS / 2, self._loads(depth, nodes), strict=True):
            held = held + weight * part * load * np.exp(part * (1 - node))
        return (self.stiffness(depth) + held / self.height) / scale


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SolvedCurve(Curve):
    """The same between solved contacts, of one pad."""

    splines: tuple[
        CubicSpline, CubicSpline, CubicSpline
    ]  # of logarithms: depth by load, load and area by depth

    def _pressed(self, **given: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        by_load, load, area = self.splines
        ((name, value),) = given.items()
        depth = value if name == "indentation" else _along(by_load, np.log(value / self.reduced_modulus))
        at = np.log(depth)
        return depth, self.reduced_modulus * _along(load, at), _along(area, at)


def _along(spline: CubicSpline, logarithm: FloatArray) -> FloatArray:
    """Return a power law's spline, beyond its ends the power there; complex steps give derivatives."""
    inside = np.clip(np.real(logarithm), spline.x[0], spline.x[-1])
    return np.asarray(np.exp(spline(inside) + spline(inside, 1) * (logarithm - inside)))


def height_of(placement: AnyPlacement) -> FloatArray:
    """Return the height of the pad's centre over the plate at touch."""
    if isinstance(placement, Placement):
        return np.asarray(np.sum(placement.normal * placement.point, axis=-1))
    return np.array(np.inf)


def solved_curve(placement: AnyPlacement, tissue: Tissue, gap: Gap, loads: FloatArray) -> SolvedCurve:
    """Solve contacts over a range of loads."""
    asked = np.geomspace(_BELOW * loads[0], loads[-1], _SOLVED)
    solved = []
    for load in asked[::-1]:  # the highest, which is refused, comes first
        try:
            solved.append(solve_contact(placement, tissue, load=float(load), points=_POINTS))
        except GeometryError as error:
            way_out = "lower loads, or a thickness" if tissue.is_deep else "lower loads"
            raise GeometryError(f"no contact under {load:.3g} N: {error}; or give {way_out}") from None
    modulus = float(tissue.reduced_modulus)
    depth, load, area = (
        np.log([float(getattr(each, name)) for each in solved[::-1]])
        for name in ("indentation", "load", "area")
    )
    load = load - math.log(modulus)
    return SolvedCurve(
        gap=gap,
        height=height_of(placement),
        reduced_modulus=np.array(modulus),
        thickness=tissue.thickness,
        poisson_ratio=tissue.poisson_ratio,
        splines=(CubicSpline(load, depth), CubicSpline(depth, load), CubicSpline(depth, area)),
    )


# --- what is uncertain of one pad, and what that makes of functions of its curve ---


def uncertain_inputs(
    placement: AnyPlacement, tissue: Tissue, stds: Mapping[str, float], *, holds: bool
) -> Inputs | None:
    """Return what is uncertain, if anything is."""
    values = {"youngs_modulus": tissue.youngs_modulus}
    if not tissue.is_deep:
        values["thickness"] = tissue.thickness
    if isinstance(placement, Placement):
        pad = placement.ellipsoid
        values |= {name: getattr(pad, name) for name in _AXES} | {"wedge_angle": placement.wedge_angle}
    for name in stds:
        if name not in values:
            raise GeometryError(f"no standard uncertainty of {name!r} here; there are {', '.join(values)}")
        if not holds and name != "youngs_modulus":
            raise GeometryError(
                f"the uncertainty of {name} needs the fast laws, which do not hold up to the highest load: "
                "give lower loads, or the uncertainty of youngs_modulus alone"
            )
    given: dict[str, Any] = {name: (values[name], std) for name, std in stds.items()}
    return Inputs.of(**given) if given else None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PressedPad:
    """One pad, its curve, and what is uncertain of it."""

    curve: Curve
    placement: AnyPlacement
    tissue: Tissue
    inputs: Inputs | None

    def placed(self, what: str) -> Placement:
        """Return the placement, and refuse radii of curvature in its place."""
        if not isinstance(self.placement, Placement):
            raise GeometryError(f"{what} needs a pad: give a Placement, not a Paraboloid")
        return self.placement

    def with_std(self, function: Callable[[Curve], FloatArray]) -> tuple[FloatArray, FloatArray]:
        """Return a function of the curve, and its standard uncertainty."""
        value = function(self.curve)
        if self.inputs is None:
            return value, np.zeros_like(value)

        def model(**given: FloatArray) -> dict[str, FloatArray]:
            columns = {name: each[..., None] for name, each in given.items()}
            # What does not depend on these inputs has their shape and type none the less.
            found = function(self._varied(columns)) + sum(0 * each for each in columns.values())
            return {str(index): part for index, part in enumerate(np.moveaxis(found, -1, 0))}

        return value, propagate(model, self.inputs).std

    def _varied(self, given: Mapping[str, FloatArray]) -> Curve:
        """Return the curve of other pads and tissues."""
        tissue = self.tissue
        changed: dict[str, Any] = {
            "reduced_modulus": reduced_modulus(
                given.get("youngs_modulus", tissue.youngs_modulus), tissue.poisson_ratio
            ),
            "thickness": given.get("thickness", tissue.thickness),
        }
        if isinstance(self.placement, Placement) and given.keys() & {*_AXES, "wedge_angle"}:
            pad = self.placement.ellipsoid
            axes = [given.get(name, getattr(pad, name)) for name in _AXES]
            wedge = given.get("wedge_angle", self.placement.wedge_angle)
            normal = platen_normal(wedge, self.placement.roll_angle)
            changed["gap"] = gap_kernel(*axes, normal=normal)
            changed["height"] = support_function(axes[0], axes[1], axes[2], normal)
        return replace(self.curve, **changed)
