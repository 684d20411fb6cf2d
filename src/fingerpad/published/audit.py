"""Every number printed by Dzidek et al. (2017), beside what its equations give.

A printed number stands for an interval, half a unit of its last digit to either side, and so does each
printed number that goes into an equation. A value is reproduced if the interval that the equations give,
over all inputs that would be printed alike, meets the interval of the printed value. There is no other
tolerance, and no constant is chosen to meet a printed value.

The extremes of the computed interval are taken at the corners of the box of inputs: over boxes as small as
these every equation used here is monotonic in each input, or flat to far below the last digit.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import StrEnum
from itertools import product
from typing import Final

import numpy as np

from fingerpad._arrays import FloatArray, as_float_array
from fingerpad._display import Displayed
from fingerpad.contact import equivalent_radius_from_indentation
from fingerpad.geometry import Ellipse, Ellipsoid, Placement
from fingerpad.published.dzidek2017 import METHODS, Printed, PublishedWedge, SemiAxes, dzidek2017

_MEAN_RADIUS: Final = "R_0g = 1/H, H from Eq. (1) at v = 90°"
_PLACEMENT: Final = "tan u = (ℓb/ℓa) tan θ"
_CORRECTION: Final = "R_corr = R_0g F₂⁻³, Johnson's F₂ ≤ 1: their F₁ with the factor (2/π) k^½"
_SLIP_REMARK: Final = "printed with cos 2u in Eq. (1) replaced by cos 2v = −1"
_MEASURED: Final = "measured input; nothing is printed from which it could be computed"


class Verdict(StrEnum):
    """Whether a printed number follows from the equations.

    Examples
    --------
    >>> sum(item.verdict is Verdict.NOT_REPRODUCIBLE for item in audit())
    24
    """

    REPRODUCED = "reproduced"
    WITH_MISPRINT = "reproduced with the known misprint"
    NOT_REPRODUCIBLE = "not reproducible from what is printed"
    FITTED = "fitted to printed numbers"


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class AuditItem(Displayed):
    """One printed number and what the equations give for it.

    Attributes
    ----------
    item : str
        Which number: table, row and column.
    printed : float or None
        As printed, or the ratio of two printed numbers; None where nothing is printed.
    unit : str
        Unit of all numbers here.
    verdict : Verdict
        One of the three verdicts.
    computed : float or None
        What the equations give from the printed inputs; None for a measured input.
    low, high : float or None
        Range of the computed value over all inputs that round to the printed ones.
    with_misprint : float or None
        The value with the known misprint of Table 2, where the radius R_0g is concerned.
    formula : str
        The equation used; empty for a measured input.
    remark : str
        A remark; may be empty.

    Examples
    --------
    >>> item = {item.item: item for item in audit()}["Table 3, θ = 30°, u"]
    >>> item.printed, round(item.computed, 1), item.unit
    (47.6, 45.2, '°')
    """

    item: str
    printed: float | None
    unit: str
    verdict: Verdict
    computed: float | None = None
    low: float | None = None
    high: float | None = None
    with_misprint: float | None = None
    formula: str = ""
    remark: str = ""


def audit() -> list[AuditItem]:
    """Return every number of Tables 1 to 4, the text's radii and the pooled values, each with its verdict.

    Returns
    -------
    list of AuditItem
        In the order of the tables.

    Examples
    --------
    >>> items = {item.item: item for item in audit()}
    >>> item = items["Table 2, ellipse, u = 30°"]
    >>> item.printed, round(item.computed, 2), round(item.with_misprint, 2), str(item.verdict)
    (25.3, 17.11, 25.26, 'reproduced with the known misprint')
    """
    article = dzidek2017()
    items = [item for method in METHODS for item in _table_1(method, article.semi_axes[method])]
    for method in METHODS:
        for u_deg, printed in zip(article.table2_u_deg, article.table2_radii_mm[method], strict=True):
            items.append(_table_2(method, article.semi_axes[method], u_deg, printed))
    wedges = sorted(article.wedges.values(), key=lambda wedge: -wedge.wedge_angle_deg)  # as the tables do
    for part in (_text, _table_3, _table_4, _pooled):
        for wedge in wedges:
            items.extend(part(wedge, article.semi_axes["ellipse"]))
    return items


def radius_with_misprint(ellipsoid: Ellipsoid, u: FloatArray | float) -> FloatArray:
    """Return the radius that Table 2 prints in place of R_0g = 1/H at v = π/2.

    With cos 2u in Eq. (1) replaced by cos 2v = −1, 1/H becomes 2 ℓc² S^(3/2)/(ℓa ℓb (ℓa² + ℓc²)) with
    S = ℓb² cos²u + ℓa² sin²u, correct at u = π/2 only. It explains printed numbers, and is used for nothing
    else.
    """
    a, b, c = ellipsoid.palmar, ellipsoid.distal, ellipsoid.radial_ulnar
    S = b**2 * np.cos(u) ** 2 + a**2 * np.sin(u) ** 2
    radius: FloatArray = 2 * c**2 * S**1.5 / (a * b * (a**2 + c**2))
    return radius


def _table_1(method: str, axes: SemiAxes) -> Iterator[AuditItem]:
    for name, printed in (
        ("palmar semi-axis ℓa", axes.palmar),
        ("distal semi-axis ℓb", axes.distal),
        ("radial–ulnar semi-axis ℓc", axes.radial_ulnar),
    ):
        yield _measured(f"Table 1, {method}, {name}", printed, "mm")


def _table_2(method: str, axes: SemiAxes, u_deg: float, printed: Printed) -> AuditItem:
    u = np.radians(u_deg)

    def mean_curvature_radius(*semi_axes: FloatArray) -> FloatArray:
        return Ellipsoid(*semi_axes).curvature(u, np.pi / 2).mean_curvature_radius

    return _checked(
        f"Table 2, {method}, u = {u_deg:g}°",
        printed,
        "mm",
        mean_curvature_radius,
        (axes.palmar, axes.distal, axes.radial_ulnar),
        formula=_MEAN_RADIUS,
        with_misprint=lambda *semi_axes: radius_with_misprint(Ellipsoid(*semi_axes), u),
    )


def _text(wedge: PublishedWedge, axes: SemiAxes) -> Iterator[AuditItem]:
    name = f"Text, ellipse, θ = {wedge.wedge_angle_deg}°, R_0g"
    yield _placed_radius(name, wedge.text_mean_curvature_radius_mm, wedge, axes)


def _table_3(wedge: PublishedWedge, axes: SemiAxes) -> Iterator[AuditItem]:
    name = f"Table 3, θ = {wedge.wedge_angle_deg}°"
    yield _measured(f"{name}, semi-major axis ℓd", wedge.semi_major_mm, "mm")
    yield _measured(f"{name}, semi-minor axis ℓe", wedge.semi_minor_mm, "mm")
    yield _checked(
        f"{name}, area",
        wedge.area_mm2,
        "mm²",
        lambda major, minor: Ellipse(major, minor).area,
        (wedge.semi_major_mm, wedge.semi_minor_mm),
        formula="π ℓd ℓe",
    )
    direct = dzidek2017().semi_axes["direct"].ellipsoid
    yield _checked(
        f"{name}, u",
        wedge.u_deg,
        "°",
        lambda *semi_axes: np.degrees(_placement(Ellipsoid(*semi_axes), wedge).u),
        (axes.palmar, axes.distal, axes.radial_ulnar),
        formula=_PLACEMENT,
        remark=f"ellipse semi-axes; the direct ones give {np.degrees(_placement(direct, wedge).u):.2f}°",
    )


def _table_4(wedge: PublishedWedge, axes: SemiAxes) -> Iterator[AuditItem]:
    name = f"Table 4, θ = {wedge.wedge_angle_deg}°"
    yield _placed_radius(f"{name}, R_0g", wedge.mean_curvature_radius_mm, wedge, axes)
    yield _checked(
        f"{name}, R_corr",
        wedge.corrected_radius_mm,
        "mm",
        _corrected_radius,
        (wedge.mean_curvature_radius_mm, wedge.semi_major_mm, wedge.semi_minor_mm),
        formula=_CORRECTION,
        remark="from the printed R_0g and contact ellipse",
    )
    yield _measured(f"{name}, R_g", wedge.measured_radius_mm, "mm")


def _pooled(wedge: PublishedWedge, _: SemiAxes) -> Iterator[AuditItem]:
    """Return the pooled value and its uncertainty: only one of the loads pooled is printed."""
    name = f"Pooled, θ = {wedge.wedge_angle_deg}°"
    exact = Printed(wedge.mean_curvature_radius_mm.value, 0.0)  # "the geometric radius is assumed exact"
    value, low, high = _over_rounding(_corrected_radius, (exact, wedge.semi_major_mm, wedge.semi_minor_mm))
    yield AuditItem(
        item=f"{name}, R_corr",
        printed=wedge.pooled_radius_mm.value,
        computed=value,
        low=low,
        high=high,
        unit="mm",
        verdict=Verdict.NOT_REPRODUCIBLE,
        formula=_CORRECTION,
        remark=f"computed for {wedge.load_N:g} N, the only load of which the contact ellipse is printed",
    )
    yield AuditItem(
        item=f"{name}, uncertainty of R_corr",
        printed=wedge.pooled_uncertainty_mm.value,
        computed=(high - low) / 2,
        unit="mm",
        verdict=Verdict.NOT_REPRODUCIBLE,
        formula=f"half the range of {_CORRECTION}",
        remark=f"computed from the rounding of the contact ellipse at {wedge.load_N:g} N, R_0g exact; "
        "neither the other loads nor the uncertainty of the axes are printed",
    )


def _placement(ellipsoid: Ellipsoid, wedge: PublishedWedge) -> Placement:
    return Placement(ellipsoid, wedge_angle=np.radians(wedge.wedge_angle_deg))


def _placed_radius(name: str, printed: Printed, wedge: PublishedWedge, axes: SemiAxes) -> AuditItem:
    """Audit R_0g at the place of contact on a wedge."""

    def misprint(*semi_axes: FloatArray) -> FloatArray:
        ellipsoid = Ellipsoid(*semi_axes)
        return radius_with_misprint(ellipsoid, _placement(ellipsoid, wedge).u)

    return _checked(
        name,
        printed,
        "mm",
        lambda *semi_axes: _placement(Ellipsoid(*semi_axes), wedge).curvature.mean_curvature_radius,
        (axes.palmar, axes.distal, axes.radial_ulnar),
        formula=f"{_MEAN_RADIUS}, {_PLACEMENT}",
        with_misprint=misprint,
    )


def _corrected_radius(radius: FloatArray, semi_major: FloatArray, semi_minor: FloatArray) -> FloatArray:
    return equivalent_radius_from_indentation(radius, Ellipse(semi_major, semi_minor).axis_ratio)


def _measured(name: str, printed: Printed, unit: str) -> AuditItem:
    return AuditItem(
        item=name,
        printed=printed.value,
        unit=unit,
        verdict=Verdict.NOT_REPRODUCIBLE,
        remark=_MEASURED,
    )


def _checked(
    name: str,
    printed: Printed,
    unit: str,
    equation: Callable[..., FloatArray],
    inputs: tuple[Printed, ...],
    *,
    formula: str,
    with_misprint: Callable[..., FloatArray] | None = None,
    remark: str = "",
) -> AuditItem:
    """Audit a number that an equation gives from printed inputs, and if it fails try the known misprint."""
    value, low, high = _over_rounding(equation, inputs)
    misprint = None if with_misprint is None else _over_rounding(with_misprint, inputs)
    verdict = Verdict.NOT_REPRODUCIBLE
    if _meets(printed, low, high):
        verdict = Verdict.REPRODUCED
    elif misprint is not None and _meets(printed, *misprint[1:]):
        verdict, remark = Verdict.WITH_MISPRINT, _SLIP_REMARK
    return AuditItem(
        item=name,
        printed=printed.value,
        computed=value,
        low=low,
        high=high,
        with_misprint=None if misprint is None else misprint[0],
        unit=unit,
        verdict=verdict,
        formula=formula,
        remark=remark,
    )


def _meets(printed: Printed, low: float, high: float) -> bool:
    return printed.interval[0] <= high and low <= printed.interval[1]


def _over_rounding(
    equation: Callable[..., FloatArray], inputs: tuple[Printed, ...]
) -> tuple[float, float, float]:
    """Return the equation's value at the printed inputs, and its extremes over their rounding."""
    corners = np.array(list(product(*(number.interval for number in inputs)))).T
    extremes = equation(*corners)
    value = float(equation(*(as_float_array(number.value) for number in inputs)))
    return value, float(extremes.min()), float(extremes.max())
