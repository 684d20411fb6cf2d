"""The field below a pad, by Hertz theory and of a solved contact alike: on its axis and in section."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Self, TypeAlias

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array, broadcast, check_all
from fingerpad._display import Displayed
from fingerpad.contact.contact import AnyPlacement, Contact, Tissue
from fingerpad.contact.hertz import hertz_contact
from fingerpad.contact.solved_stress import SolvedStress
from fingerpad.contact.solver import SolvedContact
from fingerpad.contact.stress import HertzPressure, StressField
from fingerpad.exceptions import GeometryError

_LEVELS = 25  # of the first search for the highest shear
_NARROWED = 6  # of each later one
_SEARCHES = 3
# A section's half-width and greatest depths, in mean radii of the contact.
_WIDE, _DEEP, _LAYER = 1.75, 1.5, 3.0

Pressure: TypeAlias = Callable[[ArrayLike, ArrayLike], FloatArray]
Stress: TypeAlias = Callable[[ArrayLike, ArrayLike, ArrayLike], StressField]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ContactSection(Displayed):
    """The section through the place of first contact, along the finger and normal to the surface."""

    along: FloatArray  # (n,), from the place of first contact
    depth: FloatArray  # (m,), below the surface
    pressure: FloatArray  # (n,)
    maximum_shear: FloatArray  # (m, n)
    thickness: float  # of the layer; infinite on a half-space


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ContactField(Displayed):
    """Pressure, stress and strain of one contact, and the tissue below it.

    The axis is the normal at the place of first contact, where both coordinates in the surface are zero.

    Attributes
    ----------
    contact : Contact
        The contact.
    tissue : Tissue
        What is pressed; deep in Hertz theory.
    pressure_at : callable
        Pressure at points (along, across) of the surface.
    stress_at : callable
        Stress at points (along, across, depth), on those axes.

    Examples
    --------
    The pad of Dzidek et al. (2017) at 2 N: on 8 mm of tissue over bone the shear is higher than Hertz theory
    says, and highest nearer to the surface.

    >>> from fingerpad.contact import solve_contact
    >>> from fingerpad.geometry import Ellipsoid, Placement
    >>> place = Placement(Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8), wedge_angle=np.radians(30))
    >>> tissue = Tissue(youngs_modulus=0.1024, thickness=8.0)
    >>> solved = solve_contact(place, tissue, load=2.0, points=64)
    >>> hertz = ContactField.of_hertz(place, tissue, load=2.0)
    >>> for field in (hertz, ContactField.of_solution(solved)):
    ...     shear, depth = field.highest_shear_on_axis()
    ...     print(f"{1000 * shear:.1f} kPa at {depth:.1f} mm")
    9.1 kPa at 2.9 mm
    11.7 kPa at 2.5 mm
    """

    contact: Contact
    tissue: Tissue
    pressure_at: Pressure
    stress_at: Stress
    _fast_stress_at: Stress | None = None  # near enough for a first search

    @classmethod
    def of_solution(cls, contact: SolvedContact) -> Self:
        """Return the field of a solved contact.

        Parameters
        ----------
        contact : SolvedContact
            On deep tissue or on a layer.

        Returns
        -------
        ContactField
            Along the finger and across it; the pressure is linear between cells.

        Raises
        ------
        GeometryError
            If a layer is so thick beside the contact that it is deep tissue in effect.
        """
        stress = SolvedStress.of(contact)
        return cls(
            contact=contact,
            tissue=contact.tissue,
            pressure_at=partial(_solved_pressure, contact),
            stress_at=stress.at,
            _fast_stress_at=stress.of_long_waves().at,
        )

    @classmethod
    def of_hertz(
        cls,
        placement: AnyPlacement,
        tissue: Tissue,
        *,
        load: float | None = None,
        area: float | None = None,
        indentation: float | None = None,
    ) -> Self:
        """Return the field by Hertz theory, in deep tissue: closed forms throughout.

        Parameters
        ----------
        placement, tissue, load, area, indentation
            As for `hertz_contact`, of one contact.

        Returns
        -------
        ContactField
            First coordinate along the finger, second across.

        Raises
        ------
        GeometryError
            If a value is impossible.
        """
        contact = hertz_contact(placement, tissue, load=load, area=area, indentation=indentation)
        if np.ndim(contact.load) or not 0 < contact.load < math.inf:
            raise GeometryError("the field is that of one contact under a positive, finite load")
        angle = float(placement.gap.angle) + (0.0 if contact.along else math.pi / 2)
        pressure = HertzPressure.of_contact(contact, angle)
        deep = Tissue(tissue.youngs_modulus, tissue.poisson_ratio)
        return cls(
            contact=contact,
            tissue=deep,
            pressure_at=pressure.at,
            stress_at=partial(pressure.stress, poisson_ratio=float(tissue.poisson_ratio)),
        )

    def stress_on_axis(self, depth: ArrayLike) -> StressField:
        """Return the stress below the place of first contact.

        Parameters
        ----------
        depth : array_like
            Depths below the surface, of any shape.

        Returns
        -------
        StressField
            Tensor of shape (..., 3, 3), axes along, across and down.

        Raises
        ------
        GeometryError
            If a depth is outside the tissue.
        """
        depths = as_float_array(depth)
        place = f"in the layer, from 0 to its thickness {self.tissue.thickness:g}"
        if self.tissue.is_deep:
            place = "finite and not negative"
        good = (depths >= 0) & (depths <= self.tissue.thickness) & np.isfinite(depths)
        check_all(good, "depth", depths, place, GeometryError)
        return self.stress_at(0.0, 0.0, depths)

    def strain(self, stress: StressField) -> FloatArray:
        """Return the strain of the tissue under a stress.

        Parameters
        ----------
        stress : StressField
            Stress in the tissue, tensor of shape (..., 3, 3).

        Returns
        -------
        ndarray, shape (..., 3, 3)
            Strain, extension positive.
        """
        return stress.strain(
            youngs_modulus=self.tissue.youngs_modulus, poisson_ratio=float(self.tissue.poisson_ratio)
        )

    def strain_energy_density(self, stress: StressField) -> FloatArray:
        """Return the energy stored in the tissue under a stress, by volume.

        Parameters
        ----------
        stress : StressField
            Stress in the tissue, tensor of shape (..., 3, 3).

        Returns
        -------
        ndarray, shape (...)
            Energy per volume, in the unit of the stress.
        """
        return stress.strain_energy_density(
            youngs_modulus=self.tissue.youngs_modulus, poisson_ratio=float(self.tissue.poisson_ratio)
        )

    def highest_shear_on_axis(self) -> tuple[float, float]:
        """Return the highest maximum shear stress on the axis, and its depth.

        It is looked for down to the bone, but no deeper than twice the contact's mean radius.

        Returns
        -------
        shear : float
            In the unit of the stress.
        depth : float
            Below the surface.
        """
        end = min(float(self.tissue.thickness), 2 * self._mean_radius)
        low, high, levels, stress_at = 0.0, end, _LEVELS, self._fast_stress_at or self.stress_at
        for _ in range(_SEARCHES):
            depths = np.linspace(low, high, levels)
            shear = stress_at(0.0, 0.0, depths).maximum_shear
            best = int(np.argmax(shear))
            low, high = float(depths[max(best - 1, 0)]), float(depths[min(best + 1, levels - 1)])
            levels, stress_at = _NARROWED, self.stress_at
        return float(shear[best]), float(depths[best])

    def section(self, *, points: int = 181, levels: int = 61) -> ContactSection:
        """Return the section along the finger, down to the bone where the layer is not thick.

        Parameters
        ----------
        points, levels : int
            Points along the finger, and in depth.

        Returns
        -------
        ContactSection
            Of width 3.5 times the contact's mean radius.
        """
        width = _WIDE * self._mean_radius
        deepest = (_DEEP if self.tissue.is_deep else _LAYER) * self._mean_radius
        along = np.linspace(-width, width, points)
        depth = np.linspace(0, min(float(self.tissue.thickness), deepest), levels)
        return ContactSection(
            along=along,
            depth=depth,
            pressure=self.pressure_at(along, np.zeros(points)),
            maximum_shear=self.stress_at(along, 0.0, depth[:, None]).maximum_shear,
            thickness=float(self.tissue.thickness),
        )

    @property
    def _mean_radius(self) -> float:
        return math.sqrt(self.contact.area / math.pi)


def _solved_pressure(contact: SolvedContact, along: ArrayLike, across: ArrayLike) -> FloatArray:
    """Return the solved pressure at points of the surface, zero beyond its grid."""
    return contact.grid.sample(contact.pressure, contact.grid.to_own(*broadcast(along, across)))
