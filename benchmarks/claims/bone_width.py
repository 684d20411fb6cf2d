"""A bone narrower than the pad, by finite elements: how a layer of one thickness misses it.

Tissue is a block with a flat surface, fixed at its base, with a rigid strip of bone along the finger inside.
Finite elements give by how much the bone changes the displacement of the surface under pressure on any cell
of a grid: quadratic hexahedra, a quarter of the block. What they err by close to the pressure cancels in
that change, which is added to the exact influence of the layer without a bone. The contact under the pad's
gap is then solved on the grid, and compared with that of a layer of uniform thickness by the fast laws.
"""

import math
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, Final, NamedTuple

import cv2
import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

from benchmarks.arrays import Array
from benchmarks.simulated import TABLE_1
from benchmarks.tables import table
from fingerpad import Placement
from fingerpad.contact.fast_laws import plate_gap, press
from fingerpad.contact.grid import contact_outline
from fingerpad.contact.influence import influence as uniform_influence
from fingerpad.geometry import Gap

# Printed contact area (mm²) by wedge angle (degrees).
PRINTED: Final = {30: 116.3, 45: 69.4}
POISSON: Final = 0.49
BASE: Final = 12.0  # thickness of the tissue beside the bone, mm
_CELLS: Final = 32  # of the contact's grid along each side of a quarter
_REACH, _FAR = 9.0, 32.0  # half of the sides of that grid and of the block, mm
_BESIDE: Final = 6.0  # from the bone's side to where mesh lines that follow a round bone are flat again, mm
_GRID: Final = (np.arange(_CELLS) + 0.5) * _REACH / _CELLS


@dataclass(frozen=True)
class Bone:
    """A rigid strip along the finger: half of its width, depth of its top, and whether that is round, mm."""

    half_width: float
    depth: float
    round_top: bool = False

    def top(self, x: Array) -> Array:
        """Return the depth of the plane of the mesh that has its top, x across the finger."""
        r = self.half_width if self.round_top else 0.0
        above = r - np.sqrt(np.maximum(r**2 - x**2, 0.0))
        return self.depth + np.where(x <= r, above, r * np.clip(1 - (x - r) / _BESIDE, 0, 1))


BONES: Final = {
    "wide, 8 mm deep": Bone(1e3, 8.0),
    "box 6 mm wide, 3 mm deep": Bone(3.0, 3.0),
    "round, 6 mm wide, 4 mm deep": Bone(3.0, 4.0, round_top=True),
    "box 3 mm wide, 2.5 mm deep": Bone(1.5, 2.5),
}


class Contact(NamedTuple):
    """A contact: load over E*, indentation, area, and its axis along the finger over that across."""

    load: float
    indentation: float
    area: float
    along_over_across: float


@cache
def _system(bone: Bone, side: float) -> tuple[csc_array, Array]:
    """Return the stiffness for E* = 1, component by component, and the places of its nodes.

    The mesh has a plane that follows the bone's top; changes of volume are integrated with fewer points, so
    that elements do not lock.
    """
    from skfem import Basis, BilinearForm, ElementHex2, ElementVector, MeshHex, asm  # noqa: PLC0415
    from skfem.helpers import ddot, div, sym_grad  # noqa: PLC0415

    steps = [side] * round(_REACH / side)
    while sum(steps) < _FAR:
        steps.append(min(1.5 * steps[-1], 6.0))
    lateral = np.append(0.0, np.cumsum(steps))
    above = np.linspace(0, bone.depth, max(round(bone.depth / side), 2) + 1)
    below = np.linspace(bone.depth, BASE, max(round((BASE - bone.depth) / (1.5 * side)), 2) + 1)
    block = MeshHex.init_tensor(lateral, lateral, np.append(above, below[1:]))
    p, top = block.p.copy(), bone.top(block.p[0])
    under = top + (p[2] - bone.depth) / (BASE - bone.depth) * (BASE - top)
    p[2] = np.where(p[2] <= bone.depth + 1e-9, p[2] * top / bone.depth, under)
    block = MeshHex(p, block.t)
    full, reduced = (Basis(block, ElementVector(ElementHex2()), intorder=order) for order in (5, 3))
    first, second = (1 - POISSON) * POISSON / (1 - 2 * POISSON), (1 - POISSON) / 2  # Lamé's
    shear = asm(BilinearForm(lambda u, v, _: 2 * second * ddot(sym_grad(u), sym_grad(v))), full)
    volume = asm(BilinearForm(lambda u, v, _: first * div(u) * div(v)), reduced)
    parts = full.nodal_dofs, full.edge_dofs, full.facet_dofs, full.interior_dofs
    rows = np.concatenate([part[axis] for axis in range(3) for part in parts])
    return csc_array((shear + volume)[rows][:, rows]), full.doflocs[:, rows[: rows.size // 3]]


def _flexibility(bone: Bone, side: float, *, with_bone: bool) -> Array:
    """Return mean displacements of cells under unit force on cells, of a quarter with its symmetry.

    Cells are half as wide as elements.
    """
    stiffness, places = _system(bone, side)
    x, y, z = places
    far = x.max() - 1e-9
    inside = (x <= bone.half_width + 1e-6) & (z >= bone.top(x) - 1e-3)
    held = (z > BASE - 1e-9) | (x > far) | (y > far) | (with_bone & inside)
    free = np.flatnonzero(~np.concatenate([held | (x < 1e-9), held | (y < 1e-9), held]))
    cells = 2 * round(_REACH / side)
    # Means of the quadratic shape functions of a line's nodes over its cells
    weights, part = np.zeros((cells + 1, cells)), np.array([5, 8, -1]) / 12
    for element in range(0, cells, 2):
        weights[element : element + 3, element] += part
        weights[element : element + 3, element + 1] += part[::-1]
    loads = np.zeros((3 * x.size, cells**2))
    surface = np.flatnonzero((z < 1e-9) & (x < _REACH + 1e-6) & (y < _REACH + 1e-6))
    across, along = (weights[np.rint(2 * one[surface] / side).astype(int)] for one in (x, y))
    loads[2 * x.size + surface] = np.einsum("ni,nj->nij", across, along).reshape(surface.size, -1)
    factors = splu(stiffness[free][:, free], permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    return loads[free].T @ factors.solve(loads[free])


@cache
def influence(bone: Bone, side: float) -> Array:
    """Return displacements of the contact's cells under unit pressure on cells and their images; E* = 1."""
    cell = _REACH / _CELLS
    kernel = uniform_influence((cell, cell), (2 * _CELLS, 2 * _CELLS), BASE, POISSON)
    at = np.arange(_CELLS)
    ways = np.abs(at[:, None] - at), at[:, None] + at + 1
    exact: Any = sum(kernel[one[:, None, :, None], other[None, :, None, :]] for one in ways for other in ways)
    change = _flexibility(bone, side, with_bone=True) - _flexibility(bone, side, with_bone=False)
    # The change is smooth: splines that are even about both planes of symmetry take it to the finer grid.
    n = 2 * round(_REACH / side)
    coarse = (np.arange(n) + 0.5) * side / 2
    even = CubicSpline(np.append(-coarse[::-1], coarse), np.vstack([np.eye(n)[::-1], np.eye(n)]))(_GRID)
    change = change.reshape(4 * (n,))
    finer = np.einsum("ai,bj,ijkl,ck,dl->abcd", even, even, change, even, even, optimize=True)
    return (exact + finer * cell**2).reshape(_CELLS**2, _CELLS**2)


def solve(flexibility: Array, gap: Array, indentation: float, depth: float) -> Contact:
    """Solve the contact of a quarter at an indentation, by active sets."""
    overlap = indentation - gap.reshape(-1)
    active, pressure = overlap > 0.3 * indentation, np.zeros(overlap.size)
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
    side = np.append(-_GRID[::-1], _GRID)
    outline = contact_outline(side, side, whole, decay_length=depth)
    moments = cv2.moments(outline.points.astype(np.float32))
    along_over_across = math.sqrt(moments["m02"] / moments["m20"])
    return Contact(float(whole.sum()) * (_REACH / _CELLS) ** 2, indentation, outline.area, along_over_across)


def pad_gap(wedge_deg: float) -> Gap:
    """Return the gap of the pad of Table 1, made even along the finger: without its skewness."""
    zero = np.zeros(())
    gap = plate_gap(Placement(TABLE_1, wedge_angle=math.radians(wedge_deg)))
    return replace(gap, first_skewness=zero, second_skewness=zero)


def pressed(bone: Bone, side: float, wedge_deg: float, area: float) -> Contact:
    """Return the contact of a given area."""
    gap, flexibility = pad_gap(wedge_deg), influence(bone, side)
    q = _GRID[:, None] ** 2 / float(gap.second_radius) + _GRID**2 / float(gap.first_radius)
    heights = q / (1 + np.sqrt(np.maximum(1 - float(gap.flatness) * q, 1e-3)))

    def at(indentation: float) -> Contact:
        return solve(flexibility, heights, indentation, bone.depth)

    typical = area / (math.pi * 20)
    found = brentq(lambda xi: at(xi).area - area, 0.6 * typical, 1.9 * typical, xtol=1e-2 * typical)
    # The area grows by whole cells a little unevenly: a line through the neighbourhood is even.
    columns = np.log([at(float(found) * factor) for factor in (0.94, 0.97, 1.0, 1.03, 1.06)])
    values = [np.polyval(np.polyfit(columns[:, 2], column, 1), math.log(area)) for column in columns.T]
    return Contact(*np.exp(values).tolist())


def _as_layer(found: Contact, wedge: float, area: float) -> tuple[float, ...]:
    """Return A/(πξ), the thickness of the layer that acts so, E read with it over the true one, and axes."""
    gap, radius = pad_gap(wedge), area / (math.pi * found.indentation)

    def layer(t: float) -> Any:
        return press(gap, area=area, reduced_modulus=1.0, thickness=t, poisson_ratio=POISSON)

    def excess(t: float) -> float:
        return float(layer(t).area_over_pi_indentation) - radius

    thickness = float(brentq(excess, math.sqrt(area / math.pi) / 2.9, 60.0))
    return radius, thickness, found.load / float(layer(thickness).load), found.along_over_across


def report(side: float = 1.5) -> None:
    """Print which layer a narrow bone acts like, and what it makes of the contact's shape."""
    head = "bone", "A/(πξ), mm", "t of the layer that acts so, mm", "modulus read over true"
    rows = []
    for name, bone in BONES.items():
        found = [_as_layer(pressed(bone, side, wedge, area), wedge, area) for wedge, area in PRINTED.items()]
        columns = zip((1, 1, 2, 2), zip(*found, strict=True), strict=True)
        rows.append((name, *(", ".join(f"{one:.{n}f}" for one in values) for n, values in columns)))
    title = f"At wedge angles of {' and '.join(map(str, PRINTED))}°; elements of {side:g} mm"
    table((*head, "along over across"), rows, title)
