"""A spherical pad over a bone as round as itself, pressed flat: finite elements of neo-Hookean tissue.

Lengths are in units of the pad's radius, loads of E* of small strains. The half-shell is axisymmetric, of
eight-node elements with four points of integration, which do not lock where tissue is nearly incompressible.
The plate is rigid and without friction: a node that touches it keeps its height and may slide.
"""

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.linalg import spsolve

from benchmarks.arrays import Array

_ALONG, _THROUGH, _STEPS = 70, 10, 24  # elements in the contact's reach and through the tissue; steps of load
_REACH = 0.66  # angle at the bone's middle up to which elements are small
_CORNERS = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
_ROUNDS = 60


def _gradients(x: float, y: float) -> tuple[Array, Array]:
    """Return the shape functions of the serendipity element, corners first, and their gradients."""
    value, slope = np.zeros(8), np.zeros((2, 8))
    for i, (a, b) in enumerate(_CORNERS):
        value[i] = (1 + a * x) * (1 + b * y) * (a * x + b * y - 1) / 4
        slope[:, i] = a * (1 + b * y) * (2 * a * x + b * y) / 4, b * (1 + a * x) * (a * x + 2 * b * y) / 4
    for i, side in ((4, -1), (6, 1)):
        value[i] = (1 - x * x) * (1 + side * y) / 2
        slope[:, i] = -x * (1 + side * y), side * (1 - x * x) / 2
    for i, side in ((5, 1), (7, -1)):
        value[i] = (1 + side * x) * (1 - y * y) / 2
        slope[:, i] = side * (1 - y * y) / 2, -y * (1 + side * x)
    return value, slope


class _Shell:
    """Nodes and elements; `surface` are the nodes of the skin from the place of first contact on."""

    def __init__(self, thickness: float, poisson_ratio: float) -> None:
        angle = np.linspace(0, _REACH, _ALONG + 1)
        step = angle[1]
        while angle[-1] + 1.2 * step < np.pi / 2:
            step *= 1.2
            angle = np.append(angle, angle[-1] + step)
        angle[-1] = np.pi / 2
        depth = (1 - np.linspace(0, 1, _THROUGH + 1)) ** 1.5
        halved = (np.sort(np.append(one, (one[1:] + one[:-1]) / 2)) for one in (angle, 1 - depth))
        theta, height = np.meshgrid(*halved, indexing="ij")
        radius = 1 - thickness + thickness * height
        self.r, self.z = (radius * np.sin(theta)).ravel(), (1 - radius * np.cos(theta)).ravel()
        nodes = np.arange(theta.size).reshape(theta.shape)
        places = ((0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1))
        corners = nodes[:-2:2, :-2:2]
        wide = 2 * _THROUGH + 1
        self.elements = np.stack([(corners + i * wide + j).ravel() for i, j in places], axis=1)
        self.surface = nodes[:, -1]
        self.of = np.stack([2 * self.elements, 2 * self.elements + 1], axis=-1).reshape(-1, 16)
        unused = np.setdiff1d(nodes, self.elements)
        held = [2 * nodes[:, 0], 2 * nodes[:, 0] + 1, 2 * nodes[0], 2 * unused, 2 * unused + 1]
        self.held = np.unique(np.concatenate(held))
        self.shear = (1 - poisson_ratio) / 2
        self.bulk = 2 * self.shear * (1 + poisson_ratio) / (3 * (1 - 2 * poisson_ratio))
        point = 1 / np.sqrt(3)
        self.points = [self._point(x, y) for x in (-point, point) for y in (-point, point)]

    def _point(self, x: float, y: float) -> tuple[Array, Array]:
        """Return, of each element, what the displacement gradient is of displacements, and the volume."""
        value, slope = _gradients(x, y)
        jacobian = np.stack([self.r[self.elements] @ slope.T, self.z[self.elements] @ slope.T], axis=-1)
        along = np.linalg.inv(jacobian) @ slope
        radius = self.r[self.elements] @ value
        strain = np.zeros((len(self.elements), 5, 16))  # u_r over r and z, u_z over r and z, and the hoop's
        strain[:, :2, 0::2], strain[:, 2:4, 1::2] = along, along
        strain[:, 4, 0::2] = value / radius[:, None]
        return strain, 2 * np.pi * radius * np.abs(np.linalg.det(jacobian))

    def forces(self, moved: Array) -> tuple[csr_array, Array]:
        """Return stiffness and forces of G/2 (J^(-2/3) I - 3) + K/2 (J - 1)²."""
        stiffness, force = np.zeros((len(self.of), 16, 16)), np.zeros((len(self.of), 16))
        for strain, volume in self.points:
            f = np.einsum("eij,ej->ei", strain, moved[self.of]) + np.array([1, 0, 0, 1, 1])
            a, b, c, d, hoop = f.T
            plane = a * d - b * c
            j, i = plane * hoop, (f * f).sum(axis=1)
            j_f = np.stack([d * hoop, -c * hoop, -b * hoop, a * hoop, plane], axis=1)
            j_ff = np.zeros((len(f), 5, 5))
            j_ff[:, 0, 3], j_ff[:, 1, 2] = hoop, -hoop
            j_ff[:, :4, 4] = np.stack([d, -c, -b, a], axis=1)
            j_ff += j_ff.transpose(0, 2, 1)
            w_i = self.shear / 2 * j ** (-2 / 3)
            w_j = -self.shear / 3 * j ** (-5 / 3) * i + self.bulk * (j - 1)
            w_ij = -self.shear / 3 * j ** (-5 / 3)
            w_jj = 5 / 9 * self.shear * j ** (-8 / 3) * i + self.bulk
            stress = 2 * w_i[:, None] * f + w_j[:, None] * j_f
            mixed = f[:, :, None] * j_f[:, None, :]
            slope = 2 * np.multiply.outer(w_i, np.eye(5)) + w_j[:, None, None] * j_ff
            slope += 2 * w_ij[:, None, None] * (mixed + mixed.transpose(0, 2, 1))
            slope += w_jj[:, None, None] * j_f[:, :, None] * j_f[:, None, :]
            force += volume[:, None] * np.einsum("eij,ei->ej", strain, stress)
            stiffness += strain.transpose(0, 2, 1) @ (volume[:, None, None] * slope) @ strain
        rows, columns = np.repeat(self.of, 16, axis=1), np.tile(self.of, 16)
        size = 2 * self.r.size
        whole = csr_array((stiffness.ravel(), (rows.ravel(), columns.ravel())), shape=(size, size))
        return whole, np.bincount(self.of.ravel(), force.ravel(), size)

    def press(self, moved: Array, touching: Array, plate: float) -> tuple[Array, Array, float]:
        """Return the displacements under a plate at a height, which nodes touch it, and the load."""
        upright = 2 * self.surface + 1
        for _ in range(_ROUNDS):
            stiffness, force = self.forces(moved)
            step, fixed = np.zeros_like(moved), upright[touching]
            step[fixed] = plate - (self.z + moved[1::2])[self.surface[touching]]
            free = np.setdiff1d(np.arange(moved.size), np.append(self.held, fixed))
            rest = -force[free] - (stiffness @ step)[free]
            step[free] = spsolve(stiffness[free][:, free].tocsc(), rest)
            moved = moved + step
            largest = np.abs(step).max()
            if largest > 1e-3:
                continue
            now = touching | ((self.z + moved[1::2])[self.surface] < plate - 1e-12)
            if largest < 1e-7 and (now == touching).all():
                force = self.forces(moved)[1]
                now = now & (force[upright] >= 0)
                now[0] = True
                if (now == touching).all():
                    return moved, touching, float(force[upright[touching]].sum())
            touching = now
        raise RuntimeError("the contact was not found")


def pressed_pad(thickness: float, poisson_ratio: float, deepest: float) -> tuple[Array, Array, Array]:
    """Return indentations up to the deepest, with load over E* and contact area, from no contact on."""
    shell = _Shell(thickness, poisson_ratio)
    moved, touching = np.zeros(2 * shell.r.size), np.zeros(shell.surface.size, bool)
    touching[0] = True
    found = [(0.0, 0.0, 0.0)]
    for plate in np.linspace(0, deepest, _STEPS + 1)[1:]:
        moved, touching, load = shell.press(moved, touching, float(plate))
        last = int(np.flatnonzero(touching)[-1])
        r, gap = (shell.r + moved[0::2])[shell.surface], (shell.z + moved[1::2])[shell.surface] - plate
        # Beside a contact the gap grows as the power 3/2 of the distance.
        ratio = (gap[last + 2] / gap[last + 1]) ** (2 / 3)
        edge = np.clip((ratio * r[last + 1] - r[last + 2]) / (ratio - 1), r[last], r[last + 1])
        found.append((float(plate), load, np.pi * float(edge) ** 2))
    indentation, load, area = np.array(found).T
    return indentation, load, area
