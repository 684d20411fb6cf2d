"""Loads of simulators' contacts by their own formulas, on grids, against the pad's law."""

import math

import mujoco
import numpy as np
import pytest

import fingerpad as fp
from fingerpad.simulator import TetrahedralMesh, simulator_law

PAD = fp.Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
PLACE = fp.Placement(PAD, wedge_angle=np.radians(30))
USUAL = fp.Tissue(youngs_modulus=0.05, thickness=8.0)
# Soft and deep, usual, stiff and thin, and one that the fast laws do not take.
PADS = {
    "deep": (PLACE, fp.Tissue(0.06), (0.1, 1.5)),
    "usual": (PLACE, USUAL, (0.2, 3.0)),
    "thin": (PLACE, fp.Tissue(0.15, 0.48, 4.0), (0.2, 3.0)),
    "solver": (PLACE, fp.Tissue(0.05, 0.2, 4.0), (0.5, 2.0)),
    "paraboloid": (fp.Paraboloid(12.0, 14.0), USUAL, (0.2, 2.0)),
}


@pytest.fixture(scope="module", params=PADS)
def law(request):
    return simulator_law(*PADS[request.param])


def usual(**changes):
    return simulator_law(PLACE, USUAL, **changes)


def overlap(law, indentation, cells=801):
    """Return depths of overlap on a grid over the plate, and the area of a cell, mm."""
    gap = law.pad.placement.gap
    reach = 1.2 * math.sqrt(2 * max(gap.first_radius, gap.second_radius) * indentation)
    side = np.linspace(-reach, reach, cells)
    depth = indentation - gap.height(*np.meshgrid(side, side, indexing="ij"))
    return np.where(depth > 0, depth, 0), (side[1] - side[0]) ** 2


def loads_of(law, pressure):
    """Return the loads of a foundation at some indentations of the law, and those of the law."""
    places = [0, 20, 40, 63]
    found = []
    for place in places:
        depth, cell = overlap(law, law.indentation[place])
        found.append(pressure(depth * 1e-3).sum() * cell * 1e-6)
    return np.array(found), law.load[places]


@pytest.mark.parametrize("name", ["usual", "thin", "solver"])
def test_law_is_that_of_the_solver(name) -> None:
    law = simulator_law(*PADS[name])
    assert law.model == ("solver" if name == "solver" else "fast laws")
    for place in (0, 63):
        solved = fp.solve_contact(
            law.pad.placement, law.pad.tissue, indentation=law.indentation[place], points=128
        )
        assert law.load[place] == pytest.approx(solved.load, rel=0.01)
        assert law.area[place] == pytest.approx(solved.area, rel=0.015)


def test_pressure_by_depth_has_the_load_over_the_overlap(law) -> None:
    table = law.pressure_by_depth()
    found, wanted = loads_of(law, table.pressure_at)
    assert found == pytest.approx(wanted, rel=2e-3)
    assert table.worst_relative_error < 1e-3
    assert (np.diff(table.pressure) > 0).all()
    assert table.pressure_at([-1.0, 0.0]).tolist() == [0, 0]
    assert round(table.pressure_at(0)) == 0  # a number for a number
    assert table.pressure_at(2 * table.depth[-1]) > table.pressure[-1]


def test_newton_kh_has_the_smallest_worst_error(law) -> None:
    found = law.newton_kh()
    loads, wanted = loads_of(law, lambda depth: found.kh * depth)
    error = loads / wanted - 1
    assert np.abs(error).max() <= found.worst_relative_error + 2e-3
    error = found.kh * law.pad.curve.overlap(law.indentation) * 1e-9 / law.load - 1
    assert error.max() == pytest.approx(-error.min(), rel=1e-6)
    assert error.max() == pytest.approx(found.worst_relative_error)


def test_area_factor_is_that_of_the_geometric_overlap(law) -> None:
    factors = []
    for place in range(0, 64, 9):
        depth, cell = overlap(law, law.indentation[place])
        factors.append((depth > 0).sum() * cell / law.area[place])
    worst = max(factors, key=lambda factor: abs(math.log(factor)))
    assert law.newton_kh().area_factor == pytest.approx(worst, rel=0.02)


def test_drake_modulus_by_the_field_of_an_ellipsoid() -> None:
    law = usual()
    found = law.drake_modulus()
    normal, height = PLACE.normal, float(PLACE.normal @ PLACE.point)
    along = np.array([-normal[1], normal[0], 0])
    side = np.linspace(-14, 14, 501)
    x, y = np.meshgrid(side, side)
    error = []
    for indentation, load in zip(law.indentation[::21], law.load[::21], strict=True):
        points = (
            (height - indentation) * normal + x[..., None] * along + y[..., None] * np.cross(normal, along)
        )
        extent = np.maximum(1 - np.linalg.norm(points / PAD.semi_axes, axis=-1), 0)
        error.append(found.modulus * extent.sum() * (side[1] - side[0]) ** 2 * 1e-6 / load - 1)
    assert np.abs(error).max() == pytest.approx(found.worst_relative_error, abs=1e-3)
    assert law.drake_modulus(mesh=law.mesh(4)).modulus == pytest.approx(found.modulus, rel=0.03)


def pressed(contact, *, mass, time_step):
    """Return an ellipsoid that touches a plate in MuJoCo."""
    solref, solimp = (
        " ".join(f"{number:.12g}" for number in each) for each in (contact.solref, contact.solimp)
    )
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{time_step}" gravity="0 0 0"/><worldbody>'
        '<geom type="plane" size="1 1 1"/>'
        f'<body pos="0 0 .0079"><joint name="press" type="slide" axis="0 0 -1"/><geom type="ellipsoid" '
        f'size=".0138 .0118 .0079" mass="{mass}" priority="1" solref="{solref}" solimp="{solimp}"/></body>'
        '</worldbody><actuator><motor joint="press"/></actuator></mujoco>'
    )
    return model, mujoco.MjData(model)


def run(contact, load, *, mass, time_step=0.0005, seconds=6.0, start=0.0):
    """Press an ellipsoid in MuJoCo; return penetration and speed at the end."""
    model, data = pressed(contact, mass=mass, time_step=time_step)
    data.ctrl[0], data.qpos[0] = load, start
    mujoco.mj_step(model, data, round(seconds / time_step))
    return float(data.qpos[0]), abs(float(data.qvel[0]))


@pytest.mark.parametrize("mass", [0.02, 0.5])
def test_mujoco_is_at_rest_where_the_law_says(mass) -> None:
    law = usual()
    found = law.mujoco(effective_mass=mass)
    for place in (0, 30, 63):
        depth, speed = run(found, law.load[place], mass=mass)
        assert speed < 1e-8
        assert found.load(depth) == pytest.approx(law.load[place], rel=1e-6)
        assert law.pad.curve.load(np.array(1e3 * depth)) == pytest.approx(
            law.load[place], rel=found.worst_relative_error + 1e-3
        )


def test_mujoco_at_twice_the_mass() -> None:
    one, two = (usual().mujoco(effective_mass=mass) for mass in (0.1, 0.2))
    assert one.solref_at_twice_the_mass == pytest.approx(two.solref)
    assert one.solimp == pytest.approx(two.solimp)
    assert one.load(0.001) == pytest.approx(two.load(0.001))


@pytest.mark.parametrize("damping_ratio", [0.1, 1.0])
def test_largest_time_step(damping_ratio) -> None:
    law = usual()
    found = law.mujoco(effective_mass=0.001, damping_ratio=damping_ratio)
    assert found.flag == "time_step_below_default"
    step = found.largest_time_step
    near = {"mass": 0.001, "seconds": 3000 * step, "start": 0.999e-3 * law.indentation[-1]}
    assert run(found, 3.0, **near, time_step=0.95 * step)[1] < 1e-6
    assert run(found, 3.0, **near, time_step=1.2 * step)[1] > 1e-3


def test_mujoco_damping_ratio() -> None:
    law = usual()
    found = law.mujoco(effective_mass=0.1, damping_ratio=0.2)
    model, data = pressed(found, mass=0.1, time_step=1e-5)
    rest = run(found, law.load[32], mass=0.1)[0]
    data.ctrl[0], data.qpos[0] = law.load[32], rest + 1e-6
    apart = []
    for _ in range(20000):
        mujoco.mj_step(model, data)
        apart.append(data.qpos[0] - rest)
    apart = np.array(apart)
    peaks = apart[1:-1][(apart[1:-1] > apart[:-2]) & (apart[1:-1] > apart[2:]) & (apart[1:-1] > 1e-9)]
    decrement = math.log(peaks[0] / peaks[1])
    assert decrement / math.hypot(2 * math.pi, decrement) == pytest.approx(0.2, rel=0.01)


AXES_STD = {"palmar": 0.1, "distal": 0.2, "radial_ulnar": 0.3}
STDS = {"youngs_modulus": 0.005, "thickness": 0.5, "wedge_angle": 0.02, **AXES_STD}


def numbers(law):
    table = law.pressure_by_depth()
    return {
        "kh": law.newton_kh().kh,
        "modulus": law.drake_modulus().modulus,
        "pressure": float(table.pressure_at(0.001)),
    }


def changed(name, by):
    pad = {each: float(getattr(PAD, each)) for each in ("palmar", "distal", "radial_ulnar")}
    other = {"wedge_angle": np.radians(30), "youngs_modulus": 0.05, "thickness": 8.0}
    values = pad | other
    values[name] += by
    place = fp.Placement(fp.Ellipsoid(*(values[each] for each in pad)), wedge_angle=values["wedge_angle"])
    return numbers(simulator_law(place, fp.Tissue(values["youngs_modulus"], 0.5, values["thickness"])))


@pytest.mark.parametrize("name", STDS)
def test_band_of_each_input(name) -> None:
    std = 0.1 * STDS[name]
    law = usual(stds={name: std})
    up, down = changed(name, std), changed(name, -std)
    table = law.pressure_by_depth()
    bands = {
        "kh": law.newton_kh().kh_std,
        "modulus": law.drake_modulus().modulus_std,
        "pressure": float(np.interp(0.001, table.depth, table.pressure_std)),
    }
    for key, band in bands.items():
        assert band == pytest.approx(abs(up[key] - down[key]) / 2, rel=0.05, abs=1e-4 * up[key]), key


def test_band_is_the_sum_of_squares() -> None:
    each = [usual(stds={name: std}).newton_kh().kh_std for name, std in STDS.items()]
    both = usual(stds=STDS).newton_kh().kh_std
    assert both == pytest.approx(math.hypot(*each), rel=1e-6)


BAD = {
    "loads descend": (lambda: usual(loads=(3.0, 0.2)), "loads must be two that ascend"),
    "loads beyond the pad": (lambda: simulator_law(PLACE, fp.Tissue(0.01)), "the load would flatten"),
    "no tissue": (lambda: simulator_law(PLACE, 0.05), "must be a Tissue"),
    "unknown uncertainty": (lambda: usual(stds={"modulus": 1.0}), "no standard uncertainty of 'modulus'"),
    "thickness of deep tissue": (
        lambda: simulator_law(PLACE, fp.Tissue(0.06), (0.1, 1.0), stds={"thickness": 1.0}),
        "no standard uncertainty of 'thickness'",
    ),
    "negative uncertainty": (lambda: usual(stds={"thickness": -1.0}), "positive or zero"),
    "uncertainty beyond the laws": (
        lambda: simulator_law(*PADS["solver"], stds={"thickness": 0.5}),
        "needs the fast laws",
    ),
    "no mass": (lambda: usual().mujoco(0.0), "effective_mass must be positive"),
    "mass too small": (lambda: usual().mujoco(1e-8), "effective_mass must be at least .* time steps below"),
    "negative damping": (lambda: usual().mujoco(0.1, -1.0), "damping_ratio must be positive"),
    "no inside": (lambda: simulator_law(*PADS["paraboloid"]).drake_modulus(), "needs a pad"),
    "mesh elsewhere": (
        lambda: usual().drake_modulus(
            TetrahedralMesh(usual().mesh(1).points / 3, usual().mesh(1).tetrahedra)
        ),
        "cut by the plate",
    ),
    "flat tetrahedron": (
        lambda: TetrahedralMesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2, 3]]),
        "must have a volume",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input(name) -> None:
    call, message = BAD[name]
    with pytest.raises(fp.FingerpadError, match=message):
        call()
