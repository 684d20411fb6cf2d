"""Pictures of flat grids through a pinhole camera: rays from each pixel to the plane."""

from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.arrays import Array


@dataclass(frozen=True)
class Scene:
    """A camera over the plane z = 0, in which a grid lies; lengths in mm.

    The plane is tilted by `tilt` radians about an axis in the picture that is turned by `turn`, and looked at
    from `distance`. `focal` is in px. `squeeze` shortens the picture's columns, as a prism
    does; `bend` is that of a lens.
    """

    rows: int = 480
    columns: int = 640
    focal: float = 1400.0
    distance: float = 100.0
    tilt: float = 0.0
    turn: float = 0.0
    squeeze: float = 1.0
    bend: float = 0.0

    def plane_of(self, row: Array, column: Array) -> tuple[Array, Array]:
        """Return the place (x, y) on the plane that a pixel shows."""
        u = (column - (self.columns - 1) / 2) / self.squeeze / self.focal
        v = (row - (self.rows - 1) / 2) / self.focal
        radius = u**2 + v**2
        u, v = u * (1 + self.bend * radius), v * (1 + self.bend * radius)
        axis = np.array([np.cos(self.turn), np.sin(self.turn), 0])
        turned = Rotation.from_rotvec(self.tilt * axis).as_matrix()
        ray = np.stack([u, v, np.ones_like(u)], axis=-1) @ turned.T
        start = np.array([0, 0, -self.distance]) @ turned.T
        reach = -start[2] / ray[..., 2]
        return start[0] + reach * ray[..., 0], start[1] + reach * ray[..., 1]

    def area_per_pixel(self, row: float, column: float) -> float:
        """Return the area of the plane that a pixel shows, mm²: from four rays."""
        x, y = self.plane_of(row + np.array([-0.5, 0.5, 0, 0]), column + np.array([0, 0, -0.5, 0.5]))
        return abs(float((x[1] - x[0]) * (y[3] - y[2]) - (x[3] - x[2]) * (y[1] - y[0])))

    def picture(
        self, points: tuple[int, int], spacing: float, pattern: str, noise: float = 3.0, seed: int = 0
    ) -> Array:
        """Return a checkerboard with so many inner corners, or a grid of dots, its middle at the origin."""
        total = np.zeros((self.rows, self.columns))
        rows, columns = np.indices(total.shape).astype(float)
        for down, right in product((np.arange(4) + 0.5) / 4 - 0.5, repeat=2):
            x, y = self.plane_of(rows + down, columns + right)
            # Array of the points from 0; between them in a checkerboard are squares.
            i, j = y / spacing + (points[0] - 1) / 2, x / spacing + (points[1] - 1) / 2
            if pattern == "checkerboard":
                on_board = (i > -1) & (i < points[0]) & (j > -1) & (j < points[1])
                dark = on_board & ((np.floor(i) + np.floor(j)) % 2 == 0)
            else:
                near_i, near_j = np.rint(i).clip(0, points[0] - 1), np.rint(j).clip(0, points[1] - 1)
                dark = np.hypot(i - near_i, j - near_j) < 0.25
            total += np.where(dark, 40.0, 215.0) / 16
        total += np.random.default_rng(seed).normal(0, noise, total.shape)
        return np.clip(np.rint(total), 0, 255).astype(np.uint8)
