"""Load of finite elements over that of the solver: the same layer first, then one thing changed at a time.

The solver's layer is flat and has no sides; the tissue of ``finger.inp`` is bent as the finger is, and its
sides are free. The flat layers lie under the same pad's gap. The last row is the exported file, read by
meshio and assembled by scikit-fem.
"""

import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np
from scipy.sparse import csc_array
from scipy.spatial import cKDTree

from benchmarks.arrays import Array
from benchmarks.simulated import PLACED
from benchmarks.tables import table
from fingerpad import Ellipsoid, Placement, Tissue, solve_contact
from fingerpad.contact.contact import AnyPlacement
from fingerpad.simulator import export_finger, simulator_law
from fingerpad.simulator.elements import TissueElements, stiffness_of
from fingerpad.simulator.mesh import MIDDLES, LayerMesh, layer_mesh

THICKNESS: Final = 8.0
INDENTATIONS: Final = (0.3, 0.75, 1.5, 2.2)
# Share of the rings that are even, up to which radius, and the rim's, mm.
_EVEN, _REACH, _FAR = 0.65, 8.5, 32.0
_BEYOND: Final = 1e3


def wide_layer(place: AnyPlacement, thickness: float, *, rings: int, layers: int) -> tuple[LayerMesh, Array]:
    """Return a flat layer that ends far from the contact, its plate's normal x, and the pad's gap to it."""
    round_pad = Placement(Ellipsoid(10, 10, 10), wedge_angle=0.0)
    mesh = layer_mesh(round_pad, thickness, rings=rings, layers=layers)
    lateral = mesh.points[:, 1:]
    radius = np.linalg.norm(lateral, axis=1)
    share = np.arcsin(np.minimum(radius / 10, 1)) / (np.pi / 3)
    beyond = np.maximum((share - _EVEN) / (1 - _EVEN), 0)
    wanted = np.minimum(share, _EVEN) / _EVEN * _REACH * (_FAR / _REACH) ** beyond
    points = np.column_stack([-mesh.depth, lateral * (wanted / np.maximum(radius, 1e-12))[:, None]])
    for middle, edge in enumerate(MIDDLES, start=4):
        points[mesh.tetrahedra[:, middle]] = points[mesh.tetrahedra[:, edge]].mean(axis=1)
    gap = place.gap.height(points[:, 1], points[:, 2])
    return replace(mesh, points=points), np.nan_to_num(gap, nan=_BEYOND)


def bent_layer(place: Placement, thickness: float, bend: float, **size: int) -> tuple[LayerMesh, Array]:
    """Return the exported tissue with its plate's distance times `bend`: 0 is flat with the same sides."""
    mesh = layer_mesh(place, thickness, **size)
    gap = (mesh.points @ place.normal).max() - mesh.points @ place.normal - mesh.depth
    return replace(mesh, points=mesh.points + np.outer((1 - bend) * gap, place.normal)), gap


def rows_of(tissue: Tissue, indentations: tuple[float, ...], **size: int) -> Iterator[tuple[str, Array]]:
    """Yield what was changed, and the load of the elements over the solver's."""
    solved = np.array([solve_contact(PLACED, tissue, indentation=at).load for at in indentations])
    thickness, ratio = float(tissue.thickness), float(tissue.poisson_ratio)
    across = np.array([1.0, 0.0, 0.0])
    cases = [("flat and wide, as the solver's", across, *wide_layer(PLACED, thickness, **size))]
    bends = {"flat, free sides where the export ends": 0.0, "bent by half": 0.5, "bent as the pad": 1.0}
    for words, bend in bends.items():
        cases.append((words, PLACED.normal, *bent_layer(PLACED, thickness, bend, **size)))
    for words, normal, mesh, gap in cases:
        stiffness = stiffness_of(mesh, ratio)
        elements = TissueElements(mesh, stiffness, normal=normal, gap=gap, deepest=indentations[-1])
        load = np.array([elements.load(at) for at in indentations])
        yield words, float(tissue.youngs_modulus) * load / solved


def assembled(points: Array, cells: Array, poisson_ratio: float, *, order: int) -> csc_array:
    """Return the stiffness for E = 1 MPa by scikit-fem, its rows in the order of the points."""
    from skfem import Basis, ElementTetP2, ElementVector, MeshTet2  # noqa: PLC0415 (optional)
    from skfem.models.elasticity import lame_parameters, linear_elasticity  # noqa: PLC0415 (optional)

    basis = Basis(MeshTet2(points.T, cells.T), ElementVector(ElementTetP2()), intorder=order)
    stiffness = linear_elasticity(*lame_parameters(1.0, poisson_ratio)).assemble(basis).tocsc()
    rows = np.concatenate([basis.nodal_dofs, basis.edge_dofs], axis=1)
    _, place = cKDTree(basis.doflocs[:, rows[0]].T).query(points)
    rows = rows[:, place].T.reshape(-1)
    return stiffness[rows][:, rows]


def exported_loads(folder: Path, indentations: tuple[float, ...], normal: Array) -> Array:
    """Return the loads of ``finger.inp`` as meshio reads it and scikit-fem assembles it, N."""
    import meshio  # noqa: PLC0415 (optional)

    file = folder / "finger.inp"
    read = meshio.read(file)
    points, cells = read.points, read.cells_dict["tetra10"]
    elastic = file.read_text(encoding="utf-8").split("*ELASTIC\n")[1].split("\n")[0]
    modulus, ratio = map(float, elastic.split(","))
    height, skin, bone = points @ normal, read.point_sets["SKIN"], read.point_sets["BONE"]
    mesh = LayerMesh(points=points, depth=height, tetrahedra=cells, skin=skin, bone=bone)
    stiffness, gap = assembled(points, cells, ratio, order=3), height.max() - height
    elements = TissueElements(mesh, stiffness, normal=normal, gap=gap, deepest=indentations[-1])
    return modulus * np.array([elements.load(at) for at in indentations])


def report(rings: int = 10, layers: int = 3, poisson_ratio: float = 0.49) -> None:
    """Print the steps from the solver's layer to the exported tissue of the usual pad."""
    tissue = Tissue(0.05, poisson_ratio, THICKNESS)
    rows = list(rows_of(tissue, INDENTATIONS, rings=rings, layers=layers))
    with tempfile.TemporaryDirectory() as folder:
        export_finger(simulator_law(PLACED, tissue, (0.2, 3.0)), Path(folder), effective_mass=0.1)
        load = exported_loads(Path(folder), INDENTATIONS, PLACED.normal)
    solved = np.array([solve_contact(PLACED, tissue, indentation=at).load for at in INDENTATIONS])
    rows.append(("`finger.inp` by scikit-fem", load / solved))
    cells = ((words, *(f"{one:.2f}" for one in ratio)) for words, ratio in rows)
    table(("elements", *(f"{at:g} mm" for at in INDENTATIONS)), cells)
