"""Loads of a pad in simulators against the solver.

Three pads are pressed at ten loads each. MuJoCo runs the exported file; Drake reads it where it is installed
(``pip install drake``), and otherwise its formula is integrated over the exported mesh. Newton 1.8 makes
hydroelastic contacts on CUDA devices alone: its law and the table of pressures are integrated over the
overlap.
"""

import tempfile
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Final

import mujoco
import numpy as np

from benchmarks.arrays import Array
from benchmarks.simulated import PLACED
from benchmarks.tables import percent, table
from fingerpad import Tissue, solve_contact
from fingerpad.simulator import SimulatorLaw, export_finger, simulator_law

MASS: Final = 0.1
TARGETS: Final = ("pressure by depth", "Newton `kh`", "Drake", "MuJoCo")
_LOADS: Final = 10
_CELLS: Final = 601
_SECONDS: Final = 4.0


# Tissue, and the range of loads.
PADS: Final = {
    "soft, deep: E = 60 kPa, no bone": (Tissue(0.06), (0.1, 1.5)),
    "usual: E = 50 kPa, 8 mm on bone": (Tissue(0.05, thickness=8.0), (0.2, 3.0)),
    "stiff, thin: E = 150 kPa, ν = 0.48, 4 mm on bone": (Tissue(0.15, 0.48, 4.0), (0.2, 3.0)),
}


def errors_of(tissue: Tissue, law: SimulatorLaw, loads: Array) -> tuple[list[float], float]:
    """Return the largest error of each simulator, and the factor of an overlap's area furthest from 1."""
    indentation = np.interp(loads, law.load, law.indentation)
    solved = [solve_contact(PLACED, tissue, indentation=depth) for depth in indentation]
    load, area = (np.array([getattr(one, name) for one in solved]) for name in ("load", "area"))
    kh, pressures = law.newton_kh().kh, law.pressure_by_depth()
    found = []
    for depth in indentation:
        deep, cell = _overlap(depth)
        pressure = pressures.pressure_at(deep).sum()
        found.append((pressure * cell, kh * deep.sum() * cell, (deep > 0).sum() * cell * 1e6))
    foundation, newton, overlap = np.array(found).T
    with tempfile.TemporaryDirectory() as folder:
        export_finger(law, Path(folder), effective_mass=MASS)
        drake = _drake(law, Path(folder), indentation)
        rested = _mujoco(Path(folder), loads)
    held = np.array([float(solve_contact(PLACED, tissue, indentation=depth).load) for depth in rested])
    pairs = (foundation, load), (newton, load), (drake, load), (loads, held)
    factor = overlap / area
    errors = [float(np.abs(one / other - 1).max()) for one, other in pairs]
    return errors, float(factor[np.argmax(np.abs(np.log(factor)))])


def _overlap(indentation: float) -> tuple[Array, float]:
    """Return depths of overlap with the plate, m, and the area of a cell, m²."""
    reach = 8.0 * np.sqrt(indentation)
    side = np.linspace(-reach, reach, _CELLS)
    gap = PLACED.gap.height(*np.meshgrid(side, side, indexing="ij"))
    depth: Array = np.maximum(indentation - np.nan_to_num(gap, nan=np.inf), 0)
    return depth * 1e-3, float(side[1] - side[0]) ** 2 * 1e-6


def _mujoco(folder: Path, loads: Array) -> list[float]:
    """Return the indentations at which the exported finger rests."""
    model = mujoco.MjModel.from_xml_path(str(folder / "finger.xml"))
    data = mujoco.MjData(model)
    rested = []
    for load in loads:
        data.ctrl[0] = load
        mujoco.mj_step(model, data, round(_SECONDS / model.opt.timestep))
        rested.append(1000 * float(data.qpos[0]))
    return rested


def _drake(law: SimulatorLaw, folder: Path, indentation: Array) -> Array:
    """Return loads, by Drake where it is installed."""
    height = float(PLACED.normal @ PLACED.point)
    try:
        import pydrake.all as drake  # noqa: PLC0415 (it need not be installed)
    except ImportError:
        mesh = law.mesh()
        _, extent = mesh.sections(PLACED.normal, height - indentation)
        return law.drake_modulus(mesh).modulus * extent * 1e-6
    builder = drake.DiagramBuilder()
    plant, _ = drake.AddMultibodyPlantSceneGraph(builder, 0.0)
    plant.set_contact_model(drake.ContactModel.kHydroelastic)
    drake.Parser(plant).AddModels(str(folder / "finger.sdf"))
    rigid = drake.ProximityProperties()
    drake.AddRigidHydroelasticProperties(rigid)
    drake.AddContactMaterial(friction=drake.CoulombFriction(0, 0), properties=rigid)
    world, middle = plant.world_body(), drake.RigidTransform()
    plant.RegisterCollisionGeometry(world, middle, drake.HalfSpace(), "plate", rigid)
    plant.Finalize()
    context = builder.Build().CreateDefaultContext()
    own = plant.GetMyMutableContextFromRoot(context)
    link = plant.GetBodyByName("pad")
    turned = plant.GetFreeBodyPose(own, link).rotation()
    found = []
    for depth in indentation:
        plant.SetFreeBodyPose(own, link, drake.RigidTransform(turned, [0, 0, (height - depth) / 1000]))
        contact = plant.get_contact_results_output_port().Eval(own).hydroelastic_contact_info(0)
        found.append(contact.F_Ac_W().translational()[2])
    return np.abs(found)


def report() -> None:
    """Print the table of errors, as it stands in the documentation."""
    rows = []
    for name, (tissue, (low, high)) in PADS.items():
        law = simulator_law(PLACED, tissue, (low, high))
        errors, factor = errors_of(tissue, law, np.geomspace(low, high, _LOADS))
        elements = "no bone"
        if not tissue.is_deep:
            ratio = law.finite_elements().load_ratio
            elements = f"× {ratio[0]:.2f} to {ratio[-1]:.2f}"
        words = f"{name}, {low:g}–{high:g} N"
        rows.append((words, *map(percent, errors), f"× {factor:.2f}", elements))
    table(("pad, loads", *TARGETS, "area of a foundation", "finite elements"), rows)
    try:
        drake = f"Drake {version('drake')} and"
    except PackageNotFoundError:
        drake = "Drake's formula on the exported mesh, and"
    print(f"\nMuJoCo {version('mujoco')}, {drake} Newton's law over the overlap, as Newton 1.8 needs a GPU.")
