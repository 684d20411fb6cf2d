"""Stress in a layer bonded to a rigid base, under a solved contact pressure.

Each wave of the pressure is a plane problem across the layer, of four constants. The layer's response dies
away as e^(−0.8 r/t) or faster: a margin of six thicknesses on each side keeps periodic images below 1e-4.
"""

import math

import numpy as np
from scipy import fft
from scipy.ndimage import map_coordinates

from fingerpad._arrays import ArrayLike, FloatArray, broadcast
from fingerpad.contact.solver import ContactSolution
from fingerpad.contact.stress import StressField
from fingerpad.exceptions import GeometryError

_MARGIN = 6  # thicknesses on each side of the contact
_LARGEST = 1200  # cells along a side of the padded grid
_COARSEST = 32  # cells along a side of the contact's own grid
_COMPONENTS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def layer_stress(
    solution: ContactSolution, along: ArrayLike, across: ArrayLike, depth: ArrayLike
) -> StressField:
    """Return the stress at points of the layer.

    Parameters
    ----------
    solution : ContactSolution
        A contact on a layer.
    along, across : array_like
        Coordinates in the surface, as those of the contact; NaN is returned more than five thicknesses
        beyond the grid of the contact.
    depth : array_like
        Depth below the surface; NaN is returned outside [0, thickness]. The cost grows with the number of
        different depths. At depths below one cell of the solution's grid, the stress is that of the cells.

    Returns
    -------
    StressField
        Axes along, across and down.

    Raises
    ------
    GeometryError
        If the body is a half-space, or so thick beside the contact that it is one in effect.

    Examples
    --------
    Incompressible tissue over bone is sheared least in the middle of the contact and most at the bone:

    >>> from fingerpad.contact import ElasticBody, solve_contact
    >>> body = ElasticBody.of(reduced_modulus=0.1, thickness=2.0)
    >>> sphere = lambda x, y: (x**2 + y**2) / 20
    >>> contact = solve_contact(sphere, body, half_widths=(3, 3), area=50.0, points=64)
    >>> field = layer_stress(contact, [0.0, 2.5], 0.0, 2.0)
    >>> bool(field.maximum_shear[1] > 10 * field.maximum_shear[0])
    True
    """
    along, across, depth = broadcast(along, across, depth)
    padded, spacing, start = _padded_pressure(solution)
    angle, thickness = solution.grid.angle, solution.body.thickness
    cosine, sine = math.cos(angle), math.sin(angle)
    own = np.stack([along * cosine + across * sine, across * cosine - along * sine])
    where = [(side - first) / step for side, first, step in zip(own, start, spacing, strict=True)]
    inside = (depth >= 0) & (depth <= thickness)
    for place, size in zip(where, padded.shape, strict=True):
        inside &= (place >= 0) & (place <= size - 1)
    spectrum = fft.rfft2(padded)
    wave_x = 2 * np.pi * fft.fftfreq(padded.shape[0], spacing[0])[:, None]
    wave_y = 2 * np.pi * fft.rfftfreq(padded.shape[1], spacing[1])[None, :]
    wave = np.hypot(wave_x, wave_y)
    wave[0, 0] = 1.0  # of no direction; see _transfer
    direction = wave_x / wave, wave_y / wave
    direction[0][0, 0] = 1.0
    constants = _constants(wave * thickness, solution.body.poisson_ratio)
    tensor = np.full((*depth.shape, 3, 3), np.nan)
    for level in np.unique(depth[inside]):
        here = inside & (depth == level)
        parts = _transfer(
            wave=wave,
            depth=level,
            thickness=thickness,
            constants=constants,
            poisson_ratio=solution.body.poisson_ratio,
            direction=direction,
        )
        for (row, column), factor in zip(_COMPONENTS, parts, strict=True):
            plane = fft.irfft2(spectrum * factor, padded.shape)
            values = map_coordinates(plane, [place[here] for place in where], order=3, mode="grid-wrap")
            tensor[here, row, column] = tensor[here, column, row] = values
    turn = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
    return StressField(tensor=turn @ tensor @ turn.T)


def _padded_pressure(solution: ContactSolution) -> tuple[FloatArray, tuple[float, float], FloatArray]:
    """Return the pressure with a margin, its cells' sides, and the first cell's centre on the grid's axes."""
    grid, thickness = solution.grid, solution.body.thickness
    if math.isinf(thickness):
        raise GeometryError("thickness must be finite: the stress in a half-space is hertz_stress's")
    pressure, spacing = solution.pressure, grid.spacing
    while True:
        margin = [math.ceil(_MARGIN * thickness / step) for step in spacing]
        if max(margin) * 2 + len(pressure) <= _LARGEST:
            break
        if len(pressure) < 2 * _COARSEST or len(pressure) % 2:
            raise GeometryError(
                f"thickness {thickness:g} is too great beside the contact's semi-minor axis "
                f"{solution.semi_minor:g}: the stress is that in a half-space, hertz_stress's"
            )
        pressure = (pressure[::2] + pressure[1::2]) / 2
        pressure = (pressure[:, ::2] + pressure[:, 1::2]) / 2
        spacing = 2 * spacing[0], 2 * spacing[1]
    shape = [fft.next_fast_len(len(pressure) + 2 * cells, real=True) for cells in margin]
    padded = np.zeros(shape)
    padded[margin[0] : margin[0] + len(pressure), margin[1] : margin[1] + len(pressure)] = pressure
    first = grid.centre - grid.half_widths + (0.5 - np.array(margin)) * spacing
    return padded, spacing, first


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
    constants: FloatArray = np.linalg.solve(matrix, right)[..., 0].astype(np.float64)
    return constants


def _transfer(
    *,
    wave: FloatArray,
    depth: float,
    thickness: float,
    constants: FloatArray,
    poisson_ratio: float,
    direction: tuple[FloatArray, FloatArray],
) -> list[FloatArray]:
    """Return the six components of the stress under a unit wave of pressure."""
    zeta, eta = wave * depth, wave * (depth - thickness)
    down, up = np.exp(-zeta), np.exp(eta)
    a, b, c, d = np.moveaxis(constants, -1, 0)
    value = (a + b * zeta) * down + (c + d * eta) * up
    slope = (b - a - b * zeta) * down + (c + d + d * eta) * up
    bend = (a - 2 * b + b * zeta) * down + (c + 2 * d + d * eta) * up
    value[0, 0], slope[0, 0] = 1, 0  # a uniform pressure: no strain sideways
    bend[0, 0] = -poisson_ratio / (1 - poisson_ratio)
    normal = poisson_ratio * (bend - value)  # across the wave
    x, y = direction
    return [
        x**2 * bend + y**2 * normal,
        y**2 * bend + x**2 * normal,
        -value,
        x * y * (bend - normal),
        -1j * x * slope,
        -1j * y * slope,
    ]
