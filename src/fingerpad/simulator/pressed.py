"""One pad, and what its uncertainties make of functions of its curve."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.contact import Tissue
from fingerpad.contact.contact import AnyPlacement, reduced_modulus
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Placement
from fingerpad.geometry.ellipsoid import support_function
from fingerpad.geometry.gap import gap_kernel
from fingerpad.geometry.placement import platen_normal
from fingerpad.simulator.curve import Curve
from fingerpad.uncertainty import Inputs, propagate

_AXES: Final = ("palmar", "distal", "radial_ulnar")


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
