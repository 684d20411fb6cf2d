"""The numbers printed by Dzidek et al. (2017), as data with the precision to which they are printed."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal
from functools import cache
from importlib.resources import files
from types import MappingProxyType
from typing import Any, Final, Self

from fingerpad._display import Displayed
from fingerpad.geometry import Ellipsoid

METHODS: Final = ("direct", "ellipse")
WEDGE_ANGLES_DEG: Final = (30, 45)


@dataclass(frozen=True, slots=True)
class Printed:
    """A printed number, and half a unit of its last digit."""

    value: float
    rounding: float

    @classmethod
    def of(cls, digits: str | Decimal) -> Self:
        """Return a number from its digits; a trailing zero counts."""
        number = Decimal(digits)
        half_unit = Decimal("0.5").scaleb(int(number.as_tuple().exponent))
        return cls(value=float(number), rounding=float(half_unit))

    @property
    def interval(self) -> tuple[float, float]:
        """Values that are printed alike: value ∓ half a unit of the last digit."""
        return self.value - self.rounding, self.value + self.rounding


@dataclass(frozen=True, slots=True, kw_only=True)
class SemiAxes:
    """One row of Table 1, mm."""

    palmar: Printed
    distal: Printed
    radial_ulnar: Printed

    @property
    def ellipsoid(self) -> Ellipsoid:
        """The pad with these semi-axes."""
        return Ellipsoid(self.palmar.value, self.distal.value, self.radial_ulnar.value)


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class PublishedWedge(Displayed):
    """Numbers printed for one wedge angle: Tables 3 and 4 (at `load_N`), text, and pooled value.

    Attributes
    ----------
    wedge_angle_deg : int
        Wedge angle θ.
    load_N : float
        Normal force of Tables 3 and 4.
    semi_major_mm, semi_minor_mm, area_mm2 : Printed
        Contact ellipse and its area, measured (Table 3).
    u_deg : Printed
        Parametric angle of the place of contact (Table 3).
    text_mean_curvature_radius_mm : Printed
        R_0g as given in the text below Table 1.
    mean_curvature_radius_mm, corrected_radius_mm, measured_radius_mm : Printed
        R_0g, R_g^corr and R_g (Table 4).
    pooled_radius_mm, pooled_uncertainty_mm : Printed
        R_g^corr combined over all loads, and its uncertainty, of a kind that Dzidek et al. do not name.

    Examples
    --------
    >>> wedge = dzidek2017().wedges[45]
    >>> wedge.semi_major_mm.value, wedge.semi_minor_mm.value, wedge.load_N
    (5.3, 4.2, 2.0)
    """

    wedge_angle_deg: int
    load_N: float  # noqa: N815 the unit's own capital
    semi_major_mm: Printed
    semi_minor_mm: Printed
    area_mm2: Printed
    u_deg: Printed
    text_mean_curvature_radius_mm: Printed
    mean_curvature_radius_mm: Printed
    corrected_radius_mm: Printed
    measured_radius_mm: Printed
    pooled_radius_mm: Printed
    pooled_uncertainty_mm: Printed


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Dzidek2017(Displayed):
    """The numbers of the supplement of Dzidek et al. (2017).

    Attributes
    ----------
    semi_axes : mapping of str to SemiAxes
        Table 1, by method: "direct" or "ellipse".
    table2_u_deg : tuple of float
        Parametric angles of Table 2.
    table2_radii_mm : mapping of str to tuple of Printed
        R_0g of Table 2, by method, one for each angle.
    wedges : mapping of int to PublishedWedge
        The rest, by wedge angle in degrees: 30 or 45.

    Examples
    --------
    >>> printed = dzidek2017()
    >>> printed.semi_axes["ellipse"].distal.value
    13.8
    >>> printed.wedges[30].corrected_radius_mm
    Printed(value=19.9, rounding=0.05)
    """

    semi_axes: Mapping[str, SemiAxes]
    table2_u_deg: tuple[float, ...]
    table2_radii_mm: Mapping[str, tuple[Printed, ...]]
    wedges: Mapping[int, PublishedWedge]


@cache
def dzidek2017() -> Dzidek2017:
    """Return the printed numbers.

    Returns
    -------
    Dzidek2017
        Read once.

    Examples
    --------
    >>> dzidek2017().wedges[30].measured_radius_mm.interval
    (20.45, 20.55)
    """
    text = files("fingerpad.published").joinpath("dzidek2017.toml").read_text(encoding="utf-8")
    data = tomllib.loads(text, parse_float=Decimal)
    axes, radii = data["table1"]["semi_axes_mm"], data["table2"]["R_0g_mm"]
    return Dzidek2017(
        semi_axes=MappingProxyType(
            {
                method: SemiAxes(**{axis: Printed.of(value) for axis, value in axes[method].items()})
                for method in METHODS
            }
        ),
        table2_u_deg=tuple(map(float, data["table2"]["u_deg"])),
        table2_radii_mm=MappingProxyType(
            {method: tuple(map(Printed.of, radii[method])) for method in METHODS}
        ),
        wedges=MappingProxyType({angle: _wedge(data, angle) for angle in WEDGE_ANGLES_DEG}),
    )


def _wedge(data: Mapping[str, Any], angle: int) -> PublishedWedge:
    """Return the printed numbers of one wedge angle."""
    key = f"wedge_{angle}"
    contact, radii, pooled = (data[table][key] for table in ("table3", "table4", "pooled"))
    return PublishedWedge(
        wedge_angle_deg=angle,
        load_N=float(data["table3"]["load_N"]),
        **{name: Printed.of(digits) for name, digits in contact.items()},
        text_mean_curvature_radius_mm=Printed.of(data["text"]["R_0g_mm"][key]),
        mean_curvature_radius_mm=Printed.of(radii["R_0g_mm"]),
        corrected_radius_mm=Printed.of(radii["R_corr_mm"]),
        measured_radius_mm=Printed.of(radii["R_g_mm"]),
        pooled_radius_mm=Printed.of(pooled["R_corr_mm"]),
        pooled_uncertainty_mm=Printed.of(pooled["uncertainty_mm"]),
    )
