"""Grids of cells in the tangent plane, which follow the contact, and its edge, far finer than the grid.

The pressure falls to zero as the root of the distance from the edge, so its square is smooth there. The
square is fitted over a ring inside the edge, in the polar coordinates of the ellipse with the contact's
second moments, and its zero is the edge. The outermost cells are left out: only part of each is in contact.
"""

import math
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from scipy.ndimage import distance_transform_edt, map_coordinates

from fingerpad._arrays import FloatArray
from fingerpad._display import Displayed

FILLED = 0.9  # of the grid's width, by the contact
_SKIPPED = 2.5  # cells at the edge
_RING = 0.2  # of the semi-axes, or the decay length if less, but no fewer than so many cells
_RING_CELLS = 9
_FEWEST = 6  # cells from edge to middle that the fit takes; below, the ellipse of the cells' moments stands
_FARTHEST = 4  # cells from that ellipse
_RADIAL, _HARMONICS = 4, 6
_ANGLES = 256


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ContactOutline:
    """The edge of a contact."""

    points: FloatArray  # closed polygon (n, 2), first point not repeated
    area: float
    centre: FloatArray  # of the area, (2,)
    semi_major: float  # of the ellipse with this area, and the ratio of its second moments
    semi_minor: float
    long_axis_angle: float  # from the first coordinate, in (−π/2, π/2]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ContactGrid(Displayed):
    """A rectangular grid of cells in the tangent plane."""

    centre: FloatArray  # in the grid's own axes, (2,)
    half_widths: FloatArray  # of its sides, (2,)
    angle: float  # from the plane's first coordinate to the grid's first side, rad
    points: int  # cells along each side

    @property
    def spacing(self) -> tuple[float, float]:
        """Sides of a cell."""
        first, second = 2 * self.half_widths / self.points
        return float(first), float(second)

    @property
    def cell_area(self) -> float:
        """Area of a cell."""
        return self.spacing[0] * self.spacing[1]

    @property
    def sides(self) -> tuple[FloatArray, FloatArray]:
        """Cell centres along each side, in the grid's own axes."""
        steps = (2 * np.arange(self.points) + 1) / self.points - 1
        first, second = (c + w * steps for c, w in zip(self.centre, self.half_widths, strict=True))
        return first, second

    @property
    def coordinates(self) -> tuple[FloatArray, FloatArray]:
        """Cell centres in the plane, each of shape (points, points)."""
        place = self.to_plane(self.cells)
        return place[..., 0], place[..., 1]

    @property
    def cells(self) -> FloatArray:
        """Cell centres in the grid's own axes, shape (points, points, 2)."""
        return np.stack(np.meshgrid(*self.sides, indexing="ij"), axis=-1)

    def to_plane(self, place: FloatArray) -> FloatArray:
        """Turn points of the grid's own axes into the plane's, shape (..., 2)."""
        cosine, sine = math.cos(self.angle), math.sin(self.angle)
        return np.asarray(place @ np.array([[cosine, sine], [-sine, cosine]]))

    def to_own(self, along: FloatArray, across: FloatArray) -> FloatArray:
        """Turn points of the plane into the grid's own axes, shape (..., 2)."""
        cosine, sine = math.cos(self.angle), math.sin(self.angle)
        return np.stack([along * cosine + across * sine, across * cosine - along * sine], axis=-1)

    def around(self, outline: ContactOutline, points: int) -> Self:
        """Return a grid that a contact fills, its outline given in this grid's own axes."""
        low, high = outline.points.min(axis=0), outline.points.max(axis=0)
        return replace(self, centre=(low + high) / 2, half_widths=(high - low) / 2 / FILLED, points=points)

    def sample(self, field: FloatArray, place: FloatArray) -> FloatArray:
        """Return a field on this grid at points of its own axes, shape (..., 2), zero beyond it."""
        index = (place - [side[0] for side in self.sides]) / self.spacing
        found = map_coordinates(field, index.reshape(-1, 2).T, order=1, mode="constant")
        return np.reshape(found, index.shape[:-1])


def contact_outline(
    along: FloatArray, across: FloatArray, pressure: FloatArray, *, decay_length: float = np.inf
) -> ContactOutline:
    """Return the edge of the region under pressure (n, m), at cell centres `along` (n,) and `across` (m,).

    `decay_length` is the distance from the edge over which the square of the pressure is smooth: a layer's
    thickness.
    """
    touching = pressure > 0
    place = np.stack(np.meshgrid(along, across, indexing="ij"), axis=-1)
    inside = place[touching]
    centre = inside.mean(axis=0)
    step = np.array([along[1] - along[0], across[1] - across[0]])
    offset = inside - centre
    moments, axes = np.linalg.eigh(offset.T @ offset / len(inside) + np.diag(step**2 / 12))
    to_plane = axes * (2 * np.sqrt(moments))  # from the unit disc to the ellipse of the cells' second moments
    radius, angle = _polar((place - centre) @ np.linalg.inv(to_plane).T)
    depth = distance_transform_edt(np.pad(touching, 1))[1:-1, 1:-1]
    mean = np.sqrt(np.prod(2 * np.sqrt(moments)))
    cell = np.sqrt(np.prod(step)) / mean
    theta = 2 * np.pi * np.arange(_ANGLES) / _ANGLES
    edge = np.ones(_ANGLES)
    if depth.max() > _FEWEST:
        ring = max(min(_RING, decay_length / mean), _RING_CELLS * cell)
        used = (depth > _SKIPPED) & (radius > 1 - ring)
        coefficients = _fit_ring((1 - radius[used]) / ring, angle[used], pressure[used] ** 2)
        zero = 1 - ring * _first_zero(_harmonics(theta) @ coefficients)
        edge = np.clip(zero, 1 - _FARTHEST * cell, 1 + _FARTHEST * cell)
    return _outline(edge, theta, centre, to_plane)


def _polar(place: FloatArray) -> tuple[FloatArray, FloatArray]:
    return np.hypot(place[..., 0], place[..., 1]), np.arctan2(place[..., 1], place[..., 0])


def _harmonics(angle: FloatArray) -> FloatArray:
    """Return 1, cos φ, sin φ, cos 2φ, ... along the last axis."""
    powers = np.exp(1j * angle)[:, None] ** np.arange(_HARMONICS + 1)
    return np.concatenate([powers.real, powers.imag[:, 1:]], axis=1)


def _fit_ring(depth: FloatArray, angle: FloatArray, squared: FloatArray) -> FloatArray:
    """Return the coefficients of p² in harmonics and powers of the depth, least squares."""
    powers = depth[:, None] ** np.arange(_RADIAL + 1)
    weight = 1 / (squared / squared.max() + 0.02)  # the cells nearest the edge determine it best
    design = (_harmonics(angle)[:, :, None] * powers[:, None, :]).reshape(len(depth), -1)
    weighted = (design * weight[:, None]).T
    solution = np.linalg.lstsq(weighted @ weighted.T, weighted @ (squared * weight), rcond=1e-13)[0]
    return np.asarray(solution.reshape(-1, _RADIAL + 1), dtype=np.float64)


def _first_zero(coefficients: FloatArray) -> FloatArray:
    """Return the zero next to 0 of each polynomial, by Newton's method."""
    powers = np.arange(1, _RADIAL + 1)
    zero = np.zeros(len(coefficients))
    for _ in range(10):
        value = (coefficients * zero[:, None] ** np.arange(_RADIAL + 1)).sum(axis=1)
        slope = (coefficients[:, 1:] * powers * zero[:, None] ** (powers - 1)).sum(axis=1)
        zero = zero - value / slope
    return zero


def _outline(edge: FloatArray, theta: FloatArray, centre: FloatArray, to_plane: FloatArray) -> ContactOutline:
    """Integrate the moments of the region inside r = edge(θ), and map it to the plane."""
    unit = np.stack([np.cos(theta), np.sin(theta)])
    size = np.pi * np.mean(edge**2)
    middle = 2 * np.pi / 3 * np.mean(edge**3 * unit, axis=1) / size
    second = np.pi / 2 * (edge**4 * unit) @ unit.T / len(theta) / size - np.outer(middle, middle)
    scale = abs(np.linalg.det(to_plane))
    area = float(size * scale)
    spread, axes = np.linalg.eigh(to_plane @ second @ to_plane.T)
    ratio = (spread[1] / spread[0]) ** 0.25
    mean = np.sqrt(area / np.pi)
    direction = axes[:, 1] if axes[0, 1] > 0 or (axes[0, 1] == 0 and axes[1, 1] > 0) else -axes[:, 1]
    return ContactOutline(
        points=centre + (to_plane @ (edge * unit)).T,
        area=area,
        centre=centre + to_plane @ middle,
        semi_major=float(mean * ratio),
        semi_minor=float(mean / ratio),
        long_axis_angle=float(np.arctan2(direction[1], direction[0])),
    )
