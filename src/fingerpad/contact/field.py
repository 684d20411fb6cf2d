"""The field below a pad, by Hertz theory and of a solved contact alike: on its axis and in section."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Self, TypeAlias

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array, broadcast, check_all
from fingerpad._display import Displayed
from fingerpad.contact.contact_stress import contact_stress
from fingerpad.contact.ellipsoid_contact import hertz_contact_at, hertz_geometry_of_pad, normal_of_one_pad
from fingerpad.contact.gap import Counterface
from fingerpad.contact.hertz import youngs_modulus
from fingerpad.contact.hertz_pressure import HertzPressure
from fingerpad.contact.influence import ElasticBody
from fingerpad.contact.solver import ContactSolution
from fingerpad.contact.stress import StressField
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Ellipsoid

_LEVELS = 25  # of the first search for the highest shear
_NARROWED = 6  # of each later one
_SEARCHES = 3
# A section's half-width and greatest depths, in mean radii of the contact.
_WIDE, _DEEP, _LAYER = 1.75, 1.5, 3.0

Pressure: TypeAlias = Callable[[ArrayLike, ArrayLike], FloatArray]
Stress: TypeAlias = Callable[[ArrayLike, ArrayLike, ArrayLike], StressField]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ContactSection(Displayed):
    """The section through the place of first contact, along the finger and normal to the surface.

    Attributes
    ----------
    along : ndarray, shape (n,)
        Coordinates along the finger, from the place of first contact.
    depth : ndarray, shape (m,)
        Depths below the surface.
    pressure : ndarray, shape (n,)
        Contact pressure.
    maximum_shear : ndarray, shape (m, n)
        Maximum shear stress.
    thickness : float
        Of the layer; infinite on a half-space.

    Examples
    --------
    >>> pad = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
    >>> field = ContactField.of_hertz(pad, wedge_angle=np.radians(30), load=2.0, reduced_modulus=0.1365)
    >>> section = field.section(points=41, levels=11)
    >>> section.maximum_shear.shape
    (11, 41)
    >>> print(f"{1000 * section.pressure.max():.1f} kPa")
    33.9 kPa
    """

    along: FloatArray
    depth: FloatArray
    pressure: FloatArray
    maximum_shear: FloatArray
    thickness: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ContactField(Displayed):
    """Pressure, stress and strain of one contact, and the tissue below it.

    The axis is the normal at the place of first contact, where both coordinates in the surface are zero.

    Attributes
    ----------
    load, area, indentation, peak_pressure : float
        Normal force W, contact area, mutual approach ξ, highest pressure.
    body : ElasticBody
        The tissue.
    pressure_at : callable
        Pressure at points (along, across) of the surface.
    stress_at : callable
        Stress at points (along, across, depth), on those axes.

    Examples
    --------
    The pad of Dzidek et al. (2017) at 2 N: on 8 mm of tissue over bone the shear is higher than Hertz theory
    says, and highest nearer to the surface.

    >>> from fingerpad.contact import EllipsoidContact
    >>> pad = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
    >>> press = {"wedge_angle": np.radians(30), "load": 2.0, "reduced_modulus": 0.1365}
    >>> hertz = ContactField.of_hertz(pad, **press)
    >>> contact = EllipsoidContact.of(pad, thickness=8.0, points=64, **press)
    >>> for field in (hertz, ContactField.of_solution(contact.solution)):
    ...     shear, depth = field.highest_shear_on_axis()
    ...     print(f"{1000 * shear:.1f} kPa at {depth:.1f} mm")
    9.1 kPa at 2.9 mm
    11.7 kPa at 2.5 mm
    """

    load: float
    area: float
    indentation: float
    peak_pressure: float
    body: ElasticBody
    pressure_at: Pressure
    stress_at: Stress

    @classmethod
    def of_solution(cls, solution: ContactSolution) -> Self:
        """Return the field of a solved contact.

        Parameters
        ----------
        solution : ContactSolution
            A contact on a half-space or on a layer.

        Returns
        -------
        ContactField
            In the solution's own coordinates; stress as `contact_stress`, pressure linear between cells.
        """
        return cls(
            load=solution.load,
            area=solution.area,
            indentation=solution.indentation,
            peak_pressure=solution.peak_pressure,
            body=solution.body,
            pressure_at=partial(_solved_pressure, solution),
            stress_at=partial(contact_stress, solution),
        )

    @classmethod
    def of_hertz(
        cls,
        pad: Ellipsoid,
        *,
        wedge_angle: float,
        roll_angle: float = 0.0,
        counterface: Counterface | None = None,
        reduced_modulus: float,
        poisson_ratio: float = 0.5,
        load: float | None = None,
        indentation: float | None = None,
        area: float | None = None,
    ) -> Self:
        """Return the field by Hertz theory, in a half-space: closed forms throughout.

        Parameters
        ----------
        pad : Ellipsoid
            One pad.
        wedge_angle, roll_angle : float
            Placement, radians.
        counterface : Counterface, optional
            The rigid body; a plate where none is given.
        reduced_modulus, poisson_ratio : float
            E* and ν of the tissue.
        load, indentation, area : float
            Exactly one of normal force W, mutual approach ξ and contact area.

        Returns
        -------
        ContactField
            First coordinate along the finger, second across.

        Raises
        ------
        GeometryError
            If a value is impossible.
        """
        body = ElasticBody(reduced_modulus=reduced_modulus, poisson_ratio=poisson_ratio)
        given = [value for value in (load, indentation, area) if value is not None]
        if len(given) != 1 or not given[0] > 0:
            raise GeometryError("give exactly one of load, indentation and area, positive")
        rigid = Counterface.plate() if counterface is None else counterface
        geometry, angle = hertz_geometry_of_pad(pad, normal_of_one_pad(pad, wedge_angle, roll_angle), rigid)
        contact = hertz_contact_at(geometry, reduced_modulus, load, indentation, area)
        if geometry.long_axis == 1:
            angle += math.pi / 2
        pressure = HertzPressure.of_contact(contact, angle)
        return cls(
            load=float(contact.load),
            area=float(contact.area),
            indentation=float(contact.indentation),
            peak_pressure=float(contact.peak_pressure),
            body=body,
            pressure_at=pressure.at,
            stress_at=partial(pressure.stress, poisson_ratio=poisson_ratio),
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
            If a depth is outside the body.
        """
        depths = as_float_array(depth)
        place = f"in the layer, from 0 to its thickness {self.body.thickness:g}"
        if math.isinf(self.body.thickness):
            place = "finite and not negative"
        good = (depths >= 0) & (depths <= self.body.thickness) & np.isfinite(depths)
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
        return stress.strain(youngs_modulus=self._modulus, poisson_ratio=self.body.poisson_ratio)

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
            youngs_modulus=self._modulus, poisson_ratio=self.body.poisson_ratio
        )

    @property
    def _modulus(self) -> FloatArray:
        return youngs_modulus(self.body.reduced_modulus, self.body.poisson_ratio)

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
        end = min(self.body.thickness, 2 * self._mean_radius)
        low, high, levels = 0.0, end, _LEVELS
        for _ in range(_SEARCHES):
            depths = np.linspace(low, high, levels)
            shear = self.stress_on_axis(depths).maximum_shear
            best = int(np.argmax(shear))
            low, high = float(depths[max(best - 1, 0)]), float(depths[min(best + 1, levels - 1)])
            levels = _NARROWED
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
        deepest = (_DEEP if math.isinf(self.body.thickness) else _LAYER) * self._mean_radius
        along = np.linspace(-width, width, points)
        depth = np.linspace(0, min(self.body.thickness, deepest), levels)
        return ContactSection(
            along=along,
            depth=depth,
            pressure=self.pressure_at(along, np.zeros(points)),
            maximum_shear=self.stress_at(along, 0.0, depth[:, None]).maximum_shear,
            thickness=self.body.thickness,
        )

    @property
    def _mean_radius(self) -> float:
        return math.sqrt(self.area / math.pi)


def _solved_pressure(solution: ContactSolution, along: ArrayLike, across: ArrayLike) -> FloatArray:
    """Return the solved pressure at points of the surface, zero beyond its grid."""
    return solution.grid.sample(solution.pressure, solution.grid.to_own(*broadcast(along, across)))
