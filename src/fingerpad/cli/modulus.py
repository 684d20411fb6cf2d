"""The command that finds a pad's modulus from a load and the contact area or indentation under it."""

import math
from typing import Annotated

import typer

from fingerpad._plausible import load_doubts
from fingerpad.cli.shared import (
    AsJson,
    PoissonRatio,
    RollAngle,
    SemiAxes,
    Thickness,
    WedgeAngle,
    only_one,
    placement_of,
    pressed_record,
    print_if_too_large,
    print_json,
    print_law_flag,
    print_note,
    print_side_by_side,
    require_positive,
)
from fingerpad.units import KPA_PER_MPA


def modulus(
    semi_axes_mm: SemiAxes,
    wedge_deg: WedgeAngle,
    load_n: Annotated[float, typer.Option(help="Normal force, N.")],
    roll_deg: RollAngle = 0.0,
    poisson_ratio: PoissonRatio = 0.5,
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
    from fingerpad.contact.contact import from_reduced_modulus
    from fingerpad.contact.fast_laws import find_modulus, plate_gap
    from fingerpad.geometry import Paraboloid

    only_one({"--area-mm2": area_mm2, "--indentation-mm": indentation_mm})
    for option, value in (("--load-n", load_n), ("--thickness-mm", thickness_mm)):
        require_positive(option, value)
    gap = plate_gap(placement_of(semi_axes_mm=semi_axes_mm, wedge_deg=wedge_deg, roll_deg=roll_deg))
    paraboloid = plate_gap(Paraboloid(gap.first_radius, gap.second_radius))
    records, flag = [], ""
    for of, thickness in ((paraboloid, None), (gap, thickness_mm)):
        reduced, contact = find_modulus(
            of,
            load=load_n,
            area=area_mm2,
            indentation=indentation_mm,
            thickness=thickness,
            poisson_ratio=poisson_ratio,
        )
        flag = str(contact.flags)
        records.append(
            {
                **pressed_record(contact),
                "reduced_modulus_kpa": KPA_PER_MPA * reduced,
                "youngs_modulus_kpa": KPA_PER_MPA * from_reduced_modulus(reduced, poisson_ratio),
            }
        )
    hertz, whole = records
    for doubt in load_doubts(load_n, hertz["youngs_modulus_kpa"]):
        print_note(doubt)
    if as_json:
        print_json({**whole, "flag": flag or None, "thickness_mm": thickness_mm, "hertz": hertz})
    else:
        print_side_by_side({"whole pad": whole, "Hertz": hertz})
        print_law_flag(flag)
        print_if_too_large(math.sqrt(hertz["area_mm2"] / math.pi / (gap.first_radius * gap.second_radius)))
