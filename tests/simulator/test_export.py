"""The exported files, run and measured by what others wrote to read them."""

import math
import sys
import xml.etree.ElementTree as ET

import meshio
import mujoco
import numpy as np
import pytest
from scipy.spatial import ConvexHull

import fingerpad as fp
from fingerpad.simulator import export_finger, simulator_law
from fingerpad.simulator.mesh import layer_mesh

# Seen nowhere else in code or tests, on a roll as well.
PAD = fp.Ellipsoid(palmar=8.6, distal=15.1, radial_ulnar=10.4)
PLACE = fp.Placement(PAD, wedge_angle=np.radians(41), roll_angle=np.radians(12))
TISSUE = fp.Tissue(youngs_modulus=0.083, poisson_ratio=0.47, thickness=5.5)
VOLUME = 4 / 3 * np.pi * 8.6 * 15.1 * 10.4
HEIGHT = float(PLACE.normal @ PLACE.point)


@pytest.fixture(scope="module")
def law():
    return simulator_law(PLACE, TISSUE, (0.2, 3.0))


@pytest.fixture(scope="module")
def folder(law, tmp_path_factory):
    made = tmp_path_factory.mktemp("finger") / "new"
    names = [file.name for file in export_finger(law, made, effective_mass=0.03)]
    assert sorted(names) == sorted(file.name for file in made.iterdir())
    return made


def test_mujoco_presses_the_exported_finger(law, folder) -> None:
    """Ten loads; at the depth where each comes to rest the solver has that load within 3 %."""
    model = mujoco.MjModel.from_xml_path(str(folder / "finger.xml"))
    data = mujoco.MjData(model)
    assert 1 / model.body("finger").invweight0[0] == pytest.approx(model.body("finger").mass[0])
    for load in np.geomspace(0.2, 3.0, 10):
        data.ctrl[0] = load
        mujoco.mj_step(model, data, round(4 / model.opt.timestep))
        assert abs(data.qvel[0]) < 1e-7
        assert data.contact[0].dist == pytest.approx(-data.qpos[0], rel=1e-6)
        solved = fp.solve_contact(PLACE, TISSUE, indentation=1000 * data.qpos[0], points=64)
        assert solved.load == pytest.approx(load, rel=0.03)


def test_mujoco_has_the_pad_where_it_touches(folder) -> None:
    model = mujoco.MjModel.from_xml_path(str(folder / "finger.xml"))
    data = mujoco.MjData(model)
    data.qpos[0] = 1e-4
    mujoco.mj_forward(model, data)
    # The place of contact, from the plate's axes to the pad's own.
    pad = data.geom("pad")
    own = pad.xmat.reshape(3, 3).T @ (data.contact[0].pos - [0, 0, 0.5e-4] - pad.xpos)
    assert 1000 * own == pytest.approx(PLACE.point, abs=0.15)
    assert pad.xmat.reshape(3, 3) @ PLACE.normal == pytest.approx([0, 0, -1], abs=1e-8)


def read_vtk(folder):
    mesh = meshio.read(folder / "finger.vtk")
    return 1000 * mesh.points, mesh.cells_dict["tetra"]


def volumes_of(points, cells):
    a, b, c, d = (points[cells[:, place]] for place in range(4))
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6


def test_tetrahedra_for_drake(law, folder) -> None:
    points, cells = read_vtk(folder)
    volumes = volumes_of(points, cells)
    assert (volumes > 0).all()
    assert volumes.sum() == pytest.approx(VOLUME, rel=0.005)
    on_surface = np.linalg.norm(points / PAD.semi_axes, axis=1) > 1e-9
    assert (~on_surface).sum() == 1
    assert np.linalg.norm(points[on_surface] / PAD.semi_axes, axis=1) == pytest.approx(1)
    tree = ET.parse(folder / "finger.sdf").getroot()
    pose = [float(number) for number in tree.find(".//pose").text.split()]
    assert 1000 * pose[2] == pytest.approx(HEIGHT)
    modulus = float(tree.find(".//{http://drake.mit.edu}hydroelastic_modulus").text)
    assert modulus == pytest.approx(law.drake_modulus(law.mesh()).modulus, rel=1e-5)
    inertia = [float(tree.find(f".//{name}").text) for name in ("ixx", "iyy", "izz")]
    assert inertia[0] + inertia[1] > inertia[2] > 0


def test_pose_of_the_sdf_lays_the_pad_on_the_plate(folder) -> None:
    roll, pitch, yaw = (
        float(number) for number in ET.parse(folder / "finger.sdf").getroot().find(".//pose").text.split()[3:]
    )
    cosine, sine = np.cos([roll, pitch, yaw]), np.sin([roll, pitch, yaw])
    about_x = np.array([[1, 0, 0], [0, cosine[0], -sine[0]], [0, sine[0], cosine[0]]])
    about_y = np.array([[cosine[1], 0, sine[1]], [0, 1, 0], [-sine[1], 0, cosine[1]]])
    about_z = np.array([[cosine[2], -sine[2], 0], [sine[2], cosine[2], 0], [0, 0, 1]])
    turned = about_z @ about_y @ about_x
    assert turned @ PLACE.normal == pytest.approx([0, 0, -1], abs=1e-6)
    assert (turned @ (read_vtk(folder)[0].T))[2].min() == pytest.approx(-HEIGHT, rel=0.01)


def test_surface_is_closed_and_curved_as_the_pad(folder) -> None:
    mesh = meshio.read(folder / "finger.obj")
    points, faces = 1000 * mesh.points, mesh.cells_dict["triangle"]
    a, b, c = (points[faces[:, place]] for place in range(3))
    assert np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6 == pytest.approx(VOLUME, rel=0.005)
    edges = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    _, count = np.unique(edges, axis=0, return_counts=True)
    assert (count == 2).all()
    # A quadric through the vertices around the place of contact, against the pad's curvature there.
    along = np.array([-PLACE.normal[1], PLACE.normal[0], 0]) / math.hypot(*PLACE.normal[:2])
    near = points[np.linalg.norm(points - PLACE.point, axis=1) < 4] - PLACE.point
    x, y, z = near @ along, near @ np.cross(PLACE.normal, along), near @ PLACE.normal
    powers = [(2, 0), (1, 1), (0, 2), *((i, j) for i in range(5) for j in range(5 - i) if i + j != 2)]
    terms = np.stack([x**i * y**j for i, j in powers], axis=1)
    fitted = np.linalg.lstsq(terms, -z, rcond=None)[0]
    gaussian = 4 * fitted[0] * fitted[2] - fitted[1] ** 2
    assert fitted[0] + fitted[2] == pytest.approx(float(PLACE.curvature.mean_curvature), rel=0.02)
    assert gaussian == pytest.approx(float(PLACE.curvature.gaussian_curvature), rel=0.03)


def test_finite_elements(folder) -> None:
    mesh = meshio.read(folder / "finger.inp")
    cells, points = mesh.cells_dict["tetra10"], mesh.points
    volumes = volumes_of(points, cells)
    assert (volumes > 0).all()
    # Columns of tissue along the plate's normal: the skin's shadow on the plate times the thickness.
    skin = points[mesh.point_sets["SKIN"]]
    along = np.cross(PLACE.normal, [0, 0, 1.0])
    along /= np.linalg.norm(along)
    shadow = ConvexHull(np.stack([skin @ along, skin @ np.cross(PLACE.normal, along)], axis=1)).volume
    assert volumes.sum() == pytest.approx(5.5 * shadow, rel=0.02)
    assert np.linalg.norm(skin / PAD.semi_axes, axis=1) == pytest.approx(1, abs=1e-7)
    bone = points[mesh.point_sets["BONE"]] + 5.5 * PLACE.normal
    assert np.linalg.norm(bone / PAD.semi_axes, axis=1) == pytest.approx(1, abs=1e-7)
    assert np.linalg.norm(skin - PLACE.point, axis=1).min() == pytest.approx(0, abs=1e-6)
    assert len(mesh.point_sets["BONE"]) == len(mesh.point_sets["SKIN"])
    # Every corner of an element is used, and each middle lies near that of its edge.
    assert np.unique(cells).size == len(points)
    for middle, (one, other) in enumerate(((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)), start=4):
        apart = np.linalg.norm(
            points[cells[:, middle]] - (points[cells[:, one]] + points[cells[:, other]]) / 2, axis=1
        )
        assert (apart < 0.15 * np.linalg.norm(points[cells[:, one]] - points[cells[:, other]], axis=1)).all()
    text = (folder / "finger.inp").read_text(encoding="utf-8")
    assert "*ELASTIC\n0.083, 0.47" in text


def test_faces_of_the_layer_meet() -> None:
    mesh = layer_mesh(PLACE, 5.5, rings=5, layers=2)
    faces = np.sort(mesh.tetrahedra[:, [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]]].reshape(-1, 3), axis=1)
    _, count = np.unique(faces, axis=0, return_counts=True)
    assert count.max() == 2
    # Skin and bone of 6 · 5² triangles each, and the rim, two for each side of a prism.
    assert (count == 1).sum() == 2 * 6 * 25 + 6 * 5 * 2 * 2


def test_table_and_words(law, folder) -> None:
    table = np.genfromtxt(folder / "pressure_by_depth.csv", delimiter=",", names=True)
    assert table.dtype.names == ("depth_m", "pressure_Pa", "pressure_Pa_std")
    assert table["pressure_Pa"] == pytest.approx(law.pressure_by_depth().pressure)
    words = (folder / "README.md").read_text(encoding="utf-8")
    for part in (
        "8.6 × 15.1 × 10.4 mm",
        "wedge of 41°, roll 12°",
        "5.5 mm of tissue",
        "0.2 to 3 N",
        "finger.inp",
    ):
        assert part in words


def test_without_meshio_nothing_is_written(law, tmp_path, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "meshio", None)
    with pytest.raises(
        fp.FingerpadError, match=r"needs the package meshio: pip install 'fingerpad\[simulators\]'"
    ):
        export_finger(law, tmp_path / "new", effective_mass=0.1)
    assert not (tmp_path / "new").exists()


def test_paraboloid_and_places_that_cannot_be_written(law, tmp_path) -> None:
    flat = simulator_law(fp.Paraboloid(12.0, 14.0), TISSUE, (0.2, 2.0))
    with pytest.raises(fp.FingerpadError, match="needs a pad"):
        export_finger(flat, tmp_path, effective_mass=0.1)
    file = tmp_path / "file"
    file.write_text("")
    with pytest.raises(fp.FingerpadError, match="cannot make this folder"):
        export_finger(law, file, effective_mass=0.1)
