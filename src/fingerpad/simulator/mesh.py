"""Meshes of a pad: its surface, its inside for Drake, and its tissue over bone for finite elements."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import FloatArray, as_float_array, set_fields
from fingerpad._display import Displayed
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Ellipsoid, Placement

Indices: TypeAlias = npt.NDArray[np.intp]

_FACES: Final = ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))  # of a tetrahedron, seen from outside in order
# Edges that a plane cuts, in order around the section, by how many vertices lie above it: those come first.
_CUT_EDGES: Final = {
    1: ((0, 0, 0), (1, 2, 3)),
    2: ((0, 0, 1, 1), (2, 3, 3, 2)),
    3: ((0, 1, 2), (3, 3, 3)),
}
MIDDLES: Final = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))  # edges of a ten-node tetrahedron
_MIRRORED: Final = (0, 2, 1, 3, 6, 5, 4, 7, 9, 8)  # the same tetrahedron of ten nodes, two corners exchanged
_FLATTEST: Final = 0.1  # height of an element over its width
_WIDEST: Final = np.pi / 3  # from the place of contact to the mesh's rim, on the unit sphere
_STEEPEST: Final = 0.3  # cosine of the skin there to the plate
_GOLDEN: Final = (1 + 5**0.5) / 2


@dataclass(frozen=True, slots=True, init=False, eq=False, repr=False)
class TetrahedralMesh(Displayed):
    """A convex body of tetrahedra.

    Attributes
    ----------
    points : ndarray, shape (n, 3)
        Vertices, mm.
    tetrahedra : ndarray of int, shape (m, 4)
        Indices of their vertices, of positive volume.

    Raises
    ------
    GeometryError
        If an array has another shape, or a tetrahedron has no volume.

    Examples
    --------
    >>> corner = TetrahedralMesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2, 3]])
    >>> print(f"{corner.volume:.4f}")
    0.1667
    """

    points: FloatArray
    tetrahedra: Indices

    def __init__(self, points: npt.ArrayLike, tetrahedra: npt.ArrayLike) -> None:
        vertices = as_float_array(points, "points")
        cells: Indices = np.array(tetrahedra, dtype=np.intp)
        for name, array, width in (("points", vertices, 3), ("tetrahedra", cells, 4)):
            if array.ndim != 2 or array.shape[1] != width or not len(array):
                raise GeometryError(f"{name} must have the shape (n, {width}), found {array.shape}")
        volume = signed_volumes(vertices, cells)
        if not (volume != 0).all():
            raise GeometryError("every tetrahedron must have a volume, found one without")
        cells[volume < 0] = cells[volume < 0][:, [0, 2, 1, 3]]
        set_fields(self, points=vertices, tetrahedra=cells)

    @property
    def volume(self) -> float:
        """Volume, mm³."""
        return float(signed_volumes(self.points, self.tetrahedra).sum())

    @property
    def surface(self) -> Indices:
        """Triangles of the surface, shape (k, 3), their vertices anticlockwise seen from outside."""
        faces = np.concatenate([self.tetrahedra[:, face] for face in _FACES])
        _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
        return np.asarray(faces[first[count == 1]])

    @property
    def extent(self) -> FloatArray:
        """Depth of each vertex below the surface, over that of the deepest: Drake's pressure field."""
        corners = self.points[self.surface]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        depth = np.zeros(len(self.points))
        inside = np.setdiff1d(np.arange(len(depth)), self.surface)
        if not len(inside):
            raise GeometryError("the mesh must have a vertex inside: Drake's pressure is zero on the surface")
        height = np.sum(normal * corners[:, 0], axis=1)
        depth[inside] = [float((height - normal @ self.points[each]).min()) for each in inside]
        return np.asarray(depth / depth.max())

    def sections(self, normal: FloatArray, heights: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return what planes cut: their areas, and the integrals of the extent over them.

        Parameters
        ----------
        normal : ndarray, shape (3,)
            Unit normal of the planes.
        heights : ndarray, shape (n,)
            Of the planes over the origin, along the normal.

        Returns
        -------
        tuple of ndarray, shape (n,)
            Area and ∫ e dA, mm².
        """
        along, extent = self.points @ normal, self.extent
        cuts = np.array([self._section(along - height, extent) for height in heights])
        return cuts[:, 0], cuts[:, 1]

    def _section(self, side: FloatArray, extent: FloatArray) -> FloatArray:
        side = np.where(side == 0, 1e-12, side)  # a plane through a vertex cuts as one next to it
        above = side[self.tetrahedra] > 0
        total = np.zeros(2)
        for count, edges in _CUT_EDGES.items():
            cut = above.sum(axis=1) == count
            order = np.argsort(~above[cut], axis=1, kind="stable")
            corners = np.take_along_axis(self.tetrahedra[cut], order, axis=1)
            start, end = corners[:, edges[0]], corners[:, edges[1]]
            part = side[start] / (side[start] - side[end])
            points = self.points[start] + part[..., None] * (self.points[end] - self.points[start])
            values = extent[start] + part * (extent[end] - extent[start])
            for last in range(2, len(edges[0])):
                triangle = [0, last - 1, last]
                a, b, c = np.moveaxis(points[:, triangle], 1, 0)
                area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
                total += area.sum(), (area * values[:, triangle].mean(axis=1)).sum()
        return total


def signed_volumes(points: FloatArray, cells: Indices) -> FloatArray:
    """Return the volumes of tetrahedra, by the corners of their cells."""
    a, b, c, d = np.moveaxis(points[cells[:, :4]], 1, 0)
    return np.asarray(np.sum(np.cross(b - a, c - a) * (d - a), axis=1) / 6)


def sphere(level: int) -> tuple[FloatArray, Indices]:
    """Return the vertices and triangles of a unit sphere, of an icosahedron's each divided `level` times."""
    if level not in range(1, 7):
        raise GeometryError(f"level must be a whole number from 1 to 6, found {level}")
    turns = [
        np.roll([0, one, other * _GOLDEN], turn) for turn in range(3) for one in (-1, 1) for other in (-1, 1)
    ]
    points = np.array(turns, dtype=float)
    near = np.isclose(np.linalg.norm(points[:, None] - points, axis=-1), 2)
    triangles = np.array(
        [
            (i, j, k)
            for i in range(12)
            for j in range(i)
            for k in range(j)
            if near[i, j] and near[j, k] and near[i, k]
        ]
    )
    for _ in range(level):
        edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        unique, place = np.unique(edges, axis=0, return_inverse=True)
        middle = len(points) + place.reshape(-1, 3)
        points = np.concatenate([points, points[unique].mean(axis=1)])
        points /= np.linalg.norm(points, axis=1, keepdims=True)
        (a, b, c), (ab, bc, ca) = triangles.T, middle.T
        triangles = np.concatenate(
            [np.stack(each, axis=1) for each in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
        )
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    inward = np.linalg.det(points[triangles]) < 0
    triangles[inward] = triangles[inward][:, ::-1]
    return points, triangles


def pad_mesh(pad: Ellipsoid, level: int) -> TetrahedralMesh:
    """Return a pad as tetrahedra from its centre to the triangles of its surface."""
    points, triangles = sphere(level)
    centre = np.full((len(triangles), 1), len(points))
    return TetrahedralMesh(
        np.concatenate([points * pad.semi_axes, np.zeros((1, 3))]),
        np.concatenate([centre, triangles], axis=1),
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LayerMesh:
    """The tissue around the place of contact, from the skin to the bone, of ten-node tetrahedra.

    The bone is the skin moved inwards along the plate's normal, so that the tissue is equally thick
    everywhere, as in the law.
    """

    points: FloatArray
    depth: FloatArray  # of each point below the skin
    tetrahedra: Indices  # four corners, then the middles of edges 12, 23, 31, 14, 24, 34, as in Abaqus
    skin: Indices
    bone: Indices


def layer_mesh(placement: Placement, thickness: float, *, rings: int = 12, layers: int = 4) -> LayerMesh:
    """Return the layer of tissue (thickness in mm) over bone around the place of contact of one pad.

    `rings` of elements lie around that place, `layers` from skin to bone.
    """
    axes, normal = placement.ellipsoid.semi_axes, placement.normal
    polar = _WIDEST
    while True:
        directions, triangles = _cap(placement.point / axes, rings, polar)
        outward = directions / axes
        if (outward @ normal > _STEEPEST * np.linalg.norm(outward, axis=1)).all():
            break
        polar *= 0.9
    width = polar / rings * float(axes.mean())
    if not _FLATTEST * width * layers <= thickness < np.inf:
        least = _FLATTEST * width * layers
        raise GeometryError(f"thickness must be finite and at least {least:.2g} mm, found {thickness:g}")
    count = len(directions)
    direction = np.tile(directions, (layers + 1, 1))
    inward = np.repeat(np.linspace(0, 1, layers + 1), count)
    # Each prism is cut by the diagonals from its lowest vertices, so that neighbours agree.
    a, b, c = np.sort(np.concatenate([triangles + layer * count for layer in range(layers)]), axis=1).T
    prisms = ((a, b, c, c + count), (a, b, b + count, c + count), (a, a + count, b + count, c + count))
    corners = np.concatenate([np.stack(each, axis=1) for each in prisms])
    edges = np.sort(corners[:, MIDDLES].reshape(-1, 2), axis=1)
    unique, where = np.unique(edges, axis=0, return_inverse=True)
    middle = direction[unique].sum(axis=1)
    direction = np.concatenate([direction, middle / np.linalg.norm(middle, axis=1, keepdims=True)])
    inward = np.concatenate([inward, inward[unique].mean(axis=1)])
    points = direction * axes - thickness * inward[:, None] * normal
    cells = np.concatenate([corners, (layers + 1) * count + where.reshape(-1, 6)], axis=1)
    turned = signed_volumes(points, cells) < 0
    cells[turned] = cells[turned][:, _MIRRORED]
    return LayerMesh(
        points=points,
        depth=thickness * inward,
        tetrahedra=cells,
        skin=np.flatnonzero(inward == 0),
        bone=np.flatnonzero(inward == 1),
    )


def _cap(axis: FloatArray, rings: int, widest: float) -> tuple[FloatArray, Indices]:
    """Return directions and triangles of a cap, six more of them on each ring about an axis."""
    first = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    first /= np.linalg.norm(first)
    second = np.cross(axis, first)
    points, triangles = [axis[None]], []
    begin = [0, *(1 + 3 * ring * (ring - 1) for ring in range(1, rings + 2))]
    for ring in range(1, rings + 1):
        polar, around = widest * ring / rings, 2 * np.pi * np.arange(6 * ring)[:, None] / (6 * ring)
        points.append(
            np.cos(polar) * axis + np.sin(polar) * (np.cos(around) * first + np.sin(around) * second)
        )
        for side in range(6):
            for step in range(ring):
                outer = begin[ring] + side * ring + step
                following = begin[ring] + (side * ring + step + 1) % (6 * ring)
                inside = max(6 * (ring - 1), 1)
                inner = begin[ring - 1] + (side * (ring - 1) + step) % inside
                triangles.append((outer, following, inner))
                if step < ring - 1:
                    triangles.append(
                        (inner, following, begin[ring - 1] + (side * (ring - 1) + step + 1) % inside)
                    )
    return np.concatenate(points), np.array(triangles)
