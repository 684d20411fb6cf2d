"""Pictures of known truth: contact imprints with friction ridges, and points of an outline.

The ridges come from noise filtered again and again along a flow with a core and a delta, as real prints have;
minutiae appear by themselves. The contact ends sharply at an ellipse, which is the truth.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal, TypeAlias

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, FloatArray
from fingerpad.exceptions import GeometryError
from fingerpad.geometry.ellipse import Ellipse
from fingerpad.image.scale import MM_PER_INCH

Look: TypeAlias = Literal["ink", "livescan", "prism"]
Pattern: TypeAlias = Literal["arch", "loop", "whorl"]
_Float32: TypeAlias = npt.NDArray[np.float32]

# The ridges grow on a grid of their own, so that every resolution shows the same finger.
_CELLS_PER_PERIOD = 8.0
_DIRECTIONS = 16
_GENERATIONS = 14
# Dark level, light level, blur (mm), and whether contact is the dark one.
_LOOKS: dict[Look, tuple[float, float, float, bool]] = {
    "ink": (55.0, 225.0, 0.035, True),
    "livescan": (35.0, 250.0, 0.025, True),
    "prism": (25.0, 205.0, 0.035, False),
}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SyntheticImprint:
    """A rendered imprint and the truth about it.

    Attributes
    ----------
    pixels : ndarray of uint8, (rows, columns)
        The picture.
    ellipse : Ellipse
        True outline of the contact, mm.
    orientation : float
        True angle of its major axis from straight up, counter-clockwise as seen, radians.
    centroid : (float, float)
        True centre, (row, column), px.
    ridge_area : float
        True area of the ridges, pores left out, mm².
    ridge_period : float
        Mean ridge period asked for, mm.
    mm_per_px : float
        True scale.
    """

    pixels: npt.NDArray[np.uint8]
    ellipse: Ellipse
    orientation: float
    centroid: tuple[float, float]
    ridge_area: float
    ridge_period: float
    mm_per_px: float

    @property
    def gross_area(self) -> float:
        """True area inside the ellipse, mm²."""
        return float(self.ellipse.area)


def render_imprint(
    *,
    semi_major: float = 9.5,
    semi_minor: float = 7.0,
    orientation: float = 0.0,
    ppi: float = 500.0,
    ridge_period: float = 0.45,
    pattern: Pattern = "loop",
    look: Look = "livescan",
    noise_std: float = 6.0,
    lighting: float = 0.0,
    margin: float = 2.0,
    seed: int = 0,
) -> SyntheticImprint:
    """Render a contact imprint whose ellipse is known.

    Parameters
    ----------
    semi_major, semi_minor : float
        Semi-axes of the contact, mm.
    orientation : float
        Angle of the major axis from straight up, counter-clockwise as seen on the screen, radians.
    ppi : float
        Resolution, pixels per inch.
    ridge_period : float
        Mean distance between ridges, mm.
    pattern : {"arch", "loop", "whorl"}
        Flow of the ridges.
    look : {"ink", "livescan", "prism"}
        Ink on card, dark on white, or light on dark.
    noise_std : float
        Standard deviation of the camera's noise, grey levels.
    lighting : float
        Relative fall of the light from one corner to the other, 0 to 1.
    margin : float
        Empty ground round the ellipse's box, mm; negative cuts the contact.
    seed : int
        The same seed gives the same picture.

    Raises
    ------
    GeometryError
        If a length is not positive, or the semi-axes are swapped.

    Examples
    --------
    >>> truth = render_imprint(semi_major=8.0, semi_minor=6.0, seed=1)
    >>> truth.pixels.dtype, round(truth.gross_area, 1)
    (dtype('uint8'), 150.8)
    """
    ellipse = Ellipse.of(semi_major, semi_minor)
    for name, value in (("ppi", ppi), ("ridge_period", ridge_period)):
        if not value > 0:
            raise GeometryError(f"{name} must be positive, found {value}")
    mm_per_px = MM_PER_INCH / ppi
    rng = np.random.default_rng(seed)
    up, left = _grid(ellipse, orientation, margin, mm_per_px)
    along = up * math.cos(orientation) + left * math.sin(orientation)
    across = left * math.cos(orientation) - up * math.sin(orientation)
    radius = np.hypot(along / semi_major, across / semi_minor)
    ridges = _ridges(along, across, radius, ridge_period=ridge_period, pattern=pattern, seed=seed)
    pixels = _expose(ridges, look, mm_per_px, lighting=lighting, noise_std=noise_std, rng=rng)
    rows, columns = up.shape
    return SyntheticImprint(
        pixels=pixels,
        ellipse=ellipse,
        orientation=math.pi / 2 - (math.pi / 2 - orientation) % math.pi,
        centroid=((rows - 1) / 2, (columns - 1) / 2),
        ridge_area=float(np.count_nonzero(ridges)) * mm_per_px**2,
        ridge_period=ridge_period,
        mm_per_px=mm_per_px,
    )


def outline_points(
    semi_x: float,
    semi_y: float,
    *,
    count: int = 60,
    arc: tuple[float, float] = (0.0, 2 * math.pi),
    centre: tuple[float, float] = (0.0, 0.0),
    angle: float = 0.0,
    noise_std: float = 0.0,
    seed: int = 0,
) -> FloatArray:
    """Return noisy points (x, y) on an arc of an ellipse, in the unit of its semi-axes.

    Parameters
    ----------
    semi_x, semi_y : float
        Semi-axes along x and y before the turn by `angle`.
    count : int
        Number of points, evenly spaced in the parametric angle.
    arc : (float, float)
        First and last parametric angle, radians; the last is left out.
    centre, angle : (float, float), float
        Centre, and turn from x towards y, radians.
    noise_std : float
        Standard deviation of each coordinate.

    Returns
    -------
    ndarray, (count, 2)

    Examples
    --------
    >>> outline_points(2.0, 1.0, count=4).round(6).tolist()
    [[2.0, 0.0], [0.0, 1.0], [-2.0, 0.0], [-0.0, -1.0]]
    """
    t = np.linspace(*arc, count, endpoint=False)
    x, y = semi_x * np.cos(t), semi_y * np.sin(t)
    turned = np.stack(
        [x * math.cos(angle) - y * math.sin(angle), x * math.sin(angle) + y * math.cos(angle)], axis=-1
    )
    return turned + centre + np.random.default_rng(seed).normal(0, noise_std, turned.shape)


def _grid(
    ellipse: Ellipse, orientation: float, margin: float, mm_per_px: float
) -> tuple[FloatArray, FloatArray]:
    """Return the distances up and left of the centre of each pixel, mm."""
    cosine, sine = math.cos(orientation), math.sin(orientation)
    major, minor = float(ellipse.semi_major), float(ellipse.semi_minor)
    height = math.hypot(major * cosine, minor * sine) + margin
    width = math.hypot(major * sine, minor * cosine) + margin
    rows, columns = (max(1, round(2 * length / mm_per_px)) for length in (height, width))
    up = -(np.arange(rows) - (rows - 1) / 2) * mm_per_px
    left = -(np.arange(columns) - (columns - 1) / 2) * mm_per_px
    grid_up, grid_left = np.meshgrid(up, left, indexing="ij")
    return grid_up, grid_left


def _ridges(
    along: FloatArray,
    across: FloatArray,
    radius: FloatArray,
    *,
    ridge_period: float,
    pattern: Pattern,
    seed: int,
) -> BoolArray:
    """Return where ridges touch: crests above a level that rises towards the edge, without pores."""
    reach = max(np.abs(along[radius <= 1]).max(initial=0), np.abs(across[radius <= 1]).max(initial=0))
    # Whole steps of 8 periods let pictures of one finger share a sheet.
    crests, grain = _ridge_sheet(seed, pattern, 8 * math.ceil((reach / ridge_period + 1) / 8))
    cells = _CELLS_PER_PERIOD / ridge_period
    middle = (crests.shape[0] - 1) / 2

    def sample(sheet: _Float32) -> _Float32:
        columns = (middle - across * cells).astype(np.float32)
        rows = (middle - along * cells).astype(np.float32)
        return _single(cv2.remap(sheet, columns, rows, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REFLECT))

    # Pressure falls to nothing at the edge: the ridges thin out and break up there.
    edge = np.clip((radius - 0.86) / 0.14, 0, 1) ** 2
    touching = sample(crests) > -0.12 + 0.3 * edge + (0.22 + 0.3 * edge) * sample(grain)
    return touching & (radius <= 1)


def _flow(pattern: Pattern, along: FloatArray, across: FloatArray, size: float) -> FloatArray:
    """Return the direction of the ridges (Sherlock & Monro's zeros and poles), from across to along."""
    place = (across + 1j * along) / size
    cores = {"arch": [], "loop": [0.02 + 0.1j], "whorl": [0.04 + 0.22j, -0.04 - 0.12j]}[pattern]
    deltas = {"arch": [], "loop": [0.62 - 0.62j], "whorl": [0.7 - 0.6j, -0.7 - 0.62j]}[pattern]
    if pattern == "arch":
        return np.arctan2(-1.4 * place.real * np.exp(-((place.imag + 0.1) ** 2) / 0.5), 1.0)
    turns = [np.angle(place - core) for core in cores] + [-np.angle(place - delta) for delta in deltas]
    return np.asarray(np.sum(turns, axis=0) / 2, dtype=np.float64)


@lru_cache(maxsize=12)
def _ridge_sheet(seed: int, pattern: Pattern, half_periods: int) -> tuple[_Float32, _Float32]:
    """Grow a square sheet of ridges, crests +1 and valleys −1, and the grain that makes pores and breaks."""
    rng = np.random.default_rng([seed, 7])
    side = int(2 * half_periods * _CELLS_PER_PERIOD)
    middle = (side - 1) / 2
    rows, columns = np.indices((side, side), dtype=np.float64)
    direction = _flow(pattern, middle - rows, columns - middle, 17 * _CELLS_PER_PERIOD)
    nearest = np.rint(direction / (math.pi / _DIRECTIONS)).astype(int) % _DIRECTIONS
    bank = [_gabor(k * math.pi / _DIRECTIONS) for k in range(_DIRECTIONS)]
    sheet = rng.normal(0, 1, (side, side)).astype(np.float32)
    grown = np.empty_like(sheet)
    for _ in range(_GENERATIONS):
        for k, kernel in enumerate(bank):
            chosen = nearest == k
            if chosen.any():
                grown[chosen] = cv2.filter2D(sheet, -1, kernel)[chosen]
        sheet = np.tanh(grown / (0.6 * grown.std())).astype(np.float32)
    grain = cv2.GaussianBlur(rng.normal(0, 1, (side, side)).astype(np.float32), (0, 0), 1.1)
    return _single(cv2.GaussianBlur(sheet, (0, 0), 0.8)), _single(grain / grain.std())


def _gabor(direction: float) -> _Float32:
    """Return the zero-mean filter for ridges along `direction` (from right to up)."""
    reach = int(1.6 * _CELLS_PER_PERIOD)
    y, x = np.mgrid[-reach : reach + 1, -reach : reach + 1].astype(np.float64)
    off = x * math.sin(direction) + y * math.cos(direction)
    envelope = np.exp(-(x**2 + y**2) / (2 * (0.55 * _CELLS_PER_PERIOD) ** 2))
    kernel = envelope * np.cos(2 * math.pi * off / _CELLS_PER_PERIOD)
    kernel -= envelope * kernel.sum() / envelope.sum()
    return _single(kernel)


def _expose(
    ridges: BoolArray,
    look: Look,
    mm_per_px: float,
    *,
    lighting: float,
    noise_std: float,
    rng: np.random.Generator,
) -> npt.NDArray[np.uint8]:
    """Turn touching ridges into grey levels: blur, light, grain of the ink, noise."""
    dark, light, blur, contact_is_dark = _LOOKS[look]
    amount = cv2.GaussianBlur(ridges.astype(np.float32), (0, 0), max(blur / mm_per_px, 0.3))
    amount = amount * (1 + 0.12 * _cloud(rng, ridges.shape, 0.8 / mm_per_px))
    if look == "ink":
        amount = amount * (1 - 0.25 * np.abs(_cloud(rng, ridges.shape, 0.04 / mm_per_px)))
    level = light - (light - dark) * amount if contact_is_dark else dark + (light - dark) * amount
    rows, columns = ridges.shape
    slope = np.add.outer(np.linspace(0, 0.5, rows), np.linspace(0, 0.5, columns))
    exposed = level * (1 - lighting * slope) + rng.normal(0, noise_std, ridges.shape)
    return np.clip(np.rint(exposed), 0, 255).astype(np.uint8)


def _cloud(rng: np.random.Generator, shape: tuple[int, ...], sigma: float) -> _Float32:
    """Return smooth noise of unit deviation."""
    noise = cv2.GaussianBlur(rng.normal(0, 1, shape).astype(np.float32), (0, 0), sigma)
    return _single(noise / noise.std())


def _single(values: npt.ArrayLike) -> _Float32:
    return np.asarray(values, dtype=np.float32)
