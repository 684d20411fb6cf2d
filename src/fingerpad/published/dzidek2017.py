"""The numbers printed by Dzidek et al. (2017), as data with the precision to which they are printed."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal
from functools import cache
from importlib.resources import files
from types import MappingProxyType
from typing import NamedTuple, Self

from fingerpad._display import Displayed
from fingerpad.geometry import Ellipsoid


class Printed(NamedTuple):
    """A printed number, and half a unit of its last digit."""

    value: float
    rounding: float

    @classmethod
    def of(cls, digits: str) -> Self:
        """Return a number from its digits; a trailing zero counts."""
        number = Decimal(digits)
        return cls(float(number), float(Decimal("0.5").scaleb(int(number.as_tuple().exponent))))

    @property
    def interval(self) -> tuple[float, float]:
        """Values that are printed alike: value ∓ half a unit of the last digit."""
        return self.value - self.rounding, self.value + self.rounding


class SemiAxes(NamedTuple):
    """One row of Table 1, mm."""

    palmar: Printed
    distal: Printed
    radial_ulnar: Printed

    @property
    def ellipsoid(self) -> Ellipsoid:
        """The pad with these semi-axes."""
        return Ellipsoid(*(axis.value for axis in self))


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class PublishedWedge(Displayed):
    """Numbers printed for one wedge angle θ."""

    wedge_angle_deg: int
    text_mean_curvature_radius_mm: Printed  # R_0g as given in the text below Table 1
    load_N: float  # noqa: N815 (the unit's own capital) normal force of Tables 3 and 4
    semi_major_mm: Printed  # Table 3: contact ellipse and its area, measured
    semi_minor_mm: Printed
    area_mm2: Printed
    u_deg: Printed  # parametric angle of the place of contact
    mean_curvature_radius_mm: Printed  # Table 4: R_0g, R_g^corr and R_g
    corrected_radius_mm: Printed
    measured_radius_mm: Printed
    pooled_radius_mm: Printed  # R_g^corr combined over all loads
    pooled_uncertainty_mm: Printed  # its uncertainty, of a kind that Dzidek et al. do not name


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Dzidek2017(Displayed):
    """The numbers of the supplement of Dzidek et al. (2017)."""

    semi_axes: Mapping[str, SemiAxes]  # Table 1, by method: "direct" or "ellipse"
    table2_radii_mm: Mapping[str, Mapping[str, Printed]]  # R_0g by method and parametric angle in degrees
    wedges: Mapping[int, PublishedWedge]  # the rest, by wedge angle in degrees: 30 or 45


@cache
def dzidek2017() -> Dzidek2017:
    """Return the printed numbers, with the precision to which they are printed.

    Returns
    -------
    Dzidek2017
        Table 1 (`semi_axes`), Table 2, and what is printed for either wedge angle (`wedges`).

    Examples
    --------
    >>> printed = dzidek2017()
    >>> printed.semi_axes["ellipse"].ellipsoid.distal.item(), printed.wedges[45].semi_major_mm.value
    (13.8, 5.3)
    >>> printed.wedges[30].corrected_radius_mm
    Printed(value=19.9, rounding=0.05)
    """
    text = files("fingerpad.published").joinpath("dzidek2017.toml").read_text(encoding="utf-8")
    data = tomllib.loads(text, parse_float=Printed.of)
    wedges = {}
    for angle in (30, 45):
        tables = (data[table][f"wedge_{angle}"] for table in ("text", "table3", "table4", "pooled"))
        numbers = {name: number for table in tables for name, number in table.items()}
        load = float(data["table3"]["load_N"])
        wedges[angle] = PublishedWedge(wedge_angle_deg=angle, load_N=load, **numbers)
    return Dzidek2017(
        semi_axes=MappingProxyType(
            {method: SemiAxes(**row) for method, row in data["table1"]["semi_axes_mm"].items()}
        ),
        table2_radii_mm=MappingProxyType(data["table2"]["R_0g_mm"]),
        wedges=MappingProxyType(wedges),
    )
