"""Commands of the model: geometry, hertz, correct, reproduce."""

import math
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer

from fingerpad._files import make_folder
from fingerpad.cli.shared import (
    AsJson,
    Indentation,
    Load,
    SemiAxes,
    Thickness,
    WedgeAngle,
    contact_record,
    only_one,
    placement_of,
    pressed_record,
    print_folder,
    print_if_too_large,
    print_json,
    print_record,
    print_rows,
    require_positive,
)
from fingerpad.units import KPA_PER_MPA

if TYPE_CHECKING:
    from fingerpad.published import AuditItem


def geometry(
    semi_axes_mm: SemiAxes,
    wedge_deg: WedgeAngle,
    roll_deg: Annotated[
        float | None, typer.Option(min=-90, max=90, help="Roll about the finger's long axis, degrees.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Find where a pad on a wedge touches the platen, and how it is curved there.

    u and v are the parametric angles of the place of contact. The in-plane radius is that along the finger,
    the transverse one that across it. The mean-curvature radius 1/H is R_0g of Dzidek et al. (2017), to be
    corrected by `fingerpad correct`; the geometric mean of the principal radii is that of Hertz theory.
    """
    placement = placement_of(semi_axes_mm=semi_axes_mm, wedge_deg=wedge_deg, roll_deg=roll_deg or 0.0)
    curvature = placement.curvature
    record = {
        "u_deg": np.degrees(placement.u),
        "v_deg": np.degrees(placement.v),
        "in_plane_radius_mm": curvature.in_plane_radius,
        "transverse_radius_mm": curvature.transverse_radius,
        "mean_curvature_radius_mm": curvature.mean_curvature_radius,
        "geometric_mean_radius_mm": curvature.geometric_mean_radius,
        "mean_curvature_per_mm": curvature.mean_curvature,
        "gaussian_curvature_per_mm2": curvature.gaussian_curvature,
        "point_mm": placement.point,
    }
    if roll_deg is not None:
        record |= {
            "principal_radii_mm": np.array(curvature.principal_radii),
            "principal_directions": curvature.principal_directions,
        }
    print_record(record, as_json)


def hertz(
    radii_mm: Annotated[tuple[float, float], typer.Option(help="Relative principal radii of curvature, mm.")],
    reduced_modulus_kpa: Annotated[float, typer.Option(help="Reduced modulus E*, kPa.")],
    load_n: Load = None,
    indentation_mm: Indentation = None,
    thickness_mm: Thickness = None,
    poisson_ratio: Annotated[
        float, typer.Option(min=0, max=0.5, help="Poisson's ratio, which matters to a layer alone.")
    ] = 0.5,
    as_json: AsJson = False,
) -> None:
    """Solve the elliptical Hertz contact under a load, or at an indentation.

    With a thickness, also the contact of the same paraboloid on a layer of tissue over bone, by fast laws.
    """
    from fingerpad.contact import Tissue, fast_contact, hertz_contact, indentation_factor, size_factor
    from fingerpad.geometry import Paraboloid

    only_one({"--load-n": load_n, "--indentation-mm": indentation_mm})
    for option, value in (("--reduced-modulus-kpa", reduced_modulus_kpa), ("--thickness-mm", thickness_mm)):
        require_positive(option, value)
    for radius in radii_mm:
        require_positive("--radii-mm", radius)
    bodies = Paraboloid(*radii_mm)
    modulus = reduced_modulus_kpa / KPA_PER_MPA
    pressed = {"load": load_n, "indentation": indentation_mm}
    contact = hertz_contact(bodies, Tissue.of_reduced_modulus(modulus), **pressed)
    size = math.sqrt(contact.semi_major * contact.semi_minor / math.prod(radii_mm))
    record = {
        **contact_record(contact),
        "mean_pressure_kpa": KPA_PER_MPA * contact.mean_pressure,
        "stiffness_N_per_mm": 1.5 * contact.load / contact.indentation,
        "F1": size_factor(1 / contact.aspect_ratio),
        "F2": indentation_factor(1 / contact.aspect_ratio),
        "contact_size": size,
    }
    if thickness_mm is not None:
        layer = Tissue.of_reduced_modulus(modulus, poisson_ratio, thickness_mm)
        on_layer = fast_contact(bodies, layer, **pressed)
        flag = str(on_layer.flags)
        record["on_layer"] = pressed_record(on_layer) | ({"flag": flag or None} if as_json or flag else {})
    print_record(record, as_json)
    if not as_json:
        print_if_too_large(size)


def correct(
    ellipse_mm: Annotated[
        tuple[float, float], typer.Option(help="Semi-major and semi-minor axis of the contact, mm.")
    ],
    radius_mm: Annotated[float, typer.Option(help="Radius of curvature of the undeformed pad, mm.")],
    as_json: AsJson = False,
) -> None:
    """Correct a radius of curvature for the observed contact ellipse.

    Of the ellipse only the ratio of its axes matters. radius_from_indentation_mm is the corrected radius of
    Dzidek et al. (2017): that of a sphere of the same indentation under the same load; _from_area_mm has the
    same area under the same load, and _from_compliance_mm the same area at the same indentation, to be
    compared with R_g of a loading curve. K and E are the complete elliptic integrals at the eccentricity, F1
    and F2 the factors of Hertz theory. With uncertainties: `fingerpad run`.
    """
    from fingerpad import contact
    from fingerpad.geometry import Ellipse

    for semi_axis in ellipse_mm:
        require_positive("--ellipse-mm", semi_axis)
    observed = Ellipse(*ellipse_mm)
    require_positive("--radius-mm", radius_mm)
    k = observed.axis_ratio
    first, b, d = contact.complete_integrals(k)
    record = {
        "eccentricity": observed.eccentricity,
        "K": first,
        "E": b + k**2 * d,
        "F1": contact.size_factor(k),
        "F2": contact.indentation_factor(k),
        "radius_from_indentation_mm": contact.equivalent_radius_from_indentation(radius_mm, k),
        "radius_from_area_mm": contact.equivalent_radius_from_area(radius_mm, k),
        "radius_from_compliance_mm": contact.equivalent_radius_from_compliance(radius_mm, k),
    }
    print_record(record, as_json)


def reproduce(
    figures: Annotated[
        Path | None,
        typer.Option(help="Folder for Fig. 1 of Dzidek et al. (2017), 4, 5 and 6, as SVG and PNG."),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Compute every number printed in Dzidek et al. (2017), and list which are reproduced.

    The last lines show what one layer of tissue over bone gives, its thickness fitted to both R_g.
    """
    from fingerpad.published import audit, layer_items

    items = audit() + layer_items()
    if figures is not None:
        from fingerpad.figures import dzidek2017_figures, save_figure

        make_folder(figures)
        for name, figure, caption in dzidek2017_figures():
            save_figure(figure, figures / name, description=caption)
    if as_json:
        print_json([asdict(item) for item in items])
    else:
        _print_audit(items)
    print_folder("Figures", figures, as_json)


def _print_audit(items: "list[AuditItem]") -> None:
    rows = [("item", "printed", "computed", "unit", "verdict")]
    for item in items:
        printed = "–" if item.printed is None else f"{item.printed:.1f}"
        computed = "–" if item.computed is None else f"{item.computed:.2f}"
        verdict = f"{item.verdict} (measured)" if item.computed is None else item.verdict
        rows.append((item.item, f"{printed:>7}", f"{computed:>8}", item.unit, verdict))
    print_rows(rows)
