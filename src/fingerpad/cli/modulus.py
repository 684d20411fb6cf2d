"""The command that finds a pad's modulus from a load and the contact area or indentation under it."""

from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

from fingerpad.cli.shared import (
    AsJson,
    RollAngle,
    SemiAxes,
    Thickness,
    WedgeAngle,
    checked_pad,
    only_one,
    pressed_record,
    print_json,
    print_law_flag,
    print_side_by_side,
    require_positive,
)
from fingerpad.units import KPA_PER_MPA

if TYPE_CHECKING:
    from fingerpad.contact import LayeredContact


def modulus(
    semi_axes_mm: SemiAxes,
    wedge_deg: WedgeAngle,
    load_n: Annotated[float, typer.Option(help="Normal force, N.")],
    roll_deg: RollAngle = 0.0,
    poisson_ratio: Annotated[
        float, typer.Option(min=0, max=0.5, help="Poisson's ratio of the tissue.")
    ] = 0.5,
    thickness_mm: Thickness = None,
    area_mm2: Annotated[float | None, typer.Option(help="Contact area, mm².")] = None,
    indentation_mm: Annotated[
        float | None, typer.Option(help="Indentation, mm, instead of --area-mm2.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Find Young's modulus from a load and the contact area or the indentation.

    The whole ellipsoid, on deep tissue or on a layer over bone, by fast laws, beside Hertz theory. The laws
    are flagged, and say nothing, beyond their range.
    """
    from fingerpad.contact.layered import layered_contact_kernel
    from fingerpad.contact.pad_gap import PadGap

    only_one({"--area-mm2": area_mm2, "--indentation-mm": indentation_mm})
    for flag, value in (("--load-n", load_n), ("--thickness-mm", thickness_mm)):
        require_positive(flag, value)
    gap = PadGap.of(
        checked_pad(semi_axes_mm), wedge_angle=np.radians(wedge_deg), roll_angle=np.radians(roll_deg)
    )
    paraboloid = PadGap.paraboloid(gap.first_radius, gap.second_radius)
    pressed: dict[str, Any] = {
        "poisson_ratio": poisson_ratio,
        "load": load_n,
        "area": area_mm2,
        "indentation": indentation_mm,
    }
    whole, hertz = (
        _record(layered_contact_kernel(gap, thickness=thickness, **pressed))
        for gap, thickness in ((gap, thickness_mm), (paraboloid, None))
    )
    hertz.pop("flag")
    if as_json:
        print_json({**whole, "thickness_mm": thickness_mm, "hertz": hertz})
    else:
        flag = whole.pop("flag")
        print_side_by_side({"whole pad": whole, "Hertz": hertz})
        print_law_flag(flag)


def _record(contact: "LayeredContact") -> dict[str, Any]:
    flag = str(contact.flag)
    return {
        **pressed_record(contact),
        "reduced_modulus_kpa": KPA_PER_MPA * contact.reduced_modulus,
        "youngs_modulus_kpa": KPA_PER_MPA * contact.youngs_modulus,
        "flag": flag or None,
    }
