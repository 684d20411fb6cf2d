"""The contact of a whole pad, solved on a grid, beside fast laws and Hertz theory."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import typer

from fingerpad._json import plain
from fingerpad.cli.shared import (
    AsJson,
    Grid,
    Pressed,
    contact_record,
    placement_of,
    pressed_of,
    print_json,
    print_law_flag,
    print_side_by_side,
    takes,
    tissue_of,
)
from fingerpad.exceptions import ConvergenceError, GeometryError

if TYPE_CHECKING:
    from fingerpad.contact import Tissue
    from fingerpad.geometry import Placement


@takes(placement=placement_of, tissue=tissue_of, pressed=pressed_of)
def solve(
    *,
    placement: "Placement",
    tissue: "Tissue",
    pressed: Pressed,
    grid: Grid = 256,
    as_json: AsJson = False,
) -> None:
    """Press a whole ellipsoidal pad against a flat plate, on deep tissue or on a layer over bone.

    Fast laws and Hertz theory answer the same question beside it. The laws are flagged, and say nothing,
    beyond their range; the error of Hertz theory is its departure from the solved contact, and its flag
    says where it ignores a thickness that matters. The long axis lies along the first principal
    direction, the one nearer to the finger's axis, along the second, or along either.
    """
    from fingerpad.contact import fast_contact, hertz_contact, solve_contact
    from fingerpad.contact.fast_laws import ERROR_OF_BOTH, ERROR_OF_PAD

    try:
        solved = solve_contact(placement, tissue, **pressed.given, points=grid)
    except (ConvergenceError, GeometryError) as error:
        way_out = "; try another --grid" if isinstance(error, ConvergenceError) else ""
        raise type(error)(f"{pressed}: {error}{way_out}") from None
    fast = fast_contact(placement, tissue, **pressed.given)
    hertz = hertz_contact(placement, tissue, **pressed.given)
    flag, error_of_laws = str(fast.flags), ERROR_OF_PAD if tissue.is_deep else ERROR_OF_BOTH
    departures = (
        abs(getattr(hertz, name) / getattr(solved, name) - 1) for name in ("load", "area", "indentation")
    )
    record = {
        **contact_record(solved),
        "relative_error_estimate": solved.relative_error,
        "fast": {
            **contact_record(fast),
            "relative_error_estimate": None if flag else error_of_laws,
            "flag": flag or None,
        },
        "hertz": {
            **contact_record(hertz),
            "relative_error_estimate": max(departures),
            "flag": str(hertz.flags) or None,
        },
    }
    if as_json:
        print_json(record)
    else:
        _print_table(record)


def _print_table(record: Mapping[str, Any]) -> None:
    """Print the solved contact and the other answers, a column each."""
    plainly = plain(record)
    others = {name: plainly.pop(name) for name in ("fast", "hertz")}
    print_side_by_side({"solved": plainly, **others})
    print_law_flag(others["fast"]["flag"])
    if others["hertz"]["flag"] == "thickness_ignored":
        typer.echo("Hertz theory takes the layer for deep tissue")
