r"""Contact laws: the load of a pressed pad from its indentation, W(ξ).

**Where a law is.** Each is one function with one decorator, `contact_law`, which puts it into the registry
`LAWS`: `hertz`, `load_dependent`, `exact_sphere` and `free_exponent` below, `jkr` in
`fingerpad.loading.adhesion`, and those of a lab in its own files. Fits, comparisons and figures take a law by
its name and ask it for load and area, no more.

**To add one**, write such a function: of the indentation, of ``loading_radius`` and ``poisson_ratio`` if it
needs them, and of its own parameters. Place of contact, zero and drift of the force, scale of the areas and a
yielding stage are the fit's (`fingerpad.loading.joint`), and no law's.

Lengths in mm, forces in N, moduli in MPa; arrays broadcast, and what has no answer is NaN.
"""

import importlib.util
import inspect
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, TypeVar

import numpy as np
from scipy.interpolate import CubicSpline

from fingerpad._arrays import ArrayLike, BoolArray, FloatArray, as_float_array, broadcast
from fingerpad._display import Displayed
from fingerpad.contact.fast_laws import press
from fingerpad.exceptions import FitError, LoadingError
from fingerpad.geometry.gap import Gap, paraboloid_gap

Real = TypeVar("Real", float, FloatArray)
Values = Mapping[str, float]
Law = Callable[..., Any]
Bound = tuple[float | None, float | None]

# What a fit gives to a law that names it, and what it fits beside a law's own parameters.
_GIVEN: Final = ("loading_radius", "poisson_ratio", "shape_factor")
_OF_THE_FIT: Final = (
    "contact_offset",
    "force_zero",
    "force_tilt",
    "force_bend",
    "stage_compliance",
    "inverse_thickness",
    "area_offset",
    "area_growth",
    "area_delay",
    "area_gain",
    "area_edge",
    "pad_form",
)
# Parameters whose start is found from the curve, and values of a soft pad for the trial at registration.
_USUAL: Final = {
    "youngs_modulus": 0.05,
    "initial_modulus": 0.05,
    "load_coefficient": 0.0,
    "load_exponent": 1.5,
    "work_of_adhesion": 5e-5,
}
# A law is tried at registration on a pad of this radius (mm), at these indentations (mm).
_TRIED_RADIUS: Final = 10.0
_TRIED: Final = (0.0, 0.02, 0.1, 0.3, 0.6, 1.0)
# Steps in which the indentation is found that a yielding stage leaves; a lab's law may need more.
_STEPS, _MORE_STEPS = 6, 30
# Knots of an adhesive law between its pull-off and the deepest indentation.
_ADHESIVE_KNOTS: Final = 400
# Where β h comes this near to one, the load grows beyond all bounds, and a search must be turned back.
_POLE = 0.02
# The exact sphere is tabulated to this a/R, a layer to this a/t (its laws hold to 3).
_WIDEST, _THINNEST = 0.98, 2.95
_WIDEST_PAD, _KNOTS = 1.2, 48  # a/R to which a pad is tabulated, where its laws hold
_LEAST = 0.2
_INCOMPRESSIBLE = 0.5
# Of the gap of a pad: R1/R2, then skewness and flatness times R (see `Gap`).
PAD_FORM: Final = ("radius_ratio", "first_skewness", "second_skewness", "flatness")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ContactLaw(Displayed):
    """A contact law that can be fitted; `contact_law` makes it from a function, which it can be called as.

    Attributes
    ----------
    name, label : str
        Its key in `LAWS`, and what legends call it.
    function : callable
        W (N) of ξ (mm) and keywords.
    parameters : mapping of str to (float, float)
        Lower and upper bound of each of its own parameters; infinite where open.
    units : mapping of str to str
        Of parameters and derived quantities.
    start : mapping of str to float
        Where a search begins.
    area, pull_off : callable or None
        Area (mm²) if it is not π R ξ, and ξ at which an adhesive contact is lost.
    derived : mapping of str to callable
        Quantities that follow from the parameters.
    verdict : callable or None
        Whether the law holds at the parameters found, and that in words.

    Examples
    --------
    >>> print(f"{hertz(1.806, loading_radius=20.5, poisson_ratio=0.5, youngs_modulus=0.1024):.2f} N")
    2.00 N
    """

    name: str
    label: str
    function: Law
    parameters: Mapping[str, tuple[float, float]]
    units: Mapping[str, str]
    start: Mapping[str, float]
    area: Law | None
    pull_off: Law | None
    derived: Mapping[str, Law]
    verdict: Law | None

    def __call__(self, *args: Any, **keywords: Any) -> Any:  # noqa: D102
        return self.function(*args, **keywords)

    @property
    def is_bounded(self) -> bool:
        """Whether a parameter has a bound, which the search then keeps to."""
        return any(math.isfinite(end) for pair in self.parameters.values() for end in pair)


@lru_cache(maxsize=256)
def _arguments(function: Law) -> frozenset[str]:
    return frozenset(inspect.signature(function).parameters)


def evaluate(law: ContactLaw, function: Law, values: Values, *given: Any, **more: Any) -> Any:
    """Return one of the functions of a law at a fit's values, with its parameters held inside their bounds.

    Raise FitError if it raises whatever error.
    """
    keywords = {name: min(max(values[name], low), high) for name, (low, high) in law.parameters.items()}
    wanted = _arguments(function)
    keywords |= {name: value for name, value in more.items() if name in wanted}
    try:
        with np.errstate(all="ignore"):
            return function(*given, **keywords)
    except Exception as fault:  # a lab's function may raise anything
        at = ", ".join(f"{name} = {values[name]:.4g}" for name in law.parameters)
        raise FitError(
            f"the contact law {law.name} fails at {at}: {type(fault).__name__}: {fault}; have it return NaN "
            "where it has no answer"
        ) from fault


LAWS: Final[dict[str, ContactLaw]] = {}


def contact_law(
    *,
    parameters: Mapping[str, Bound],
    units: Mapping[str, str],
    start: Mapping[str, float] | None = None,
    name: str | None = None,
    label: str | None = None,
    area: Law | None = None,
    pull_off: Law | None = None,
    derived: Mapping[str, Law] | None = None,
    verdict: Law | None = None,
) -> Callable[[Law], ContactLaw]:
    """Register a function as a contact law, to be fitted, compared and drawn by its name.

    The function takes the indentation ξ (mm, an array that is zero or above) and, as keywords, its own
    parameters, and ``loading_radius`` (mm) and ``poisson_ratio`` if it names them. It returns the load W (N),
    an array of the same shape that is zero at ξ = 0. A law that names ``shape_factor`` gets the factor by
    which a layer stiffens Hertz's contact (1 on a half-space); the load of one that does not is multiplied by
    it.

    Parameters
    ----------
    parameters : mapping of str to (float or None, float or None)
        The law's own parameters, each with its lower and upper bound; None for an open one.
    units : mapping of str to str
        Unit of each parameter and derived quantity; ``""`` for a plain number.
    start : mapping of str to float, optional
        Where the search begins. Without it ``youngs_modulus`` begins at that of Hertz theory, and others
        between their two bounds.
    name : str, optional
        Name of the law; that of the function without it.
    label : str, optional
        What legends call it; its name without it.
    area : callable, optional
        Contact area (mm²), of the same arguments; π R ξ without it.
    pull_off : callable, optional
        For an adhesive law: the indentation, negative, at which contact is lost on the way out, of the same
        keywords. The law is then also asked for the load there, and zero is not required at ξ = 0. It is
        fitted to the way out.
    derived : mapping of str to callable, optional
        Quantities that follow from the parameters, of the same keywords.
    verdict : callable, optional
        Returns whether the law holds at the parameters found, and that in words, of the same keywords.

    Returns
    -------
    callable
        Decorator, which returns a `ContactLaw`.

    Raises
    ------
    LoadingError
        If the declaration contradicts the function, the name is taken, or the function does not return a
        finite load for each indentation.

    Examples
    --------
    >>> @contact_law(
    ...     parameters={"stiffness": (0, None)}, units={"stiffness": "N/mm"}, start={"stiffness": 1.0}
    ... )
    ... def flat_punch(indentation, *, stiffness):
    ...     return stiffness * indentation
    >>> flat_punch.name, flat_punch(np.array([0.0, 0.5]), stiffness=2.0)
    ('flat_punch', array([0., 1.]))
    >>> _ = LAWS.pop("flat_punch")
    """

    def register(function: Law) -> ContactLaw:
        called = name or str(getattr(function, "__name__", ""))
        law = ContactLaw(
            name=called,
            label=label or called.replace("_", " "),
            function=function,
            parameters=MappingProxyType({key: _ends(key, pair) for key, pair in parameters.items()}),
            units=MappingProxyType(dict(units)),
            start=MappingProxyType(dict(start or {})),
            area=area,
            pull_off=pull_off,
            derived=MappingProxyType(dict(derived or {})),
            verdict=verdict,
        )
        _check_declaration(law)
        _check_values(law)
        LAWS[law.name] = law
        return law

    return register


def find_law(law: str | ContactLaw) -> ContactLaw:
    """Return a law by its name, or import it from ``file.py:name`` or ``module:name``.

    Raises
    ------
    LoadingError
        If there is none, or what is imported fails.
    """
    if isinstance(law, ContactLaw):
        return law
    if law in LAWS:
        return LAWS[law]
    place, _, name = law.rpartition(":")
    if not place:
        raise LoadingError(
            f"no contact law {law!r}: known are {', '.join(LAWS)}; register your own with @contact_law, or "
            f"name its file, as my_laws.py:{law}"
        )
    found = getattr(_imported(place), name, None)
    if not isinstance(found, ContactLaw):
        raise LoadingError(f"{place} has no contact law {name!r}: is it decorated with @contact_law?")
    return found


def _imported(place: str) -> Any:
    """Return a module by its name or its file."""
    if place.endswith(".py") and not Path(place).is_file():
        raise LoadingError(f"no file {place}, which should hold a contact law")
    try:
        if not place.endswith(".py"):
            return importlib.import_module(place)
        spec = importlib.util.spec_from_file_location(Path(place).stem, place)
        assert spec is not None  # of a file that ends in .py
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    except LoadingError:
        raise
    except Exception as fault:  # a lab's file may raise anything
        raise LoadingError(f"{place} cannot be imported: {type(fault).__name__}: {fault}") from fault
    return module


def start_of(law: ContactLaw, values: Values, load: float) -> dict[str, float]:
    """Return where the search of a law's parameters begins: as it says, else by our values at a load."""
    modulus = values.get("youngs_modulus", 0.0)
    if "initial_modulus" in values:
        modulus = values["initial_modulus"] + values["load_coefficient"] * load
    usual = {**_USUAL, **values, "youngs_modulus": modulus}
    start = {}
    for name, (low, high) in law.parameters.items():
        if name in law.start:
            start[name] = law.start[name]
        elif name in usual:
            inside = min(max(usual[name], low), high)
            start[name] = inside if low < inside < high else _between(low, high)
        else:
            start[name] = _between(low, high)
    return start


def _between(low: float, high: float) -> float:
    """Return a number between two ends, in even ratio where both are above zero."""
    if not (math.isfinite(low) and math.isfinite(high)):
        return low + 1.0 if math.isfinite(low) else high - 1.0
    return math.sqrt(low * high) if low > 0 else (low + high) / 2


def _ends(name: str, pair: Any) -> tuple[float, float]:
    try:
        low, high = pair
        ends = (-math.inf if low is None else float(low), math.inf if high is None else float(high))
    except (TypeError, ValueError):
        raise LoadingError(
            f"bounds of {name} must be two numbers, None for an open one, as (0, None); found {pair!r}"
        ) from None
    if not ends[0] < ends[1]:
        raise LoadingError(f"bounds of {name} must rise, found {pair!r}")
    return ends


def _check_declaration(law: ContactLaw) -> None:
    """Raise LoadingError where names of a law contradict its function, or are taken."""
    what = f"the contact law {law.name}"
    if not law.name.isidentifier():
        raise LoadingError(
            f"a contact law needs a name, found {law.name!r}: define a function, or give name="
        )
    other = LAWS.get(law.name)
    # A cell of a notebook that is run again replaces the law that it made.
    if other and (other.function.__module__, other.function.__qualname__) != (
        law.function.__module__,
        law.function.__qualname__,
    ):
        raise LoadingError(
            f"{what} exists already, in {other.function.__module__}: give yours another name, as by name="
        )
    taken = sorted(set(law.parameters) & {*_GIVEN, *_OF_THE_FIT, *PAD_FORM, "indentation"})
    if taken:
        raise LoadingError(
            f"{what} cannot have a parameter {taken[0]}, which the fit uses: name it otherwise"
        )
    if not law.parameters:
        raise LoadingError(f"{what} has no parameters: nothing could be fitted")
    functions = {"": law.function, "area": law.area, "pull_off": law.pull_off, "verdict": law.verdict}
    for part, function in {**functions, **law.derived}.items():
        if function is not None:
            _check_signature(f"{what}{part and f', {part}'}", function, law, indented=part in {"", "area"})
    for missing in [key for key in (*law.parameters, *law.derived) if key not in law.units]:
        raise LoadingError(f'{what} states no unit of {missing}: add it to units, "" for a plain number')
    for key, ends in law.parameters.items():
        if not ({*law.start, *_USUAL} & {key} or all(map(math.isfinite, ends))):
            raise LoadingError(
                f"{what} does not say where to begin with {key}: add it to start, or give two bounds"
            )
    for unknown in [key for key in (*law.units, *law.start) if key not in {*law.parameters, *law.derived}]:
        raise LoadingError(f"{what} has no parameter {unknown}, of which unit or start is given")
    for key, (low, high) in law.parameters.items():
        if key in law.start and not low < law.start[key] < high:
            raise LoadingError(
                f"{what} starts {key} at {law.start[key]:g}, not between its bounds {low:g}, {high:g}"
            )


def _check_signature(what: str, function: Law, law: ContactLaw, *, indented: bool) -> None:
    arguments = list(inspect.signature(function).parameters.values())
    first, rest = arguments[:1], arguments[indented:]
    if indented and not (
        first and first[0].kind in {first[0].POSITIONAL_ONLY, first[0].POSITIONAL_OR_KEYWORD}
    ):
        raise LoadingError(f"{what} must take the indentation as its first argument")
    if any(each.kind in {each.VAR_KEYWORD, each.VAR_POSITIONAL} for each in arguments):
        raise LoadingError(f"{what} must name its arguments, without * and **")
    names = {each.name for each in rest}
    unknown = [
        each.name
        for each in rest
        if each.name not in {*law.parameters, *_GIVEN} and each.default is each.empty
    ]
    if unknown:
        raise LoadingError(
            f"{what} takes {unknown[0]}, which is no parameter of it: add it to parameters with its bounds, "
            f"or use {' and '.join(_GIVEN[:2])}"
        )
    missing = [key for key in law.parameters if key not in names]
    if missing:
        raise LoadingError(f"{what} does not take its parameter {missing[0]}: add it to its arguments")


def _check_values(law: ContactLaw) -> None:
    """Raise LoadingError where a law, at its start, does not return one finite load for each indentation."""
    what = f"the contact law {law.name}"
    values = start_of(law, _USUAL, 0.0)
    given = {"loading_radius": _TRIED_RADIUS, "poisson_ratio": 0.5}
    xi = np.array(_TRIED)
    way_out = "it must work on arrays: use NumPy's functions and np.where, not math and if"
    for part, function in (("load", law.function), ("area", law.area)):
        if function is None:
            continue
        try:
            found = evaluate(law, function, values, xi, **given)
            single = [evaluate(law, function, values, xi[k : k + 1], **given) for k in range(xi.size)]
        except FitError as fault:
            raise LoadingError(f"{fault.__cause__ and str(fault).split(';')[0]}; {way_out}") from fault
        whole = np.asarray(found)
        if whole.shape != xi.shape or whole.dtype.kind not in "fiu":
            raise LoadingError(
                f"{what} returns {type(found).__name__} of shape {whole.shape} as {part} of {xi.size} "
                f"indentations: {way_out}"
            )
        at = ", ".join(f"{name} = {value:.4g}" for name, value in values.items())
        bad = np.flatnonzero(~np.isfinite(whole))
        if bad.size:
            raise LoadingError(
                f"{what} gives the {part} {whole[bad[0]]} at an indentation of {xi[bad[0]]:g} mm on a sphere "
                f"of {_TRIED_RADIUS:g} mm with {at}: give other start values, or let it go on there"
            )
        if not np.allclose(np.concatenate(single), whole, rtol=1e-9, atol=1e-12 * np.abs(whole).max()):
            raise LoadingError(f"{what} gives another {part} for one indentation than for many: {way_out}")
        if law.pull_off is None and abs(float(whole[0])) > 1e-9 * float(np.abs(whole).max()):
            raise LoadingError(
                f"{what} gives the {part} {float(whole[0]):.3g} at no indentation, where it must be zero; an "
                "adhesive law names the place of its pull-off"
            )
        if not np.abs(whole).max() > 0:
            raise LoadingError(f"{what} gives no {part} at any indentation, with {at}")


# --- laws of this library ---
# They go on outside of what is physical, so that a search without bounds can come back.

_OPEN: Final[Bound] = (None, None)


def hertz_stiffness(radius: Real, poisson_ratio: Real) -> Real:
    """Return k = 4/3 √R/(1 − ν²) of Hertz's W = k E ξ^(3/2), Johnson (4.23)."""
    stiffness: Real = 4 / 3 * radius**0.5 / (1 - poisson_ratio**2)
    return stiffness


@contact_law(parameters={"youngs_modulus": _OPEN}, units={"youngs_modulus": "MPa"}, label="Hertz")
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
    return youngs_modulus * (stiffness * indentation**1.5)


def _growing(
    indentation: FloatArray,
    *,
    loading_radius: float,
    poisson_ratio: float,
    initial_modulus: float,
    load_coefficient: float,
    shape_factor: FloatArray | float = 1.0,
) -> Any:
    """Return the load of a modulus E_0g + β W: finite and very large beyond its pole, for a search."""
    stiffness = hertz_stiffness(loading_radius, poisson_ratio) * shape_factor
    h = stiffness * indentation**1.5
    return initial_modulus * h / np.maximum(1 - load_coefficient * h, _POLE)


for _name, _label in (
    ("load_dependent", "modulus growing with load"),
    ("exact_sphere", "exact sphere"),  # differs by its shape factor
):
    contact_law(
        parameters={"initial_modulus": _OPEN, "load_coefficient": _OPEN},
        units={"initial_modulus": "MPa", "load_coefficient": "MPa/N"},
        name=_name,
        label=_label,
    )(_growing)


@contact_law(
    parameters={"youngs_modulus": _OPEN, "load_exponent": _OPEN},
    units={"youngs_modulus": "MPa", "load_exponent": ""},
    label="free exponent",
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
    return youngs_modulus * stiffness * indentation ** min(max(load_exponent, 0.05), 20.0)


# --- a law with the values that fit a record, and where a record is on it ---


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FittedForceModel(Displayed):
    """A force model with the values that fit a record.

    Attributes
    ----------
    law : str
        Key of `LAWS`.
    values : dict of str to float
        All parameters: mm, N, s, MPa.
    poisson_ratio : float
        ν of the pad.
    aicc : float
        Corrected Akaike criterion χ² + 2k + 2k(k+1)/(n−k−1), to compare models under one noise.

    Examples
    --------
    >>> values = {"contact_offset": 1.0, "loading_radius": 20.5, "youngs_modulus": 0.1024}
    >>> model = FittedForceModel(law="hertz", values=values, poisson_ratio=0.5, aicc=0.0)
    >>> model.load(np.array([1.0, 2.806])).round(2)
    array([0., 2.])
    """

    law: str
    values: dict[str, float]
    poisson_ratio: float
    aicc: float

    def load(self, displacement: FloatArray) -> FloatArray:
        """Return the fitted load at readings of the displacement.

        Parameters
        ----------
        displacement : ndarray
            Readings, mm, from the instrument's zero.

        Returns
        -------
        ndarray
            W, N.
        """
        xi = indentation_of(self.values, self.law, displacement, self.poisson_ratio)
        return load_on(self.values, self.law, xi, self.poisson_ratio)

    def corrected_load(self, clock: FloatArray, load: FloatArray) -> FloatArray:
        """Return measured forces with zero and tilt removed.

        Parameters
        ----------
        clock : ndarray
            Times of the readings, s, from the start of the record.
        load : ndarray
            Readings, N.

        Returns
        -------
        ndarray
            N.
        """
        return load - force_zero(self.values, clock)


def load_on(
    values: Values, law: str, xi: FloatArray, poisson_ratio: float, attached: BoolArray | None = None
) -> FloatArray:
    """Return the load (N) at indentations of any sign; `attached`: rows of an adhesive law in contact."""
    floor = pull_off_of(values, law, poisson_ratio)
    if attached is None:
        return load_at(values, law, xi if floor < 0 else np.maximum(xi, 0.0), poisson_ratio)
    return np.where(attached, load_at(values, law, np.maximum(xi, floor), poisson_ratio), 0.0)


def load_at(values: Values, law: str, xi: FloatArray, poisson_ratio: float) -> FloatArray:
    """Return the load W (N) at indentations ξ (mm), none of them before contact."""
    found = LAWS[law]
    factor, _ = shape_factors(law, values, xi, poisson_ratio)
    given = {
        "loading_radius": max(values["loading_radius"], 1e-9),
        "poisson_ratio": poisson_ratio,
        "shape_factor": factor,
    }
    load = np.asarray(evaluate(found, found.function, values, xi, **given))
    if load.shape != xi.shape:
        raise FitError(
            f"the contact law {law} returns shape {load.shape} for indentations of shape {xi.shape}"
        )
    if "shape_factor" not in _arguments(found.function):
        load = load * factor
    return load


def area_at(values: Values, law: str, xi: FloatArray, poisson_ratio: float) -> FloatArray:
    """Return the contact area (mm²) at indentations; below zero before contact, where it is π R ξ."""
    found, radius = LAWS[law], values["loading_radius"]
    _, factor = shape_factors(law, values, np.maximum(xi, 0.0), poisson_ratio)
    if found.area is None:
        return np.asarray(np.pi * radius * xi * factor)
    floor = pull_off_of(values, law, poisson_ratio)
    given = {"loading_radius": max(radius, 1e-9), "poisson_ratio": poisson_ratio}
    return np.asarray(evaluate(found, found.area, values, np.maximum(xi, floor), **given)) * factor


def pull_off_of(values: Values, law: str, poisson_ratio: float) -> float:
    """Return the least indentation that a law has contact at: zero, or that of an adhesive pull-off."""
    found = LAWS[law]
    if found.pull_off is None:
        return 0.0
    given = {"loading_radius": max(values["loading_radius"], 1e-9), "poisson_ratio": poisson_ratio}
    return float(evaluate(found, found.pull_off, values, **given)) * (1 - 1e-9)


def indentation_of(
    values: Values,
    law: str,
    displacement: FloatArray,
    poisson_ratio: float,
    attached: BoolArray | None = None,
) -> FloatArray:
    """Return ξ, negative before contact: the displacement from contact on, less what the stage yields."""
    whole = displacement - values["contact_offset"]
    compliance = values.get("stage_compliance", 0.0)
    if compliance == 0:
        return whole
    if LAWS[law].pull_off is not None:
        return _on_yielding_stage(values, law, whole, poisson_ratio, attached)
    xi = np.maximum(whole, 0.0)
    for _ in range(_STEPS if LAWS[law].function.__module__ == __name__ else _MORE_STEPS):
        load = load_at(values, law, xi, poisson_ratio)
        rise = 1.5 * load / np.maximum(xi, 1e-9)
        xi = np.maximum(xi - (xi + compliance * load - whole) / np.maximum(1 + compliance * rise, 0.2), 0.0)
    return np.where(whole > 0, xi, whole)


def _on_yielding_stage(
    values: Values, law: str, whole: FloatArray, poisson_ratio: float, attached: BoolArray | None
) -> FloatArray:
    """Return ξ of an adhesive law, whose contact a yielding stage tears off earlier than a rigid one."""
    floor = pull_off_of(values, law, poisson_ratio)
    knots = floor + (max(float(whole.max()), 0.0) - 3 * floor) * np.linspace(0, 1, _ADHESIVE_KNOTS) ** 2
    moved = knots + values["stage_compliance"] * load_at(values, law, knots, poisson_ratio)
    first = int(np.argmin(moved))  # before it the contact is not stable
    knots, moved = knots[first:], np.maximum.accumulate(moved[first:])
    rising = np.append(True, np.diff(moved) > 0)
    xi = np.interp(whole, moved[rising], knots[rising])
    return xi if attached is not None else np.where(whole >= moved[0], xi, np.minimum(whole, 2 * floor))


def slope_at(values: Values, law: str, xi: FloatArray, poisson_ratio: float) -> FloatArray:
    """Return dW/dξ at indentations in contact; of our laws without the factor of their shape."""
    if LAWS[law].function.__module__ != __name__ or PAD_FORM[0] in values:
        floor = pull_off_of(values, law, poisson_ratio)
        step = 0.01 * np.maximum(np.abs(xi) if floor == 0 else 0.1 * np.abs(xi).max(), 1e-12)
        up, down = (
            load_at(values, law, np.maximum(xi + way * step, floor), poisson_ratio) for way in (1, -1)
        )
        return np.asarray((up - down) / (2 * step))
    h = hertz_stiffness(max(values["loading_radius"], 1e-9), poisson_ratio) * xi**1.5
    modulus = values.get("initial_modulus", values.get("youngs_modulus", 0.0))
    rest = np.maximum(1 - values.get("load_coefficient", 0.0) * h, _POLE)
    return np.asarray(1.5 * modulus * h / np.maximum(xi, 1e-12) / rest**2)


def force_zero(values: Values, clock: FloatArray) -> FloatArray:
    """Return what the sensor shows without contact, N."""
    line = values.get("force_zero", 0.0) + values.get("force_tilt", 0.0) * clock
    bend = values.get("force_bend", 0.0)
    return line + bend * (clock / clock[-1]) ** 2 if bend else line


# --- shape: how load and area depart from those of a paraboloid on a half-space ---
# An exact sphere, or a layer over bone: both are factors at the same ξ, on 4/3 √R ξ^(3/2) and on π R ξ. A pad
# that is not a sphere has R = 1/H, and its form is four numbers without dimension, `PAD_FORM`.


def shape_factors(
    law: str, values: Mapping[str, float], xi: FloatArray, poisson_ratio: float
) -> tuple[FloatArray, FloatArray]:
    """Return the factors on load and area at indentations ξ (mm), both one for a paraboloid on a half-space.

    The law ``exact_sphere``, or a value ``inverse_thickness`` (1/mm), says otherwise. A negative one, to
    which a search may go, continues the factors in a straight line.
    """
    one = np.ones_like(xi)
    radius = max(values["loading_radius"], 1e-9)
    if law == "exact_sphere":
        return _within(_sphere(), xi / radius)
    if PAD_FORM[0] in values:
        curved = values.get("pad_form", 1.0)
        form = (values[PAD_FORM[0]], *(curved * values[name] for name in PAD_FORM[1:]))
        inverse = radius * values.get("inverse_thickness", 0.0)
        return _on_layer(form, inverse, poisson_ratio, np.sqrt(np.maximum(xi, 0.0) / radius))
    if values.get("inverse_thickness", 0.0) != 0:
        size = np.sqrt(radius * np.maximum(xi, 0.0)) * values["inverse_thickness"]
        return _within(_layer(poisson_ratio), size)
    return one, one


def _within(factors: CubicSpline, size: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the factors on load and area, the spline's columns; beyond its ends they go on straight."""
    known = np.clip(size, 0.0, factors.x[-1])
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
    a = np.linspace(0.01, _WIDEST_PAD, _KNOTS) * min(1.0, _THINNEST / (inverse * _WIDEST_PAD + 1e-12))
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
    a = np.linspace(0.02, _THINNEST, 150)
    contact = press(
        paraboloid_gap(np.ones(()), np.ones(())),
        area=np.pi * a**2,
        reduced_modulus=1.0,
        thickness=1.0,
        poisson_ratio=max(poisson_ratio, 0.3),
    )
    size = np.append(0.0, np.sqrt(contact.indentation))
    factors = [0.75 * contact.load / contact.indentation**1.5, contact.area_over_pi_indentation]
    return CubicSpline(size, np.insert(factors, 0, 1.0, axis=1).T)


# --- equations between arrays, of the modulus that grows with load ---
# With E_g = E_0g + β W for E, Hertz's load is explicit in h = 4/3 √R ξ^(3/2)/(1 − ν²): W = E_0g h/(1 − β h).


@np.errstate(all="ignore")
def load_from_indentation(
    indentation: ArrayLike,
    *,
    loading_radius: ArrayLike,
    initial_modulus: ArrayLike,
    load_coefficient: ArrayLike = 0.0,
    poisson_ratio: ArrayLike = 0.5,
) -> FloatArray:
    r"""Return the load W at an indentation ξ, zero before contact.

    :math:`W = E_{0g} h/(1 - \beta h)` with :math:`h = \tfrac{4}{3} R_g^{1/2} \xi^{3/2}/(1-\nu^2)`: Hertz
    theory with E_g = E_0g + β W. NaN where β h ≥ 1, at which the load is infinite.

    Parameters
    ----------
    indentation : array_like
        ξ, mm.
    loading_radius, initial_modulus, load_coefficient, poisson_ratio : array_like
        R_g (mm), E_0g (MPa), β (MPa/N) and ν.

    Returns
    -------
    ndarray
        W, N.

    Examples
    --------
    >>> print(f"{load_from_indentation(1.806, loading_radius=20.5, initial_modulus=0.1024):.2f} N")
    2.00 N
    """
    xi, radius, modulus, coefficient, ratio = broadcast(
        indentation, loading_radius, initial_modulus, load_coefficient, poisson_ratio
    )
    h = hertz_stiffness(radius, ratio) * np.maximum(xi, 0) ** 1.5
    rest = 1 - coefficient * h
    return np.where(rest > 0, modulus * h / rest, np.nan)[()]


@np.errstate(all="ignore")
def indentation_from_load(
    load: ArrayLike,
    *,
    loading_radius: ArrayLike,
    initial_modulus: ArrayLike,
    load_coefficient: ArrayLike = 0.0,
    poisson_ratio: ArrayLike = 0.5,
) -> FloatArray:
    r"""Return the indentation ξ under a load W; the inverse of `load_from_indentation`.

    :math:`\xi = [3(1-\nu^2) W/(4 R_g^{1/2}(E_{0g} + \beta W))]^{2/3}`.

    Parameters
    ----------
    load : array_like
        W, N.
    loading_radius, initial_modulus, load_coefficient, poisson_ratio : array_like
        R_g (mm), E_0g (MPa), β (MPa/N) and ν.

    Returns
    -------
    ndarray
        ξ, mm.

    Examples
    --------
    >>> print(f"{indentation_from_load(2.0, loading_radius=20.5, initial_modulus=0.1024):.3f} mm")
    1.806 mm
    """
    W, radius, modulus, coefficient, ratio = broadcast(
        load, loading_radius, initial_modulus, load_coefficient, poisson_ratio
    )
    xi: FloatArray = (3 * (1 - ratio**2) * W / (4 * np.sqrt(radius) * (modulus + coefficient * W))) ** (2 / 3)
    return xi


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
    W, xi, radius, ratio = broadcast(load, indentation, loading_radius, poisson_ratio)
    return np.where(xi > 0, 3 * (1 - ratio**2) * W / (4 * np.sqrt(radius) * xi**1.5), np.nan)[()]


def area_from_load(
    load: ArrayLike,
    *,
    loading_radius: ArrayLike,
    initial_modulus: ArrayLike,
    load_coefficient: ArrayLike = 0.0,
    poisson_ratio: ArrayLike = 0.5,
) -> FloatArray:
    r"""Return the contact area A under a load W.

    :math:`A = \pi [3(1-\nu^2) W R_g/(4(E_{0g} + \beta W))]^{2/3}`, which is π R_g ξ(W).

    Parameters
    ----------
    load : array_like
        W, N.
    loading_radius, initial_modulus, load_coefficient, poisson_ratio : array_like
        R_g (mm), E_0g (MPa), β (MPa/N) and ν.

    Returns
    -------
    ndarray
        A, mm².

    Examples
    --------
    >>> print(f"{area_from_load(2.0, loading_radius=20.5, initial_modulus=0.1024):.1f} mm²")
    116.3 mm²
    """
    xi = indentation_from_load(
        load,
        loading_radius=loading_radius,
        initial_modulus=initial_modulus,
        load_coefficient=load_coefficient,
        poisson_ratio=poisson_ratio,
    )
    area: FloatArray = np.pi * as_float_array(loading_radius) * xi
    return area


@np.errstate(all="ignore")
def local_area_exponent(
    load: ArrayLike, *, initial_modulus: ArrayLike, load_coefficient: ArrayLike
) -> FloatArray:
    r"""Return :math:`d\ln A/d\ln W = \tfrac{2}{3} E_{0g}/(E_{0g} + \beta W)`: 2/3 for Hertz, less as β grows.

    Parameters
    ----------
    load : array_like
        W, N.
    initial_modulus, load_coefficient : array_like
        E_0g (MPa) and β (MPa/N).

    Returns
    -------
    ndarray
        The exponent.

    Examples
    --------
    >>> print(f"{local_area_exponent(2.0, initial_modulus=0.04, load_coefficient=0.02):.3f}")
    0.333
    """
    W, modulus, coefficient = broadcast(load, initial_modulus, load_coefficient)
    return 2 / 3 * modulus / (modulus + coefficient * W)
