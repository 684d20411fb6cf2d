"""Every number printed by Dzidek et al. (2017), beside what its equations give.

A printed number stands for an interval, half a unit of its last digit to either side, and so does each
printed number that goes into an equation. A value is reproduced if the interval that the equations give,
over all inputs that would be printed alike, meets the interval of the printed value. There is no other
tolerance, and no constant is chosen to meet a printed value.

The extremes of the computed interval are taken at the corners of the box of inputs: over boxes as small as
these every equation used here is monotonic in each input, or flat to far below the last digit.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from itertools import product
from typing import Final, TypeAlias

import numpy as np

from fingerpad._arrays import FloatArray, as_float_array
from fingerpad._display import Displayed
from fingerpad.contact import equivalent_radius_from_indentation
from fingerpad.geometry import Ellipse, Ellipsoid, Placement
from fingerpad.published.dzidek2017 import Printed, PublishedWedge, dzidek2017

Equation: TypeAlias = Callable[..., FloatArray]
Radii: TypeAlias = Callable[..., tuple[FloatArray, FloatArray]]  # true, and with the misprint

_MEAN_RADIUS: Final = "R_0g = 1/H, H from Eq. (1) at v = 90°"
_PLACEMENT: Final = "tan u = (ℓb/ℓa) tan θ"
_CORRECTION: Final = "R_corr = R_0g F₂⁻³, Johnson's F₂ ≤ 1: their F₁ with the factor (2/π) k^½"
_SLIP_REMARK: Final = "printed with cos 2u in Eq. (1) replaced by cos 2v = −1"
_MEASURED: Final = "measured input; nothing is printed from which it could be computed"
_AXES: Final = ("palmar semi-axis ℓa", "distal semi-axis ℓb", "radial–ulnar semi-axis ℓc")
_PARTS: Final = ("Table 1", "Table 2", "Text", "Table 3", "Table 4", "Pooled")


class Verdict(StrEnum):
    """Whether a printed number follows from the equations."""

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
        Whether it follows from the equations.
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
    """

    item: str
    printed: float | None
    unit: str = "mm"
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
    items = [
        _measured(f"Table 1, {method}, {name}", printed)
        for method, axes in article.semi_axes.items()
        for name, printed in zip(_AXES, axes, strict=True)
    ]
    items += [
        _mean_radius(
            f"Table 2, {method}, u = {u}°",
            printed,
            method,
            _MEAN_RADIUS,
            lambda *semi_axes, u=u: _radii(Ellipsoid(*semi_axes), np.radians(float(u))),
        )
        for method, radii in article.table2_radii_mm.items()
        for u, printed in radii.items()
    ]
    for angle in sorted(article.wedges, reverse=True):  # as the tables do
        items += _on_wedge(article.wedges[angle])
    return sorted(items, key=lambda item: _PARTS.index(item.item.partition(",")[0]))


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


def _on_wedge(wedge: PublishedWedge) -> Iterator[AuditItem]:
    """Audit what is printed for one wedge angle."""
    angle, load = f"θ = {wedge.wedge_angle_deg}°", f"{wedge.load_N:g} N"
    semi_axes, theta = dzidek2017().semi_axes, np.radians(wedge.wedge_angle_deg)
    radius, axes = wedge.mean_curvature_radius_mm, (wedge.semi_major_mm, wedge.semi_minor_mm)

    def u_deg(*semi_axes: FloatArray) -> FloatArray:
        return np.degrees(Placement(Ellipsoid(*semi_axes), wedge_angle=theta).u)

    def radii(*semi_axes: FloatArray) -> tuple[FloatArray, FloatArray]:
        placement = Placement(Ellipsoid(*semi_axes), wedge_angle=theta)
        return _radii(placement.ellipsoid, placement.u)

    def corrected(radius: FloatArray, semi_major: FloatArray, semi_minor: FloatArray) -> FloatArray:
        return equivalent_radius_from_indentation(radius, semi_minor / semi_major)

    for place, printed in (("Text, ellipse", wedge.text_mean_curvature_radius_mm), ("Table 4", radius)):
        name = f"{place}, {angle}, R_0g"
        yield _mean_radius(name, printed, "ellipse", f"{_MEAN_RADIUS}, {_PLACEMENT}", radii)
    yield _measured(f"Table 3, {angle}, semi-major axis ℓd", wedge.semi_major_mm)
    yield _measured(f"Table 3, {angle}, semi-minor axis ℓe", wedge.semi_minor_mm)
    name, area = f"Table 3, {angle}, area", wedge.area_mm2
    yield _checked(name, area, lambda *axes: Ellipse(*axes).area, axes, "π ℓd ℓe", unit="mm²")
    remark = f"ellipse semi-axes; the direct ones give {u_deg(*semi_axes['direct'].ellipsoid.semi_axes):.2f}°"
    name, printed = f"Table 3, {angle}, u", wedge.u_deg
    yield _checked(name, printed, u_deg, semi_axes["ellipse"], _PLACEMENT, unit="°", remark=remark)
    remark = "from the printed R_0g and contact ellipse"
    name, printed = f"Table 4, {angle}, R_corr", wedge.corrected_radius_mm
    yield _checked(name, printed, corrected, (radius, *axes), _CORRECTION, remark=remark)
    yield _measured(f"Table 4, {angle}, R_g", wedge.measured_radius_mm)
    exact = Printed(radius.value, 0.0)  # "the geometric radius is assumed exact"
    name, printed = f"Pooled, {angle}, R_corr", wedge.pooled_radius_mm
    remark = f"computed for {load}, the only load of which the contact ellipse is printed"
    yield _checked(name, printed, corrected, (exact, *axes), _CORRECTION, remark=remark)
    _, low, high = _over_rounding(corrected, (exact, *axes))
    yield AuditItem(
        item=f"Pooled, {angle}, uncertainty of R_corr",
        printed=wedge.pooled_uncertainty_mm.value,
        verdict=Verdict.NOT_REPRODUCIBLE,
        computed=(high - low) / 2,
        formula=f"half the range of {_CORRECTION}",
        remark=f"computed from the rounding of the contact ellipse at {load}, R_0g exact; "
        "neither the other loads nor the uncertainty of the axes are printed",
    )


def _radii(pad: Ellipsoid, u: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return R_0g at u, true and with the misprint."""
    return pad.curvature(u, np.pi / 2).mean_curvature_radius, radius_with_misprint(pad, u)


def _measured(name: str, printed: Printed) -> AuditItem:
    return AuditItem(item=name, printed=printed.value, verdict=Verdict.NOT_REPRODUCIBLE, remark=_MEASURED)


def _mean_radius(name: str, printed: Printed, method: str, formula: str, radii: Radii) -> AuditItem:
    """Audit R_0g, and if it is not reproduced try the known misprint."""
    true, slip = (
        _checked(name, printed, lambda *axes, i=i: radii(*axes)[i], dzidek2017().semi_axes[method], formula)
        for i in range(2)
    )
    if slip.verdict is Verdict.REPRODUCED and true.verdict is not Verdict.REPRODUCED:
        true = replace(true, verdict=Verdict.WITH_MISPRINT, remark=_SLIP_REMARK)
    return replace(true, with_misprint=slip.computed)


def _checked(
    name: str,
    printed: Printed,
    equation: Equation,
    inputs: Sequence[Printed],
    formula: str,
    *,
    unit: str = "mm",
    remark: str = "",
) -> AuditItem:
    """Audit a number that an equation gives from printed inputs."""
    value, low, high = _over_rounding(equation, inputs)
    meets = printed.interval[0] <= high and low <= printed.interval[1]
    return AuditItem(
        item=name,
        printed=printed.value,
        unit=unit,
        verdict=Verdict.REPRODUCED if meets else Verdict.NOT_REPRODUCIBLE,
        computed=value,
        low=low,
        high=high,
        formula=formula,
        remark=remark,
    )


def _over_rounding(equation: Equation, inputs: Sequence[Printed]) -> tuple[float, float, float]:
    """Return the equation's value at the printed inputs, and its extremes over their rounding."""
    extremes = equation(*np.array(list(product(*(number.interval for number in inputs)))).T)
    value = equation(*(as_float_array(number.value) for number in inputs))
    return float(value), float(extremes.min()), float(extremes.max())
