"""Rendered photographs of a finger's faces whose true semi-axes are known."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias

import cv2
import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from fingerpad._arrays import Float32Array, FloatArray, as_float32
from fingerpad._display import Displayed
from fingerpad.exceptions import GeometryError
from fingerpad.image.ellipse import rotation
from fingerpad.image.levels import linear_light, srgb_levels
from fingerpad.image.photograph.faces import Direction, Face, face_axes, palmar_directions
from fingerpad.simulate._finger_shape import FingerShape, finger_shape, pad_arc

Backdrop: TypeAlias = Literal["white", "grey", "black", "blue", "green", "cork"]

_BACKDROPS: Mapping[Backdrop, tuple[int, int, int]] = {
    "white": (228, 228, 224),
    "grey": (150, 152, 155),
    "black": (26, 26, 29),
    "blue": (52, 92, 160),
    "green": (58, 135, 82),
    "cork": (168, 128, 84),
}
# From light to dark, palmar side.
_SKINS = ((238, 198, 178), (226, 176, 146), (205, 144, 110), (162, 104, 74), (118, 74, 52), (84, 54, 42))
_NAIL = (232, 190, 182)
# Width and height of the frame, mm, with the fingertip up, and the pad's centre from its upper edge.
_FRAME = (38.0, 44.0)
_CENTRE_DEPTH = 22.0
# How far from the outline depths are exact, inside and outside: beyond, no light depends on them.
_BAND_MM, _OUTER_BAND_MM = 3.5, 0.75
_DISTANCE_MM = 250.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SyntheticFinger(Displayed):
    """A rendered photograph of a finger and the truth about it."""

    pixels: npt.NDArray[np.uint8]  # (rows, columns, 3); red, green, blue
    face: Face
    semi_axes: tuple[float, float]  # across and along (see `FACE_AXES`), mm
    centre: tuple[float, float]  # of the ellipse, (row, column), px
    tilt: float  # from the face's x towards its y, radians
    arc: tuple[float, float]  # parametric angles of the exactly elliptic arc, radians
    tip: Direction
    palmar: Direction
    mm_per_px: float

    def arc_points(self, count: int = 60) -> FloatArray:
        """Return true points (row, column), px, along the elliptic arc, ends included."""
        t = np.linspace(*self.arc, count)
        local = np.stack([self.semi_axes[0] * np.cos(t), self.semi_axes[1] * np.sin(t)], axis=-1)
        axes = rotation(self.tilt).T @ face_axes(self.face, self.tip, self.palmar)
        return np.asarray(local @ axes / self.mm_per_px + self.centre, dtype=np.float64)


def render_finger(
    face: Face = "palmar",
    *,
    semi_axes: tuple[float, float] | None = None,
    arc_deg: float = 150.0,
    departure: float = 0.4,
    tip: Direction = "up",
    palmar: Direction | None = None,
    tilt_deg: float = 0.0,
    skin: float = 0.2,
    backdrop: Backdrop = "blue",
    light_deg: float = 120.0,
    shadow: float = 0.15,
    texture_mm: float = 0.015,
    blur_px: float = 1.0,
    noise_std: float = 2.0,
    camera_tilt_deg: float = 0.0,
    jpeg_quality: int | None = 90,
    mm_per_px: float = 0.05,
    seed: int = 0,
) -> SyntheticFinger:
    """Render a photograph of one face of a finger before a plain backdrop.

    Parameters
    ----------
    face : {"palmar", "distal", "radial", "ulnar"}
        The face that looks at the camera.
    semi_axes : (float, float), optional
        Semi-axes across and along (see `FACE_AXES`), mm; by default those of the index finger in Dzidek et
        al. (2017).
    arc_deg : float
        Extent of the exactly elliptic arc round the pad, parametric degrees, 20 to 180.
    departure : float
        Relative change of the curvature beyond the arc, −0.8 (blunter) to 0.8 (tighter).
    tip, palmar : Direction
        Where the fingertip points, and the palmar side in the distal (down if left out) and side faces.
    tilt_deg : float
        Turn of the finger in the picture.
    skin : float
        Skin tone from light, 0, to dark, 1.
    backdrop : str
        Colour of the backdrop.
    light_deg, shadow : float
        Direction that the light comes from, and depth of the shadow on the backdrop, 0 to 1.
    texture_mm : float
        Standard deviation of the outline's roughness.
    blur_px, noise_std, jpeg_quality : float, float, int or None
        Lens blur (standard deviation), camera noise in grey levels, JPEG quality (None for none).
    camera_tilt_deg : float
        Tilt of the finger's plane against the picture's, seen from 250 mm.
    mm_per_px : float
        Scale.
    seed : int
        The same seed gives the same picture.

    Returns
    -------
    SyntheticFinger
        Photograph and truth.

    Raises
    ------
    GeometryError
        If a length is not positive or the arc cannot be drawn.

    Examples
    --------
    >>> truth = render_finger("distal", semi_axes=(11.8, 7.9), mm_per_px=0.1, seed=1)
    >>> truth.pixels.shape, truth.palmar, round(math.degrees(truth.arc[1] - truth.arc[0]))
    ((440, 380, 3), 'down', 150)
    """
    palmar = palmar_directions(face, tip, palmar)[0]
    semi_axes = semi_axes or {"palmar": (11.8, 13.8), "distal": (11.8, 7.9)}.get(face, (7.9, 13.8))
    positive = all(length > 0 for length in (*semi_axes, mm_per_px))
    if not (positive and 20 <= arc_deg <= 180 and -0.8 <= departure <= 0.8):
        raise GeometryError(
            "semi_axes and mm_per_px must be positive, arc_deg 20 to 180 and departure -0.8 to 0.8, "
            f"found {semi_axes}, {mm_per_px}, {arc_deg}, {departure}"
        )
    rng = np.random.default_rng(seed)
    shape = finger_shape(
        face, semi_axes, extent=math.radians(arc_deg), departure=departure, texture=texture_mm, rng=rng
    )
    size, centre = _frame(face, tip, palmar, mm_per_px)
    axes = rotation(math.radians(tilt_deg)).T @ face_axes(face, tip, palmar)
    rows, columns = (np.arange(n) - c for n, c in zip(size, centre, strict=True))
    flat = np.stack([rows[:, None] * r * mm_per_px + columns * c * mm_per_px for r, c in axes])
    to_face = _to_face_plane(flat, math.radians(camera_tilt_deg), rng)
    depth, nail = _depths(to_face, shape, mm_per_px)
    look = (skin, backdrop, light_deg, shadow, mm_per_px)
    light = _light_from_pixels(face, (depth, nail), to_face, look, rng)
    return SyntheticFinger(
        pixels=_expose(light, blur_px, noise_std, jpeg_quality, rng),
        face=face,
        semi_axes=semi_axes,
        centre=centre,
        tilt=math.radians(tilt_deg),
        arc=pad_arc(face, math.radians(arc_deg)),
        tip=tip,
        palmar=palmar,
        mm_per_px=mm_per_px,
    )


def _frame(
    face: Face, tip: Direction, palmar: Direction, mm_per_px: float
) -> tuple[tuple[int, int], tuple[float, float]]:
    """Return the size of the picture and the ellipse's centre in it, (row, column)."""
    width, height = (round(length / mm_per_px) for length in _FRAME)
    along = face_axes(face, tip, palmar)[1]
    rows, columns = (height, width) if along[0] else (width, height)
    # The pad's end is nearer to its side of the frame than the finger's root; end on, it is in the middle.
    shift = 0.0 if face == "distal" else height / 2 - _CENTRE_DEPTH / mm_per_px
    middle = (np.array([rows, columns]) - 1) / 2 + shift * along
    return (rows, columns), (float(middle[0]), float(middle[1]))


def _to_face_plane(seen: FloatArray, camera_tilt: float, rng: np.random.Generator) -> FloatArray:
    """Return the place (x, y) of each pixel in the face's plane, mm, tilted about a line of any direction."""
    direction = rng.uniform(0, 2 * math.pi)
    if camera_tilt == 0:
        return seen
    toward = math.cos(direction), math.sin(direction)
    along = seen[0] * toward[0] + seen[1] * toward[1]
    # A ray through a place of the picture, from 250 mm, meets the plane farther out on the side tilted away.
    stretch = 1 / (math.cos(camera_tilt) - along / _DISTANCE_MM * math.sin(camera_tilt))
    beyond = stretch * (1 - math.cos(camera_tilt)) * along
    return np.stack(
        [x * stretch * math.cos(camera_tilt) + beyond * t for x, t in zip(seen, toward, strict=True)]
    )


def _depths(places: FloatArray, shape: FingerShape, mm_per_px: float) -> tuple[Float32Array, Float32Array]:
    """Return the depth of each pixel inside the finger, mm, and the share of the nail in it.

    Far from the outline it is about right, and outside too small.
    """
    inside = _inside(places, shape.points, mm_per_px)
    edge = cv2.dilate(inside, np.ones((3, 3), np.uint8)) != cv2.erode(inside, np.ones((3, 3), np.uint8))
    away = cv2.distanceTransform((~edge).astype(np.uint8), cv2.DIST_L2, 5) * mm_per_px
    depth = np.where(inside > 0, away, -away).astype(np.float64)
    near = (depth > -_OUTER_BAND_MM - 3 * mm_per_px) & (depth < _BAND_MM)
    spots = np.stack([part[near] for part in places], axis=-1)
    _, nearest = cKDTree(shape.points, compact_nodes=False, balanced_tree=False).query(spots)
    signed = -np.einsum("ij,ij->i", spots - shape.points[nearest], shape.normals[nearest])
    # The nail's plate covers the dorsal outline and stands a little above it.
    plate = shape.nail[nearest]
    proud = signed + 0.25 * plate
    nail = np.zeros(depth.shape, np.float32)
    nail[near] = plate * np.clip(0.5 + proud / mm_per_px, 0, 1) * (signed < 0.9)
    depth[near] = np.where(plate > 0.5, proud, signed)
    return as_float32(depth), nail


def _inside(places: FloatArray, outline: FloatArray, mm_per_px: float) -> npt.NDArray[np.uint8]:
    """Return where pixels lie inside the outline, to about a pixel."""
    low = places.min(axis=(1, 2)) - 2
    high = places.max(axis=(1, 2)) + 2
    columns, rows = np.ceil((high - low) / mm_per_px).astype(int)
    chart = np.zeros((rows, columns), np.uint8)
    corners = np.rint((np.clip(outline, low - 30, high + 30) - low) / mm_per_px).astype(np.int32)
    cv2.fillPoly(chart, [corners.reshape(-1, 1, 2)], 1)
    x, y = ((place - least) / mm_per_px for place, least in zip(places, low, strict=True))
    return np.asarray(cv2.remap(chart, as_float32(x), as_float32(y), cv2.INTER_NEAREST), dtype=np.uint8)


def _light_from_pixels(
    face: Face,
    cover: tuple[Float32Array, Float32Array],
    places: FloatArray,
    look: tuple[float, Backdrop, float, float, float],
    rng: np.random.Generator,
) -> Float32Array:
    """Return the light from each pixel, linear red, green, blue: skin and nail over the backdrop."""
    (depth, nail), (skin, backdrop, light_deg, shadow, mm_per_px) = cover, look
    size = depth.shape
    angle = math.radians(light_deg)
    light = np.array([0.55 * math.cos(angle), -0.55 * math.sin(angle)], dtype=np.float32)
    share = np.clip(0.5 + depth / mm_per_px, 0, 1)
    # Colours are worked out only where there is finger, and one by one.
    covered = share > 0
    tones = linear_light(np.array([_SKINS], dtype=np.uint8))[0]
    shade, gloss = (part[covered] for part in _shading(depth, light, mm_per_px))
    blush = _cloud(rng, size, 2.5 / mm_per_px)[covered].astype(np.float64)
    # The look of the skin's ridges: noise of their period.
    grain = _cloud(rng, size, 0.09 / mm_per_px) - 0.8 * _cloud(rng, size, 0.2 / mm_per_px)
    ridges = (1 + 0.03 * grain)[covered]
    folds = 1 - _creases(face, places[:, covered], rng)
    plate = linear_light(np.array([[_NAIL]], dtype=np.uint8))[0, 0] * (0.55 + 0.45 * (1 - skin))
    ground = linear_light(np.array([[_BACKDROPS[backdrop]]], dtype=np.uint8))[0, 0]
    fall = np.tensordot(rng.normal(0, 0.003, 2), places, 1)
    paper = 1 + as_float32(fall) + 0.008 * _cloud(rng, size, 0.15 / mm_per_px)
    step = np.array([[1, 0, -light[0] * 4 / mm_per_px], [0, 1, -light[1] * 4 / mm_per_px]])
    dark = cv2.warpAffine(share, step, (size[1], size[0]), borderMode=cv2.BORDER_REPLICATE)
    paper *= 1 - shadow * as_float32(cv2.GaussianBlur(dark, (0, 0), 1.8 / mm_per_px))
    share, nail = share[covered], nail[covered]
    planes = []
    for k, reddening in enumerate((0.03, 0.06, 0.06)):
        tone = float(np.interp(skin * (len(tones) - 1), range(len(tones)), tones[:, k]))
        colour = tone * (1 + reddening * blush) * ridges * folds
        colour += nail * (plate[k] - colour)
        plane = ground[k] * paper
        finger = colour * shade + gloss * (0.012 + 0.10 * nail)
        plane[covered] = share * finger + (1 - share) * plane[covered]
        planes.append(plane)
    return as_float32(cv2.merge(planes))


def _shading(depth: Float32Array, light: Float32Array, mm_per_px: float) -> tuple[Float32Array, Float32Array]:
    """Return the diffuse shade of a rounded body and its highlight."""
    radius = max(1.0, 0.85 * float(depth.max()))
    q = np.clip(depth / radius, 0, 1)
    slopes = cv2.GaussianBlur(np.maximum(depth, -0.5), (0, 0), 0.7 / mm_per_px)
    down, right = np.gradient(slopes)
    length = np.maximum(np.hypot(down, right), 1e-6)
    tilt = 1 - q
    facing = np.sqrt(np.maximum(1 - tilt**2, 0))
    level = math.sqrt(1 - float(light @ light))
    lambert = level * facing - tilt * (right * light[0] + down * light[1]) / length
    shade = 0.42 + 0.62 * np.maximum(lambert, 0)
    return as_float32(shade), as_float32(np.maximum(lambert, 0) ** 24)


def _creases(face: Face, places: FloatArray, rng: np.random.Generator) -> Float32Array:
    """Return the darkness of the skin's folds at the joint, at places (x, y), mm."""
    x, y = places
    if face == "distal":
        return np.zeros(x.shape, np.float32)
    dark = np.zeros(x.shape)
    for _ in range(4):
        middle, width = -15.5 + rng.normal(0, 1.2), rng.uniform(0.12, 0.3)
        bend, tilt, phase = rng.uniform(-0.01, 0.02), rng.normal(0, 0.04), rng.uniform(0, 6)
        strength, side = rng.uniform(0.12, 0.4), rng.normal(0, 3)
        line = middle + tilt * x + bend * x**2 + 0.15 * np.sin(0.9 * x + phase)
        near = np.abs(y - line) < 8 * width
        along, across = (x[near] - side) / 7, (y[near] - line[near]) / width
        dark[near] += strength * np.exp(-(along**2) - 0.5 * across**2)
    return as_float32(np.minimum(dark, 0.6))


def _expose(
    light: Float32Array, blur: float, noise_std: float, jpeg_quality: int | None, rng: np.random.Generator
) -> npt.NDArray[np.uint8]:
    """Return what a camera makes of the light: blur, shot and read noise, sRGB, JPEG."""
    seen = cv2.GaussianBlur(light, (0, 0), blur) if blur > 0 else light
    # In grey levels the camera's noise is about even over the brighter tones.
    levels = rng.normal(0, noise_std, seen.shape)
    levels += srgb_levels(seen)
    pixels = np.clip(np.rint(levels, out=levels), 0, 255, out=levels).astype(np.uint8)
    if jpeg_quality is not None:
        _, file = cv2.imencode(".jpg", pixels[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, jpeg_quality])
        pixels = np.asarray(cv2.imdecode(file, cv2.IMREAD_COLOR), dtype=np.uint8)[..., ::-1].copy()
    return pixels


def _cloud(rng: np.random.Generator, size: tuple[int, ...], sigma: float) -> Float32Array:
    """Return smooth noise of unit deviation, grown coarse where it is very smooth."""
    step = max(1, int(sigma / 4))
    rough = rng.normal(0, 1, (size[0] // step + 2, size[1] // step + 2)).astype(np.float32)
    soft = cv2.GaussianBlur(rough, (0, 0), max(sigma / step, 0.3))
    large = cv2.resize(soft, (rough.shape[1] * step, rough.shape[0] * step), interpolation=cv2.INTER_CUBIC)
    noise = as_float32(large)[: size[0], : size[1]]
    return as_float32(noise / noise.std())
