"""Contact laws as functions that can be fitted: declared, checked, and found by their names.

Lengths in mm, forces in N, moduli in MPa; arrays broadcast, and what has no answer is NaN.
"""

import importlib.util
import inspect
import math
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

import numpy as np

from fingerpad._display import Displayed
from fingerpad.exceptions import FitError, LoadingError

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
# Of the gap of a pad: R1/R2, then skewness and flatness times R (see `Gap`).
PAD_FORM: Final = ("radius_ratio", "first_skewness", "second_skewness", "flatness")
# Steps in which the indentation is found that a yielding stage leaves: of a law that rises nearly as Hertz's
# does, and of any other.
NEAR_HERTZ, _STEPS = 6, 30


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
    slope : callable or None
        dW/dξ (N/mm) if it is not found by differences.
    shape : callable or None
        Factors on load and area of a body that is no paraboloid, against ξ/R.
    steps : int
        Steps in which the indentation on a yielding stage is found.
    derived : mapping of str to callable
        Quantities that follow from the parameters.
    verdict : callable or None
        Whether the law holds at the parameters found, and that in words.

    Examples
    --------
    >>> from fingerpad.loading.laws import hertz
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
    slope: Law | None
    shape: Law | None
    steps: int
    derived: Mapping[str, Law]
    verdict: Law | None

    def __call__(self, *args: Any, **keywords: Any) -> Any:  # noqa: D102
        return self.function(*args, **keywords)

    @property
    def is_bounded(self) -> bool:
        """Whether a parameter has a bound, which the search then keeps to."""
        return any(math.isfinite(end) for pair in self.parameters.values() for end in pair)


@lru_cache(maxsize=256)
def arguments_of(function: Law) -> frozenset[str]:
    """Return the names of the arguments of a function."""
    return frozenset(inspect.signature(function).parameters)


def evaluate(law: ContactLaw, function: Law, values: Values, *given: Any, **more: Any) -> Any:
    """Return one of the functions of a law at a fit's values, with its parameters held inside their bounds.

    Raise FitError if it raises whatever error.
    """
    keywords = {name: min(max(values[name], low), high) for name, (low, high) in law.parameters.items()}
    wanted = arguments_of(function)
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
    slope: Law | None = None,
    shape: Law | None = None,
    steps: int = _STEPS,
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
    slope : callable, optional
        dW/dξ (N/mm), of the same arguments, by which noise of the displacement is weighed; differences of the
        load without it. It is not multiplied by ``shape_factor``.
    shape : callable, optional
        Of ξ/R alone: the factors by which load and area exceed those of a paraboloid, on a half-space.
    steps : int
        Steps of Newton's method, each with Hertz's slope, in which the indentation on a stage that yields is
        found.
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
            slope=slope,
            shape=shape,
            steps=steps,
            derived=MappingProxyType(dict(derived or {})),
            verdict=verdict,
        )
        _check_declaration(law)
        _check_values(law)
        LAWS[law.name] = law
        return law

    return register


def find_law(law: str | ContactLaw) -> ContactLaw:
    """Return a law by its name, or import it from ``file.py:name`` or ``module:name``."""
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
            if not {"", str(Path.cwd())} & set(
                sys.path
            ):  # an installed command does not look where it is called
                sys.path.append(str(Path.cwd()))
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


def _is_made_again(one: Callable[..., Any], other: Callable[..., Any]) -> bool:
    """Whether two functions are one definition, run again: a cell of a notebook, or a script's own file."""
    files = (one.__code__.co_filename, other.__code__.co_filename)
    same_place = one.__module__ == other.__module__ or Path(files[0]).resolve() == Path(files[1]).resolve()
    return same_place and one.__qualname__ == other.__qualname__


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
    if other and not _is_made_again(other.function, law.function):
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
    indented = {"": law.function, "area": law.area, "slope": law.slope}
    others = {"pull_off": law.pull_off, "verdict": law.verdict, **law.derived}
    for part, function in {**indented, **others}.items():
        if function is not None:
            _check_signature(f"{what}{part and f', {part}'}", function, law, indented=part in indented)
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
