"""Rendered contact images with friction ridges, of known truth.

The ridges come from noise filtered again and again along a flow with a core and a delta, as real prints have;
minutiae appear by themselves. The contact ends at an ellipse, or at a smooth irregular outline whose
equal-area ellipse is the truth; ridges thin out towards it.
"""

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, Float32Array, FloatArray, as_float32, check_radians
from fingerpad._display import Displayed
from fingerpad.exceptions import GeometryError
from fingerpad.geometry.ellipse import Ellipse
from fingerpad.image.ellipse import half_turn, polygon_moments
from fingerpad.simulate._ridge_sheet import CELLS_PER_PERIOD, Pattern, ridge_sheet
from fingerpad.units import MM_PER_INCH

Look: TypeAlias = Literal["ink", "livescan", "prism"]

# Dark level, light level, blur (mm), and whether contact is the dark one.
_LOOKS: dict[Look, tuple[float, float, float, bool]] = {
    "ink": (55.0, 225.0, 0.035, True),
    "livescan": (35.0, 250.0, 0.025, True),
    "prism": (25.0, 205.0, 0.035, False),
}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SyntheticContactImage(Displayed):
    """A rendered contact image and its truth."""

    pixels: npt.NDArray[np.uint8]  # (rows, columns)
    ellipse: Ellipse  # the outline, or the equal-area ellipse of an irregular one, mm
    orientation: float  # of the major axis from straight up, counter-clockwise as seen, radians
    centroid: tuple[float, float]  # (row, column), px
    ridge_area: float  # without pores and creases, mm²
    ridge_period: float  # mean, mm
    mm_per_px: float

    @property
    def gross_area(self) -> float:
        """True area inside the outline, mm²."""
        return float(self.ellipse.area)


def render_contact_image(
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
    irregularity: float = 0.0,
    creases: int = 0,
    smudges: int = 0,
    blur: float = 0.0,
    jpeg_quality: int | None = None,
    margin: float = 2.0,
    seed: int = 0,
    ridge_seed: int | None = None,
) -> SyntheticContactImage:
    """Render a contact image whose ellipse is known.

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
    irregularity : float
        Standard deviation of the outline's radius about the ellipse's, as a share of it: two to six waves
        round the outline, the longer the higher.
    creases : int
        Number of fine straight lines without contact across the print.
    smudges : int
        Number of smears, as of moist or sliding skin: parts of 1.5 to 3 mm radius within which ridges blur
        into one another. The contact and its ridges, which are the truth, stay what they are.
    blur : float
        Standard deviation of a blur on top of the look's own, mm.
    jpeg_quality : int, optional
        Quality of a lossy compression, 1 to 100; None for none.
    margin : float
        Empty background round the ellipse's box, mm; negative cuts the contact.
    seed : int
        The same seed gives the same picture.
    ridge_seed : int, optional
        Seed of the ridges alone, to see one finger's skin in several pictures; `seed` when None.

    Returns
    -------
    SyntheticContactImage
        Picture and truth.

    Raises
    ------
    GeometryError
        If a length is not positive, the semi-axes are swapped, or the orientation is beyond a full turn.

    Examples
    --------
    >>> truth = render_contact_image(semi_major=3.0, semi_minor=2.5, seed=1)
    >>> truth.pixels.dtype, round(truth.gross_area, 1)
    (dtype('uint8'), 23.6)
    """
    check_radians("orientation", orientation)
    ellipse = Ellipse(semi_major, semi_minor)
    for name, value in (("ppi", ppi), ("ridge_period", ridge_period)):
        if not value > 0:
            raise GeometryError(f"{name} must be positive, found {value}")
    mm_per_px = MM_PER_INCH / ppi
    rng = np.random.default_rng(seed)
    t = np.linspace(0, 2 * math.pi, 4000, endpoint=False)
    reach = _reach(t, irregularity, seed)
    along, across = semi_major * reach * np.cos(t), semi_minor * reach * np.sin(t)
    cosine, sine = math.cos(orientation), math.sin(orientation)
    outline = np.stack([along * cosine - across * sine, along * sine + across * cosine], axis=-1)
    up, left = _grid(outline, margin, mm_per_px)
    along, across = up * cosine + left * sine, left * cosine - up * sine
    radius = np.hypot(along / semi_major, across / semi_minor)
    if irregularity:
        radius /= _reach(np.arctan2(across / semi_minor, along / semi_major), irregularity, seed)
    skin = seed if ridge_seed is None else ridge_seed
    ridges = _ridges((along, across), radius, ridge_period, pattern, skin)
    ridges &= ~_creases(along, across, semi_minor, creases, seed)
    places, semi_axes = (along, across), (semi_major, semi_minor)
    amount = _smudge(ridges.astype(np.float32), radius <= 1, places, semi_axes, count=smudges, seed=seed)
    pixels = _expose(amount, look, mm_per_px, lighting=lighting, noise_std=noise_std, blur=blur, rng=rng)
    if jpeg_quality is not None:
        _, code = cv2.imencode(".jpg", pixels, [cv2.IMWRITE_JPEG_QUALITY, jpeg_quality])
        pixels = np.asarray(cv2.imdecode(code, cv2.IMREAD_GRAYSCALE), dtype=np.uint8)
    centre_up, centre_left = 0.0, 0.0
    if irregularity:
        moments = polygon_moments(outline)
        ellipse, orientation = Ellipse(*moments.semi_axes.tolist()), math.atan2(*moments.axes[0][::-1])
        centre_up, centre_left = moments.centroid.tolist()
    return SyntheticContactImage(
        pixels=np.asarray(pixels, dtype=np.uint8),
        ellipse=ellipse,
        orientation=half_turn(orientation),
        centroid=(_grid_index(centre_up, up[:, 0]), _grid_index(centre_left, left[0])),
        ridge_area=float(np.count_nonzero(ridges)) * mm_per_px**2,
        ridge_period=ridge_period,
        mm_per_px=mm_per_px,
    )


def _grid_index(length: float, grid: FloatArray) -> float:
    """Return the pixel at which an even grid takes a value."""
    return float((length - grid[0]) / (grid[1] - grid[0]))


def _reach(angle: FloatArray, irregularity: float, seed: int) -> FloatArray:
    """Return the outline's radius over the ellipse's, at parametric angles from the major axis."""
    waves = np.arange(2, 7)
    rng = np.random.default_rng([seed, 3])
    size, phase = rng.uniform(0.5, 1, len(waves)), rng.uniform(0, 2 * math.pi, len(waves))
    size = size / waves
    size *= irregularity * math.sqrt(2) / np.linalg.norm(size)
    reach = (a * np.cos(wave * angle + p) for a, wave, p in zip(size, waves, phase, strict=True))
    return sum(reach, start=np.ones_like(angle))


def _grid(outline: FloatArray, margin: float, mm_per_px: float) -> tuple[FloatArray, FloatArray]:
    """Return the distances up and left of the ellipse's centre of each pixel, mm."""
    middle = (outline.max(axis=0) + outline.min(axis=0)) / 2
    lengths = (np.ptp(outline, axis=0) + 2 * margin) / mm_per_px
    counts = (max(2, round(length)) for length in lengths)
    sides = [-(np.arange(n) - (n - 1) / 2) * mm_per_px + m for m, n in zip(middle, counts, strict=True)]
    up, left = np.meshgrid(*sides, indexing="ij")
    return up, left


def _ridges(
    places: tuple[FloatArray, FloatArray], radius: FloatArray, period: float, pattern: Pattern, seed: int
) -> BoolArray:
    """Return where ridges touch: crests above a level that rises towards the edge, without pores."""
    along, across = places
    reach = max(np.abs(along[radius <= 1]).max(initial=0), np.abs(across[radius <= 1]).max(initial=0))
    # Whole steps of 8 periods let pictures of one finger share a sheet.
    crests, grain = ridge_sheet(seed, pattern, 8 * math.ceil((reach / period + 1) / 8))
    cells = CELLS_PER_PERIOD / period
    middle = (crests.shape[0] - 1) / 2

    def sample(sheet: Float32Array) -> Float32Array:
        columns = (middle - across * cells).astype(np.float32)
        rows = (middle - along * cells).astype(np.float32)
        return as_float32(cv2.remap(sheet, columns, rows, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REFLECT))

    # Pressure falls to nothing at the edge: the ridges thin out and break up there.
    edge = np.clip((radius - 0.86) / 0.14, 0, 1) ** 2
    touching = sample(crests) > -0.12 + 0.3 * edge + (0.22 + 0.3 * edge) * sample(grain)
    return touching & (radius <= 1)


def _creases(along: FloatArray, across: FloatArray, semi_minor: float, count: int, seed: int) -> BoolArray:
    """Return where fine lines of 0.1 to 0.3 mm keep the skin off."""
    lines = np.zeros(along.shape, dtype=bool)
    rng = np.random.default_rng([seed, 5])
    for _ in range(count):
        angle, off = rng.uniform(0, math.pi), rng.uniform(-0.7, 0.7) * semi_minor
        width = rng.uniform(0.1, 0.3)
        lines |= np.abs(along * math.sin(angle) + across * math.cos(angle) - off) < width / 2
    return lines


def _smudge(
    amount: Float32Array,
    inside: BoolArray,
    places: tuple[FloatArray, FloatArray],
    semi_axes: tuple[float, float],
    *,
    count: int,
    seed: int,
) -> Float32Array:
    """Smear ridges into one another within parts of the contact, 1.5 to 3 mm in radius.

    Each is a Gaussian of 0.25 to 0.5 mm along the slide, 0.1 to 0.25 mm across; nothing leaves the contact.
    `places` are the distances (along, across) of each pixel from the centre, mm.
    """
    along, across = places
    mm_per_px = math.hypot(along[0, 0] - along[1, 0], across[0, 0] - across[1, 0])
    rng = np.random.default_rng([seed, 9])
    for _ in range(count):
        slide, width = rng.uniform(0.25, 0.5), rng.uniform(0.1, 0.25)
        kernel = _gaussian(slide / mm_per_px, width / mm_per_px, rng.uniform(0, math.pi))
        carried, room = (cv2.filter2D(layer, -1, kernel) for layer in (amount, inside.astype(np.float32)))
        smear = np.where(inside, carried / np.maximum(room, 1e-6), 0)
        off = [at - rng.uniform(-0.8, 0.8) * reach for at, reach in zip(places, semi_axes, strict=True)]
        weight = np.exp(-((np.hypot(*off) / rng.uniform(1.5, 3.0)) ** 4))
        amount = np.asarray(amount + weight * (smear - amount), dtype=np.float32)
    return amount


def _gaussian(long: float, short: float, angle: float) -> Float32Array:
    """Return an elongated Gaussian kernel of unit sum, in px."""
    reach = math.ceil(3 * long)
    y, x = np.mgrid[-reach : reach + 1, -reach : reach + 1]
    forth, aside = x * math.cos(angle) + y * math.sin(angle), y * math.cos(angle) - x * math.sin(angle)
    kernel = np.exp(-((forth / long) ** 2 + (aside / short) ** 2) / 2)
    return np.asarray(kernel / kernel.sum(), dtype=np.float32)


def _expose(
    amount: Float32Array,
    look: Look,
    mm_per_px: float,
    *,
    lighting: float,
    noise_std: float,
    blur: float,
    rng: np.random.Generator,
) -> npt.NDArray[np.uint8]:
    """Turn the amount of touching ridge into grey levels: blur, light, grain of the ink, noise."""
    dark, light, own_blur, contact_is_dark = _LOOKS[look]
    width = max(math.hypot(blur, own_blur) / mm_per_px, 0.3)
    contact = np.asarray(cv2.GaussianBlur(amount, (0, 0), width), dtype=np.float64)
    contact *= 1 + 0.12 * _cloud(rng, contact.shape, 0.8 / mm_per_px)
    if look == "ink":
        contact *= 1 - 0.25 * np.abs(_cloud(rng, contact.shape, 0.04 / mm_per_px))
    level = light - (light - dark) * contact if contact_is_dark else dark + (light - dark) * contact
    rows, columns = contact.shape
    slope = np.add.outer(np.linspace(0, 0.5, rows), np.linspace(0, 0.5, columns))
    exposed = level * (1 - lighting * slope) + rng.normal(0, noise_std, contact.shape)
    return np.clip(np.rint(exposed), 0, 255).astype(np.uint8)


def _cloud(rng: np.random.Generator, shape: tuple[int, ...], sigma: float) -> Float32Array:
    """Return smooth noise of unit deviation."""
    noise = cv2.GaussianBlur(rng.normal(0, 1, shape).astype(np.float32), (0, 0), sigma)
    return as_float32(noise / noise.std())
