"""Stress under a solved contact pressure, in a half-space or a layer bonded to a rigid base.

Each wave of the pressure is a plane problem across the body, of four constants. A layer's response dies away
as e^(−0.8 r/t) or faster: a margin of six thicknesses on each side keeps periodic images below 1e-4. That of
a half-space falls off as 1/r² only. There the Hertzian pressure of the same load, centre and second moments
is subtracted first, whose stress is known in closed form. The stress of the rest falls off as 1/r⁵.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Self, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy import fft
from scipy.ndimage import map_coordinates

from fingerpad._arrays import ArrayLike, BoolArray, FloatArray, broadcast
from fingerpad._display import Displayed
from fingerpad.contact.contact import Tissue
from fingerpad.contact.grid import ContactGrid
from fingerpad.contact.solver import SolvedContact
from fingerpad.contact.stress import HertzPressure, StressField
from fingerpad.exceptions import GeometryError

ComplexArray: TypeAlias = NDArray[np.complex128]

_MARGIN = 6  # thicknesses on each side of the contact
_LARGEST = 1700  # cells along a side of the padded grid
_COARSEST = 32  # cells along a side of the contact's own grid
_DECAYED = 20.0  # e-folds, after which nothing of a wave is left
_SHORT = 0.5  # depth in mean radii, of which waves that have died away are short ones
_FEW = 4  # points that are summed wave by wave
_COMPONENTS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SolvedStress(Displayed):
    """The stress under a solved contact: made once, and asked for at any points.

    Attributes
    ----------
    contact : SolvedContact
        The contact.

    Examples
    --------
    Incompressible tissue over bone is sheared least in the middle of the contact and most at the bone, deep
    tissue under the middle:

    >>> from fingerpad.contact import Tissue, solve_contact
    >>> from fingerpad.geometry import Paraboloid
    >>> for thickness in (2.0, np.inf):
    ...     tissue = Tissue(youngs_modulus=0.075, thickness=thickness)
    ...     contact = solve_contact(Paraboloid(10.0, 10.0), tissue, area=50.0, points=64)
    ...     shear = SolvedStress.of(contact).at([0.0, 2.5], 0.0, 2.0).maximum_shear
    ...     print((shear / contact.mean_pressure).round(2))
    [0.   0.42]
    [0.4  0.37]
    """

    contact: SolvedContact
    _hertz: HertzPressure | None
    _waves: _Waves

    @classmethod
    def of(cls, contact: SolvedContact) -> Self:
        """Split the pressure into one of Hertz theory, on deep tissue, and the waves of the rest.

        Parameters
        ----------
        contact : SolvedContact
            On deep tissue or on a layer.

        Returns
        -------
        SolvedStress

        Raises
        ------
        GeometryError
            If a layer is so thick beside the contact that it is deep tissue in effect.
        """
        grid, tissue = contact.grid, contact.tissue
        if not tissue.is_deep:
            margin = np.full(2, _MARGIN * float(tissue.thickness))
            return cls(contact=contact, _hertz=None, _waves=_Waves.of(contact.pressure, grid, margin, tissue))
        hertz = HertzPressure.of_moments(grid, contact.pressure)
        rest = contact.pressure - hertz.over_cells(grid)
        return cls(contact=contact, _hertz=hertz, _waves=_Waves.of(rest, grid, 2 * grid.half_widths, tissue))

    def of_long_waves(self) -> Self:
        """Leave out waves far shorter than the contact, which hardly matter to where the stress is highest.

        Returns
        -------
        SolvedStress
            Faster by far near the surface, and there within some per cent.
        """
        mean_radius = math.sqrt(self.contact.area / math.pi)
        return replace(self, _waves=self._waves.without_decayed(_SHORT * mean_radius))

    def at(self, along: ArrayLike, across: ArrayLike, depth: ArrayLike) -> StressField:
        """Return the stress at points of the tissue.

        Parameters
        ----------
        along, across : array_like
            Coordinates in the surface, as those of the contact. In a layer, NaN is returned more than five
            thicknesses beyond the grid of the contact.
        depth : array_like
            Below the surface; NaN is returned outside the tissue. The cost goes with the number of different
            depths. Nearer to the surface than a cell of the contact's grid, the stress is that of the cells.

        Returns
        -------
        StressField
            Axes along, across and down.
        """
        along, across, depth = broadcast(along, across, depth)
        tissue, grid = self.contact.tissue, self.contact.grid
        inside = (depth >= 0) & (depth <= tissue.thickness)
        own = grid.to_own(along, across)
        field = _stress_of_waves(self._waves, tissue, own, depth, inside).turned(grid.angle)
        if self._hertz is None:
            return field
        closed = self._hertz.stress(along, across, depth, poisson_ratio=float(tissue.poisson_ratio))
        return StressField(tensor=closed.tensor + np.nan_to_num(field.tensor))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Waves:
    """A pressure as a sum of waves over a rectangle, in the grid's own axes."""

    shape: tuple[int, int]  # cells of the rectangle
    sides: FloatArray  # its lengths, (2,)
    first: FloatArray  # centre of its first cell, (2,)
    spectrum: ComplexArray  # what `rfft2` gives
    # Which waves feel the base of a layer, by row, from the last where negative, and column of the spectrum;
    # and the constants of Airy's function for these, (..., 4): all others are those of a half-space.
    long: NDArray[np.intp]
    constants: FloatArray

    @classmethod
    def of(cls, pressure: FloatArray, grid: ContactGrid, margin: FloatArray, tissue: Tissue) -> Self:
        """Return the waves of a pressure over the grid, with so wide a margin on each side of it.

        Where that takes too many cells, they are made larger.
        """
        spacing = np.array(grid.spacing)
        while (len(pressure) + 2 * np.ceil(margin / spacing)).max() > _LARGEST:
            if len(pressure) < 2 * _COARSEST:
                raise GeometryError(
                    f"thickness {tissue.thickness:g} is too great beside the contact: leave it out, the "
                    "stress is that in a half-space"
                )
            pressure, spacing = _half_as_many(pressure), 2 * spacing
        points, cells = len(pressure), np.ceil(margin / spacing).astype(int)
        shape = tuple(fft.next_fast_len(points + 2 * int(count), real=True) for count in cells)
        padded = np.zeros(shape)
        padded[cells[0] : cells[0] + points, cells[1] : cells[1] + points] = pressure
        spectrum, sides = fft.rfft2(padded), np.array(shape) * spacing
        long, constants = np.empty((0, 2), dtype=np.intp), np.empty((0, 4))
        if math.isfinite(tissue.thickness):
            x = np.hypot(*_wave_vectors(shape, sides)) * tissue.thickness
            long = np.argwhere(x < _DECAYED)
            constants = _constants(x[tuple(long.T)], float(tissue.poisson_ratio))
            long[long[:, 0] > (shape[0] - 1) // 2, 0] -= shape[0]
        return cls(
            shape=shape,
            sides=sides,
            first=grid.centre - grid.half_widths + (0.5 - cells) * spacing,
            spectrum=spectrum,
            long=long,
            constants=constants,
        )

    def holds(self, place: FloatArray) -> BoolArray:
        """Return whether points, from the first cell's centre, are in the rectangle."""
        span = self.sides * (1 - 1 / np.array(self.shape))
        inside = (place >= 0) & (place <= span)
        return inside[..., 0] & inside[..., 1]

    def at(self, spectrum: ComplexArray, place: FloatArray) -> FloatArray:
        """Return the field of a spectrum at points, from the first cell's centre."""
        if len(place) <= _FEW:
            return self._sum(spectrum, place)
        plane = fft.irfft2(spectrum, self.shape)
        cells = (place * self.shape / self.sides).T
        return np.asarray(map_coordinates(plane, cells, order=3, mode="grid-wrap"))

    def _sum(self, spectrum: ComplexArray, place: FloatArray) -> FloatArray:
        """Return what `at` does, wave by wave: for a few points faster than the whole plane."""
        first, second = _wave_vectors(self.shape, self.sides)
        twice = np.full(second.size, 2.0)  # for the waves that `rfft2` leaves out
        twice[0] = 1
        if self.shape[1] % 2 == 0:
            twice[-1] = 1
        along_second = spectrum @ (twice[:, None] * np.exp(1j * second.T * place[:, 1]))
        waves = np.sum(np.exp(1j * first * place[:, 0]) * along_second, axis=0)
        return np.asarray(waves.real / math.prod(self.shape))

    def without_decayed(self, depth: float) -> Self:
        """Leave out what has died away at a depth: a coarser grid then holds the rest."""
        if depth == 0:
            return self
        needed = np.ceil(_DECAYED / depth * self.sides / np.pi)
        fewer = tuple(
            min(cells, fft.next_fast_len(int(count), real=True))
            for cells, count in zip(self.shape, needed, strict=True)
        )
        if fewer == self.shape:
            return self
        size = math.prod(fewer) / math.prod(self.shape)
        kept = np.all(np.abs(self.long) <= (np.array(fewer) - 1) // 2, axis=-1)
        return replace(
            self,
            shape=fewer,
            spectrum=_fewer_waves(self.spectrum, fewer) * size,
            long=self.long[kept],
            constants=self.constants[kept],
        )


def _wave_vectors(shape: tuple[int, int], sides: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the wavenumbers along the two sides, as `rfft2` orders them."""
    first = 2 * np.pi * fft.fftfreq(shape[0], sides[0] / shape[0])
    second = 2 * np.pi * fft.rfftfreq(shape[1], sides[1] / shape[1])
    return first[:, None], second[None, :]


def _fewer_waves(spectrum: ComplexArray, shape: tuple[int, int]) -> ComplexArray:
    """Return the longest waves, as `rfft2` orders them on a coarser grid."""
    rows, columns = (shape[0] - 1) // 2, (shape[1] - 1) // 2 + 1
    fewer = np.zeros((shape[0], shape[1] // 2 + 1), dtype=spectrum.dtype)
    fewer[: rows + 1, :columns] = spectrum[: rows + 1, :columns]
    fewer[-rows:, :columns] = spectrum[-rows:, :columns]
    return fewer


def _half_as_many(pressure: FloatArray) -> FloatArray:
    """Return the mean pressure over squares of four cells."""
    even = np.pad(pressure, (0, len(pressure) % 2))
    return (even[::2, ::2] + even[1::2, ::2] + even[::2, 1::2] + even[1::2, 1::2]) / 4


def _stress_of_waves(
    waves: _Waves, tissue: Tissue, own: FloatArray, depth: FloatArray, in_tissue: BoolArray
) -> StressField:
    """Return the stress at points in the grid's own axes; NaN outside the tissue and beyond the rectangle."""
    place = own - waves.first
    inside = in_tissue & waves.holds(place)
    tensor = np.full((*depth.shape, 3, 3), np.nan)
    for level in np.unique(depth[inside]):
        here = inside & (depth == level)
        left = waves.without_decayed(level)
        for (row, column), spectrum in zip(_COMPONENTS, _transfer(left, level, tissue), strict=True):
            tensor[here, row, column] = tensor[here, column, row] = left.at(spectrum, place[here])
    return StressField(tensor=tensor)


def _constants(x: FloatArray, poisson_ratio: float) -> FloatArray:
    """Return the constants of Airy's function (A + Bζ)e^−ζ + (C + D(ζ − x))e^(ζ−x), ζ = qz, x = qt.

    At the surface the function is one and its slope nought, for the pressure and no shear; at the base both
    displacements vanish, (1 − ν)f'' + νf = 0 and (1 − ν)f''' − (2 − ν)f' = 0.
    """
    solid, decay = 1 - poisson_ratio, np.exp(-x)
    zero, one = np.zeros_like(x), np.ones_like(x)
    equations = [
        [one, zero, decay, -x * decay],
        [-one, one, decay, (1 - x) * decay],
        [decay, (x - 2 * solid) * decay, one, 2 * solid * one],
        [decay, (solid * (3 - x) - (1 + solid) * (1 - x)) * decay, -one, (2 * solid - 1) * one],
    ]
    matrix = np.stack([np.stack(row, axis=-1) for row in equations], axis=-2)
    right = np.broadcast_to(np.array([1.0, 0, 0, 0])[:, None], (*x.shape, 4, 1))
    return np.linalg.solve(matrix, right)[..., 0].astype(np.float64)


def _transfer(waves: _Waves, depth: float, tissue: Tissue) -> Iterator[ComplexArray]:
    """Yield the waves of the six components of the stress at a depth."""
    x, y = _wave_vectors(waves.shape, waves.sides)
    wave = np.hypot(x, y)
    zeta = wave * depth
    down = np.exp(-zeta)
    value, slope, bend = (1 + zeta) * down, -zeta * down, (zeta - 1) * down
    if waves.long.size:
        here = tuple(waves.long.T)
        zeta, down, eta = zeta[here], down[here], wave[here] * (depth - tissue.thickness)
        up = np.exp(eta)
        a, b, c, d = waves.constants.T
        value[here] = (a + b * zeta) * down + (c + d * eta) * up
        slope[here] = (b - a - b * zeta) * down + (c + d + d * eta) * up
        bend[here] = (a - 2 * b + b * zeta) * down + (c + 2 * d + d * eta) * up
    del zeta, down  # as large as each of the others
    value[0, 0], slope[0, 0] = 1, 0  # a uniform pressure: no strain sideways
    bend[0, 0] = -tissue.poisson_ratio / (1 - tissue.poisson_ratio)
    normal = tissue.poisson_ratio * (bend - value)  # across the wave
    wave[0, 0] = 1  # of no direction
    x, y = x / wave, y / wave
    x[0, 0] = 1
    yield waves.spectrum * (normal + x**2 * (bend - normal))
    yield waves.spectrum * (normal + y**2 * (bend - normal))
    yield waves.spectrum * -value
    yield waves.spectrum * (x * y * (bend - normal))
    yield waves.spectrum * (-1j * x * slope)
    yield waves.spectrum * (-1j * y * slope)
