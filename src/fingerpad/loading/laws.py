"""The contact laws of this library, W(ξ), and the load and area of a law with the values that fit a record.

`hertz`, `load_dependent`, `exact_sphere`, `free_exponent` and `jkr` are each one function with one decorator,
`contact_law`, which puts it into the registry `LAWS`; those of a lab are in its own files. Fits, comparisons
and figures take a law by its name and ask it for load and area, no more.

**To add one**, write such a function: of the indentation, of ``loading_radius`` and ``poisson_ratio`` if it
needs them, and of its own parameters. Place of contact, zero and drift of the force, scale of the areas and a
yielding stage are the fit's (`fingerpad.loading.joint`), and no law's.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Any, Final, TypeVar

import numpy as np
from scipy.interpolate import CubicSpline

from fingerpad._arrays import ArrayLike, BoolArray, FloatArray, as_float_array, broadcast_named
from fingerpad._display import Displayed
from fingerpad.contact.fast_laws import press
from fingerpad.exceptions import FitError
from fingerpad.geometry.gap import Gap, paraboloid_gap
from fingerpad.loading.law_registry import (
    LAWS,
    NEAR_HERTZ,
    PAD_FORM,
    Bound,
    Law,
    arguments_of,
    contact_law,
    evaluate,
)

Real = TypeVar("Real", float, FloatArray)

# Knots of an adhesive law between its pull-off and the deepest indentation.
_ADHESIVE_KNOTS: Final = 400
# Where β h comes this near to one, the load grows beyond all bounds, and a search must be turned back.
_POLE = 0.02
# The exact sphere is tabulated to this a/R, a layer to this a/t (its laws hold to 3).
_WIDEST, THINNEST = 0.98, 2.95
_WIDEST_PAD, _KNOTS = 1.2, 48  # a/R to which a pad is tabulated, where its laws hold
_LEAST = 0.2
_INCOMPRESSIBLE = 0.5
_SPHERE: Final = (1.0, 0.0, 0.0, 1.0)  # its form, as that of a pad
# The law whose quantities are stated of a curve.
MAIN: Final = "load_dependent"

# --- shape: how load and area depart from those of a paraboloid on a half-space ---
# An exact sphere, or a layer over bone: both are factors at the same ξ, on 4/3 √R ξ^(3/2) and on π R ξ. A pad
# that is not a sphere has R = 1/H, and its form is four numbers without dimension, `PAD_FORM`.


def shape_factors(
    law: str, values: Mapping[str, float], xi: FloatArray, poisson_ratio: float
) -> tuple[FloatArray | float, FloatArray | float]:
    """Return the factors on load and area at indentations ξ (mm), both one for a paraboloid on a half-space.

    The `shape` of a law, or a value ``inverse_thickness`` (1/mm), says otherwise. A negative one, to which a
    search may go, continues the factors in a straight line.
    """
    radius, shape = max(values["loading_radius"], 1e-9), LAWS[law].shape
    if shape is not None:
        if inverse := radius * values.get("inverse_thickness", 0.0):
            return _on_layer(_SPHERE, inverse, poisson_ratio, np.sqrt(np.maximum(xi, 0.0) / radius))
        load, area = shape(xi / radius)
        return load, area
    if PAD_FORM[0] in values:
        curved = values.get("pad_form", 1.0)
        form = (values[PAD_FORM[0]], *(curved * values[name] for name in PAD_FORM[1:]))
        inverse = radius * values.get("inverse_thickness", 0.0)
        return _on_layer(form, inverse, poisson_ratio, np.sqrt(np.maximum(xi, 0.0) / radius))
    if values.get("inverse_thickness", 0.0) != 0:
        size = np.sqrt(radius * np.maximum(xi, 0.0)) * values["inverse_thickness"]
        return _within(_layer(poisson_ratio), size)
    return 1.0, 1.0


def _within(factors: CubicSpline, size: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the factors on load and area, the spline's columns; beyond its ends they go on straight."""
    known = np.minimum(np.maximum(size, 0.0), factors.x[-1])
    both = factors(known)
    beyond = size - known
    if beyond.any():
        both += factors(known, 1) * beyond[..., None]
    both = np.maximum(both, _LEAST)
    return both[..., 0], both[..., 1]


def _on_layer(
    form: tuple[float, ...], inverse: float, poisson_ratio: float, size: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the factors of a pad at sizes √(ξ/R); a negative R/t continues them as an odd function of it."""
    if poisson_ratio > _INCOMPRESSIBLE:
        most = _on_layer(form, inverse, _INCOMPRESSIBLE, size)
        less = _on_layer(form, inverse, 2 * _INCOMPRESSIBLE - poisson_ratio, size)
        return 2 * most[0] - less[0], 2 * most[1] - less[1]
    load, area = _within(_pad(form, abs(inverse), poisson_ratio), size)
    if inverse >= 0:
        return load, area
    deep = _within(_pad(form, 0.0, poisson_ratio), size)
    return np.maximum(2 * deep[0] - load, _LEAST), np.maximum(2 * deep[1] - area, _LEAST)


@lru_cache(maxsize=1024)
def _pad(form: tuple[float, ...], inverse: float, poisson_ratio: float) -> CubicSpline:
    """Return the factors of a pad of R = 1 on a layer of thickness 1/inverse, against √ξ."""
    first = (1 + form[0]) / 2
    radii = np.array([first, first / form[0]])
    a = np.linspace(0.01, _WIDEST_PAD, _KNOTS) * min(1.0, THINNEST / (inverse * _WIDEST_PAD + 1e-12))
    skew = dict(zip(PAD_FORM[1:], map(np.asarray, form[1:]), strict=True))
    contact = press(
        Gap(first_radius=radii[0], second_radius=radii[1], **skew, angle=np.zeros(())),
        area=np.pi * a**2,
        reduced_modulus=1.0,
        thickness=1 / inverse if inverse else None,
        poisson_ratio=max(poisson_ratio, 0.3),
    )
    known = contact.flag_code == 0
    load, depth, area = (
        np.append(at_first, getattr(contact, name)[known])
        for at_first, name in zip(_first_touch(*radii.tolist()), ("load", "indentation", "area"), strict=True)
    )
    size = np.append(0.0, np.sqrt(depth[1:]))
    return CubicSpline(size, np.stack([0.75 * load / depth**1.5, area / (np.pi * depth)], axis=-1))


@lru_cache(maxsize=1024)
def _first_touch(first: float, second: float) -> tuple[float, float, float]:
    """Return load, indentation and area of a paraboloid of these radii on a half-space."""
    point = press(paraboloid_gap(np.array(first), np.array(second)), area=np.pi, reduced_modulus=1.0)
    return float(point.load), float(point.indentation), float(point.area)


def _on_sphere(size: FloatArray) -> tuple[FloatArray, FloatArray]:
    return _within(_sphere(), size)


@cache
def _sphere() -> CubicSpline:
    """Return the factors against ξ/R (Sneddon 1965: ξ = a artanh(a/R), frictionless)."""
    a = np.linspace(0.01, _WIDEST, 300)
    depth = a * np.arctanh(a)
    load = (1 + a**2) * np.arctanh(a) - a
    size = np.append(0.0, depth)
    return CubicSpline(size, np.insert([0.75 * load / depth**1.5, a**2 / depth], 0, 1.0, axis=1).T)


@cache
def _layer(poisson_ratio: float) -> CubicSpline:
    """Return the factors against √(Rξ)/t on a layer bonded to bone (`fast_contact`)."""
    a = np.linspace(0.02, THINNEST, 150)
    radius = 256.0  # they do not depend on it; on one like the thickness, the layer would be pressed through
    contact = press(
        paraboloid_gap(np.array(radius), np.array(radius)),
        area=np.pi * a**2,
        reduced_modulus=1.0,
        thickness=1.0,
        poisson_ratio=max(poisson_ratio, 0.3),
    )
    size = np.sqrt(radius * contact.indentation)
    factors = [0.75 * radius * contact.load / size**3, contact.area_over_pi_indentation / radius]
    size = np.append(0.0, size)
    return CubicSpline(size, np.insert(factors, 0, 1.0, axis=1).T)


# --- laws of this library ---
# They go on outside of what is physical, so that a search without bounds can come back.

_OPEN: Final[Bound] = (None, None)


def hertz_stiffness(radius: Real, poisson_ratio: Real) -> Real:
    """Return k = 4/3 √R/(1 − ν²) of Hertz's W = k E ξ^(3/2), Johnson (4.23)."""
    stiffness: Real = 4 / 3 * radius**0.5 / (1 - poisson_ratio**2)
    return stiffness


def _three_halves(indentation: FloatArray) -> FloatArray:
    """Return ξ^(3/2), six times as fast as a power; searches spend much of their time on it."""
    return indentation * np.sqrt(indentation)


def _slope_of_growing(
    indentation: FloatArray,
    *,
    loading_radius: float,
    poisson_ratio: float,
    initial_modulus: float,
    load_coefficient: float = 0.0,
) -> Any:
    """Return dW/dξ of a modulus E_0g + β W."""
    h = hertz_stiffness(loading_radius, poisson_ratio) * _three_halves(indentation)
    rest = np.maximum(1 - load_coefficient * h, _POLE)
    return 1.5 * initial_modulus * h / np.maximum(indentation, 1e-12) / rest**2


def _slope_of_hertz(
    indentation: FloatArray,
    *,
    loading_radius: float,
    poisson_ratio: float,
    youngs_modulus: float,
) -> Any:
    return _slope_of_growing(
        indentation,
        loading_radius=loading_radius,
        poisson_ratio=poisson_ratio,
        initial_modulus=youngs_modulus,
    )


@contact_law(
    parameters={"youngs_modulus": _OPEN},
    units={"youngs_modulus": "MPa"},
    label="Hertz",
    slope=_slope_of_hertz,
    steps=NEAR_HERTZ,
)
def hertz(
    indentation: FloatArray,
    *,
    loading_radius: float,
    poisson_ratio: float,
    youngs_modulus: float,
    shape_factor: FloatArray | float = 1.0,
) -> Any:
    """Return W = 4/3 E* √R ξ^(3/2), Johnson (4.23)."""
    stiffness = hertz_stiffness(loading_radius, poisson_ratio) * shape_factor
    return youngs_modulus * (stiffness * _three_halves(indentation))


_GROWING: Final[Mapping[str, Any]] = {
    "parameters": {"initial_modulus": _OPEN, "load_coefficient": _OPEN},
    "units": {"initial_modulus": "MPa", "load_coefficient": "MPa/N"},
    "slope": _slope_of_growing,
    "steps": NEAR_HERTZ,
}


@contact_law(**_GROWING, label="modulus growing with load")
def load_dependent(
    indentation: FloatArray,
    *,
    loading_radius: float,
    poisson_ratio: float,
    initial_modulus: float,
    load_coefficient: float,
    shape_factor: FloatArray | float = 1.0,
) -> Any:
    """Return W = E_0g h/(1 − β h) with h = 4/3 √R ξ^(3/2)/(1 − ν²): Hertz's law with E = E_0g + β W.

    Its pole is left finite and very large, for a search.
    """
    stiffness = hertz_stiffness(loading_radius, poisson_ratio) * shape_factor
    h = stiffness * _three_halves(indentation)
    return initial_modulus * h / np.maximum(1 - load_coefficient * h, _POLE)


# The same law of another body: not its paraboloid is pressed, but the sphere itself.
contact_law(**_GROWING, name="exact_sphere", label="exact sphere", shape=_on_sphere)(load_dependent.function)


def _slope_of_free_exponent(
    indentation: FloatArray,
    *,
    loading_radius: float,
    poisson_ratio: float,
    youngs_modulus: float,
    load_exponent: float,
) -> Any:
    factor = youngs_modulus * hertz_stiffness(loading_radius, poisson_ratio)
    exponent = _searched(load_exponent)
    return exponent * factor * np.maximum(indentation, 1e-12) ** (exponent - 1)


def _searched(load_exponent: float) -> float:
    """Return an exponent that a search cannot lose itself with."""
    return min(max(load_exponent, 0.05), 20.0)


@contact_law(
    parameters={"youngs_modulus": _OPEN, "load_exponent": _OPEN},
    units={"youngs_modulus": "MPa", "load_exponent": ""},
    label="free exponent",
    slope=_slope_of_free_exponent,
    steps=NEAR_HERTZ,
)
def free_exponent(
    indentation: FloatArray,
    *,
    loading_radius: float,
    poisson_ratio: float,
    youngs_modulus: float,
    load_exponent: float,
    shape_factor: FloatArray | float = 1.0,
) -> Any:
    """Return W ∝ ξ^m, with Hertz's factor."""
    stiffness = hertz_stiffness(loading_radius, poisson_ratio) * shape_factor
    return youngs_modulus * stiffness * indentation ** _searched(load_exponent)


# --- the law of an adhesive contact ---
# Of Johnson, Kendall and Roberts (1971), with the radius a of the contact, E* and the work of adhesion w:
# W = 4 E* a³/(3R) − √(8π w E* a³) and ξ = a²/R − √(2π w a/E*). The contact is lost where dξ/da = 0, at
# a_f³ = π w R²/(8 E*). With a = a_f t², ξ = a_f² (t⁴ − 4t)/R and W = π w R (t⁶/6 − t³). The stable branch is
# t ≥ 1, and there t⁴ − 4t + 3 = u² (u² + 4u + 6) with u = t − 1, whose root grows with u without a turning
# point.

# Range of the forces of adhesion, mm, for Tabor's parameter: the distance of atoms in contact.
RANGE_OF_ADHESION: Final = 0.3e-6
# Tabor's parameter above which the theory of JKR holds, and below which that of DMT does.
JKR_ABOVE, DMT_BELOW = 5.0, 0.1
_NEWTON: Final = 8
# No work of adhesion at all is as good as this share of E* R.
_NONE: Final = 1e-30


def _scales(
    loading_radius: float, poisson_ratio: float, youngs_modulus: float, work_of_adhesion: float
) -> tuple[float, float]:
    """Return the work of adhesion, above zero, and the radius a_f at which contact is lost."""
    modulus = max(youngs_modulus, 1e-300) / (1 - poisson_ratio**2)
    work = max(work_of_adhesion, _NONE * modulus * loading_radius)
    return work, float((np.pi * work * loading_radius**2 / (8 * modulus)) ** (1 / 3))


def _root(indentation: ArrayLike, radius: float, lost: float) -> FloatArray:
    """Return t of the stable branch; NaN without contact."""
    xi = as_float_array(indentation)
    rest = xi * radius / lost**2 + 3
    wanted = np.sqrt(np.where(rest >= 0, rest, np.nan))
    u = wanted / np.sqrt(6 + wanted)
    for _ in range(_NEWTON):
        root = np.sqrt(u * u + 4 * u + 6)
        u = u - (u * root - wanted) / (root + u * (u + 2) / root)
    return np.asarray(1 + u)


def _area(
    indentation: ArrayLike,
    *,
    loading_radius: float,
    poisson_ratio: float,
    youngs_modulus: float,
    work_of_adhesion: float,
) -> Any:
    """Return π a², zero without contact."""
    _, lost = _scales(loading_radius, poisson_ratio, youngs_modulus, work_of_adhesion)
    t = _root(indentation, loading_radius, lost)
    return np.nan_to_num(np.pi * lost**2 * t**4)


def _pull_off(
    *, loading_radius: float, poisson_ratio: float, youngs_modulus: float, work_of_adhesion: float
) -> float:
    """Return the indentation −3 a_f²/R at which contact is lost."""
    _, lost = _scales(loading_radius, poisson_ratio, youngs_modulus, work_of_adhesion)
    return -3 * lost**2 / loading_radius


def _pull_off_load(*, loading_radius: float, youngs_modulus: float, work_of_adhesion: float) -> float:  # noqa: ARG001
    """Return the largest pull, 3/2 π w R."""
    return 1.5 * np.pi * work_of_adhesion * loading_radius


def tabor_parameter(
    *,
    loading_radius: float,
    youngs_modulus: float,
    work_of_adhesion: float,
    poisson_ratio: float = 0.5,
    range_of_adhesion: float = RANGE_OF_ADHESION,
) -> float:
    """Return Tabor's parameter μ = (R w²/(E*² z₀³))^(1/3) (Tabor 1977).

    Where it exceeds 5 the theory of Johnson, Kendall and Roberts holds, and below 0.1 that of Derjaguin,
    Muller and Toporov (Johnson and Greenwood 1997).

    Parameters
    ----------
    loading_radius, youngs_modulus, work_of_adhesion : float
        R (mm), E (MPa) and w (mJ/mm²).
    poisson_ratio : float
        ν.
    range_of_adhesion : float
        z₀, mm; 0.3 nm, the distance of atoms, without it.

    Returns
    -------
    float
        μ; NaN where R, E or z₀ is not positive, or w negative.

    Examples
    --------
    A soft pad of 10 mm, E = 40 kPa and w = 50 mJ/m²:

    >>> print(f"{tabor_parameter(loading_radius=10, youngs_modulus=0.04, work_of_adhesion=50e-6):.2g}")
    6.9e+04
    """
    if not (min(loading_radius, youngs_modulus, range_of_adhesion) > 0 and work_of_adhesion >= 0):
        return math.nan
    modulus = youngs_modulus / (1 - poisson_ratio**2)
    return float((loading_radius * work_of_adhesion**2 / (modulus**2 * range_of_adhesion**3)) ** (1 / 3))


def _verdict(
    *, loading_radius: float, poisson_ratio: float, youngs_modulus: float, work_of_adhesion: float
) -> tuple[bool, str]:
    mu = tabor_parameter(
        loading_radius=loading_radius,
        youngs_modulus=youngs_modulus,
        work_of_adhesion=work_of_adhesion,
        poisson_ratio=poisson_ratio,
    )
    said = f"Tabor's parameter is {mu:.2g} with adhesion that reaches {1e6 * RANGE_OF_ADHESION:g} nm: "
    if mu > JKR_ABOVE:
        return True, f"{said}above {JKR_ABOVE:g}, so that JKR holds"
    if mu < DMT_BELOW:
        return (
            False,
            f"{said}below {DMT_BELOW:g}, where DMT holds and w is the pull-off over 2 π R, not 3/2 π R",
        )
    return (
        False,
        f"{said}between {DMT_BELOW:g} and {JKR_ABOVE:g}, where w lies between that of JKR and of DMT",
    )


@contact_law(
    parameters={"youngs_modulus": (0, None), "work_of_adhesion": (0, None)},
    units={
        "youngs_modulus": "MPa",
        "work_of_adhesion": "mJ/mm²",
        "pull_off_load": "N",
        "tabor_parameter": "",
    },
    label="JKR",
    area=_area,
    pull_off=_pull_off,
    derived={"pull_off_load": _pull_off_load, "tabor_parameter": tabor_parameter},
    verdict=_verdict,
)
def jkr(
    indentation: ArrayLike,
    *,
    loading_radius: float,
    poisson_ratio: float,
    youngs_modulus: float,
    work_of_adhesion: float,
) -> Any:
    """Return the load of an adhesive sphere, negative under tension; 0 where the contact is lost."""
    work, lost = _scales(loading_radius, poisson_ratio, youngs_modulus, work_of_adhesion)
    cube = _root(indentation, loading_radius, lost) ** 3
    return np.nan_to_num(np.pi * work * loading_radius * (cube**2 / 6 - cube))


# --- a law with the values that fit a record, and where a record is on it ---


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class AppliedLaw(Displayed):
    """A law of `LAWS` with values of all parameters: mm, N, s, MPa."""

    law: str
    values: Mapping[str, float]
    poisson_ratio: float

    def load(self, displacement: FloatArray) -> FloatArray:
        """Return the load W (N) at readings of the displacement (mm), from the instrument's zero."""
        return self.load_on(self.indentation(displacement))

    def corrected_load(self, clock: FloatArray, load: FloatArray) -> FloatArray:
        """Return measured forces (N) at times from the start of the record (s) with zero and tilt removed."""
        return load - self.force_zero(clock)

    def force_zero(self, clock: FloatArray) -> FloatArray:
        """Return what the sensor shows without contact, N."""
        line = self.values.get("force_zero", 0.0) + self.values.get("force_tilt", 0.0) * clock
        bend = self.values.get("force_bend", 0.0)
        return line + bend * (clock / clock[-1]) ** 2 if bend else line

    @property
    def pull_off(self) -> float:
        """The least indentation with contact: zero, or that of an adhesive pull-off."""
        pull_off = LAWS[self.law].pull_off
        return 0.0 if pull_off is None else float(self._evaluate(pull_off)) * (1 - 1e-9)

    def load_on(self, xi: FloatArray, attached: BoolArray | None = None) -> FloatArray:
        """Return the load (N) at indentations of any sign; `attached`: rows of an adhesive law in contact."""
        floor = self.pull_off
        if attached is None:
            return self.load_at(xi if floor < 0 else np.maximum(xi, 0.0))
        return np.where(attached, self.load_at(np.maximum(xi, floor)), 0.0)

    def load_at(self, xi: FloatArray) -> FloatArray:
        """Return the load W (N) at indentations ξ (mm), none of them before contact."""
        function = LAWS[self.law].function
        factor, _ = shape_factors(self.law, self.values, xi, self.poisson_ratio)
        load = np.asarray(self._evaluate(function, xi, shape_factor=factor))
        if load.shape != xi.shape:
            raise FitError(
                f"the contact law {self.law} returns shape {load.shape} for indentations of shape {xi.shape}"
            )
        return load if "shape_factor" in arguments_of(function) else load * factor

    def area_at(self, xi: FloatArray) -> FloatArray:
        """Return the contact area (mm²) at indentations; below zero before contact, where it is π R ξ."""
        area = LAWS[self.law].area
        _, factor = shape_factors(self.law, self.values, np.maximum(xi, 0.0), self.poisson_ratio)
        if area is None:
            return np.asarray(np.pi * self.values["loading_radius"] * xi * factor)
        return np.asarray(self._evaluate(area, np.maximum(xi, self.pull_off))) * factor

    def slope_at(self, xi: FloatArray) -> FloatArray:
        """Return dW/dξ at indentations in contact, as the law states it, without the factor of a shape."""
        slope = LAWS[self.law].slope
        if slope is not None and PAD_FORM[0] not in self.values:
            return np.asarray(self._evaluate(slope, xi))
        floor = self.pull_off
        step = 0.01 * np.maximum(np.abs(xi) if floor == 0 else 0.1 * np.abs(xi).max(), 1e-12)
        up, down = (self.load_at(np.maximum(xi + way * step, floor)) for way in (1, -1))
        return np.asarray((up - down) / (2 * step))

    def indentation(self, displacement: FloatArray, attached: BoolArray | None = None) -> FloatArray:
        """Return ξ, negative before contact: the displacement from contact on, less what the stage yields."""
        whole = displacement - self.values["contact_offset"]
        compliance = self.values.get("stage_compliance", 0.0)
        if compliance == 0:
            return whole
        if LAWS[self.law].pull_off is not None:
            return self._on_yielding_stage(whole, compliance, attached)
        xi = np.maximum(whole, 0.0)
        for _ in range(LAWS[self.law].steps):
            load = self.load_at(xi)
            rise = 1.5 * load / np.maximum(xi, 1e-9)
            left = xi + compliance * load - whole
            xi = np.maximum(xi - left / np.maximum(1 + compliance * rise, 0.2), 0.0)
        return np.where(whole > 0, xi, whole)

    def _on_yielding_stage(
        self, whole: FloatArray, compliance: float, attached: BoolArray | None
    ) -> FloatArray:
        """Return ξ of an adhesive law, whose contact a yielding stage tears off earlier than a rigid one."""
        floor = self.pull_off
        knots = floor + (max(float(whole.max()), 0.0) - 3 * floor) * np.linspace(0, 1, _ADHESIVE_KNOTS) ** 2
        moved = knots + compliance * self.load_at(knots)
        first = int(np.argmin(moved))  # before it the contact is not stable
        knots, moved = knots[first:], np.maximum.accumulate(moved[first:])
        rising = np.append(True, np.diff(moved) > 0)
        xi = np.interp(whole, moved[rising], knots[rising])
        return xi if attached is not None else np.where(whole >= moved[0], xi, np.minimum(whole, 2 * floor))

    def _evaluate(self, function: Law, *given: FloatArray, **more: FloatArray | float) -> Any:
        radius = max(self.values["loading_radius"], 1e-9)
        known: dict[str, Any] = {"loading_radius": radius, "poisson_ratio": self.poisson_ratio, **more}
        return evaluate(LAWS[self.law], function, self.values, *given, **known)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FittedForceModel(AppliedLaw):
    """A law with the values that fit a record, and its corrected Akaike criterion under a noise.

    That is χ² + 2k + 2k(k+1)/(n−k−1), to compare models under one noise.
    """

    aicc: float


# --- what rows of a curve say of a sphere, one by one ---


@np.errstate(all="ignore")
def secant_modulus(
    load: ArrayLike, indentation: ArrayLike, *, loading_radius: ArrayLike, poisson_ratio: ArrayLike = 0.5
) -> FloatArray:
    r"""Return the secant modulus E_g, NaN before contact.

    :math:`E_g = 3(1-\nu^2) W/(4 R_g^{1/2} \xi^{3/2})` (Dzidek et al. 2017).

    Parameters
    ----------
    load, indentation : array_like
        W (N) and ξ (mm).
    loading_radius, poisson_ratio : array_like
        R_g (mm) and ν.

    Returns
    -------
    ndarray
        E_g, MPa.

    Examples
    --------
    The contact of Dzidek et al. (2017) at 30° and 2 N:

    >>> print(f"{1000 * secant_modulus(2.0, 1.806, loading_radius=20.5):.1f} kPa")
    102.4 kPa
    """
    W, xi, radius, ratio = broadcast_named(
        load=load, indentation=indentation, loading_radius=loading_radius, poisson_ratio=poisson_ratio
    )
    return np.where(xi > 0, 3 * (1 - ratio**2) * W / (4 * np.sqrt(radius) * xi**1.5), np.nan)[()]


@np.errstate(all="ignore")
def sphere_ratio(indentation: ArrayLike, area: ArrayLike, *, loading_radius: ArrayLike) -> FloatArray:
    """Return E* read from the area over E* read from the indentation, both on a sphere of one radius.

    E* = 3 W R/(4 a³) with a = √(A/π), and E* = 3 W/(4 R^½ ξ^{3/2}) (Johnson 1985, Eqs 4.22 and 4.23) have the
    ratio (πRξ/A)^{3/2}, whatever the load and the modulus: one on a sphere of radius R. For an elliptical
    contact of axis ratio k taken for a sphere of radius R_e it is (R_e/R_Aξ)^{3/2} = F2^{3/2}/F1³.

    Parameters
    ----------
    indentation, area : array_like
        ξ (mm) and A (mm²), from first contact on.
    loading_radius : array_like
        R, mm.

    Returns
    -------
    ndarray
        The ratio, NaN before contact.

    Examples
    --------
    Tissue on bone is indented less than a half-space of the same contact area:

    >>> sphere_ratio([0.9, 1.3], [60.0, 90.0], loading_radius=14.5).round(2)
    array([0.56, 0.53])
    """
    xi, A, radius = broadcast_named(indentation=indentation, area=area, loading_radius=loading_radius)
    touching = (xi > 0) & (A > 0)
    return np.where(touching, radius * np.pi * xi / A, np.nan)[()] ** 1.5
