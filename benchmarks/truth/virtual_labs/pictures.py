"""Contact images, photographs and outlines of a pad."""

from dataclasses import dataclass

import cv2
import numpy as np
from scipy import ndimage

from benchmarks.arrays import Array, Rng

from .physics import PROFILE_AT, Pad

SUPERSAMPLING = 2


@dataclass(frozen=True)
class Device:
    """How a device images a contact."""

    kind: str
    ppi: float
    blur_mm: float
    fading: float  # exponent of contrast against pressure
    valley: float  # contrast of valleys in contact, of that of ridges
    noise: float
    dirt: int  # specks
    texture: float
    shading: float
    dark_on_light: bool
    ridge_width: float  # share of a ridge period at the highest pressure
    widening: float  # exponent of the ridges' width against pressure

    @classmethod
    def draw(cls, kind: str, rng: Rng) -> "Device":
        """Draw a device of a kind: sharp, soft or dirty."""
        ridge_width, widening = rng.uniform(0.5, 0.62), rng.uniform(0.25, 0.45)
        ppi = float(rng.choice([500, 600])) if kind == "sharp" else 500.0
        if kind == "sharp":
            look = rng.uniform(0.015, 0.03), 0.0, 0.0, rng.uniform(1, 4), 0, 0.0, 0.03
        elif kind == "soft":
            look = rng.uniform(0.05, 0.09), rng.uniform(0.2, 0.4), rng.uniform(0.1, 0.3), 3.0, 0, 1.0, 0.06
        else:
            look = rng.uniform(0.02, 0.05), rng.uniform(0, 0.15), 0.0, 6.0, 40, 5.0, 0.15
        return cls(kind, ppi, *look, bool(rng.random() < 0.7), ridge_width, widening)


def contact_image(
    outline: Array, profile: Array, pressure: float, device: Device, mm_per_px: float, *, rng: Rng
) -> tuple[Array, float]:
    """Render a contact; ``pressure`` is over that of the highest load. Return picture, true area."""
    reach = float(outline.max()) * 1.25 + 2
    n = int(2 * reach / mm_per_px)
    step = mm_per_px / SUPERSAMPLING
    axis = (np.arange(n * SUPERSAMPLING) - (n * SUPERSAMPLING - 1) / 2) * step
    rows, columns = np.meshgrid(axis, axis, indexing="ij")
    turn, shift = np.radians(rng.normal(0, 1.0)), rng.uniform(-0.6, 0.6, 2)
    dr, dc = rows - shift[0], columns - shift[1]
    down, right = np.cos(turn) * dr - np.sin(turn) * dc, np.sin(turn) * dr + np.cos(turn) * dc
    # r over the radius of the outline, which is about the finger's direction, up in the picture
    angle, closed = np.mod(np.arctan2(right, -down), 2 * np.pi), np.append(outline, outline[0])
    rho = np.hypot(down, right) / np.interp(angle, np.linspace(0, 2 * np.pi, len(closed)), closed)
    inside = rho < 1
    local = pressure * np.interp(rho, PROFILE_AT, np.maximum(profile, 0), right=0)
    tail = rho > PROFILE_AT[-2]  # the last step of the profile falls like a square root
    local[tail] = pressure * profile[-2] * np.sqrt(np.maximum(1 - rho[tail], 0) / (1 - PROFILE_AT[-2]))
    width = device.ridge_width * local**device.widening
    phase = _ridges(rows, columns, rng)
    slope = np.pi * device.ridge_width * 0.1
    ridge = np.clip((np.cos(phase) - np.cos(np.pi * width)) / slope + 0.5, 0, 1) * inside
    if device.kind == "dirty":  # pores and cracks interrupt ridges
        near = ndimage.distance_transform_edt(rng.random(ridge.shape) >= 0.6 * step**2) * step
        ridge *= np.clip((near - 0.06) / step, 0, 1)
    signal = ridge * local**device.fading + device.valley * (1 - ridge) * inside * local**0.5
    signal = ndimage.gaussian_filter(signal, device.blur_mm / step)
    signal = signal.reshape(n, SUPERSAMPLING, n, SUPERSAMPLING).mean(axis=(1, 3))
    if device.dirt:
        signal = np.maximum(signal, _specks(n, mm_per_px, device.dirt, rng))
    ground, contrast = (225, 150) if device.dark_on_light else (30, 150)
    light = 1 + device.shading * _smooth(n, 0.4 * n, rng)
    grey = ground + (-contrast if device.dark_on_light else contrast) * signal
    grey = grey * light + device.texture * _smooth(n, 1.5 / mm_per_px, rng)
    grey = grey + rng.normal(0, device.noise, (n, n))
    return np.clip(grey, 0, 255), float(inside.sum()) * step**2


def _smooth(n: int, scale_px: float, rng: Rng) -> Array:
    """Return a smooth random field of unit standard deviation."""
    coarse = max(4, int(np.ceil(n / scale_px)) + 3)
    field = cv2.resize(rng.normal(0, 1, (coarse, coarse)), (n, n), interpolation=cv2.INTER_CUBIC)
    return field / max(field.std(), 1e-9)


def _ridges(rows: Array, columns: Array, rng: Rng) -> Array:
    """Return the phase of a whorl, loop or arch with minutiae."""
    period = rng.uniform(0.42, 0.55)
    core = rng.uniform(-1.5, 1.5, 2)
    stretch = rng.uniform(1.0, 1.25)
    arch = rng.random() < 0.3
    r, c = rows - core[0], columns - core[1]
    distance = r + 0.03 * c**2 if arch else np.hypot(r / stretch, c)
    distance = distance + 0.12 * _smooth(len(rows), 3.0 / (rows[1, 0] - rows[0, 0]), rng)
    phase = 2 * np.pi * distance / period
    extent = float(rows.max())
    # Each minutia turns the phase once about its place.
    turns, at = np.ones(rows.shape, complex), columns + 1j * rows
    for row, column in rng.uniform(-extent, extent, (14, 2)):
        around = (at - (column + 1j * row)) / extent
        turns *= around if rng.random() < 0.5 else around.conj()
    return phase + np.angle(turns)


def _specks(n: int, mm_per_px: float, count: int, rng: Rng) -> Array:
    """Return dirt on the platen."""
    specks = np.zeros((n, n))
    for _ in range(count):
        centre = tuple(int(x) for x in rng.uniform(0, n, 2))
        axes = tuple(max(1, int(x / mm_per_px)) for x in rng.uniform(0.03, 0.2, 2))
        turn, depth = rng.uniform(0, 180), rng.uniform(0.2, 0.8)
        cv2.ellipse(specks, centre, axes, turn, 0, 360, depth, -1)
    return ndimage.gaussian_filter(specks, 0.8)


FACES = ("palmar", "distal", "radial")


def _arc(pad: Pad, face: str, angle: Array) -> Array:
    """Return points (right, up), mm, of the arc of a face, at angles from its widest place."""
    across = pad.palmar if face == "radial" else pad.radial_ulnar
    along = pad.palmar if face == "distal" else pad.distal
    power = 2 / pad.exponent if face == "radial" else 1
    return np.stack([across * np.cos(angle) ** power, along * np.sin(angle) ** power], axis=1)


def silhouette(pad: Pad, face: str, widening: float) -> Array:
    """Return a face's closed outline (right, up), mm: pad and shaft, or the section seen end-on."""
    if face == "distal":
        turn = np.linspace(0, 2 * np.pi, 800)[:-1]
        depth = pad.palmar * np.where(np.cos(turn) > 0, 1, pad.dorsal_ratio)
        return np.stack([pad.radial_ulnar * np.sin(turn), -depth * np.cos(turn)], axis=1)
    shaft, arc = np.linspace(0, 24, 60)[::-1], _arc(pad, face, np.linspace(0, np.pi / 2, 200))
    wide = 1 + widening * (shaft / 20) ** 2
    right = np.concatenate([np.stack([arc[0, 0] * wide, -shaft], axis=1), arc])
    return np.concatenate([right, right[::-1] * [-pad.dorsal_ratio if face == "radial" else -1, 1]])


def photograph(pad: Pad, face: str, mm_per_px: float, rng: Rng) -> Array:
    """Render a face before a blue card, turned by some degrees as held, in RGB."""
    outline = silhouette(pad, face, rng.uniform(0, 0.04))
    if face == "radial" and rng.random() < 0.5:
        outline = outline * [-1, 1]
    turn = np.radians(rng.normal(0, 1.5))
    outline = outline @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    margin = 6 / mm_per_px
    points = outline / mm_per_px * [1, -1]
    points = points - points.min(axis=0) + margin
    width = int(points[:, 0].max() + margin)
    # The shaft leaves the picture at its lower edge.
    height = int(points[:, 1].max() + margin if face == "distal" else points[:, 1].max() - 2 / mm_per_px)
    k = 4
    mask = np.zeros((height * k, width * k), np.uint8)
    cv2.fillPoly(mask, [np.round((points * k + (k - 1) / 2) * 16).astype(np.int32)], 255, shift=4)
    cover = cv2.resize(mask, (width, height), interpolation=cv2.INTER_AREA).astype(float) / 255
    cover = ndimage.gaussian_filter(cover, rng.uniform(0.6, 1.2))
    depth = ndimage.distance_transform_edt(cover > 0.5) * mm_per_px
    light = 0.72 + 0.28 * np.sqrt(1 - (1 - np.clip(depth / 5, 0, 1)) ** 2)
    mottle, shade = (_smooth(max(width, height), scale, rng)[:height, :width, None] for scale in (12, 300))
    skin = np.array([215, 165, 140]) * light[..., None] * (1 + 0.02 * mottle)
    card = np.array([40, 70, 150]) * (1 + 0.05 * shade)
    picture = card + cover[..., None] * (skin - card) + rng.normal(0, 2.5, (height, width, 3))
    return np.clip(picture, 0, 255)


def outline_points(pad: Pad, face: str, noise_mm: float, scale: float, rng: Rng) -> Array:
    """Return points digitised along the pad's arc of a face, in the manifest's axes, origin anywhere."""
    angle = np.linspace(0, np.pi / 2, 50) if face == "radial" else np.linspace(0, np.pi, 80)
    points = _arc(pad, face, angle)
    points = points + rng.normal(0, noise_mm, points.shape)
    return points * scale + rng.uniform(-3, 3, 2)
