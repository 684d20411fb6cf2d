"""The contact of whole ellipsoids on a layer, by laws in closed form, as fast as Hertz theory."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Final, Self

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import ArrayLike, BoolArray, FloatArray, apply_blockwise, as_float_array
from fingerpad._display import Displayed
from fingerpad.contact.hertz_polynomials import hertz_units
from fingerpad.contact.law_factors import LayerFactors, PadFactors
from fingerpad.contact.pad_gap import PadGap
from fingerpad.exceptions import GeometryError

FLAGS: Final = (
    "",
    "no_contact",
    "contact_too_wide",
    "contact_too_skew",
    "contact_too_slender",
    "layer_too_thin",
    "poisson_ratio_out_of_range",
)
WIDEST: Final = 0.601  # √(A/A_s), A_s being the area of the pad's silhouette seen along the plate's normal
MOST_SKEW: Final = 0.2  # (μ1 a1)² + (μ2 a2)²
MOST_SLENDER: Final = 0.33  # axis ratio in Hertz theory, of a whole ellipsoid
MOST_SLENDER_ON_LAYER: Final = 0.5
THINNEST: Final = 3.01  # √(A/π)/t, 3 with the laws' own error
LOWEST_POISSON_RATIO: Final = 0.3
ERROR_OF_PAD: Final = (
    0.002  # largest relative error of load, area and indentation; of a layer alone twice this
)
ERROR_OF_BOTH: Final = 0.01
_LARGEST_MISS = 0.01
_STEPS = 2  # of Newton's method: the first guess is within some per cent


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FastContact(Displayed):
    """Contacts by the laws; NaN where they are flagged.

    Attributes
    ----------
    load : ndarray
        Normal force W.
    area : ndarray
        Contact area.
    indentation : ndarray
        Mutual approach ξ.
    flag_code : ndarray
        Place in `FLAGS` of what takes a contact out of the laws' range; 0 within.

    Examples
    --------
    >>> contact = fast_contact(PadGap.paraboloid(10.0, 10.0), indentation=1.0, reduced_modulus=0.1)
    >>> float(contact.area_over_pi_indentation.round(6))  # of a sphere: its radius
    10.0
    """

    load: FloatArray
    area: FloatArray
    indentation: FloatArray
    flag_code: npt.NDArray[np.int8]

    @property
    def flag(self) -> npt.NDArray[np.str_]:
        """Names of the flags, empty where there is none."""
        names: npt.NDArray[np.str_] = np.array(FLAGS)[self.flag_code]
        return names

    @property
    def area_over_pi_indentation(self) -> FloatArray:
        """A/(πξ), the loading radius of each load alone."""
        return self.area / (np.pi * self.indentation)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FastEllipse(Displayed):
    """The form of contacts by the laws; NaN beyond their range.

    Attributes
    ----------
    semi_major, semi_minor : ndarray
        Semi-axes of the ellipse with the contact's area and ratio of second moments.
    long_axis : ndarray
        0 where it lies nearer to the first principal direction, 1 nearer to the second.
    peak_over_mean_pressure : ndarray
        Highest pressure over W/A; 3/2 in Hertz theory.

    Examples
    --------
    >>> float(fast_ellipse(PadGap.paraboloid(10.0, 10.0), area=np.pi).semi_major.round(6))
    1.0
    """

    semi_major: FloatArray
    semi_minor: FloatArray
    long_axis: FloatArray
    peak_over_mean_pressure: FloatArray


def fast_contact(
    gap: PadGap,
    *,
    reduced_modulus: ArrayLike,
    thickness: ArrayLike | None = None,
    poisson_ratio: ArrayLike = 0.5,
    load: ArrayLike | None = None,
    area: ArrayLike | None = None,
    indentation: ArrayLike | None = None,
) -> FastContact:
    """Press pads against a plate, by laws that agree with the solved contact within 0.5 %.

    They hold for contacts up to 0.6 of the silhouette's mean radius, thicknesses from a third of the
    contact's mean radius, ν of a layer from 0.3 to 0.5, and axis ratios of Hertz theory down to 0.5 on a
    layer and to 0.33 elsewhere; beyond, they give NaN and a flag. Both together are within 1 %. Arrays
    broadcast, and complex steps give derivatives.

    Parameters
    ----------
    gap : PadGap
        The pads' gaps.
    reduced_modulus : array_like
        E* of the tissue.
    thickness : array_like, optional
        Of a layer of tissue bonded to a rigid base; a half-space where none is given.
    poisson_ratio : array_like
        ν of the tissue, which matters to a layer alone.
    load, area, indentation : array_like
        Exactly one of normal force W, contact area and mutual approach ξ.

    Returns
    -------
    FastContact
        Shapes broadcast.

    Raises
    ------
    GeometryError
        If not exactly one of load, area and indentation is given.

    Examples
    --------
    The pad of Dzidek et al. (2017) at 2 N, on deep tissue and on 8 mm of it over bone:

    >>> from fingerpad.geometry import Ellipsoid
    >>> pad = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
    >>> gap = PadGap.of(pad, wedge_angle=np.radians(30))
    >>> contact = fast_contact(gap, load=2.0, thickness=[np.inf, 8.0], reduced_modulus=0.1365)
    >>> contact.area.round(1), contact.indentation.round(2)
    (array([83.9, 77.3]), array([2.1 , 1.25]))
    >>> str(fast_contact(gap, load=2.0, thickness=0.5, reduced_modulus=0.1365).flag)
    'layer_too_thin'
    """
    given = {"load": load, "area": area, "indentation": indentation}
    wanted = [(name, value) for name, value in given.items() if value is not None]
    if len(wanted) != 1:
        raise GeometryError(f"give exactly one of load, area and indentation, found {len(wanted)}")
    (name, value), modulus = wanted[0], as_float_array(reduced_modulus)
    value = as_float_array(value) / modulus if name == "load" else value
    force, size, depth, code = _apply(partial(_sizes, of=name), gap, value, thickness, poisson_ratio)
    return FastContact(
        load=modulus * force, area=size, indentation=depth, flag_code=np.real(code).astype(np.int8)[()]
    )


def fast_ellipse(
    gap: PadGap, *, area: ArrayLike, thickness: ArrayLike | None = None, poisson_ratio: ArrayLike = 0.5
) -> FastEllipse:
    """Return the form of contacts of known area, by laws like those of `fast_contact`.

    Parameters
    ----------
    gap, thickness, poisson_ratio
        As for `fast_contact`.
    area : array_like
        Contact area.

    Returns
    -------
    FastEllipse
        Shapes broadcast.

    Examples
    --------
    Bone makes the contact rounder, and its peak higher:

    >>> gap = PadGap.paraboloid(10.0, 16.0)
    >>> for thickness in (np.inf, 4.0):
    ...     form = fast_ellipse(gap, area=50.0, thickness=thickness)
    ...     aspect_ratio = form.semi_major / form.semi_minor
    ...     print(f"{aspect_ratio:.2f}, {form.peak_over_mean_pressure:.2f}")
    1.37, 1.50
    1.30, 1.59
    """
    major, minor, axis, peak = _apply(_form, gap, area, thickness, poisson_ratio)
    return FastEllipse(semi_major=major, semi_minor=minor, long_axis=axis, peak_over_mean_pressure=peak)


def _apply(
    kernel: Callable[..., tuple[FloatArray, ...]],
    gap: PadGap,
    value: ArrayLike,
    thickness: ArrayLike | None,
    poisson_ratio: ArrayLike,
) -> tuple[FloatArray, ...]:
    """Apply a kernel of four results blockwise; one ν for all contacts is passed as a number."""
    shape = gap.first_skewness, gap.second_skewness, gap.flatness
    whole = any(np.any(number != 0) for number in shape)
    return apply_blockwise(
        partial(
            kernel,
            whole=whole,
            poisson_ratio=as_float_array(poisson_ratio) if np.ndim(poisson_ratio) == 0 else None,
        ),
        4,
        *(gap.first_radius, gap.second_radius, value),
        *(shape if whole else ()),
        *(() if thickness is None else (thickness, poisson_ratio)),
    )


def _sizes(
    first: FloatArray,
    second: FloatArray,
    value: FloatArray,
    *rest: FloatArray,
    of: str,
    whole: bool,
    poisson_ratio: FloatArray | None,
) -> tuple[FloatArray, ...]:
    """Return load over E*, area, indentation and flag of one block."""
    k, unit_load, unit_depth = hertz_units(first, second)
    laws = _Laws.of(first, second, k, rest, whole=whole, poisson_ratio=poisson_ratio)
    hertz = {
        "load": unit_load,
        "indentation": unit_depth,
        "area": np.array(np.pi),
    }
    a, miss = laws.mean_radius(of, value, hertz[of])
    square = a * a
    powers = {"load": square * a, "area": square, "indentation": square}
    results = [
        value if name == of else hertz[name] * power * laws.factor(name, a) for name, power in powers.items()
    ]
    code = laws.flag(a, k, miss, value)
    if code.any():
        results = [np.where(code == 0, each, np.nan) for each in results]
    return *results, code


def _form(
    first: FloatArray,
    second: FloatArray,
    area: FloatArray,
    *rest: FloatArray,
    whole: bool,
    poisson_ratio: FloatArray | None,
) -> tuple[FloatArray, ...]:
    """Return semi-axes, long axis and peak over mean pressure of one block."""
    k = hertz_units(first, second)[0]
    laws = _Laws.of(first, second, k, rest, whole=whole, poisson_ratio=poisson_ratio, form=True)
    a, miss = laws.mean_radius("area", area, np.array(np.pi))
    ratio, along = laws.axis_ratio(a)
    results = a * ratio, a / ratio, np.where(along.real < 0, 1.0, 0.0), 1.5 * laws.peak(a)
    inside = laws.flag(a, k, miss, area) == 0
    return tuple(np.where(inside, each, np.nan) for each in results)


def _has_law(poisson_ratio: FloatArray) -> BoolArray:
    """Return whether ν is one for which a layer has laws."""
    within: BoolArray = (poisson_ratio.real >= LOWEST_POISSON_RATIO) & (poisson_ratio.real <= 0.5)
    return within


_POWERS: Final = {"load": 3, "indentation": 2, "area": 2}  # of the mean radius, in Hertz theory


@dataclass(frozen=True, slots=True, kw_only=True)
class _Laws:
    """The factors that hold for one block of contacts."""

    elongation: FloatArray
    layer: LayerFactors | None
    pad: PadFactors | None

    @classmethod
    def of(
        cls,
        first: FloatArray,
        second: FloatArray,
        k: FloatArray,
        rest: tuple[FloatArray, ...],
        *,
        whole: bool,
        poisson_ratio: FloatArray | None,
        form: bool = False,
    ) -> Self:
        """Take the numbers of the gap, if it is a whole ellipsoid's, then thickness and ν, if any."""
        layer, pad, elongation = None, None, 0 * k
        if whole or form:
            longer_first = first.real > second.real
            elongation = np.where(longer_first, 0.5, -0.5) * (1 - k * k) / k
        if whole:
            pad = PadFactors(
                first, second, *rest[:3], stretch=np.where(longer_first, 1 / k, k), elongation=elongation
            )
            rest = rest[3:]
        if rest:
            nu = rest[1] if poisson_ratio is None else poisson_ratio
            ignored = np.isinf(rest[0]) & ~_has_law(nu)  # ν matters to a layer alone
            if ignored.any():
                nu = np.where(ignored, 0.5, nu)
            layer = LayerFactors(rest[0], nu, (1 - k) * (1 - k) / k)
        return cls(elongation=elongation, layer=layer, pad=pad)

    def factor(self, of: str, radius: FloatArray) -> FloatArray:
        """Return the factor on load, indentation or area."""
        factor: FloatArray = np.ones(())
        u = None
        if of == "area":
            return factor
        if self.layer is not None:
            u = self.layer.size(radius)
            factor = self.layer.value(of, radius)
        return factor if self.pad is None else factor * np.exp(self.pad.value(of, radius, u))

    def mean_radius(self, of: str, value: FloatArray, unit: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the radius √(A/π) at a load, indentation or area, and by how much Newton's method missed."""
        power = _POWERS[of]
        ratio = np.where(value.real > 0, value, np.nan) / unit
        if power == 2:
            hertz = np.sqrt(ratio)
        else:
            hertz = ratio ** (1 / 3) if np.iscomplexobj(ratio) else np.cbrt(ratio)
        change = np.zeros_like(hertz)
        if of == "area" or (self.layer is None and self.pad is None):
            return hertz, change
        radius = hertz
        if self.layer is not None:
            radius = hertz * np.exp(self.layer.first_guess(of, hertz))
        if self.pad is not None:
            radius = radius * np.exp(self.pad.value(of, radius, None) / -power)
        factor, slope = self._factor_and_slope(of, radius)
        for step in range(_STEPS):
            if step:
                factor = self.factor(of, radius)
            square = radius * radius
            miss = np.log(ratio / (factor * (square if power == 2 else square * radius))) / (power + slope)
            radius = radius * np.exp(miss)
        return radius, miss

    def _factor_and_slope(self, of: str, radius: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the factor on load or indentation, and the slope of its logarithm."""
        factor, slope, u = np.ones(()), np.zeros(()), None
        if self.layer is not None:
            u = self.layer.size(radius)
            factor, slope = self.layer.value_and_slope(of, radius)
        if self.pad is not None:
            factor = factor * np.exp(self.pad.value(of, radius, u))
            slope = slope + self.pad.slope(of, radius, u)
        return factor, slope

    def axis_ratio(self, radius: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return √(a/b) ≥ 1, and (a/b − b/a)/2 with a sign: positive along the first direction."""
        along, u = self.elongation, None
        if self.layer is not None:
            along, u = along * self.layer.roundness(radius), self.layer.size(radius)
        half = along * np.sign(along.real)
        if self.pad is not None:
            along, turned = self.pad.elongations(radius, u, along)
            half = np.sqrt(along * along + turned * turned)
        return np.sqrt(half + np.sqrt(1 + half * half)), along

    def peak(self, radius: FloatArray) -> FloatArray:
        """Return the factor on the peak pressure 3W/(2A)."""
        factor, u = 1 + 0 * radius, None
        if self.layer is not None:
            factor, u = self.layer.peak(radius), self.layer.size(radius)
        return factor if self.pad is None else factor * self.pad.peak(radius, u)

    def flag(self, radius: FloatArray, k: FloatArray, miss: FloatArray, value: FloatArray) -> FloatArray:
        """Return the places in `FLAGS`."""
        code = np.zeros(k.shape)
        found = np.isfinite(radius) & (np.abs(miss) < _LARGEST_MISS)
        ranges = []
        if self.layer is not None:
            ratio = self.layer.ratio(radius).real
            ranges += [
                ("layer_too_thin", found & (ratio >= 0) & (ratio <= THINNEST)),
                ("contact_too_slender", (k.real >= MOST_SLENDER_ON_LAYER) | self.layer.is_half_space),
            ]
        if self.pad is not None:
            ranges += [
                ("contact_too_slender", (k.real >= MOST_SLENDER) | ~self.pad.whole),
                ("contact_too_skew", self.pad.skewness(radius).real <= MOST_SKEW),
                ("contact_too_wide", found & (self.pad.width(radius).real <= WIDEST)),
            ]
        if self.layer is not None:  # the reason for what the other ranges miss
            ranges.append(("poisson_ratio_out_of_range", _has_law(self.layer.poisson_ratio)))
        ranges.append(("no_contact", (value.real > 0) & np.isfinite(value) & np.isfinite(k)))
        for name, inside in ranges:
            if not inside.all():
                code[~inside] = FLAGS.index(name)
        return code
