"""Linear finite elements of the exported tissue, pressed by a plate without friction."""

from typing import Final

import numpy as np
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import splu

from fingerpad._arrays import FloatArray
from fingerpad.exceptions import ConvergenceError
from fingerpad.simulator.mesh import MIDDLES, LayerMesh

_CORNERS: Final = np.eye(4)
# Four points that integrate quadratics over a tetrahedron, six that integrate quartics over a triangle.
_INSIDE: Final = 0.1381966011250105 + 0.4472135954999580 * _CORNERS
_ON_FACE: Final = np.concatenate(
    [part + (1 - 3 * part) * np.eye(3) for part in (0.4459484909159649, 0.0915762135097707)]
)
_ON_FACE_WEIGHTS: Final = np.repeat([0.2233815896780115, 0.1099517436553219], 3)
# Corners of the faces of a cell, then the middles of the edges between the first and second, and so on.
_FACES: Final = ((0, 1, 2, 4, 5, 6), (0, 1, 3, 4, 8, 7), (1, 2, 3, 5, 9, 8), (0, 2, 3, 6, 9, 7))
HIGHEST_POISSON_RATIO: Final = 0.49  # that elements of displacements alone take
_PENALTY: Final = 500.0  # of an overlap, in E over the thickness
_TOUCHED: Final = 0.8  # of the overlap with the plate; the area in contact is smaller
_MOVES: Final = 60
_SETTLED: Final = 1e-5  # change of the load


class TissueElements:
    """Flexibility of a layer's skin along the plate's normal, for E = 1, where a plate may touch it.

    The mesh's bone is held, all else is free; `stiffness` (3n, 3n) has three rows for each point. `gap` (n,)
    lies between point and plate at touch, mm, as is the largest indentation `deepest`.
    """

    def __init__(
        self, mesh: LayerMesh, stiffness: csc_array, *, normal: FloatArray, gap: FloatArray, deepest: float
    ) -> None:
        held = np.zeros(len(mesh.points), dtype=bool)
        held[mesh.skin] = True
        faces = np.concatenate([mesh.tetrahedra[:, face] for face in _FACES])
        faces = faces[held[faces].all(axis=1) & (gap[faces].min(axis=1) < _TOUCHED * deepest)]
        nodes, place = np.unique(faces, return_inverse=True)
        shape, slope = _quadratic(_ON_FACE, ((0, 1), (1, 2), (2, 0)))
        sides = np.einsum("fni,qna->fqai", mesh.points[faces], slope[..., 1:] - slope[..., :1])
        area = np.abs(np.cross(sides[:, :, 0], sides[:, :, 1]) @ normal) / 2
        # Of points on the skin: their share of the plate's area, the gap, and how they follow the nodes.
        self.weight: FloatArray = (area * _ON_FACE_WEIGHTS).reshape(-1)
        self.gap: FloatArray = (gap[faces] @ shape.T).reshape(-1)
        follow = np.zeros((*area.shape, len(nodes)))
        at = np.broadcast_to(place.reshape(-1, 1, 6), (*area.shape, 6))
        np.put_along_axis(follow, at, shape[None], axis=-1)
        self.shape: FloatArray = follow.reshape(-1, len(nodes))
        free = np.ones(len(mesh.points), dtype=bool)
        free[mesh.bone] = False
        kept = np.flatnonzero(np.repeat(free, 3))
        forces = np.zeros((3 * len(mesh.points), len(nodes)))
        for axis in range(3):
            forces[3 * nodes + axis, np.arange(len(nodes))] = normal[axis]
        solved = splu(stiffness[kept][:, kept], options={"SymmetricMode": True})
        self.flexibility: FloatArray = forces[kept].T @ solved.solve(forces[kept])
        self.penalty = _PENALTY / mesh.depth.max()

    def load(self, indentation: float) -> float:
        """Return the load over E at an indentation."""
        overlap = indentation - self.gap
        touching, before = overlap > 0, np.inf
        for _ in range(_MOVES):
            shape, weight = self.shape[touching], self.penalty * self.weight[touching]
            matrix = shape.T @ (weight[:, None] * shape)
            forces = np.linalg.solve(
                np.eye(len(matrix)) + matrix @ self.flexibility, shape.T @ (weight * overlap[touching])
            )
            left = overlap - self.shape @ (self.flexibility @ forces)
            load = float(forces.sum())
            if abs(load - before) <= _SETTLED * load:
                return load
            touching, before = left > 0, load
        raise ConvergenceError(f"no contact of the elements was found at {indentation:g} mm")


def _quadratic(at: FloatArray, edges: tuple[tuple[int, int], ...]) -> tuple[FloatArray, FloatArray]:
    """Return quadratic shape functions at barycentric places, and their slopes along each coordinate."""
    one, other = np.array(edges).T
    shape = np.concatenate([at * (2 * at - 1), 4 * at[:, one] * at[:, other]], axis=1)
    corners = np.eye(at.shape[1])
    slope = np.concatenate(
        [
            (4 * at - 1)[:, :, None] * corners,
            4 * (at[:, one, None] * corners[other] + at[:, other, None] * corners[one]),
        ],
        axis=1,
    )
    return shape, slope


def stiffness_of(mesh: LayerMesh, poisson_ratio: float) -> csc_array:
    """Return the stiffness of the elements, E = 1, three rows for each point."""
    points, cells = mesh.points, mesh.tetrahedra
    second = 1 / (2 * (1 + poisson_ratio))
    first = 2 * second * poisson_ratio / (1 - 2 * poisson_ratio)
    _, slope = _quadratic(_INSIDE, MIDDLES)
    local = slope[..., 1:] - slope[..., :1]
    jacobian = np.einsum("cni,qna->cqia", points[cells], local)
    gradient = np.einsum("qna,cqai->cqni", local, np.linalg.inv(jacobian))
    weight = np.linalg.det(jacobian) / 24
    pairs = np.einsum("cq,cqni,cqmj->cnimj", weight, gradient, gradient, optimize=True)
    each = first * pairs + second * np.swapaxes(pairs, 2, 4)
    each += second * np.einsum("cnkmk,ij->cnimj", pairs, np.eye(3))
    rows = (3 * cells[..., None] + np.arange(3)).reshape(len(cells), 30)
    size = 3 * len(points)
    return coo_array(
        (
            each.reshape(-1),
            (np.repeat(rows, 30, axis=1).reshape(-1), np.tile(rows, (1, 30)).reshape(-1)),
        ),
        shape=(size, size),
    ).tocsc()
