"""Files of a finger for robot simulators and finite elements."""

import math
from importlib.metadata import version
from io import StringIO
from pathlib import Path
from typing import Final

import numpy as np
from scipy.spatial.transform import Rotation

from fingerpad._arrays import FloatArray
from fingerpad._files import explain_write_errors, make_folder
from fingerpad.exceptions import FingerpadError
from fingerpad.geometry import Placement
from fingerpad.geometry.ellipsoid import tangents
from fingerpad.simulator.elements import HIGHEST_POISSON_RATIO
from fingerpad.simulator.law import SimulatorLaw, elements_or_reason
from fingerpad.simulator.mesh import TetrahedralMesh, layer_mesh
from fingerpad.simulator.targets import (
    DrakeModulus,
    MujocoContact,
    PressureByDepth,
    Target,
)

_LONGEST_TIME_STEP: Final = 0.001  # s
_OF_THE_LARGEST: Final = 0.25
_DISSIPATION: Final = 1.0  # Hunt and Crossley's, s/m: no pad was measured


def export_finger(
    law: SimulatorLaw, folder: Path, *, effective_mass: float, damping_ratio: float = 1.0, source: str = ""
) -> tuple[Path, ...]:
    """Write a finger for MuJoCo, Drake, Newton and finite elements.

    Parameters
    ----------
    law : SimulatorLaw
        The law of a pad at its placement.
    folder : Path
        Made unless it is there; files of these names are written over.
    effective_mass, damping_ratio : float
        As for `SimulatorLaw.mujoco`.
    source : str
        Where pad and tissue are from, for the README.

    Returns
    -------
    tuple of Path
        The files: ``finger.xml``, ``finger.sdf``, ``finger.vtk``, ``finger.obj``, ``pressure_by_depth.csv``,
        ``README.md``, and ``finger.inp`` where there is bone.

    Raises
    ------
    GeometryError
        If the law is that of a `Paraboloid`, or the mass too small.
    FingerpadError
        If the folder cannot be written, or meshio is not installed.

    Examples
    --------
    >>> from tempfile import mkdtemp
    >>> from fingerpad.contact import Tissue
    >>> from fingerpad.geometry import Ellipsoid
    >>> from fingerpad.simulator import simulator_law
    >>> place = Placement(Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8), wedge_angle=np.radians(30))
    >>> law = simulator_law(place, Tissue(youngs_modulus=0.05, thickness=6.0))
    >>> [file.name for file in export_finger(law, Path(mkdtemp()), effective_mass=0.1)][:3]
    ['finger.xml', 'finger.sdf', 'finger.vtk']
    """
    mesh = law.mesh()
    drake, mujoco = law.drake_modulus(mesh), law.mujoco(effective_mass, damping_ratio)
    table = law.pressure_by_depth()
    tissue_mesh, reason = _tissue_mesh(law)
    texts = {
        "finger.xml": _mjcf(law, mujoco),
        "finger.sdf": _sdf(law, drake, effective_mass),
        "finger.vtk": _vtk(mesh),
        "finger.obj": _obj(mesh),
        "pressure_by_depth.csv": _csv(table),
        "README.md": _readme(law, table, drake, mujoco, reason=reason, source=source),
    }
    if tissue_mesh:
        texts["finger.inp"] = tissue_mesh
    make_folder(folder)
    with explain_write_errors(folder):
        for name, text in texts.items():
            (folder / name).write_text(text, encoding="utf-8")
    return tuple(folder / name for name in texts)


def _numbers(*values: float) -> str:
    return " ".join(f"{value:.9g}" for value in values)


def _turned(placement: Placement) -> Rotation:
    """Return the rotation from the pad's axes to a world whose plate lies at z = 0, below."""
    along = tangents(placement.normal)[0]
    return Rotation.from_matrix(np.stack([along, np.cross(-placement.normal, along), -placement.normal]))


def _metres(law: SimulatorLaw) -> tuple[Placement, float, FloatArray]:
    """Return the placement, the height of the pad's centre at touch and its semi-axes, m."""
    placement = law.pad.placed("a file")
    return placement, float(law.pad.curve.height) / 1000, placement.ellipsoid.semi_axes / 1000


def _mjcf(law: SimulatorLaw, contact: MujocoContact) -> str:
    placement, height, axes = _metres(law)
    x, y, z, w = _turned(placement).as_quat()
    step = min(_LONGEST_TIME_STEP, _OF_THE_LARGEST * contact.largest_time_step)
    mass, eye = contact.effective_mass, 5 * height
    inertia = 0.4 * mass * float(np.mean(axes)) ** 2
    return f"""<mujoco model="finger">
  <!-- The joint "press" is the indentation, m; the motor's control is the load, N. -->
  <option timestep="{step:.3g}" gravity="0 0 0"/>
  <visual><map znear="0.01"/></visual>
  <statistic center="0 0 {height:.4g}" extent="{3 * height:.4g}"/>
  <worldbody>
    <light pos="0 -0.1 0.2" dir="0 0.4 -1"/>
    <camera name="side" pos="0 {-eye:.4g} {1.5 * height:.4g}" xyaxes="1 0 0 0 0.1 1"/>
    <geom name="plate" type="plane" size="0.03 0.03 0.002" rgba="0.75 0.8 0.85 1"/>
    <body name="finger" pos="0 0 {height:.9g}">
      <!-- In the body's own axes, so that MuJoCo's effective mass, 1/body_invweight0, is the mass itself. -->
      <inertial pos="0 0 0" mass="{mass:g}" diaginertia="{_numbers(*np.full(3, inertia))}"/>
      <joint name="press" type="slide" axis="0 0 -1"/>
      <geom name="pad" type="ellipsoid" size="{_numbers(*axes)}" quat="{_numbers(w, x, y, z)}"
            rgba="0.9 0.7 0.6 1" priority="1" condim="1"
            solref="{_numbers(*contact.solref)}"
            solimp="{_numbers(*contact.solimp)}"/>
    </body>
  </worldbody>
  <actuator><motor name="load" joint="press"/></actuator>
</mujoco>
"""


def _sdf(law: SimulatorLaw, drake: DrakeModulus, mass: float) -> str:
    placement, height, axes = _metres(law)
    roll, pitch, yaw = _turned(placement).as_euler("xyz")
    a, b, c = mass / 5 * np.array(axes) ** 2
    return f"""<?xml version="1.0"?>
<sdf version="1.7" xmlns:drake="http://drake.mit.edu">
  <model name="finger">
    <link name="pad">
      <pose>0 0 {_numbers(height, roll, pitch, yaw)}</pose>
      <inertial>
        <mass>{mass:g}</mass>
        <inertia>
          <ixx>{b + c:.6g}</ixx><iyy>{a + c:.6g}</iyy><izz>{a + b:.6g}</izz>
          <ixy>0</ixy><ixz>0</ixz><iyz>0</iyz>
        </inertia>
      </inertial>
      <collision name="pad">
        <geometry><mesh><uri>finger.vtk</uri></mesh></geometry>
        <drake:proximity_properties>
          <drake:compliant_hydroelastic/>
          <drake:hydroelastic_modulus>{drake.modulus:.6g}</drake:hydroelastic_modulus>
          <drake:hunt_crossley_dissipation>{_DISSIPATION:g}</drake:hunt_crossley_dissipation>
        </drake:proximity_properties>
      </collision>
      <visual name="pad"><geometry><mesh><uri>finger.obj</uri></mesh></geometry></visual>
    </link>
  </model>
</sdf>
"""


def _rows(values: FloatArray) -> str:
    return "\n".join(" ".join(f"{value:.9g}" for value in row) for row in values)


def _vtk(mesh: TetrahedralMesh) -> str:
    count = len(mesh.tetrahedra)
    cells = np.concatenate([np.full((count, 1), 4), mesh.tetrahedra], axis=1)
    return (
        "# vtk DataFile Version 3.0\nfinger pad, m\nASCII\nDATASET UNSTRUCTURED_GRID\n"
        f"POINTS {len(mesh.points)} double\n{_rows(mesh.points / 1000)}\n"
        f"CELLS {count} {5 * count}\n{_rows(cells)}\nCELL_TYPES {count}\n" + "10\n" * count
    )


def _obj(mesh: TetrahedralMesh) -> str:
    used, place = np.unique(mesh.surface, return_inverse=True)
    points = "".join(f"v {_numbers(*point)}\n" for point in mesh.points[used] / 1000)
    faces = "".join("f {} {} {}\n".format(*face) for face in 1 + place.reshape(-1, 3))
    return f"# finger pad, m\n{points}{faces}"


def _csv(table: PressureByDepth) -> str:
    rows = zip(table.depth, table.pressure, table.pressure_std, strict=True)
    lines = (",".join(f"{value:.9g}" for value in row) for row in rows)
    return "\n".join(["depth_m,pressure_Pa,pressure_Pa_std", *lines, ""])


def _tissue_mesh(law: SimulatorLaw) -> tuple[str, str]:
    """Return the tissue over bone for finite elements, or why there is none."""
    placement, tissue = law.pad.placed("a file"), law.pad.tissue
    thickness = float(tissue.thickness)
    if tissue.is_deep:
        return "", "No `finger.inp`: the law is that of deep tissue, without bone."
    try:
        import meshio  # noqa: PLC0415 (it need not be installed)
    except ImportError:
        raise FingerpadError(
            "finger.inp needs the package meshio: pip install 'fingerpad[simulators]'"
        ) from None
    mesh = layer_mesh(placement, thickness)
    written = StringIO()
    meshio.abaqus.write(
        written,
        meshio.Mesh(
            mesh.points,
            [("tetra10", mesh.tetrahedra)],
            point_sets={"BONE": mesh.bone, "SKIN": mesh.skin},
            cell_sets={"TISSUE": [np.arange(len(mesh.tetrahedra))]},
        ),
        float_fmt=".9g",
    )
    ratio = min(float(tissue.poisson_ratio), HIGHEST_POISSON_RATIO)
    text = (
        f"** mm, N, MPa. Fix BONE, press a rigid plate of normal ({_numbers(*placement.normal)}) on SKIN.\n"
        f"{written.getvalue()}*MATERIAL, NAME=TISSUE\n*ELASTIC\n"
        f"{float(tissue.youngs_modulus):.9g}, {ratio:g}\n*SOLID SECTION, ELSET=TISSUE, MATERIAL=TISSUE\n"
    )
    return text, ""


def _percent(share: float) -> str:
    return "unknown" if math.isnan(share) else f"{100 * share:.1f} %"


def _readme(
    law: SimulatorLaw,
    table: PressureByDepth,
    drake: DrakeModulus,
    mujoco: MujocoContact,
    *,
    reason: str,
    source: str,
) -> str:
    placement, tissue = law.pad.placed("a file"), law.pad.tissue
    newton = law.newton_kh()
    axes = " × ".join(f"{axis:g}" for axis in placement.ellipsoid.semi_axes)
    deep = math.isinf(tissue.thickness)
    layer = "deep tissue" if deep else f"{tissue.thickness:g} mm of tissue bonded to rigid bone"

    def row(name: str, value: str, target: Target) -> str:
        factor = "no area" if math.isnan(target.area_factor) else f"× {target.area_factor:.2f}"
        return f"| {name} | {value} | {_percent(target.worst_relative_error)} | {factor} |"

    rows = [
        row("`pressure_by_depth.csv`", f"{len(table.depth)} depths", table),
        row("Newton `kh`", newton.words, newton),
        row("Drake hydroelastic modulus (`finger.sdf`)", drake.words, drake),
        row("MuJoCo solref, solimp (`finger.xml`)", f"for {mujoco.effective_mass:g} kg", mujoco),
    ]
    bone = reason
    elements, too_thin = elements_or_reason(law)
    if not reason and elements is None:
        bone = f"`finger.inp` (mm, N, MPa) is the tissue around the place of contact. Its load: {too_thin}"
    elif not reason and elements is not None:
        low, high = elements.load_ratio[[0, -1]]
        rows.append(row("finite elements (`finger.inp`)", f"ν = {elements.poisson_ratio:g}", elements))
        bone = (
            "`finger.inp` (mm, N, MPa) is the tissue around the place of contact, ten-node tetrahedra "
            "between\n  SKIN and BONE. By linear finite elements it carries "
            f"**{low:.2f} of the law's load at the lowest load, {high:.2f} at the\n  highest**. The mesh is "
            "not the reason: elements of a flat, wide layer are 2 to 6 % above the law. It is\n  the "
            "geometry: this tissue is bent as the pad is and its sides are free, where the law, and\n  with "
            "it all targets above, has a flat layer without sides. Which is nearer to a finger\n  was not "
            "measured: do not "
            "take E from one and loads from the other."
        )
    turned = [math.degrees(float(angle)) for angle in (placement.wedge_angle, placement.roll_angle)]
    twice = _numbers(*mujoco.solref_at_twice_the_mass)
    share = law.load_std[[0, -1]] / law.load[[0, -1]]
    uncertain = (
        f"Standard uncertainty of the load: {_percent(share[0])} at the lowest, {_percent(share[1])} at the "
        f"highest;\nof MuJoCo's stiffness {_percent(mujoco.stiffness_std / -mujoco.solref[0])}."
        if share.any()
        else "No uncertainty of the pad or its tissue was given."
    )
    return f"""# A finger for simulators

Written by fingerpad {version("fingerpad")}. The pad: semi-axes {axes} mm (palmar, distal, radial–ulnar),
on a wedge of {turned[0]:.3g}°, roll {turned[1]:.3g}°; {layer}, E = {1000 * tissue.youngs_modulus:.4g} kPa,
ν = {tissue.poisson_ratio:g}; pressed without friction on a rigid flat plate. {source or "As given."}

The law comes from the {law.model}, and holds from {law.load[0]:.3g} to {law.load[-1]:.3g} N, at
indentations of {law.indentation[0]:.3g} to {law.indentation[-1]:.3g} mm. Nothing was fitted beyond.
{uncertain}

| target | value | worst error of the load | contact area |
|---|---|---|---|
{chr(10).join(rows)}

- Table of pressures: assumes {table.assumes}.
- Newton: assumes {newton.assumes}.
  In a callback the depth is `-signed_depth`; outside, let the pressure go on below zero as it begins inside.
- Drake: assumes {drake.assumes}.
  The dissipation of {_DISSIPATION:g} s/m was not measured.
- MuJoCo: assumes {mujoco.assumes}.
  For twice the mass solref is `{twice}`. Time steps beyond
  {1000 * mujoco.largest_time_step:.3g} ms are unstable at the highest load. The damping ratio of
  {mujoco.damping_ratio:g} was chosen, not measured, and friction is left out.
- Lengths are in metres; meshes are in the pad's own axes, x out of the palmar face, y out of the fingertip.
- {bone}
"""
