"""Commands of the model: where a pad touches, its contact by each theory, and the article's numbers."""

import math
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, TypeAlias

import numpy as np
import typer
from typer import Option

import fingerpad as fp
from fingerpad._files import make_folder
from fingerpad._json import plain
from fingerpad._plausible import load_doubts
from fingerpad.cli import options, show
from fingerpad.exceptions import ConvergenceError, GeometryError
from fingerpad.units import KPA_PER_MPA

if TYPE_CHECKING:
    from fingerpad._arrays import FloatArray
    from fingerpad.contact import ContactField
    from fingerpad.published import AuditItem

# Depths of receptors in the fingertip, mm, as the literature has them; they vary from person to person.
RECEPTORS: Final = {"Meissner": (0.5, 0.7), "Merkel": (0.7, 1.0), "Pacinian": (1.5, 2.5)}
_DEFAULT_DEPTHS: Final = (0.5, 0.7, 1.0, 1.5, 2.0, 2.5)
_COMPONENTS: Final = {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}
# Of the table of a field: heading and key.
_FIELD_COLUMNS: Final = {
    "xx": "stress_xx_kpa",
    "yy": "stress_yy_kpa",
    "zz": "stress_zz_kpa",
    "shear": "maximum_shear_kpa",
    "energy": "strain_energy_density_kJ_per_m3",
    "strain_zz": "strain_zz",
}

Load: TypeAlias = Annotated[float | None, options.positive("Normal force, N.")]
Area: TypeAlias = Annotated[float | None, options.positive("Contact area, mm², instead of --load-n.")]
Indentation: TypeAlias = Annotated[float | None, options.positive("Indentation, mm, instead of --load-n.")]
Grid: TypeAlias = Annotated[int, Option(min=64, max=1024, help="Grid cells along each side.")]
_FLAGS: Final = {"load": "--load-n", "area": "--area-mm2", "indentation": "--indentation-mm"}
_ROUND: Final = 1.001  # aspect ratio below which an ellipse has no direction


def only_one(**given: float | None) -> dict[str, float]:
    """Return which of load, area and indentation is given: exactly one must be."""
    found = {name: value for name, value in given.items() if value is not None}
    if len(found) != 1:
        *most, last = (_FLAGS[name] for name in given)
        raise typer.BadParameter(f"give exactly one of {', '.join(most)} and {last}")
    return found


def pressed_of(
    *, load_n: Load = None, area_mm2: Area = None, indentation_mm: Indentation = None
) -> dict[str, float]:
    """Return how a pad is pressed."""
    return only_one(load=load_n, area=area_mm2, indentation=indentation_mm)


def pressed_record(contact: "fp.Contact") -> dict[str, Any]:
    """Return how a pad is pressed."""
    return {
        "load_N": contact.load,
        "area_mm2": contact.area,
        "indentation_mm": contact.indentation,
        "area_over_pi_indentation_mm": contact.area_over_pi_indentation,
    }


def contact_record(contact: "fp.Contact") -> dict[str, Any]:
    """Return one contact, in mm, N and kPa; the long axis lies along either direction of a near-circle."""
    along = "either" if contact.aspect_ratio < _ROUND else "first" if contact.along else "second"
    return {
        **pressed_record(contact),
        "semi_major_mm": contact.semi_major,
        "semi_minor_mm": contact.semi_minor,
        "aspect_ratio": contact.aspect_ratio,
        "long_axis_along": along if contact.load > 0 else None,
        "peak_pressure_kpa": KPA_PER_MPA * contact.peak_pressure,
    }


def print_side_by_side(records: Mapping[str, Mapping[str, Any]]) -> None:
    """Print records, a column each, with the lines of the first."""
    columns = [plain(record) for record in records.values()]
    lines = ([key, *(_cell(column[key]) for column in columns)] for key in columns[0])
    show.rows([["", *records], *lines])


def _cell(value: str | float | None) -> str:
    if value is None:
        return "–"
    return f"{value:.5g}" if isinstance(value, float) else value


def print_flags(fast: str | None, hertz: str | None) -> None:
    """Say what takes a contact out of the range of the fast laws, and where Hertz theory ignores a layer."""
    if fast:
        typer.echo(f"The fast laws do not hold here: {fast.replace('_', ' ')}")
    if hertz == "thickness_ignored":
        typer.echo("Hertz theory takes the layer for deep tissue")


def print_if_too_large(size: float) -> None:
    """Say of a contact as wide as the bodies, by its a/R, that Hertz theory does not hold for it."""
    from fingerpad.contact.hertz import WIDEST

    if size > WIDEST:
        typer.echo(
            f"Hertz theory does not hold here: the contact's radius is {size:.2g} times that of curvature; "
            f"beyond {WIDEST:.1f} not even the error is known: check load, modulus and units"
        )


@options.takes(placement=options.placement_of)
def geometry(*, placement: "fp.Placement", as_json: options.AsJson = False) -> None:
    """Find where a pad on a wedge touches the platen, and how it is curved there.

    u and v are the parametric angles of the place of contact. The in-plane radius is that along the finger,
    the transverse one that across it. The mean-curvature radius 1/H is R_0g of Dzidek et al. (2017), to be
    corrected by `fingerpad correct`; the geometric mean of the principal radii is that of Hertz theory.
    """
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
        "principal_radii_mm": np.array(curvature.principal_radii),
        "principal_directions": curvature.principal_directions,
    }
    show.result(record, as_json)


def hertz(
    radii_mm: Annotated[tuple[float, float], options.positive("Relative principal radii of curvature, mm.")],
    reduced_modulus_kpa: Annotated[float, options.positive("Reduced modulus E*, kPa.")],
    load_n: Load = None,
    indentation_mm: Indentation = None,
    thickness_mm: options.Thickness = None,
    poisson_ratio: Annotated[
        float, Option(min=0, max=0.5, help="Poisson's ratio, which matters to a layer alone.")
    ] = 0.5,
    as_json: options.AsJson = False,
) -> None:
    """Solve the elliptical Hertz contact under a load, or at an indentation.

    With a thickness, also the contact of the same paraboloid on a layer of tissue over bone, by fast laws.
    """
    from fingerpad.contact import indentation_factor, size_factor

    pressed = only_one(load=load_n, indentation=indentation_mm)
    bodies, modulus = fp.Paraboloid(*radii_mm), reduced_modulus_kpa / KPA_PER_MPA
    contact = fp.hertz_contact(bodies, fp.Tissue.of_reduced_modulus(modulus), **pressed)
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
        layer = fp.Tissue.of_reduced_modulus(modulus, poisson_ratio, thickness_mm)
        on_layer = fp.fast_contact(bodies, layer, **pressed)
        flag = str(on_layer.flags)
        record["on_layer"] = pressed_record(on_layer) | ({"flag": flag or None} if as_json or flag else {})
    show.result(record, as_json)
    if not as_json:
        print_if_too_large(size)


@options.takes(placement=options.placement_of)
def modulus(
    *,
    placement: "fp.Placement",
    load_n: Annotated[float, options.positive("Normal force, N.")],
    poisson_ratio: options.PoissonRatio = 0.5,
    thickness_mm: options.Thickness = None,
    area_mm2: Annotated[float | None, options.positive("Contact area, mm².")] = None,
    indentation_mm: Annotated[
        float | None, options.positive("Indentation, mm, instead of --area-mm2.")
    ] = None,
    as_json: options.AsJson = False,
) -> None:
    """Find Young's modulus from a load and the contact area or the indentation.

    The whole ellipsoid, on deep tissue or on a layer over bone, by fast laws, beside Hertz theory. The laws
    are flagged, and say nothing, beyond their range.
    """
    from fingerpad.contact.contact import from_reduced_modulus
    from fingerpad.contact.fast_laws import find_modulus, plate_gap

    given = {"load": load_n, **only_one(area=area_mm2, indentation=indentation_mm)}
    gap = plate_gap(placement)
    paraboloid = plate_gap(fp.Paraboloid(gap.first_radius, gap.second_radius))
    records, flag = [], ""
    for of, thickness in ((paraboloid, None), (gap, thickness_mm)):
        reduced, contact = find_modulus(of, **given, thickness=thickness, poisson_ratio=poisson_ratio)
        flag = str(contact.flags)
        records.append(
            {
                **pressed_record(contact),
                "reduced_modulus_kpa": KPA_PER_MPA * reduced,
                "youngs_modulus_kpa": KPA_PER_MPA * from_reduced_modulus(reduced, poisson_ratio),
            }
        )
    by_hertz, whole = records
    tissue = fp.Tissue(1.0, poisson_ratio, thickness_mm or math.inf)
    by_hertz["flag"] = str(fp.hertz_contact(placement, tissue, area=by_hertz["area_mm2"]).flags) or None
    for doubt in load_doubts(load_n, by_hertz["youngs_modulus_kpa"]):
        show.note(doubt)

    def print_table(_: Mapping[str, Any]) -> None:
        print_side_by_side({"whole pad": whole, "Hertz": by_hertz})
        print_flags(flag, by_hertz["flag"])
        area = by_hertz["area_mm2"] / math.pi
        print_if_too_large(math.sqrt(area / (gap.first_radius * gap.second_radius)))

    record = {**whole, "flag": flag or None, "thickness_mm": thickness_mm, "hertz": by_hertz}
    show.result(record, as_json, print_table)


@options.takes(placement=options.placement_of, tissue=options.tissue_of, pressed=pressed_of)
def solve(
    *,
    placement: "fp.Placement",
    tissue: "fp.Tissue",
    pressed: dict[str, float],
    grid: Grid = 256,
    as_json: options.AsJson = False,
) -> None:
    """Press a whole ellipsoidal pad against a flat plate, on deep tissue or on a layer over bone.

    Fast laws and Hertz theory answer the same question beside it. The laws are flagged, and say nothing,
    beyond their range; the error of Hertz theory is its departure from the solved contact, and its flag
    says where it ignores a thickness that matters. The long axis lies along the first principal
    direction, the one nearer to the finger's axis, along the second, or along either.
    """
    from fingerpad.contact.fast_laws import ERROR_OF_BOTH, ERROR_OF_PAD

    try:
        solved = fp.solve_contact(placement, tissue, **pressed, points=grid)
    except (ConvergenceError, GeometryError) as error:
        way_out = "; try another --grid" if isinstance(error, ConvergenceError) else ""
        ((name, value),) = pressed.items()
        raise type(error)(f"{_FLAGS[name]} {value:g}: {error}{way_out}") from None
    fast = fp.fast_contact(placement, tissue, **pressed)
    by_hertz = fp.hertz_contact(placement, tissue, **pressed)
    error_of_laws = None if str(fast.flags) else ERROR_OF_PAD if tissue.is_deep else ERROR_OF_BOTH
    departure = max(
        abs(getattr(by_hertz, name) / getattr(solved, name) - 1) for name in ("load", "area", "indentation")
    )
    record = {**contact_record(solved), "relative_error_estimate": solved.relative_error}
    for name, contact, off in (("fast", fast, error_of_laws), ("hertz", by_hertz, departure)):
        flag = str(contact.flags) or None
        record[name] = {**contact_record(contact), "relative_error_estimate": off, "flag": flag}
    show.result(record, as_json, _print_solved)


def _print_solved(record: Mapping[str, Any]) -> None:
    """Print the solved contact and the other answers, a column each."""
    plainly = plain(record)
    others = {name: plainly.pop(name) for name in ("fast", "hertz")}
    print_side_by_side({"solved": plainly, **others})
    print_flags(others["fast"]["flag"], others["hertz"]["flag"])


@options.takes(placement=options.placement_of, tissue=options.tissue_of, pressed=pressed_of)
def fields(
    *,
    placement: "fp.Placement",
    tissue: "fp.Tissue",
    pressed: dict[str, float],
    depth_mm: Annotated[
        list[float] | None,
        Option(
            help="Depths below the surface, mm: one or more. By default those of receptors in the "
            "literature, which vary: Meissner 0.5-0.7, Merkel 0.7-1, Pacinian 1.5-2.5.",
            show_default=False,
        ),
    ] = None,
    grid: Grid = 256,
    plot: Annotated[
        Path | None, Option(help="Folder for the section under the contact, as SVG and PNG.")
    ] = None,
    as_json: options.AsJson = False,
) -> None:
    """Find stress and strain below the place of first contact, by Hertz theory and for the whole pad.

    In names of components x is along the finger, y across, z into the tissue; tension is positive. Hertz
    theory is that of a half-space, under the same load, area or indentation.
    """
    from fingerpad.contact import ContactField

    depths = _depths(depth_mm, float(tissue.thickness))
    by_hertz = ContactField.of_hertz(placement, tissue, **pressed)
    solved = ContactField.of_solution(fp.solve_contact(placement, tissue, **pressed, points=grid))
    record = _field_record(solved, depths) | {
        "thickness_mm": None if tissue.is_deep else tissue.thickness,
        "hertz": _field_record(by_hertz, depths),
    }
    if plot is not None:
        from fingerpad.figures import save_figure, section_figure

        make_folder(plot)
        words = "Contact pressure and maximum shear stress in the section along the finger."
        drawn = section_figure(solved, hertz=by_hertz, receptors=RECEPTORS)
        for kind in ("svg", "png"):
            save_figure(drawn, plot / f"section.{kind}", description=words)
    show.result(record, as_json, _print_fields)


def _depths(given: list[float] | None, thickness: float) -> "FloatArray":
    """Return the given depths in ascending order, or those of receptors as far as there is tissue."""
    if not given:
        return np.unique([min(depth, thickness) for depth in _DEFAULT_DEPTHS])
    for depth in given:
        if not 0 <= depth <= thickness:
            bone = "" if np.isinf(thickness) else f" and at most --thickness-mm {thickness:g}"
            raise GeometryError(f"--depth-mm must be at least 0{bone}, found {depth:g}")
    return np.unique(given)


def _field_record(field: "ContactField", depths: "FloatArray") -> dict[str, Any]:
    """Return a contact and the field on its axis, a list of one value for each depth."""
    stress = field.stress_on_axis(depths)
    strain = field.strain(stress)
    highest, where = field.highest_shear_on_axis()
    return {
        **pressed_record(field.contact),
        "peak_pressure_kpa": KPA_PER_MPA * field.contact.peak_pressure,
        "highest_shear_on_axis_kpa": KPA_PER_MPA * highest,
        "highest_shear_on_axis_depth_mm": where,
        "depth_mm": depths,
        **{f"stress_{name}_kpa": KPA_PER_MPA * stress.tensor[:, *ij] for name, ij in _COMPONENTS.items()},
        "principal_stresses_kpa": KPA_PER_MPA * stress.principal,
        "maximum_shear_kpa": KPA_PER_MPA * stress.maximum_shear,
        **{f"strain_{name}": strain[:, *ij] for name, ij in _COMPONENTS.items()},
        "principal_strains": np.linalg.eigvalsh(strain),
        "strain_energy_density_kJ_per_m3": KPA_PER_MPA * field.strain_energy_density(stress),
    }


def _print_fields(record: dict[str, Any]) -> None:
    """Print the contacts side by side, and the field on both axes as tables."""
    by_hertz = record["hertz"]
    both = {"whole pad": {key: record[key] for key in by_hertz}, "Hertz": by_hertz}
    print_side_by_side(
        {of: {key: value for key, value in one.items() if np.ndim(value) == 0} for of, one in both.items()}
    )
    for title, one in both.items():
        typer.echo(f"\n{title}, below the place of first contact: stresses in kPa, energy in kJ/m³")
        rows = [["depth_mm", *_FIELD_COLUMNS, "receptors"]]
        for index, depth in enumerate(one["depth_mm"]):
            values = (f"{one[key][index]:.4g}" for key in _FIELD_COLUMNS.values())
            here = ", ".join(name for name, (low, high) in RECEPTORS.items() if low <= depth <= high)
            rows.append([f"{depth:.4g}", *values, here])
        show.rows(rows)
    typer.echo("\nStresses in kPa, energy in kJ/m³; --json gives all components, and strains.")
    typer.echo("Depths of receptors vary between people; those named here are from the literature.")


def correct(
    ellipse_mm: Annotated[
        tuple[float, float], options.positive("Semi-major and semi-minor axis of the contact, mm.")
    ],
    radius_mm: Annotated[float, options.positive("Radius of curvature of the undeformed pad, mm.")],
    as_json: options.AsJson = False,
) -> None:
    """Correct a radius of curvature for the observed contact ellipse.

    Of the ellipse only the ratio of its axes matters. radius_from_indentation_mm is the corrected radius of
    Dzidek et al. (2017): that of a sphere of the same indentation under the same load; _from_area_mm has the
    same area under the same load, and _from_compliance_mm the same area at the same indentation, to be
    compared with R_g of a loading curve. K and E are the complete elliptic integrals at the eccentricity, F1
    and F2 the factors of Hertz theory. With uncertainties: `fingerpad run`.
    """
    from fingerpad import contact

    observed = fp.Ellipse(*ellipse_mm)
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
    show.result(record, as_json)


def reproduce(
    figures: Annotated[
        Path | None, Option(help="Folder for Fig. 1 of Dzidek et al. (2017), 4, 5 and 6, as SVG and PNG.")
    ] = None,
    as_json: options.AsJson = False,
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
            for kind in ("svg", "png"):
                save_figure(figure, figures / f"{name}.{kind}", description=caption)
    show.result([asdict(item) for item in items], as_json, lambda _: _print_audit(items))
    show.folder("Figures", figures, as_json)


def _print_audit(items: "list[AuditItem]") -> None:
    rows = [("item", "printed", "computed", "unit", "verdict")]
    for item in items:
        printed = "–" if item.printed is None else f"{item.printed:.1f}"
        computed = "–" if item.computed is None else f"{item.computed:.2f}"
        verdict = f"{item.verdict} (measured)" if item.computed is None else item.verdict
        rows.append((item.item, f"{printed:>7}", f"{computed:>8}", item.unit, verdict))
    show.rows(rows)
