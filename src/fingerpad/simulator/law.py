"""The force law of a finger pad, and what simulators take to come near it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from scipy.optimize import least_squares

from fingerpad._arrays import FloatArray, as_float_array, check_all, real_number
from fingerpad._display import Displayed
from fingerpad.contact import Tissue, fast_contact
from fingerpad.contact.contact import AnyPlacement
from fingerpad.contact.fast_laws import plate_gap
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Placement
from fingerpad.simulator.curve import Curve, PressedPad, height_of, solved_curve, uncertain_inputs
from fingerpad.simulator.elements import HIGHEST_POISSON_RATIO, TissueElements, stiffness_of
from fingerpad.simulator.mesh import TetrahedralMesh, layer_mesh, pad_mesh
from fingerpad.simulator.targets import (
    MUJOCO_TIME_STEP,
    DrakeModulus,
    FiniteElements,
    MujocoContact,
    NewtonStiffness,
    PressureByDepth,
    impedance,
    mujoco_shape,
)

_LOADS: Final = 64  # over the range, evenly in their logarithm
_DEPTHS: Final = 65  # of the table of pressures
_M_PER_MM: Final = 1e-3
_PA_PER_MPA: Final = 1e6
# Small, so that the spring is MuJoCo's answer to all but this share of a force.
_HIGHEST_IMPEDANCE: Final = 0.2
_LOWEST_IMPEDANCE: Final = 1e-4  # MuJoCo's own limits
_MIDPOINTS: Final = (1e-4, 0.9)
_SHORTEST_TIME_STEP: Final = 1e-5  # s
_RINGS, _LAYERS, _PRESSED = 5, 3, 6  # of the elements that are pressed here, and how often they are
_MARGIN: Final = 1.1  # of the highest load, near which slopes are taken


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SimulatorLaw(Displayed):
    """Load and contact area of a whole pad by indentation, over a range of loads.

    Attributes
    ----------
    pad : PressedPad
        Placement and tissue, mm and MPa, and what is uncertain of them.
    indentation, load, area : ndarray
        ξ (mm), F(ξ) (N) and A(ξ) (mm²), from the lowest load to the highest.
    load_std, area_std : ndarray
        Standard uncertainties of load and area at these indentations; zero where none was given.
    model : str
        ``fast laws``, or ``solver`` where they do not hold.

    Examples
    --------
    >>> from fingerpad.geometry import Ellipsoid, Placement
    >>> place = Placement(Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8), wedge_angle=np.radians(30))
    >>> law = simulator_law(place, Tissue(youngs_modulus=0.05, thickness=8.0), loads=(0.2, 3.0))
    >>> print(f"{law.load[-1]:.1f} N at {law.indentation[-1]:.2f} mm, {law.area[-1]:.0f} mm²")
    3.0 N at 2.21 mm, 143 mm²
    >>> print(f"{law.newton_kh().kh:.3g} N/m³, {law.drake_modulus().modulus:.3g} Pa")
    1.62e+07 N/m³, 1.63e+05 Pa
    >>> print(f"MuJoCo's load within {100 * law.mujoco(effective_mass=0.1).worst_relative_error:.1f} %")
    MuJoCo's load within 0.8 %
    >>> print(f"{law.finite_elements().load_ratio[-1]:.2f} of the law's load by elements")
    0.53 of the law's load by elements
    """

    pad: PressedPad
    indentation: FloatArray
    load: FloatArray
    area: FloatArray
    load_std: FloatArray
    area_std: FloatArray
    model: str

    def as_record(self) -> dict[str, Any]:
        """Return the law as a table, by names that end in units.

        Returns
        -------
        dict
            For tables and scripts.
        """
        return {
            "model": self.model,
            "load_N": self.load,
            "load_N_std": self.load_std,
            "indentation_mm": self.indentation,
            "area_mm2": self.area,
            "area_mm2_std": self.area_std,
        }

    def pressure_by_depth(self) -> PressureByDepth:
        """Return the pressure by depth of overlap with which an elastic foundation has the pad's load.

        Returns
        -------
        PressureByDepth
            For Newton's callback, and any foundation.
        """
        curve = self.pad.curve
        # Pressure begins as a root of the depth: even steps of the root.
        depth = self.indentation[-1] * np.linspace(0, 1, _DEPTHS) ** 2
        pressure, std = (
            np.append(0.0, part) for part in self.pad.with_std(lambda each: each.pressure(depth[1:]))
        )
        step = np.diff(depth)
        held = np.append(0, np.cumsum(step * (pressure[1:] + pressure[:-1]) / 2))
        twice = np.append(0, np.cumsum(step * held[:-1] + step**2 * (2 * pressure[:-1] + pressure[1:]) / 6))
        load = 2 * np.pi * curve.radius * (held - twice / curve.height)
        inside = depth >= self.indentation[0]
        return PressureByDepth(
            depth=depth * _M_PER_MM,
            pressure=pressure * _PA_PER_MPA,
            pressure_std=std * _PA_PER_MPA,
            worst_relative_error=float(np.abs(load[inside] / curve.load(depth[inside]) - 1).max()),
            area_factor=self._area_factor(),
            assumes="a rigid plate, and depth measured from the plate's plane along its normal",
        )

    def newton_kh(self) -> NewtonStiffness:
        """Return the one stiffness per area whose load is nearest to the pad's over the range.

        Returns
        -------
        NewtonStiffness
            ``kh``, with the smallest possible worst error.
        """
        kh, std, error = self._scale(Curve.overlap)
        per_volume = _PA_PER_MPA / _M_PER_MM
        return NewtonStiffness(
            kh=kh * per_volume,
            kh_std=std * per_volume,
            worst_relative_error=error,
            area_factor=self._area_factor(),
            assumes="a plate far stiffer than kh, and depth measured from the plate's plane along its normal",
        )

    def drake_modulus(self, mesh: TetrahedralMesh | None = None) -> DrakeModulus:
        """Return Drake's hydroelastic modulus whose load is nearest to the pad's over the range.

        Parameters
        ----------
        mesh : TetrahedralMesh, optional
            The mesh given to Drake, in the pad's axes, mm. By default one that is fine at the surface with a
            single vertex inside, at the centre, as `mesh` makes it.

        Returns
        -------
        DrakeModulus
            With the smallest possible worst error.

        Raises
        ------
        GeometryError
            If the law is that of a `Paraboloid`, which has no inside, or the mesh is not cut by the plate.
        """
        placement = self.pad.placed("Drake's modulus")
        modulus, std, error = self._scale(Curve.extent)
        if mesh is not None:
            if not isinstance(mesh, TetrahedralMesh):
                raise GeometryError(f"mesh must be a TetrahedralMesh, found {type(mesh).__name__}")
            area, reference = mesh.sections(placement.normal, float(self.pad.curve.height) - self.indentation)
            check_all(
                area > 0, "area of the mesh", area, "cut by the plate at each indentation", GeometryError
            )
            relative = std / modulus
            modulus, error = (float(each) for each in _nearest(reference, self.load))
            std = relative * modulus
        return DrakeModulus(
            modulus=modulus * _PA_PER_MPA,
            modulus_std=std * _PA_PER_MPA,
            worst_relative_error=error,
            area_factor=self._area_factor(),
            assumes="a rigid plate, and a pressure that falls from the pad's centre to its surface, as of "
            "the exported mesh with one vertex inside",
        )

    def mujoco(self, effective_mass: float, damping_ratio: float = 1.0) -> MujocoContact:
        """Return MuJoCo's solref and solimp whose load at rest is nearest to the pad's over the range.

        Parameters
        ----------
        effective_mass : float
            Of the contact, kg.
        damping_ratio : float
            Of small oscillations about the middle of the range of loads; 1 is critical.

        Returns
        -------
        MujocoContact
            With a flag where MuJoCo's own time step is too long.

        Raises
        ------
        GeometryError
            If the mass or the ratio is not positive, or the mass so small that only time steps below 10 µs
            are stable.
        """
        mass = real_number(effective_mass, "effective_mass", GeometryError)
        ratio = real_number(damping_ratio, "damping_ratio", GeometryError)
        for name, value in (("effective_mass", mass), ("damping_ratio", ratio)):
            check_all(0 < value < math.inf, name, value, "positive and finite", GeometryError)
        depth = self.indentation * _M_PER_MM
        solimp = _fit_solimp(depth, self.load)

        # N per shape; the shape's length is in m.
        scale, std, error = self._scale(lambda _, at: mujoco_shape(at * _M_PER_MM, solimp))
        stiffness = scale / mass
        middle = depth[_LOADS // 2]
        frequency = math.sqrt(_squared_frequency(middle, stiffness, solimp))
        damping = 2 * ratio * frequency * solimp[1] / float(impedance(middle, solimp))
        step = _largest_time_step(depth[-1], stiffness, damping, solimp)
        if step < _SHORTEST_TIME_STEP:
            # Frequencies and damping go with the root of the mass.
            least = mass * (_SHORTEST_TIME_STEP / step) ** 2
            raise GeometryError(
                f"effective_mass must be at least {least:.1g} kg for this pad, found {mass:g}: MuJoCo would "
                f"need time steps below {step:.1g} s"
            )
        return MujocoContact(
            effective_mass=mass,
            damping_ratio=ratio,
            solref=(-stiffness, -damping),
            solref_at_twice_the_mass=(-stiffness / 2, -damping / math.sqrt(2)),
            solimp=solimp,
            stiffness_std=std / mass,
            largest_time_step=step,
            flag="time_step_below_default" if step < MUJOCO_TIME_STEP else "",
            worst_relative_error=error,
            area_factor=math.nan,
            assumes=f"one point of contact of effective mass, 1/body_invweight0 in MuJoCo, {mass:g} kg: "
            "with another the same solref is another stiffness",
        )

    def finite_elements(self) -> FiniteElements:
        """Return how far finite elements on the exported tissue are from the law, on a coarser mesh.

        Returns
        -------
        FiniteElements
            Loads over those of the law. On the exported mesh, which is finer, they are up to 0.03 lower.

        Raises
        ------
        GeometryError
            If the law is that of a `Paraboloid` or of deep tissue, or the tissue too thin for the mesh.
        """
        placement, tissue = self.pad.placed("finite elements"), self.pad.tissue
        mesh = layer_mesh(placement, float(tissue.thickness), rings=_RINGS, layers=_LAYERS)
        depth = np.geomspace(self.indentation[0], self.indentation[-1], _PRESSED)
        ratio = min(float(tissue.poisson_ratio), HIGHEST_POISSON_RATIO)
        height = mesh.points @ placement.normal
        elements = TissueElements(
            mesh,
            stiffness_of(mesh, ratio),
            normal=placement.normal,
            gap=height.max() - height,
            deepest=float(depth[-1]),
        )
        load = float(tissue.youngs_modulus) * np.array([elements.load(float(at)) for at in depth])
        share = load / self.pad.curve.load(depth)
        return FiniteElements(
            indentation=depth * _M_PER_MM,
            load_ratio=share,
            poisson_ratio=ratio,
            worst_relative_error=float(np.abs(share - 1).max()),
            area_factor=math.nan,
            assumes="tissue that is bent as the pad is, with free sides, over a bone that is the skin moved "
            "inwards; the law has a flat layer without sides",
        )

    def simulated_loads(self, effective_mass: float = 0.1) -> dict[str, FloatArray]:
        """Return the loads that simulators have at the law's indentations.

        Parameters
        ----------
        effective_mass : float
            Of the contact in MuJoCo, kg.

        Returns
        -------
        dict of str to ndarray
            Loads, N, by ``Newton kh``, ``Drake`` (of a `Placement`) and ``MuJoCo``. A foundation with
            `pressure_by_depth` has the law's own.

        Raises
        ------
        GeometryError
            If the mass is not positive, or too small.
        """
        curve, depth = self.pad.curve, self.indentation
        per_area = _M_PER_MM / _PA_PER_MPA
        loads = {"Newton kh": self.newton_kh().kh * per_area * curve.overlap(depth)}
        if isinstance(self.pad.placement, Placement):
            loads["Drake"] = self.drake_modulus().modulus / _PA_PER_MPA * curve.extent(depth)
        return loads | {"MuJoCo": self.mujoco(effective_mass).load(depth * _M_PER_MM)}

    def mesh(self, level: int = 4) -> TetrahedralMesh:
        """Return a tetrahedral mesh of the pad for Drake, with one vertex inside.

        Parameters
        ----------
        level : int
            How often the 20 triangles of the surface are divided into four, 1 to 6.

        Returns
        -------
        TetrahedralMesh
            In the pad's axes, mm.

        Raises
        ------
        GeometryError
            If the law is that of a `Paraboloid`, or the level is not within its limits.
        """
        return pad_mesh(self.pad.placed("a mesh").ellipsoid, level)

    def _area_factor(self) -> float:
        factor = self.pad.curve.section(self.indentation) / self.area
        return float(factor[np.argmax(np.abs(np.log(factor)))])

    def _scale(self, reference: Callable[[Curve, FloatArray], FloatArray]) -> tuple[float, float, float]:
        """Return the factor on a reference load nearest to the pad's, its std, and the worst error."""

        def at_loads(curve: Curve) -> FloatArray:
            return _nearest(reference(curve, curve.depth(self.load)), self.load)[0][..., None]

        value, std = self.pad.with_std(at_loads)
        _, error = _nearest(reference(self.pad.curve, self.indentation), self.load)
        return float(value[0]), float(std[0]), float(error)


def simulator_law(
    placement: AnyPlacement,
    tissue: Tissue,
    loads: tuple[float, float] = (0.2, 3.0),
    *,
    stds: Mapping[str, float] | None = None,
) -> SimulatorLaw:
    """Return the force law of one whole pad on a plate, from which simulators' numbers follow.

    Lengths are in mm, moduli in MPa and loads in N; what goes into a simulator is in SI units.

    Parameters
    ----------
    placement : Placement or Paraboloid
        Where one pad touches a flat plate.
    tissue : Tissue
        What is pressed: deep, or a layer bonded to rigid bone.
    loads : tuple of float
        Lowest and highest load of the range that matters.
    stds : mapping, optional
        Standard uncertainties by name, independent: ``youngs_modulus``, ``thickness``, and of a pad
        ``palmar``, ``distal``, ``radial_ulnar`` and ``wedge_angle`` (radians).

    Returns
    -------
    SimulatorLaw
        By the fast laws, and by the solver where they do not hold.

    Raises
    ------
    GeometryError
        If there are several pads, the loads do not ascend, the highest would flatten the pad or press the
        layer too thin, a standard uncertainty has no such name, or one other than that of the modulus is
        given where the fast laws do not hold.

    Examples
    --------
    >>> from fingerpad.geometry import Ellipsoid, Placement
    >>> place = Placement(Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8), wedge_angle=np.radians(30))
    >>> tissue = Tissue(youngs_modulus=0.05, thickness=8.0)
    >>> law = simulator_law(place, tissue, stds={"youngs_modulus": 0.005, "thickness": 1.0})
    >>> found = law.newton_kh()
    >>> print(f"{found.kh / 1e6:.1f} ± {found.kh_std / 1e6:.1f} MN/m³")
    16.2 ± 2.4 MN/m³
    """
    if not isinstance(tissue, Tissue):
        raise GeometryError(
            f"the second argument must be a Tissue(youngs_modulus), found {type(tissue).__name__}"
        )
    gap = plate_gap(placement)
    if placement.shape or tissue.shape:
        raise GeometryError(
            f"one pad at a time, found placements of shape {placement.shape} and tissue of "
            f"shape {tissue.shape}"
        )
    ends = as_float_array(loads, "loads")
    if ends.shape != (2,) or not (0 < ends[0] < ends[1] < np.inf):
        raise GeometryError(f"loads must be two that ascend from above zero, found {loads}")
    load = np.geomspace(ends[0], ends[1], _LOADS)
    holds = not fast_contact(placement, tissue, load=_MARGIN * load[-1]).flag_code
    inputs = uncertain_inputs(placement, tissue, stds or {}, holds=holds)
    curve = (
        Curve(
            gap=gap,
            height=height_of(placement),
            reduced_modulus=tissue.reduced_modulus,
            thickness=tissue.thickness,
            poisson_ratio=tissue.poisson_ratio,
        )
        if holds
        else solved_curve(placement, tissue, gap, load)
    )
    pad = PressedPad(curve=curve, placement=placement, tissue=tissue, inputs=inputs)
    depth = curve.depth(load)
    area, area_std = pad.with_std(lambda each: each.area(depth))
    return SimulatorLaw(
        pad=pad,
        indentation=depth,
        load=load,
        area=area,
        load_std=pad.with_std(lambda each: each.load(depth))[1],
        area_std=area_std,
        model="fast laws" if holds else "solver",
    )


def _nearest(reference: FloatArray, load: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the factor on reference loads whose largest relative error is smallest, and that error."""
    ratio = reference / load
    ends = [
        np.take_along_axis(ratio, find(ratio.real, axis=-1)[..., None], axis=-1)[..., 0]
        for find in (np.argmin, np.argmax)
    ]
    low, high = ends
    return 2 / (high + low), np.real((high - low) / (high + low))


def _fit_solimp(depth: FloatArray, load: FloatArray) -> tuple[float, float, float, float, float]:
    """Return solimp whose load at rest is nearest to that of the pad, but for a factor."""
    deepest = float(depth[-1])

    def solimp(free: FloatArray) -> tuple[float, float, float, float, float]:
        lowest, width, midpoint, power = map(float, free * np.array([1.0, deepest, 1.0, 1.0]))
        return lowest * _HIGHEST_IMPEDANCE, _HIGHEST_IMPEDANCE, width, midpoint, power

    def misses(free: FloatArray) -> FloatArray:
        miss = np.log(mujoco_shape(depth, solimp(free)) / load)
        return np.asarray(miss - miss.mean())

    bounds = (
        (_LOWEST_IMPEDANCE / _HIGHEST_IMPEDANCE, 1.0, _MIDPOINTS[0], 1.0),
        (0.95, 10.0, _MIDPOINTS[1], 20.0),
    )
    starts = ((0.2, 1.5, 0.05, 1.5), (0.2, 1.5, 0.5, 1.5))
    found = [least_squares(misses, start, bounds=bounds, x_scale=(0.1, 1.0, 0.1, 1.0)) for start in starts]
    return solimp(min(found, key=lambda each: float(each.cost)).x)


def _squared_frequency(depth: FloatArray, stiffness: float, solimp: tuple[float, ...]) -> FloatArray:
    """Return ω² of small oscillations about rest, (1 − d) dF/dr over the mass."""
    step = 1e-4 * depth
    low, high = (mujoco_shape(at, solimp) for at in (depth - step, depth + step))
    return np.asarray(stiffness * (1 - impedance(depth, solimp)) * (high - low) / (2 * step))


def _largest_time_step(deepest: float, stiffness: float, damping: float, solimp: tuple[float, ...]) -> float:
    """Return the longest stable step: ω²h² + 2ch < 4 for v += h(−ω²r − cv), r += hv."""
    depth = deepest * np.linspace(0.01, 1, 100)
    squared = _squared_frequency(depth, stiffness, solimp)
    c = impedance(depth, solimp) / solimp[1] * damping
    return float(((np.sqrt(c * c + 4 * squared) - c) / squared).min())


def elements_or_reason(law: SimulatorLaw) -> tuple[FiniteElements | None, str]:
    """Return finite elements of the exported tissue, or none and why; deep tissue has none and no reason."""
    if law.pad.tissue.is_deep:
        return None, ""
    try:
        return law.finite_elements(), ""
    except GeometryError as error:
        return None, f"no finite elements: {error}"
