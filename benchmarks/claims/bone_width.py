"""A bone narrower than the pad, by finite elements.

Needs scikit-fem, which is no dependency of fingerpad: ``pip install scikit-fem``. With ``pip install
pypardiso`` it takes a fraction of the time.

Tissue is a block with a flat surface, fixed at its base, with a rigid strip of bone along the finger inside.
Finite elements give by how much the bone changes the displacement of the surface under pressure on any cell
of a grid: quadratic hexahedra, a quarter of the block. What they err by close to the pressure cancels in
that change, which is added to the exact influence of the layer without a bone. The contact under the pad's
gap is then solved on the grid, and compared with that of a layer of uniform thickness by the fast laws.
"""

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq
from scipy.sparse import bmat
from scipy.sparse.linalg import splu

from fingerpad._arrays import FloatArray
from fingerpad.contact.fast_laws import plate_gap, press
from fingerpad.contact.grid import contact_outline
from fingerpad.contact.influence import influence as uniform_influence
from fingerpad.geometry import Ellipsoid, Gap, Placement

TABLE_1 = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
# Wedge angle (degrees), printed contact area (mm²), measured axis along the finger over across.
PRINTED = ((30.0, 116.3, 1.48), (45.0, 69.4, 1.26))
_CELLS = 32  # of the contact's grid along each side of a quarter
_FAR = 32.0  # half of the block's sides, mm
_BESIDE = 6.0  # from the bone's side to where mesh lines that follow a round bone are flat again, mm


@dataclass(frozen=True, kw_only=True)
class Bone:
    """A rigid strip along the finger: half of its width, depth of its top, and whether that is round, mm.

    An infinite width is a layer. The tissue beside it is `base` thick.
    """

    half_width: float = math.inf
    depth: float = math.inf
    round_top: bool = False
    base: float = 12.0

    def top(self, x: FloatArray) -> FloatArray:
        """Return the depth of the plane of the mesh that has its top, x across the finger."""
        flat = np.full_like(x, self.depth)
        if not self.round_top:
            return flat
        r = self.half_width
        above = r - np.sqrt(np.maximum(r**2 - x**2, 0.0))
        return flat + np.where(x <= r, above, r * np.clip(1 - (x - r) / _BESIDE, 0, 1))


@dataclass(frozen=True, kw_only=True)
class Mesh:
    """Size of elements under the contact, mm; the cells that are loaded are half of it."""

    side: float = 1.0
    reach: float = 9.0  # of the grid, half of its sides
    poisson_ratio: float = 0.49

    @property
    def cell(self) -> float:
        """Side of a loaded cell."""
        return self.side / 2

    @property
    def count(self) -> int:
        """Loaded cells along each side of a quarter."""
        return 2 * round(self.reach / self.side)

    @property
    def grid(self) -> FloatArray:
        """Centres of the contact's cells along a side of a quarter."""
        return (np.arange(_CELLS) + 0.5) * self.reach / _CELLS


class Contact(NamedTuple):
    """A contact: load over E*, indentation, area, and its axis along the finger over that across."""

    load: float
    indentation: float
    area: float
    along_over_across: float

    @property
    def radius(self) -> float:
        """A/(πξ)."""
        return self.area / (math.pi * self.indentation)


def _lines(mesh: Mesh) -> FloatArray:
    """Return coordinates of a lateral side: even under the contact, then coarser."""
    steps = [mesh.side] * round(mesh.reach / mesh.side)
    while sum(steps) < _FAR:
        steps.append(min(1.5 * steps[-1], 6.0))
    return np.append(0.0, np.cumsum(steps))


def _depths(bone: Bone, mesh: Mesh, depth: float) -> FloatArray:
    """Return depths of the planes of the mesh, with one at the top of a bone."""
    above = np.linspace(0, depth, max(round(depth / mesh.side), 2) + 1)
    below = np.linspace(depth, bone.base, max(round((bone.base - depth) / (1.5 * mesh.side)), 2) + 1)
    return np.append(above, below[1:])


@cache
def _system(bone: Bone, mesh: Mesh, depth: float) -> tuple[Any, FloatArray]:
    """Return the stiffness for E* = 1, component by component, and the places of its nodes.

    The mesh has a plane at `depth`, which follows the bone's top.
    """
    from skfem import Basis, BilinearForm, ElementHex2, MeshHex, asm  # noqa: PLC0415 (optional)

    side, planes = _lines(mesh), _depths(bone, mesh, depth)
    block = MeshHex.init_tensor(side, side, planes)
    if bone.round_top:
        p = block.p.copy()
        top = bone.top(p[0])
        above = p[2] <= depth + 1e-9
        p[2] = np.where(
            above, p[2] * top / depth, top + (p[2] - depth) / (bone.base - depth) * (bone.base - top)
        )
        block = MeshHex(p, block.t)
    nu = mesh.poisson_ratio
    # E* = 1; changes of volume are integrated with fewer points, so that elements do not lock.
    first, second = (1 - nu**2) * nu / ((1 + nu) * (1 - 2 * nu)), (1 - nu**2) / (2 * (1 + nu))
    full, reduced = (Basis(block, ElementHex2(), intorder=order) for order in (5, 3))

    def product(basis: Any, one: int, other: int) -> Any:
        return asm(BilinearForm(lambda u, v, _: u.grad[one] * v.grad[other]), basis)

    pairs = [(i, j) for i in range(3) for j in range(i, 3)]
    shear, volume = (
        {key: matrix for pair in pairs for key, matrix in _both(pair, product(basis, *pair))}
        for basis in (full, reduced)
    )
    laplace = shear[0, 0] + shear[1, 1] + shear[2, 2]
    blocks = [
        [
            first * volume[j, i] + second * shear[i, j] + (second * laplace if i == j else 0 * laplace)
            for j in range(3)
        ]
        for i in range(3)
    ]
    return bmat(blocks, format="csc"), full.doflocs


def _both(pair: tuple[int, int], matrix: Any) -> list[tuple[tuple[int, int], Any]]:
    """Return ∫ ∂_i u ∂_j v for a pair, and for its reverse."""
    return [(pair, matrix), (pair[::-1], matrix.T)]


def _flexibility(bone: Bone, mesh: Mesh, depth: float, fixed: Callable[..., Any]) -> FloatArray:
    """Return mean displacements of cells under unit force on cells, of a quarter with its symmetry."""
    stiffness, places = _system(bone, mesh, depth)
    x, y, z = places
    far = x.max() - 1e-9
    held = fixed(x, y, z) | (z > bone.base - 1e-9) | (x > far) | (y > far)
    free = np.flatnonzero(np.concatenate([held | (x < 1e-9), held | (y < 1e-9), held]) == 0)
    loads = np.zeros((free.size, mesh.count**2))
    place = np.full(3 * x.size, -1)
    place[free] = np.arange(free.size)
    surface = np.flatnonzero((z < 1e-9) & (x < mesh.reach + 1e-6) & (y < mesh.reach + 1e-6))
    # Nodes of the surface lie half a side apart, along the finger y and across it x.
    i, j = (np.rint(2 * one[surface] / mesh.side).astype(int) for one in (x, y))
    across, along = _cell_weights(mesh)[i], _cell_weights(mesh)[j]
    loads[place[2 * x.size + surface]] = np.einsum("ni,nj->nij", across, along).reshape(surface.size, -1)
    return np.asarray(loads.T @ _solved(stiffness[free][:, free], loads))


def _cell_weights(mesh: Mesh) -> FloatArray:
    """Return means of the quadratic shape functions of a line's nodes over its cells, (nodes, cells)."""
    first = np.array([5, 8, -1]) / 12
    weights = np.zeros((mesh.count + 1, mesh.count))
    for element in range(mesh.count // 2):
        weights[2 * element : 2 * element + 3, 2 * element] += first
        weights[2 * element : 2 * element + 3, 2 * element + 1] += first[::-1]
    return weights


def _solved(matrix: Any, loads: FloatArray) -> FloatArray:
    try:
        from pypardiso import spsolve  # noqa: PLC0415 (optional)
    except ImportError:
        return np.asarray(
            splu(matrix, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}).solve(loads)
        )
    return np.asarray(spsolve(matrix.tocsr(), loads))


@cache
def _layer_flexibility(bone: Bone, mesh: Mesh, depth: float) -> FloatArray:
    return _flexibility(bone, mesh, depth, lambda x, _y, _z: np.zeros(x.shape, bool))


@cache
def influence(bone: Bone, mesh: Mesh) -> FloatArray:
    """Return displacements of the contact's cells under unit pressure on cells and their images; E* = 1."""
    exact = exact_influence(mesh, bone.base)
    if math.isinf(bone.depth):
        return exact

    def inside(x: FloatArray, _y: FloatArray, z: FloatArray) -> FloatArray:
        return np.asarray((x <= bone.half_width + 1e-6) & (z >= bone.top(x) - 1e-3))

    change = _flexibility(bone, mesh, bone.depth, inside) - _layer_flexibility(bone, mesh, bone.depth)
    n = mesh.count
    # The change is smooth: splines that are even about both planes of symmetry take it to the finer grid.
    side = (np.arange(n) + 0.5) * mesh.cell
    spline = CubicSpline(np.append(-side[::-1], side), np.vstack([np.eye(n)[::-1], np.eye(n)]))(mesh.grid)
    finer = np.einsum(
        "ai,bj,ijkl,ck,dl->abcd", spline, spline, change.reshape(4 * (n,)), spline, spline, optimize=True
    )
    return np.asarray(exact + finer.reshape(exact.shape) * (mesh.reach / _CELLS) ** 2)


@cache
def exact_influence(mesh: Mesh, thickness: float) -> FloatArray:
    """Return the same of a uniform layer, from the solver's own influence."""
    cell = mesh.reach / _CELLS
    kernel = uniform_influence((cell, cell), (2 * _CELLS, 2 * _CELLS), thickness, mesh.poisson_ratio)
    at = np.arange(_CELLS)
    ways = np.abs(at[:, None] - at), at[:, None] + at + 1
    total = sum(kernel[one[:, None, :, None], other[None, :, None, :]] for one in ways for other in ways)
    return np.asarray(total).reshape(_CELLS**2, _CELLS**2)


def solve(flexibility: FloatArray, gap: FloatArray, indentation: float, mesh: Mesh, depth: float) -> Contact:
    """Solve the contact of a quarter at an indentation, by active sets."""
    active = gap.reshape(-1) < 0.7 * indentation
    overlap = indentation - gap.reshape(-1)
    pressure = np.zeros(overlap.size)
    for _ in range(60):
        pressure[:] = 0
        pressure[active] = np.linalg.solve(flexibility[np.ix_(active, active)], overlap[active])
        wanted = np.where(active, pressure > 0, overlap > flexibility @ pressure + 1e-12)
        if (wanted == active).all():
            break
        active = wanted
    else:
        raise RuntimeError("the active set did not settle")
    quarter = pressure.reshape(_CELLS, _CELLS)
    whole = np.block([[quarter[::-1, ::-1], quarter[::-1]], [quarter[:, ::-1], quarter]])
    side = np.append(-mesh.grid[::-1], mesh.grid)
    outline = contact_outline(side, side, whole, decay_length=depth)
    along_over_across = math.sqrt(_moment(outline.points, 1) / _moment(outline.points, 0))
    load = float(whole.sum()) * (mesh.reach / _CELLS) ** 2
    return Contact(load, indentation, outline.area, along_over_across)


def _moment(polygon: FloatArray, axis: int) -> float:
    """Return the second moment of a polygon's area along one of its axes."""
    u, v = polygon[:, axis], polygon[:, 1 - axis]
    following_u, following_v = np.roll(u, -1), np.roll(v, -1)
    cross = u * following_v - following_u * v
    return abs(float(np.sum(cross * (u**2 + u * following_u + following_u**2)))) / 12


def pad_gap(wedge_deg: float) -> Gap:
    """Return the gap of the pad of Table 1, made even along the finger: without its skewness."""
    zero = np.zeros(())
    gap = plate_gap(Placement(TABLE_1, wedge_angle=math.radians(wedge_deg)))
    return replace(gap, first_skewness=zero, second_skewness=zero)


def pressed(bone: Bone, mesh: Mesh, wedge_deg: float, area: float) -> Contact:
    """Return the contact of a given area."""
    gap = pad_gap(wedge_deg)
    across, along = mesh.grid[:, None], mesh.grid
    q = across**2 / float(gap.second_radius) + along**2 / float(gap.first_radius)
    heights = q / (1 + np.sqrt(np.maximum(1 - float(gap.flatness) * q, 1e-3)))
    flexibility, depth = influence(bone, mesh), min(bone.depth, bone.base)

    def excess(indentation: float) -> float:
        return solve(flexibility, heights, indentation, mesh, depth).area - area

    typical = area / (math.pi * 20)
    at = float(brentq(excess, 0.6 * typical, 1.9 * typical, xtol=1e-2 * typical))
    # The area grows by whole cells a little unevenly: a line through the neighbourhood is even.
    near = [solve(flexibility, heights, at * factor, mesh, depth) for factor in (0.94, 0.97, 1.0, 1.03, 1.06)]
    columns = np.log(np.array(near))
    values = [np.polyval(np.polyfit(columns[:, 2], column, 1), math.log(area)) for column in columns.T]
    return Contact(*np.exp(values).tolist())


class Uniform(NamedTuple):
    """What a layer of uniform thickness has of the same area, by the fast laws."""

    radius: float
    load: float
    along_over_across: float


def uniform(thickness: float, poisson_ratio: float, wedge_deg: float, area: float) -> Uniform:
    """Return the contact of the same gap on a uniform layer."""
    contact = press(
        pad_gap(wedge_deg), area=area, reduced_modulus=1.0, thickness=thickness, poisson_ratio=poisson_ratio
    )
    ratio = float(contact.aspect_ratio)
    return Uniform(
        float(contact.area_over_pi_indentation), float(contact.load), ratio if contact.along else 1 / ratio
    )


def effective_thickness(radius: float, poisson_ratio: float, wedge_deg: float, area: float) -> float:
    """Return the thickness of the uniform layer of the same A/(πξ)."""
    return float(
        brentq(
            lambda t: uniform(t, poisson_ratio, wedge_deg, area).radius - radius,
            math.sqrt(area / math.pi) / 2.9,
            60.0,
        )
    )


def _row(name: str, bone: Bone, mesh: Mesh, wedge: tuple[float, float, float]) -> None:
    angle, area, _ = wedge
    start = time.perf_counter()
    found = pressed(bone, mesh, angle, area)
    t = effective_thickness(found.radius, mesh.poisson_ratio, angle, area)
    same = uniform(t, mesh.poisson_ratio, angle, area)
    print(
        f"    {name:<46} {angle:3.0f}°  {found.radius:6.2f}  {t:6.2f}  {found.load / same.load:6.3f}  "
        f"{found.along_over_across:6.3f}  {same.along_over_across:6.3f}  "
        f"({time.perf_counter() - start:.0f} s)",
        flush=True,
    )


def _bones() -> Iterator[tuple[str, Bone]]:
    for depth in (3.0, 4.0):
        yield f"box 6 mm wide, {depth:g} mm deep", Bone(half_width=3.0, depth=depth)
        yield f"round top 6 mm wide, {depth:g} mm deep", Bone(half_width=3.0, depth=depth, round_top=True)
    yield "box 3 mm wide, 2.5 mm deep", Bone(half_width=1.5, depth=2.5)
    yield "box 6 mm wide, 3 mm deep, tissue beside 18 mm", Bone(half_width=3.0, depth=3.0, base=18.0)


def checks(mesh: Mesh) -> None:
    """Print a wide bone, which is a layer, and the same narrow bone on finer meshes and other ν."""
    print("    a bone as wide as the block, a layer (error of A/(πξ), W and along over across):")
    for depth in (4.0, 8.0):
        found = pressed(Bone(half_width=1e3, depth=depth), mesh, *PRINTED[0][:2])
        same = uniform(depth, mesh.poisson_ratio, *PRINTED[0][:2])
        errors = (
            found.radius / same.radius,
            found.load / same.load,
            found.along_over_across / same.along_over_across,
        )
        print(f"    {depth:g} mm: " + ", ".join(f"{100 * (one - 1):+.2f} %" for one in errors), flush=True)


def report(*, quick: bool = False) -> None:
    """Print which layer a narrow bone acts like, and what it makes of the contact's shape."""
    try:
        import skfem  # noqa: F401, PLC0415 (optional)
    except ImportError:
        print("\nBone narrower than the pad: needs scikit-fem (pip install scikit-fem), left out")
        return
    mesh = Mesh(side=1.5 if quick else 1.0)
    print(
        "\nBone narrower than the pad, by finite elements: A/(πξ) at the printed area, mm; thickness t of the"
    )
    print(
        "uniform layer of the same A/(πξ); load over that layer's; axis along over across, of bone and layer"
    )
    checks(mesh)
    for name, bone in _bones():
        for wedge in PRINTED:
            _row(name, bone, mesh, wedge)
    box = Bone(half_width=3.0, depth=3.0)
    for name, other in (
        ("the same, elements of 1.5 mm", Mesh(side=1.5)),
        ("the same, elements of 0.75 mm", Mesh(side=0.75)),
        ("the same, ν = 0.48", Mesh(side=mesh.side, poisson_ratio=0.48)),
        ("the same, ν = 0.495", Mesh(side=mesh.side, poisson_ratio=0.495)),
    ):
        if not quick or other.side == mesh.side:
            _row(f"box 6 mm wide, 3 mm deep: {name[10:]}", box, other, PRINTED[0])
