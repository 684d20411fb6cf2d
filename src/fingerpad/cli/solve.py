"""The contact of a whole pad, solved on a grid, beside Hertz theory."""

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

from fingerpad._json import plain
from fingerpad.cli.shared import AsJson, print_json, require_positive
from fingerpad.exceptions import ConvergenceError, GeometryError
from fingerpad.units import KPA_PER_MPA

if TYPE_CHECKING:
    from fingerpad.contact import ContactSolution, HertzContact, HertzGeometry

_ROUND = 0.999  # axis ratio above which an ellipse has no direction


def solve(
    semi_axes_mm: Annotated[
        tuple[float, float, float], typer.Option(help="Palmar, distal and radial-ulnar semi-axes, mm.")
    ],
    wedge_deg: Annotated[
        float, typer.Option(min=0, max=90, help="Wedge angle, degrees: 0 is flat, 90 on the fingertip.")
    ],
    modulus_kpa: Annotated[float, typer.Option(help="Young's modulus E of the tissue, kPa.")],
    roll_deg: Annotated[
        float, typer.Option(min=-360, max=360, help="Roll about the finger's long axis, degrees.")
    ] = 0.0,
    poisson_ratio: Annotated[
        float, typer.Option(min=0, max=0.5, help="Poisson's ratio of the tissue.")
    ] = 0.5,
    thickness_mm: Annotated[
        float | None,
        typer.Option(help="Effective thickness of the tissue over bone, mm.", show_default="half-space"),
    ] = None,
    load_n: Annotated[float | None, typer.Option(help="Normal force, N.")] = None,
    area_mm2: Annotated[float | None, typer.Option(help="Contact area, mm², instead of --load-n.")] = None,
    indentation_mm: Annotated[
        float | None, typer.Option(help="Indentation, mm, instead of --load-n.")
    ] = None,
    grid: Annotated[int, typer.Option(min=64, max=1024, help="Grid cells along each side.")] = 256,
    as_json: AsJson = False,
) -> None:
    """Press a whole ellipsoidal pad against a flat plate, on deep tissue or on a layer over bone.

    Hertz theory answers the same question beside it. The long axis lies along the first principal
    direction, the one nearer to the finger's axis, along the second, or along either.
    """
    from fingerpad.contact import EllipsoidContact, HertzGeometry, reduced_modulus
    from fingerpad.geometry import Ellipsoid, Placement

    given = {"--load-n": load_n, "--area-mm2": area_mm2, "--indentation-mm": indentation_mm}
    if sum(value is not None for value in given.values()) != 1:
        raise typer.BadParameter("give exactly one of --load-n, --area-mm2 and --indentation-mm")
    for flag, value in {**given, "--modulus-kpa": modulus_kpa, "--thickness-mm": thickness_mm}.items():
        require_positive(flag, value)
    for semi_axis in semi_axes_mm:
        require_positive("--semi-axes-mm", semi_axis)
    placement = Placement(
        Ellipsoid(*semi_axes_mm), wedge_angle=np.radians(wedge_deg), roll_angle=np.radians(roll_deg)
    )
    modulus = float(reduced_modulus(modulus_kpa / KPA_PER_MPA, poisson_ratio))
    try:
        solution = EllipsoidContact.of(
            placement.ellipsoid,
            wedge_angle=float(placement.wedge_angle),
            roll_angle=float(placement.roll_angle),
            reduced_modulus=modulus,
            thickness=thickness_mm,
            poisson_ratio=poisson_ratio,
            load=load_n,
            area=area_mm2,
            indentation=indentation_mm,
            points=grid,
        ).solution
    except (ConvergenceError, GeometryError) as error:
        ((flag, value),) = ((flag, value) for flag, value in given.items() if value is not None)
        way_out = "; try another --grid" if isinstance(error, ConvergenceError) else ""
        raise type(error)(f"{flag} {value:g}: {error}{way_out}") from None
    geometry = HertzGeometry(*placement.curvature.principal_radii)
    solved = _solved_record(solution)
    record = {
        **solved,
        "hertz": _hertz_record(
            geometry, _hertz_contact(geometry, modulus, load_n, area_mm2, indentation_mm), solved
        ),
    }
    if as_json:
        print_json(record)
    else:
        _print_table(record)


def _hertz_contact(
    geometry: "HertzGeometry",
    modulus: float,
    load: float | None,
    area: float | None,
    indentation: float | None,
) -> "HertzContact":
    """Return Hertz theory's contact for the quantity that is given."""
    if load is not None:
        return geometry.under_load(load, reduced_modulus=modulus)
    if area is not None:
        return geometry.at_area(area, reduced_modulus=modulus)
    assert indentation is not None
    return geometry.at_indentation(indentation, reduced_modulus=modulus)


def _solved_record(solution: "ContactSolution") -> dict[str, Any]:
    across = abs(solution.long_axis_angle) > math.pi / 4
    return {
        **_sizes(solution),
        "long_axis_along": "either" if solution.axis_ratio > _ROUND else "second" if across else "first",
        "indentation_mm": solution.indentation,
        "area_over_pi_indentation_mm": solution.area_over_pi_indentation,
        "peak_pressure_kpa": KPA_PER_MPA * solution.peak_pressure,
        "relative_error_estimate": solution.relative_error,
    }


def _hertz_record(
    geometry: "HertzGeometry", contact: "HertzContact", solved: Mapping[str, Any]
) -> dict[str, Any]:
    """Return Hertz theory's answer; its error is the largest departure from the solved contact."""
    record = {
        **_sizes(contact),
        "long_axis_along": {0.0: "first", 1.0: "second"}.get(float(geometry.long_axis), "either"),
        "indentation_mm": contact.indentation,
        "area_over_pi_indentation_mm": contact.area / (math.pi * contact.indentation),
        "peak_pressure_kpa": KPA_PER_MPA * contact.peak_pressure,
    }
    departures = [abs(record[key] / solved[key] - 1) for key in ("load_N", "area_mm2", "indentation_mm")]
    return {**record, "relative_error_estimate": max(departures)}


def _sizes(contact: "ContactSolution | HertzContact") -> dict[str, Any]:
    return {
        "load_N": contact.load,
        "area_mm2": contact.area,
        "semi_major_mm": contact.semi_major,
        "semi_minor_mm": contact.semi_minor,
        "aspect_ratio": contact.semi_major / contact.semi_minor,
    }


def _print_table(record: Mapping[str, Any]) -> None:
    """Print the solved contact and the other answers, a column each."""
    others = {name: value for name, value in plain(record).items() if isinstance(value, dict)}
    typer.echo(f"{'':<28}" + "".join(f"{title:<16}" for title in ("solved", *others)).rstrip())
    for key, value in plain(record).items():
        if key not in others:
            values = (value, *(other[key] for other in others.values()))
            typer.echo(f"{key:<28}" + "".join(f"{_text(each):<16}" for each in values).rstrip())


def _text(value: str | float | None) -> str:
    if value is None:
        return "not known"
    return f"{value:.5g}" if isinstance(value, float) else value
