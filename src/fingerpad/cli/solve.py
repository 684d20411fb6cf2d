"""The contact of a whole pad, solved on a grid, beside fast laws and Hertz theory."""

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

from fingerpad._json import plain
from fingerpad.cli.shared import (
    Area,
    AsJson,
    Grid,
    Indentation,
    Load,
    RollAngle,
    SemiAxes,
    Thickness,
    WedgeAngle,
    YoungsModulus,
    checked_pad,
    only_one,
    pressed_record,
    print_json,
    print_law_flag,
    print_side_by_side,
    require_positive,
)
from fingerpad.exceptions import ConvergenceError, GeometryError
from fingerpad.units import KPA_PER_MPA

if TYPE_CHECKING:
    from fingerpad.contact import ContactSolution, HertzContact
    from fingerpad.geometry import Placement

_ROUND = 0.999  # axis ratio above which an ellipse has no direction


def solve(
    semi_axes_mm: SemiAxes,
    wedge_deg: WedgeAngle,
    youngs_modulus_kpa: YoungsModulus,
    roll_deg: RollAngle = 0.0,
    poisson_ratio: Annotated[
        float, typer.Option(min=0, max=0.5, help="Poisson's ratio of the tissue.")
    ] = 0.5,
    thickness_mm: Thickness = None,
    load_n: Load = None,
    area_mm2: Area = None,
    indentation_mm: Indentation = None,
    grid: Grid = 256,
    as_json: AsJson = False,
) -> None:
    """Press a whole ellipsoidal pad against a flat plate, on deep tissue or on a layer over bone.

    Fast laws and Hertz theory answer the same question beside it. The laws are flagged, and say nothing,
    beyond their range; the error of Hertz theory is its departure from the solved contact. The long axis
    lies along the first principal direction, the one nearer to the finger's axis, along the second, or
    along either.
    """
    from fingerpad.contact import reduced_modulus
    from fingerpad.geometry import Placement

    given = {"--load-n": load_n, "--area-mm2": area_mm2, "--indentation-mm": indentation_mm}
    flag = only_one(given)
    for name, value in (("--youngs-modulus-kpa", youngs_modulus_kpa), ("--thickness-mm", thickness_mm)):
        require_positive(name, value)
    placement = Placement(
        checked_pad(semi_axes_mm), wedge_angle=np.radians(wedge_deg), roll_angle=np.radians(roll_deg)
    )
    modulus = float(reduced_modulus(youngs_modulus_kpa / KPA_PER_MPA, poisson_ratio))
    body = {"thickness": thickness_mm, "poisson_ratio": poisson_ratio}
    wanted = _only_given({"load": load_n, "area": area_mm2, "indentation": indentation_mm})
    try:
        solved = _solved_record(placement, modulus, body, wanted, grid)
    except (ConvergenceError, GeometryError) as error:
        way_out = "; try another --grid" if isinstance(error, ConvergenceError) else ""
        raise type(error)(f"{flag} {given[flag]:g}: {error}{way_out}") from None
    record = {
        **solved,
        "fast": _fast_record(placement, modulus, body, wanted),
        "hertz": _hertz_record(placement, modulus, wanted, solved),
    }
    if as_json:
        print_json(record)
    else:
        _print_table(record)


def _only_given(values: Mapping[str, float | None]) -> dict[str, float]:
    return {name: value for name, value in values.items() if value is not None}


def _solved_record(
    placement: "Placement",
    modulus: float,
    body: Mapping[str, Any],
    wanted: Mapping[str, Any],
    grid: int,
) -> dict[str, Any]:
    from fingerpad.contact import EllipsoidContact

    solution = EllipsoidContact.of(
        placement.ellipsoid,
        wedge_angle=float(placement.wedge_angle),
        roll_angle=float(placement.roll_angle),
        reduced_modulus=modulus,
        points=grid,
        **body,
        **wanted,
    ).solution
    turn = solution.long_axis_angle - solution.grid.angle  # the grid lies along the principal directions
    return {
        **_sizes(solution),
        "long_axis_along": _long_axis(solution.axis_ratio, abs(math.sin(turn)) > abs(math.cos(turn))),
        "peak_pressure_kpa": KPA_PER_MPA * solution.peak_pressure,
        "relative_error_estimate": solution.relative_error,
    }


def _fast_record(
    placement: "Placement", modulus: float, body: Mapping[str, Any], wanted: Mapping[str, Any]
) -> dict[str, Any]:
    """Return the laws' answer, and what takes it out of their range."""
    from fingerpad.contact import PadGap, fast_contact, fast_ellipse
    from fingerpad.contact.fast_laws import ERROR_OF_BOTH, ERROR_OF_PAD

    gap = PadGap.of(placement.ellipsoid, wedge_angle=placement.wedge_angle, roll_angle=placement.roll_angle)
    contact = fast_contact(gap, reduced_modulus=modulus, **body, **wanted)
    form = fast_ellipse(gap, area=contact.area, **body)
    ratio = form.semi_major / form.semi_minor
    flag = str(contact.flag)
    return {
        **pressed_record(contact),
        "semi_major_mm": form.semi_major,
        "semi_minor_mm": form.semi_minor,
        "aspect_ratio": ratio,
        "long_axis_along": None if flag else _long_axis(float(1 / ratio), bool(form.long_axis)),
        "peak_pressure_kpa": KPA_PER_MPA * form.peak_over_mean_pressure * contact.load / contact.area,
        "relative_error_estimate": None
        if flag
        else ERROR_OF_PAD
        if body["thickness"] is None
        else ERROR_OF_BOTH,
        "flag": flag or None,
    }


def _hertz_record(
    placement: "Placement", modulus: float, wanted: Mapping[str, Any], solved: Mapping[str, Any]
) -> dict[str, Any]:
    """Return Hertz theory's answer; its error is the largest departure from the solved contact."""
    from fingerpad.contact import HertzGeometry
    from fingerpad.contact.ellipsoid_contact import hertz_contact_at

    geometry = HertzGeometry(*placement.curvature.principal_radii)
    contact = hertz_contact_at(geometry, modulus, *map(wanted.get, ("load", "indentation", "area")))
    record = {
        **_sizes(contact),
        "long_axis_along": _long_axis(float(geometry.axis_ratio), float(geometry.long_axis) == 1),
        "peak_pressure_kpa": KPA_PER_MPA * contact.peak_pressure,
    }
    departures = [abs(record[key] / solved[key] - 1) for key in ("load_N", "area_mm2", "indentation_mm")]
    return {**record, "relative_error_estimate": max(departures)}


def _long_axis(axis_ratio: float, along_second: bool) -> str:
    return "either" if axis_ratio > _ROUND else "second" if along_second else "first"


def _sizes(contact: "ContactSolution | HertzContact") -> dict[str, Any]:
    return {
        **pressed_record(contact),
        "semi_major_mm": contact.semi_major,
        "semi_minor_mm": contact.semi_minor,
        "aspect_ratio": contact.semi_major / contact.semi_minor,
    }


def _print_table(record: Mapping[str, Any]) -> None:
    """Print the solved contact and the other answers, a column each."""
    plainly = plain(record)
    others = {name: plainly.pop(name) for name in ("fast", "hertz")}
    print_side_by_side({"solved": plainly, **others})
    print_law_flag(others["fast"]["flag"])
