"""Surface displacement under pressure: half-space, and layer bonded to a rigid base.

A pressure that is constant over each cell of a grid displaces the surface by a discrete convolution. The
half-space's coefficients are exact (Love 1929); those of the layer add the smooth difference of the two
Green's functions. The convolution is zero-padded, so that no periodic images take part.
"""

import math
from functools import lru_cache
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from scipy import fft
from scipy.special import j0

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

_TABLE_END = 24.0  # in thicknesses; the layer's own Green's function has decayed to nothing there
_TABLE_STEP = 0.02
_GAUSS = 0.5 / np.sqrt(3)  # nodes of two-point Gauss quadrature, in cells


def layer_compliance_ratio(wavenumber_thickness: ArrayLike, poisson_ratio: float) -> FloatArray:
    r"""Return the compliance of a bonded layer over that of the half-space, for one wavenumber.

    .. math:: M(x) = \frac{(3-4\nu) \sinh 2x - 2x}{(3-4\nu) \cosh 2x + 2x^2 + 5 - 12\nu + 8\nu^2}

    for a frictionless plate on a layer bonded to a rigid base; x = qt ≥ 0 is `wavenumber_thickness`. A thin
    incompressible layer hardly yields, a thick one is a half-space.
    """
    x = as_float_array(wavenumber_thickness)
    solid, decay = 3 - 4 * poisson_ratio, np.exp(-2 * x)
    constant = 2 * x**2 + 5 - 12 * poisson_ratio + 8 * poisson_ratio**2
    above = solid * -np.expm1(-4 * x) / 2 - 2 * x * decay
    below = solid * (1 + decay**2) / 2 + constant * decay
    return above / below


@lru_cache(maxsize=16)
def _green_difference(poisson_ratio: float) -> "CubicSpline":
    """Return g(r/t) = ∫(M(x) − 1) J0(x r/t) dx, the layer's Green's function less the half-space's."""
    from scipy.interpolate import CubicSpline  # noqa: PLC0415 (slow to import, for layers alone)

    node, weight = np.polynomial.legendre.leggauss(700)
    node, weight = 11 * (node + 1), 11 * weight  # M − 1 has decayed to 1e-15 at x = 22
    amplitude = weight * (layer_compliance_ratio(node, poisson_ratio) - 1)
    radius = np.arange(0, _TABLE_END + _TABLE_STEP / 2, _TABLE_STEP)
    value = np.concatenate([j0(part[:, None] * node) @ amplitude for part in np.array_split(radius, 12)])
    return CubicSpline(radius, value, bc_type=((1, 0.0), "not-a-knot"))


def influence(
    spacing: tuple[float, float], shape: tuple[int, int], thickness: float, poisson_ratio: float
) -> FloatArray:
    """Return the displacement at the centres of cells under unit pressure on the first, times E*.

    `spacing` are the sides of a cell; an infinite thickness is a half-space, to which ν does not matter.
    """
    x, y = (step * (np.arange(count + 1) - 0.5) for step, count in zip(spacing, shape, strict=True))
    x, y = x[:, None], y[None, :]
    corner = x * np.arcsinh(y / np.abs(x)) + y * np.arcsinh(x / np.abs(y))
    deep = np.asarray(np.diff(np.diff(corner, axis=0), axis=1) / np.pi)
    if math.isinf(thickness):
        return deep
    difference = np.zeros(shape)
    table = _green_difference(poisson_ratio)
    x, y = (step * np.arange(count) for step, count in zip(spacing, shape, strict=True))
    for shift_x, shift_y in product((-_GAUSS, _GAUSS), repeat=2):
        radius = np.hypot((x + shift_x * spacing[0])[:, None], (y + shift_y * spacing[1])[None, :])
        scaled = radius / thickness
        beyond = -1 / np.maximum(scaled, _TABLE_END)
        difference += np.where(scaled < _TABLE_END, table(np.minimum(scaled, _TABLE_END)), beyond)
    return deep + difference * (spacing[0] * spacing[1]) / (4 * np.pi * thickness)


class Convolution:
    """Zero-padded convolution of a grid with an even kernel, and its approximate inverse.

    The kernel is the influence of the first cell on each.
    """

    def __init__(self, kernel: FloatArray) -> None:
        rows, columns = kernel.shape
        self.centre = float(kernel[0, 0])
        self._shape = kernel.shape
        self._padded = (2 * rows, 2 * columns)
        row, column = (np.minimum(np.arange(2 * n), 2 * n - np.arange(2 * n)) for n in kernel.shape)
        # The entry half-way round is never used; the nearest value keeps the spectrum smooth.
        even = kernel[np.minimum(row, rows - 1)[:, None], np.minimum(column, columns - 1)]
        self._spectrum = fft.rfft2(even).real
        # A thin layer yields hardly at all to the mean pressure: there the inverse is limited to that of the
        # next wavelength, twice the grid.
        limited = self._spectrum.copy()
        limited[0, 0] = max(limited[0, 0], limited[0, 1], limited[1, 0])
        self._inverse = 1 / limited

    def apply(self, pressure: FloatArray) -> FloatArray:
        """Return the displacement under a pressure."""
        return self._multiply(pressure, self._spectrum)

    def approximate_inverse(self, displacement: FloatArray) -> FloatArray:
        """Return about the pressure under which a displacement comes about: a preconditioner."""
        return self._multiply(displacement, self._inverse)

    def _multiply(self, field: FloatArray, factor: FloatArray) -> FloatArray:
        spectrum = fft.rfft2(field, self._padded)
        spectrum *= factor
        rows, columns = self._shape
        return np.asarray(fft.irfft2(spectrum, self._padded, overwrite_x=True)[:rows, :columns])
