"""What is pressed, and the contact that comes of it, by whatever theory."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final, Self, TypeAlias

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import (
    ArrayLike,
    BoolArray,
    FloatArray,
    as_float_array,
    broadcast_named,
    check_all,
    check_positive,
    check_shapes,
    set_fields,
)
from fingerpad._display import Displayed
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Paraboloid, Placement

AnyPlacement: TypeAlias = Placement | Paraboloid

# What takes a contact out of the range of a theory, by its code. The numbers are then NaN, but 0 where a pad
# is not pressed, and for Hertz theory: with `thickness_ignored` they are those of deep tissue, with
# `contact_too_wide` of a paraboloid.
FLAGS: Final = (
    "",
    "no_contact",
    "contact_too_wide",
    "contact_too_skew",
    "contact_too_slender",
    "layer_too_thin",
    "poisson_ratio_out_of_range",
    "thickness_ignored",
)


@dataclass(frozen=True, slots=True, init=False, eq=False, repr=False)
class Tissue(Displayed):
    """Elastic tissue, deep or a layer bonded to rigid bone.

    Attributes
    ----------
    youngs_modulus : array_like
        E.
    poisson_ratio : array_like
        ν, 0 to 0.5. A contact on deep tissue depends on E* = E/(1 − ν²) alone.
    thickness : array_like
        Of the layer over bone; infinite for deep tissue.

    Raises
    ------
    GeometryError
        If a modulus or thickness is not positive, or ν not within [0, 0.5].

    Examples
    --------
    >>> soft = Tissue(youngs_modulus=0.06, thickness=8.0)
    >>> round(float(soft.reduced_modulus), 6)
    0.08
    """

    youngs_modulus: FloatArray
    poisson_ratio: FloatArray
    thickness: FloatArray

    def __init__(
        self, youngs_modulus: ArrayLike, poisson_ratio: ArrayLike = 0.5, thickness: ArrayLike = math.inf
    ) -> None:
        given = {"youngs_modulus": youngs_modulus, "poisson_ratio": poisson_ratio, "thickness": thickness}
        broadcast_named(**given)  # or refuse the shapes
        modulus, nu, depth = map(as_float_array, given.values())
        check_positive("youngs_modulus", modulus, GeometryError)
        check_all((nu >= 0) & (nu <= 0.5), "poisson_ratio", nu, "within [0, 0.5]", GeometryError)
        check_all(depth > 0, "thickness", depth, "positive", GeometryError)
        set_fields(self, youngs_modulus=modulus, poisson_ratio=nu, thickness=depth)

    @classmethod
    def of_reduced_modulus(
        cls, reduced_modulus: ArrayLike, poisson_ratio: ArrayLike = 0.5, thickness: ArrayLike = math.inf
    ) -> Self:
        """Return the tissue of a reduced modulus E* = E/(1 − ν²).

        Parameters
        ----------
        reduced_modulus : array_like
            E*.
        poisson_ratio, thickness : array_like
            As for `Tissue`.

        Returns
        -------
        Tissue
        """
        return cls(from_reduced_modulus(reduced_modulus, poisson_ratio), poisson_ratio, thickness)

    @property
    def reduced_modulus(self) -> FloatArray:
        """E* = E/(1 − ν²), against a rigid body."""
        return reduced_modulus(self.youngs_modulus, self.poisson_ratio)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the array of tissues; empty for one."""
        return np.broadcast_shapes(
            np.shape(self.youngs_modulus), np.shape(self.poisson_ratio), np.shape(self.thickness)
        )

    @property
    def is_deep(self) -> bool:
        """Whether nothing of it lies over bone."""
        return bool(np.isinf(self.thickness).all())


@np.errstate(all="ignore")
def reduced_modulus(youngs_modulus: ArrayLike, poisson_ratio: ArrayLike) -> FloatArray:
    """Return E* = E/(1 − ν²) of a body pressed against a rigid one."""
    return as_float_array(youngs_modulus) / (1 - as_float_array(poisson_ratio) ** 2)


def from_reduced_modulus(reduced_modulus: ArrayLike, poisson_ratio: ArrayLike) -> FloatArray:
    """Return E = E*(1 − ν²) of a body pressed against a rigid one."""
    return as_float_array(reduced_modulus) * (1 - as_float_array(poisson_ratio) ** 2)


@dataclass(frozen=True, slots=True)
class Form:
    """The ellipse of contacts and their highest pressure.

    `semi_major` and `semi_minor` are those of the ellipse with the contact's area and ratio of second
    moments, `along` tells where the long axis lies nearer to the first principal direction, and
    `peak_over_mean_pressure` is 3/2 in Hertz theory.
    """

    semi_major: FloatArray
    semi_minor: FloatArray
    along: BoolArray
    peak_over_mean_pressure: FloatArray


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Contact(Displayed):
    """Contacts under load, one or an array of them; NaN beyond the range of the theory, with a flag.

    `hertz_contact` leaves the numbers: with ``thickness_ignored`` they are those of deep tissue, with
    ``contact_too_wide`` those of paraboloids.

    Attributes
    ----------
    load : ndarray
        Normal force W.
    indentation : ndarray
        Mutual approach ξ.
    area : ndarray
        Contact area A.
    flag_code : ndarray
        Index in `FLAGS` of what takes a contact out of the theory's range; 0 within.
    """

    load: FloatArray
    indentation: FloatArray
    area: FloatArray
    flag_code: npt.NDArray[np.int8]
    _find_form: Callable[[], Form]

    @cached_property
    def _form(self) -> Form:
        return self._find_form()  # of the laws it costs as much as the sizes, and is not always asked for

    @property
    def flags(self) -> npt.NDArray[np.str_]:
        """What takes each contact out of the theory's range, by its name in `FLAGS`; empty within."""
        return np.array(FLAGS)[self.flag_code]

    @property
    def semi_major(self) -> FloatArray:
        """Semi-major axis ℓd of the ellipse with the contact's area and ratio of second moments."""
        return self._form.semi_major

    @property
    def semi_minor(self) -> FloatArray:
        """Semi-minor axis ℓe of the same ellipse."""
        return self._form.semi_minor

    @property
    def aspect_ratio(self) -> FloatArray:
        """ℓd/ℓe ≥ 1; NaN without a contact."""
        with np.errstate(all="ignore"):
            return self.semi_major / self.semi_minor

    @property
    def along(self) -> BoolArray:
        """Whether the long axis lies along the finger: nearer to the first principal direction."""
        return self._form.along

    @property
    def mean_pressure(self) -> FloatArray:
        """W/A; NaN without load."""
        with np.errstate(all="ignore"):
            return self.load / self.area

    @property
    def peak_pressure(self) -> FloatArray:
        """Highest pressure; 3W/(2A) in Hertz theory."""
        return self._form.peak_over_mean_pressure * self.mean_pressure

    @property
    def area_over_pi_indentation(self) -> FloatArray:
        """A/(πξ), what loading data show as the loading radius R_g at this load alone."""
        with np.errstate(all="ignore"):
            return self.area / (np.pi * self.indentation)

    def _shown(self) -> list[tuple[str, Any]]:
        names = ("load", "indentation", "area", "semi_major", "semi_minor", "along", "peak_pressure")
        flags = sorted({str(flag) for flag in self.flags.ravel()} - {""})
        return [*((name, getattr(self, name)) for name in names), ("flags", ", ".join(flags) or "none")]


def only_given(**given: ArrayLike | None) -> tuple[str, FloatArray]:
    """Return the name and the value of the one quantity that is given."""
    wanted = [(name, value) for name, value in given.items() if value is not None]
    if len(wanted) != 1:
        raise GeometryError(f"give exactly one of {', '.join(given)}, found {len(wanted)}")
    ((name, value),) = wanted
    return name, as_float_array(value, name)


def check_pressed(
    placement: AnyPlacement, tissue: Tissue, **given: ArrayLike | None
) -> tuple[str, FloatArray]:
    """Return the name and value of the one quantity that is given, which broadcasts with what is pressed."""
    check_placement(placement)
    if not isinstance(tissue, Tissue):
        raise GeometryError(
            f"the second argument must be a Tissue(youngs_modulus), found {type(tissue).__name__}"
        )
    name, value = only_given(**given)
    check_shapes(placement=placement.shape, tissue=tissue.shape, **{name: value.shape})
    return name, value


def check_placement(placement: object) -> None:
    """Refuse what is no placement, such as a radius alone."""
    if not isinstance(placement, Placement | Paraboloid):
        raise GeometryError(
            f"the first argument must be a Placement, or a Paraboloid(first_radius, second_radius), "
            f"found {type(placement).__name__}"
        )
