"""The command that gives a pad in the numbers and files that robot simulators take."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer
from typer import Argument, Option

import fingerpad as fp
from fingerpad.cli import options, show
from fingerpad.exceptions import GeometryError
from fingerpad.units import KPA_PER_MPA

if TYPE_CHECKING:
    from fingerpad.simulator import FiniteElements, MujocoContact, SimulatorLaw
    from fingerpad.simulator.targets import Target

_SHOWN = 6  # rows of the table on the terminal


def simulator(
    wedge_deg: options.WedgeAngle,
    results: Annotated[
        Path | None,
        Argument(help="Output folder of a finished run, in place of the pad's numbers.", show_default=False),
    ] = None,
    finger: Annotated[str | None, Option(help="Finger of that run.", show_default="its only one")] = None,
    semi_axes_mm: Annotated[
        tuple[float, float, float] | None,
        options.positive("Palmar, distal and radial-ulnar semi-axes, mm.", show_default=False),
    ] = None,
    youngs_modulus_kpa: Annotated[
        float | None, options.positive("Young's modulus E of the tissue, kPa.", show_default=False)
    ] = None,
    thickness_mm: options.Thickness = None,
    poisson_ratio: Annotated[
        float | None,
        Option(min=0, max=0.5, help="Poisson's ratio of the tissue.", show_default="that of the run, or 0.5"),
    ] = None,
    roll_deg: options.RollAngle = 0.0,
    load_n: Annotated[
        tuple[float, float], Option(help="Lowest and highest load of the range that matters, N.")
    ] = (0.2, 3.0),
    mass_kg: Annotated[float, options.positive("MuJoCo's effective mass of the contact, kg.")] = 0.1,
    damping_ratio: Annotated[float, options.positive("Damping ratio in MuJoCo; 1 is critical.")] = 1.0,
    youngs_modulus_kpa_std: Annotated[float, Option(min=0, help="Standard uncertainty of E, kPa.")] = 0.0,
    thickness_mm_std: Annotated[
        float, Option(min=0, help="Standard uncertainty of the thickness, mm.")
    ] = 0.0,
    semi_axes_mm_std: Annotated[
        float, Option(min=0, help="Standard uncertainty of each semi-axis, mm.")
    ] = 0.0,
    export: Annotated[
        Path | None,
        Option(help="Folder for MJCF, SDF, meshes and tables. finger.inp needs the package meshio."),
    ] = None,
    as_json: options.AsJson = False,
) -> None:
    """Give a finger pad in the numbers that MuJoCo, Drake and Newton take, with the error of each.

    The whole ellipsoid, on deep tissue or on a layer over bone, by fast laws, and by the solver where
    these do not hold. Each number is the one whose load is nearest over the range of loads. Of a finished run
    the pad is that of a finger, with E and thickness from its loading curve, or from its contact images, and
    Poisson's ratio that of the run.
    """
    from fingerpad.simulator import elements_or_reason, export_finger

    source = ""
    if results is None:
        if semi_axes_mm is None or youngs_modulus_kpa is None:
            missing = "--semi-axes-mm" if semi_axes_mm is None else "--youngs-modulus-kpa"
            raise typer.BadParameter(f"give {missing}, or the output folder of a finished run")
        placement = options.placement_of(semi_axes_mm=semi_axes_mm, wedge_deg=wedge_deg, roll_deg=roll_deg)
        tissue = options.tissue_of(
            youngs_modulus_kpa=youngs_modulus_kpa,
            poisson_ratio=0.5 if poisson_ratio is None else poisson_ratio,
            thickness_mm=thickness_mm,
        )
        stds = {"youngs_modulus": youngs_modulus_kpa_std / KPA_PER_MPA, "thickness": thickness_mm_std}
        stds |= dict.fromkeys(("palmar", "distal", "radial_ulnar"), semi_axes_mm_std)
        stds = {name: std for name, std in stds.items() if std}
        if "thickness" in stds and thickness_mm is None:
            raise typer.BadParameter("--thickness-mm-std is that of --thickness-mm: give both")
    else:
        from fingerpad.study.results.load import measured_pad

        given = {"--semi-axes-mm": semi_axes_mm, "--youngs-modulus-kpa": youngs_modulus_kpa}
        if wrong := [flag for flag, value in given.items() if value is not None]:
            raise typer.BadParameter(f"{wrong[0]} is that of the run: leave it out, or the folder")
        pad = measured_pad(
            results,
            finger=finger,
            wedge_deg=wedge_deg,
            thickness_mm=thickness_mm,
            poisson_ratio=poisson_ratio,
        )
        placement, tissue, stds = pad.placement, pad.tissue, pad.stds
        source = f"{pad.source}."
        show.note(pad.source)
    try:
        law = fp.simulator_law(placement, tissue, load_n, stds=stds)
    except GeometryError as error:
        raise GeometryError(f"--load-n {load_n[0]:g} {load_n[1]:g}: {error}") from None
    try:
        mujoco = law.mujoco(mass_kg, damping_ratio)
    except GeometryError as error:
        raise GeometryError(f"--mass-kg {mass_kg:g}: {error}") from None
    elements, reason = elements_or_reason(law)
    if reason:
        show.note(reason)
    files: tuple[Path, ...] = ()
    if export is not None:
        files = export_finger(law, export, effective_mass=mass_kg, damping_ratio=damping_ratio, source=source)
    record = {
        "pressure_by_depth": law.pressure_by_depth().as_record(),
        "newton": law.newton_kh().as_record(),
        "drake": law.drake_modulus().as_record(),
        "mujoco": mujoco.as_record(),
        "finite_elements": elements.as_record() if elements else None,
        "table": law.as_record(),
    }
    show.result(record, as_json, lambda _: _print(law, mujoco, elements))
    if files and not as_json:
        typer.echo(f"Files in {export}: {', '.join(file.name for file in files)}")
    if mujoco.flag:
        show.note("MuJoCo's default time step of 2 ms is unstable for this mass: give a shorter one")


def _print(law: "SimulatorLaw", mujoco: "MujocoContact", elements: "FiniteElements | None") -> None:
    """Print the law, a line for each target, and what each assumes."""
    pressure, newton, drake = law.pressure_by_depth(), law.newton_kh(), law.drake_modulus()
    typer.echo(f"The whole pad by the {law.model}, which the simulators are to follow:")
    shown = np.linspace(0, law.load.size - 1, _SHOWN).round().astype(int)
    columns = np.column_stack([law.load, law.indentation, law.area])[shown].tolist()
    numbers = ([f"{number:.4g}" for number in row] for row in columns)
    show.rows([("load_N", "indentation_mm", "area_mm2"), *numbers])
    typer.echo()
    show.rows(
        [
            ("", "", "load within", "area"),
            _line("pressure by depth", f"{len(pressure.depth)} depths, in --json and --export", pressure),
            _line("Newton kh", newton.words, newton),
            _line("Drake modulus", drake.words, drake),
            _line("MuJoCo solref", _numbers(mujoco.solref), mujoco),
            ("MuJoCo solimp", _numbers(mujoco.solimp), "", ""),
        ]
    )
    typer.echo(
        f"\nMuJoCo: steps up to {1000 * mujoco.largest_time_step:.3g} ms are stable; with twice the "
        f"effective mass solref is {_numbers(mujoco.solref_at_twice_the_mass)}"
    )
    assumed: dict[str, Target] = {"pressure by depth, Newton": newton, "Drake": drake, "MuJoCo": mujoco}
    if elements:
        low, high = elements.load_ratio[[0, -1]]
        typer.echo(
            f"Finite elements on the exported tissue carry {low:.2f} of these loads at the lowest, "
            f"{high:.2f} at the highest"
        )
        assumed["finite elements"] = elements
    for name, target in assumed.items():
        typer.echo(f"Assumed for {name}: {target.assumes}")


def _line(name: str, value: str, target: "Target") -> tuple[str, str, str, str]:
    area = "none" if math.isnan(target.area_factor) else f"× {target.area_factor:.2f}"
    return name, value, f"{100 * target.worst_relative_error:.2g} %", area


def _numbers(values: tuple[float, ...]) -> str:
    return " ".join(f"{value:.6g}" for value in values)
