"""What robot simulators take for a finger pad, each with its error; in SI units, as theirs are."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Any, Final

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array
from fingerpad._display import Displayed
from fingerpad._rounding import value_with_uncertainty

MUJOCO_TIME_STEP: Final = 0.002  # s, MuJoCo's default
# Fields that have another name in records, which ends in their unit.
_KEYS: Final = {
    "depth": "depth_m",
    "pressure": "pressure_Pa",
    "pressure_std": "pressure_Pa_std",
    "kh": "kh_N_per_m3",
    "kh_std": "kh_N_per_m3_std",
    "modulus": "hydroelastic_modulus_Pa",
    "modulus_std": "hydroelastic_modulus_Pa_std",
    "effective_mass": "effective_mass_kg",
    "largest_time_step": "largest_time_step_s",
    "indentation": "indentation_m",
}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Target(Displayed):
    """What one simulator takes, and how far its load and area are from the pad's."""

    worst_relative_error: float
    area_factor: float
    assumes: str

    def as_record(self) -> dict[str, Any]:
        """Return the numbers by names that end in units; None for what there is not."""
        general = ("worst_relative_error", "area_factor", "assumes")
        own = (field.name for field in fields(self) if field.name not in general)
        found = {_KEYS.get(name, name): getattr(self, name) for name in (*own, *general)}
        return {key: None if isinstance(value, str) and not value else value for key, value in found.items()}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class PressureByDepth(Target):
    """Pressure of an elastic foundation by the depth of overlap, for Newton's callback and others.

    Attributes
    ----------
    worst_relative_error : float
        Largest relative error of the load at equal indentation, over the law's range of loads.
    area_factor : float
        Contact area over that of the pad, where in the range it is furthest from 1; NaN where the simulator
        has no area.
    assumes : str
        What must hold in the simulator.
    depth : ndarray
        Depths, m, from 0 to the indentation under the highest load.
    pressure, pressure_std : ndarray
        Pressure there and its standard uncertainty, Pa.

    Examples
    --------
    >>> from fingerpad.contact import Tissue
    >>> from fingerpad.geometry import Ellipsoid, Placement
    >>> from fingerpad.simulator import simulator_law
    >>> place = Placement(Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8), wedge_angle=np.radians(30))
    >>> table = simulator_law(place, Tissue(youngs_modulus=0.05, thickness=8.0)).pressure_by_depth()
    >>> print(f"{table.pressure_at(0.001):.0f} Pa")
    14942 Pa
    """

    depth: FloatArray
    pressure: FloatArray
    pressure_std: FloatArray

    def pressure_at(self, depth: ArrayLike) -> FloatArray:
        """Return the pressure at depths, linear between those of the table and along its end beyond.

        Parameters
        ----------
        depth : array_like
            Depth of overlap, m; there is no pressure where it is negative.

        Returns
        -------
        ndarray
            Pressure, Pa.
        """
        at = as_float_array(depth, "depth")
        slope = (self.pressure[-1] - self.pressure[-2]) / (self.depth[-1] - self.depth[-2])
        beyond = slope * np.maximum(at - self.depth[-1], 0)
        return np.asarray(np.interp(at, self.depth, self.pressure) + beyond)[()]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class NewtonStiffness(Target):
    """Newton's ``kh``, one stiffness per area.

    Attributes
    ----------
    worst_relative_error, area_factor, assumes : float, float and str
        As of `PressureByDepth`.
    kh, kh_std : float
        Stiffness and its standard uncertainty, N/m³.
    """

    kh: float
    kh_std: float

    @property
    def words(self) -> str:
        """The stiffness with its uncertainty and unit."""
        return _quantity(self.kh / 1e6, self.kh_std / 1e6, "MN/m³")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class DrakeModulus(Target):
    """Drake's hydroelastic modulus.

    Attributes
    ----------
    worst_relative_error, area_factor, assumes : float, float and str
        As of `PressureByDepth`.
    modulus, modulus_std : float
        Modulus and its standard uncertainty, Pa.
    """

    modulus: float
    modulus_std: float

    @property
    def words(self) -> str:
        """The modulus with its uncertainty and unit."""
        return _quantity(self.modulus / 1e3, self.modulus_std / 1e3, "kPa")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class MujocoContact(Target):
    """MuJoCo's solref and solimp, for one effective mass.

    Attributes
    ----------
    worst_relative_error, area_factor, assumes : float, float and str
        As of `PressureByDepth`.
    effective_mass : float
        Of the contact, kg: one over the sum of ``model.body_invweight0[body, 0]`` of both bodies. It is the
        mass of a free body, and of one on a slide whose inertia is given in the slide's own axes; turned
        against them it is three times the mass.
    damping_ratio : float
        Of small oscillations about the middle of the range of loads.
    solref : tuple of float
        Negative stiffness and damping, for direct format; for twice the mass `solref_at_twice_the_mass`.
    solref_at_twice_the_mass : tuple of float
        The same for twice the effective mass; solimp stays.
    solimp : tuple of float
        d0, dwidth, width (m), midpoint and power.
    stiffness_std : float
        Standard uncertainty of the stiffness, −solref[0].
    largest_time_step : float
        Beyond which MuJoCo's Euler integrator is unstable at the highest load, s.
    flag : str
        ``time_step_below_default`` where MuJoCo's own time step of 2 ms is too long; empty otherwise.
    """

    solref: tuple[float, float]
    solimp: tuple[float, float, float, float, float]
    stiffness_std: float
    effective_mass: float
    damping_ratio: float
    solref_at_twice_the_mass: tuple[float, float]
    largest_time_step: float
    flag: str

    def load(self, depth: ArrayLike) -> FloatArray:
        """Return the load at rest (N) at penetrations (m), as MuJoCo has it: m k d² r/(d_w² (1 − d))."""
        return (
            self.effective_mass * -self.solref[0] * mujoco_shape(as_float_array(depth, "depth"), self.solimp)
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FiniteElements(Target):
    """Load of linear finite elements on the exported tissue, over the load of the law.

    The law, and with it every other target, is that of a flat layer without sides. The exported tissue is
    bent as the pad is, and its sides are free: it carries less, the least where the tissue is nearly
    incompressible. A finger's skin goes on round it; which of the two is nearer was not measured.

    Attributes
    ----------
    worst_relative_error, area_factor, assumes : float, float and str
        As of `PressureByDepth`; there is no area.
    indentation : ndarray
        Some indentations of the law, m.
    load_ratio : ndarray
        Load of the elements over that of the law there.
    poisson_ratio : float
        Of the elements, at most 0.49.
    """

    indentation: FloatArray
    load_ratio: FloatArray
    poisson_ratio: float


def _quantity(value: float, std: float, unit: str) -> str:
    """Return a number with its unit and standard uncertainty: none if that is 0, and said so if it is NaN."""
    if std > 0:
        return f"{value_with_uncertainty(value, std)} {unit}"
    return f"{value:.4g} {unit}" + (", of unknown uncertainty" if math.isnan(std) else "")


def impedance(depth: FloatArray, solimp: tuple[float, ...] | FloatArray) -> FloatArray:
    """Return MuJoCo's d(r)."""
    lowest, highest, width, midpoint, power = solimp
    x = np.minimum(depth / width, 1)
    low = x**power / midpoint ** (power - 1)
    high = 1 - (1 - x) ** power / (1 - midpoint) ** (power - 1)
    return np.asarray(lowest + np.where(x <= midpoint, low, high) * (highest - lowest))


def mujoco_shape(depth: FloatArray, solimp: tuple[float, ...] | FloatArray) -> FloatArray:
    """Return the load at rest over effective mass and stiffness."""
    d = impedance(depth, solimp)
    return np.asarray((d / solimp[1]) ** 2 * depth / (1 - d))
