"""Pictures of coins of known size and tilt, with relief, rim, shadow and noise."""

import math
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import Float32Array, FloatArray, as_float32, check_radians
from fingerpad._display import Displayed
from fingerpad.exceptions import GeometryError
from fingerpad.geometry.ellipse import Ellipse
from fingerpad.image.ellipse import half_turn

_OVERSAMPLING = 3


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SyntheticCoin(Displayed):
    """A rendered coin and the truth about it."""

    pixels: npt.NDArray[np.uint8]  # (rows, columns)
    ellipse: Ellipse  # the outline, px
    orientation: float  # of the major axis from straight up, counter-clockwise as seen, radians
    centre: tuple[float, float]  # (row, column), px


def render_coin(
    *,
    radius: float = 150.0,
    tilt: float = 0.0,
    orientation: float = 0.0,
    shape: tuple[int, int] = (480, 640),
    centre: tuple[float, float] | None = None,
    level: float = 120.0,
    ground: float = 220.0,
    relief: float = 10.0,
    shadow: float = 0.1,
    blur: float = 0.9,
    noise_std: float = 4.0,
    seed: int = 0,
) -> SyntheticCoin:
    """Render a coin lying on a background, seen from far away.

    Parameters
    ----------
    radius : float
        Radius of the coin, px.
    tilt : float
        Angle between the coin and the image plane, radians; it shortens the axis across `orientation`.
    orientation : float
        Angle of the major axis from straight up, counter-clockwise as seen, radians.
    shape : (int, int)
        Rows and columns of the picture.
    centre : (float, float), optional
        (row, column) of the coin's centre, px; the middle of the picture by default.
    level, ground : float
        Mean grey level of the coin and of the background.
    relief : float
        Standard deviation of the grey levels of the coin's face and rim.
    shadow : float
        Share of the light that the coin's shadow takes from the background, 0 to 1.
    blur : float
        Standard deviation of the lens's blur, px.
    noise_std : float
        Standard deviation of the camera's noise, grey levels.
    seed : int
        The same seed gives the same picture.

    Returns
    -------
    SyntheticCoin
        Picture and truth.

    Raises
    ------
    GeometryError
        If the radius is not positive, or the tilt not within a quarter turn.

    Examples
    --------
    >>> coin = render_coin(radius=60.0, tilt=0.4, shape=(160, 160))
    >>> coin.pixels.shape, round(float(coin.ellipse.semi_minor), 3)
    ((160, 160), 55.264)
    """
    check_radians("orientation", orientation)
    check_radians("tilt", tilt)
    if not radius > 0 or not abs(tilt) < math.pi / 2:
        raise GeometryError(f"a coin needs a positive radius and a tilt below 90°, found {radius} and {tilt}")
    rng = np.random.default_rng(seed)
    centre = ((shape[0] - 1) / 2, (shape[1] - 1) / 2) if centre is None else centre
    light = rng.uniform(0, 2 * math.pi)
    noise = rng.normal(0, 1, tuple(n * _OVERSAMPLING for n in shape)).astype(np.float32)
    scene = _lit_ground(shape, centre, radius, ground=ground, shadow=shadow, light=light, rng=rng)
    window, along, across = _coin_plane(shape, centre, orientation, radius, tilt)
    distance, angle = np.hypot(along, across), np.arctan2(across, along)
    face = level + relief * _face(distance, angle, light, noise, window)
    scene[window] = np.where(distance <= 1, face, scene[window])
    scene = as_float32(cv2.GaussianBlur(scene, (0, 0), blur * _OVERSAMPLING))
    small = cv2.resize(scene, shape[::-1], interpolation=cv2.INTER_AREA)
    exposed = small + rng.normal(0, noise_std, shape)
    return SyntheticCoin(
        pixels=np.clip(np.rint(exposed), 0, 255).astype(np.uint8),
        ellipse=Ellipse(radius, radius * math.cos(tilt)),
        orientation=half_turn(orientation),
        centre=centre,
    )


def _coin_plane(
    shape: tuple[int, int], centre: tuple[float, float], orientation: float, radius: float, tilt: float
) -> tuple[tuple[slice, slice], FloatArray, FloatArray]:
    """Return the window of fine pixels round the coin, and their places along its axes, in radii."""
    fine = (np.arange(n * _OVERSAMPLING) for n in shape)
    rows, columns = ((k + 0.5) / _OVERSAMPLING - 0.5 - c for k, c in zip(fine, centre, strict=True))
    down, right = (slice(*np.searchsorted(each, (-radius - 1, radius + 1))) for each in (rows, columns))
    up, left = np.meshgrid(-rows[down], -columns[right], indexing="ij")
    cosine, sine = math.cos(orientation), math.sin(orientation)
    along = (up * cosine + left * sine) / radius
    return (down, right), along, (left * cosine - up * sine) / (radius * math.cos(tilt))


def _face(
    distance: FloatArray, angle: FloatArray, light: float, noise: Float32Array, window: tuple[slice, slice]
) -> FloatArray:
    """Return the relief of a coin's face: a lit rim, a ring of beads, letters, a portrait of noise."""
    lit = np.cos(angle - light)
    face = np.asarray((distance > 0.93) * (0.8 + 1.2 * lit), dtype=np.float64)
    step = np.abs(distance - 0.92) < 0.1
    face[step] -= 1.6 * lit[step] * np.exp(-(((distance[step] - 0.92) / 0.012) ** 2))
    beads = np.abs(distance - 0.885) < 0.018
    face[beads] += np.cos(70 * angle[beads])
    letters = np.abs(distance - 0.76) < 0.06
    face[letters] += np.sign(np.sin(23 * angle[letters] + 9 * distance[letters]))
    noise = as_float32(cv2.GaussianBlur(noise, (0, 0), 12))
    face += np.where(distance < 0.62, 1.5 * noise[window] / noise.std(), 0.0)
    return face


def _lit_ground(
    shape: tuple[int, int],
    centre: tuple[float, float],
    radius: float,
    *,
    ground: float,
    shadow: float,
    light: float,
    rng: np.random.Generator,
) -> Float32Array:
    """Return the background at the fine size: grain, a fall of light, and the coin's soft shadow."""
    rows, columns = shape
    down, right = 0.07 * radius * math.sin(light), -0.07 * radius * math.cos(light)
    grid = np.ogrid[:rows, :columns]
    disc = np.hypot(grid[0] - centre[0] - down, grid[1] - centre[1] - right) <= radius
    dark = cv2.GaussianBlur(disc.astype(np.float32), (0, 0), max(0.025 * radius, 0.5))
    grain = cv2.GaussianBlur(rng.normal(0, 1, shape).astype(np.float32), (0, 0), 1.5)
    slope = np.linspace(-0.08, 0.08, columns)[None, :] * math.cos(light)
    coarse = ground * (1 + slope) * (1 - shadow * dark) + 3 * grain / grain.std()
    size = (columns * _OVERSAMPLING, rows * _OVERSAMPLING)
    return np.asarray(cv2.resize(coarse.astype(np.float32), size, interpolation=cv2.INTER_LINEAR))
