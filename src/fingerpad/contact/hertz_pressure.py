"""The pressure of Hertz theory in the plane of contact."""

import math
from dataclasses import dataclass, replace
from itertools import product
from typing import Self

import numpy as np

from fingerpad._arrays import (
    ArrayLike,
    FloatArray,
    broadcast,
    finite_angle,
    finite_pair,
    positive_number,
    set_fields,
)
from fingerpad._display import Displayed
from fingerpad.contact.contact import Contact
from fingerpad.contact.grid import ContactGrid
from fingerpad.contact.stress import StressField, hertz_stress
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Ellipse

_SAMPLES = 4  # along each side of a cell


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class HertzPressure(Displayed):
    """A semi-ellipsoidal pressure over an ellipse that lies anywhere in the plane of contact."""

    peak_pressure: float
    semi_major: float
    semi_minor: float
    long_axis_angle: float  # from the plane's first coordinate, along the finger, rad
    centre: FloatArray  # in the plane, (2,)

    def __post_init__(self) -> None:
        peak = positive_number(self.peak_pressure, "peak_pressure", GeometryError)
        ellipse = Ellipse(
            positive_number(self.semi_major, "semi_major", GeometryError),
            positive_number(self.semi_minor, "semi_minor", GeometryError),
        )
        set_fields(
            self,
            peak_pressure=peak,
            semi_major=float(ellipse.semi_major),
            semi_minor=float(ellipse.semi_minor),
            long_axis_angle=finite_angle("long_axis_angle", self.long_axis_angle),
            centre=np.array(finite_pair(self.centre, "centre", GeometryError)),
        )

    @classmethod
    def of_contact(cls, contact: Contact, long_axis_angle: float) -> Self:
        """Return the pressure of one Hertz contact, whose long axis lies at an angle (rad) to the finger."""
        return cls(
            peak_pressure=float(contact.peak_pressure),
            semi_major=float(contact.semi_major),
            semi_minor=float(contact.semi_minor),
            long_axis_angle=long_axis_angle,
            centre=np.zeros(2),
        )

    @classmethod
    def of_moments(cls, grid: ContactGrid, pressure: FloatArray) -> Self:
        """Return the pressure that has the load, centre and second moments of one given on a grid.

        Its variance along a semi-axis a is a²/5.
        """
        place = grid.cells
        load = pressure.sum()
        middle = np.tensordot(pressure, place, 2) / load
        offset = place - middle
        second = np.einsum("ij,ijk,ijl->kl", pressure, offset, offset) / load
        spread, axes = np.linalg.eigh(second)
        minor, major = np.sqrt(5 * spread)
        return cls(
            peak_pressure=float(1.5 * load * grid.cell_area / (np.pi * major * minor)),
            semi_major=float(major),
            semi_minor=float(minor),
            long_axis_angle=math.remainder(grid.angle + math.atan2(axes[1, 1], axes[0, 1]), math.tau),
            centre=grid.to_plane(middle),
        )

    def at(self, along: ArrayLike, across: ArrayLike) -> FloatArray:
        """Return the pressure at points of the plane, zero outside the ellipse."""
        x, y = self._own(*broadcast(along, across))
        inside = 1 - (x / self.semi_major) ** 2 - (y / self.semi_minor) ** 2
        pressure: FloatArray = self.peak_pressure * np.sqrt(np.maximum(inside, 0))
        return pressure

    def over_cells(self, grid: ContactGrid) -> FloatArray:
        """Return the mean pressure over each cell of a grid that holds all of the ellipse."""
        shifts = (np.arange(_SAMPLES) + 0.5) / _SAMPLES - 0.5
        mean = np.zeros((grid.points, grid.points))
        for shift in product(shifts, shifts):
            moved = replace(grid, centre=grid.centre + np.multiply(shift, grid.spacing))
            mean += self.at(*moved.coordinates)
        load = 2 / 3 * np.pi * self.semi_major * self.semi_minor * self.peak_pressure
        mean *= load / (mean.sum() * grid.cell_area)
        return mean

    def stress(
        self, along: ArrayLike, across: ArrayLike, depth: ArrayLike, *, poisson_ratio: float
    ) -> StressField:
        """Return the stress in a half-space, as `hertz_stress`, on axes along, across and down."""
        along, across, depth = broadcast(along, across, depth)
        x, y = self._own(along, across)
        field = hertz_stress(
            *(x, y, depth),
            semi_x=self.semi_major,
            semi_y=self.semi_minor,
            peak_pressure=self.peak_pressure,
            poisson_ratio=poisson_ratio,
        )
        return field.turned(self.long_axis_angle)

    def _own(self, along: FloatArray, across: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return coordinates along the ellipse's own axes."""
        cosine, sine = math.cos(self.long_axis_angle), math.sin(self.long_axis_angle)
        along, across = along - self.centre[0], across - self.centre[1]
        return along * cosine + across * sine, across * cosine - along * sine
