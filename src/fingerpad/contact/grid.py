"""Grids of cells in the tangent plane, which follow the contact."""

import math
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from scipy.ndimage import map_coordinates

from fingerpad._arrays import FloatArray
from fingerpad._display import Displayed
from fingerpad.contact.outline import ContactOutline

FILLED = 0.9  # of the grid's width, by the contact


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ContactGrid(Displayed):
    """A rectangular grid of cells in the tangent plane.

    Attributes
    ----------
    centre : ndarray, shape (2,)
        Centre of the grid, in its own axes.
    half_widths : ndarray, shape (2,)
        Half of its sides.
    angle : float
        From the plane's first coordinate to the grid's first side, radians.
    points : int
        Cells along each side.
    """

    centre: FloatArray
    half_widths: FloatArray
    angle: float
    points: int

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
        turned: FloatArray = place @ np.array([[cosine, sine], [-sine, cosine]])
        return turned

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
        values: FloatArray = map_coordinates(field, np.moveaxis(index, -1, 0), order=1, mode="constant")
        return values
