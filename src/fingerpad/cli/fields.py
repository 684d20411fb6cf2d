"""The command that tells the stress and strain under a contact."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import numpy as np
import typer

from fingerpad._files import make_folder
from fingerpad.cli.shared import (
    AsJson,
    Grid,
    Pressed,
    placement_of,
    pressed_of,
    pressed_record,
    print_json,
    takes,
    tissue_of,
)
from fingerpad.exceptions import GeometryError
from fingerpad.units import KPA_PER_MPA

if TYPE_CHECKING:
    from fingerpad._arrays import FloatArray
    from fingerpad.contact import ContactField, Tissue
    from fingerpad.geometry import Placement

# Depths of receptors in the fingertip, mm, as the literature has them; they vary from person to person.
RECEPTORS: Final = {"Meissner": (0.5, 0.7), "Merkel": (0.7, 1.0), "Pacinian": (1.5, 2.5)}
_DEFAULT_DEPTHS: Final = (0.5, 0.7, 1.0, 1.5, 2.0, 2.5)
_COMPONENTS: Final = {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}

# Heading, key and width.
_COLUMNS: Final = (
    ("xx", "stress_xx_kpa", 9),
    ("yy", "stress_yy_kpa", 9),
    ("zz", "stress_zz_kpa", 9),
    ("shear", "maximum_shear_kpa", 9),
    ("energy", "strain_energy_density_kJ_per_m3", 9),
    ("strain_zz", "strain_zz", 11),
)


@takes(placement=placement_of, tissue=tissue_of, pressed=pressed_of)
def fields(
    *,
    placement: "Placement",
    tissue: "Tissue",
    pressed: Pressed,
    depth_mm: Annotated[
        list[float] | None,
        typer.Option(
            help="Depths below the surface, mm: one or more. By default those of receptors in the "
            "literature, which vary: Meissner 0.5-0.7, Merkel 0.7-1, Pacinian 1.5-2.5.",
            show_default=False,
        ),
    ] = None,
    grid: Grid = 256,
    plot: Annotated[
        Path | None, typer.Option(help="Folder for the section under the contact, as SVG and PNG.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Find stress and strain below the place of first contact, by Hertz theory and for the whole pad.

    In names of components x is along the finger, y across, z into the tissue; tension is positive. Hertz
    theory is that of a half-space, under the same load, area or indentation.
    """
    from fingerpad.contact import ContactField, solve_contact

    depths = _depths(depth_mm, float(tissue.thickness))
    hertz = ContactField.of_hertz(placement, tissue, **pressed.given)
    solved = ContactField.of_solution(solve_contact(placement, tissue, **pressed.given, points=grid))
    record = _record(solved, depths) | {
        "thickness_mm": None if tissue.is_deep else tissue.thickness,
        "hertz": _record(hertz, depths),
    }
    if plot is not None:
        _plot_section(solved, hertz, plot)
    if as_json:
        print_json(record)
    else:
        _print_fields(record)


def _depths(given: list[float] | None, thickness: float) -> "FloatArray":
    """Return the given depths in ascending order, or those of receptors as far as there is tissue."""
    if not given:
        return np.unique([min(depth, thickness) for depth in _DEFAULT_DEPTHS])
    for depth in given:
        if not 0 <= depth <= thickness:
            bone = "" if np.isinf(thickness) else f" and at most --thickness-mm {thickness:g}"
            raise GeometryError(f"--depth-mm must be at least 0{bone}, found {depth:g}")
    return np.unique(given)


def _record(field: "ContactField", depths: "FloatArray") -> dict[str, Any]:
    """Return a contact and the field on its axis, a list of one value for each depth."""
    stress = field.stress_on_axis(depths)
    strain = field.strain(stress)
    highest, where = field.highest_shear_on_axis()
    record: dict[str, Any] = {
        **pressed_record(field.contact),
        "peak_pressure_kpa": KPA_PER_MPA * field.contact.peak_pressure,
        "highest_shear_on_axis_kpa": KPA_PER_MPA * highest,
        "highest_shear_on_axis_depth_mm": where,
        "depth_mm": depths,
    }
    for name, place in _COMPONENTS.items():
        record[f"stress_{name}_kpa"] = KPA_PER_MPA * stress.tensor[:, *place]
    record["principal_stresses_kpa"] = KPA_PER_MPA * stress.principal
    record["maximum_shear_kpa"] = KPA_PER_MPA * stress.maximum_shear
    for name, place in _COMPONENTS.items():
        record[f"strain_{name}"] = strain[:, *place]
    record["principal_strains"] = np.linalg.eigvalsh(strain)
    record["strain_energy_density_kJ_per_m3"] = KPA_PER_MPA * field.strain_energy_density(stress)
    return record


def _print_fields(record: dict[str, Any]) -> None:
    """Print the contacts side by side, and the field on both axes as tables."""
    both = {"whole pad": record, "Hertz": record["hertz"]}
    typer.echo(f"{'':<30}" + "".join(f"{name:>11}" for name in both))
    for key in (key for key, value in record["hertz"].items() if np.ndim(value) == 0):
        typer.echo(f"{key:<30}" + "".join(f"{one[key]:11.4g}" for one in both.values()))
    for title, one in both.items():
        typer.echo(f"\n{title}, below the place of first contact")
        typer.echo("depth_mm" + "".join(f"{heading:>{width}}" for heading, _, width in _COLUMNS))
        for index, depth in enumerate(one["depth_mm"]):
            values = "".join(f"{one[key][index]:{width}.4g}" for _, key, width in _COLUMNS)
            typer.echo(f"{depth:<8.4g}{values}  {_receptors_at(depth)}".rstrip())
    typer.echo("\nStresses in kPa, energy in kJ/m³; --json gives all components, and strains.")
    typer.echo("Depths of receptors vary between people; those named here are from the literature.")


def _receptors_at(depth: float) -> str:
    return ", ".join(name for name, (low, high) in RECEPTORS.items() if low <= depth <= high)


def _plot_section(solved: "ContactField", hertz: "ContactField", folder: Path) -> None:
    from fingerpad.figures import save_figure, section_figure

    make_folder(folder)
    figure = section_figure(solved, hertz=hertz, receptors=RECEPTORS)
    save_figure(
        figure,
        folder / "section",
        description="Contact pressure and maximum shear stress in the section along the finger.",
    )
