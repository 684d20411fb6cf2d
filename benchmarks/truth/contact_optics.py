"""Pictures of a contact by prism, live-scan, ink on paper, and a glass plate lit from the side or above.

A picture is made on the fine grid as a density (0 background, 1 full contact), blurred, brought to pixels,
lit, disturbed, rounded to 8 bits and, if asked, compressed by JPEG.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from benchmarks.arrays import Array, Pixels, Rng
from benchmarks.truth.pressed_pad import Contact, smooth_noise
from benchmarks.truth.true_image import eight_bit


@dataclass(frozen=True)
class Optics:
    """Device and its faults; lengths in mm, grey levels as shares of full range."""

    device: str = "prism"  # prism, live-scan, ink, side-lit, front-lit
    blur: float = 0.6  # px, standard deviation
    background: float = 0.9
    contrast: float = 0.75
    fade: float = 0.3  # share of the contrast that comes only with pressure
    fade_pressure: float = 3.0  # kPa
    mottle: float = 0.22  # scatter of the contrast along ridges
    light: float = 0.1  # illumination's slope across the picture
    vignetting: float = 0.1
    halo: float = 0.0  # dark (+) or bright (−) beyond the contact
    halo_mm: float = 1.0
    meniscus: float = 0.0  # mm of liquid round every touching ridge
    islands: float = 0.0  # share of valleys filled with sweat
    latent: float = 0.0  # contrast of an earlier print
    texture: float = 0.01
    dirt: int = 0
    noise: float = 0.015
    jpeg: int = 0


def _noise(contact: Contact, rng: Rng, mm: float) -> Array:
    """Return noise on the fine grid, smooth over a length."""
    return smooth_noise(rng, contact.phase.shape, mm / contact.mm)


def _blur(field: Array, mm: float, contact: Contact) -> Array:
    return cv2.GaussianBlur(field.astype(np.float32), (0, 0), max(mm / contact.mm, 0.3))


def _wetted(contact: Contact, optics: Optics, rng: Rng) -> Array:
    """Share of each point that couples light: contact that fades with low pressure, and sweat beside it."""
    grip = 1 - optics.fade * np.exp(-np.maximum(contact.pressure, 0) / optics.fade_pressure)
    fine, coarse = (_noise(contact, rng, mm) for mm in (0.05, 0.4))
    mottle = np.clip(1 - optics.mottle * np.maximum(fine + 0.6 * coarse, -0.3), 0.2, 1.1)
    density = contact.touching * grip * mottle
    if optics.meniscus:
        near = _blur(contact.touching, optics.meniscus, contact)
        density = np.maximum(density, np.clip((near - 0.2) / 0.2, 0, 1) * grip * 0.9)
    if optics.islands:
        sweat = _noise(contact, rng, 0.35)
        limit = np.quantile(sweat[contact.outside < 0], 1 - optics.islands)
        wet = np.clip((sweat - limit) / 0.3, 0, 1) * (contact.outside < -0.05)
        density = np.maximum(density, wet * 0.85)
    return np.asarray(density, np.float32)


def _inked(contact: Contact, optics: Optics, rng: Rng) -> Array:
    """Ink that a touching ridge leaves on paper: squeezed to its borders, blotted, and broken by fibres."""
    near = _blur(contact.touching, 0.03, contact)
    grip = 1 - optics.fade * np.exp(-contact.pressure / optics.fade_pressure)
    film = np.clip((near - 0.3) / 0.35, 0, 1) * (1 - 0.3 * np.clip((near - 0.7) / 0.3, 0, 1)) * grip
    fibre = _noise(contact, rng, 0.035) + 0.7 * _noise(contact, rng, 0.12)
    supply = 1.0 + 0.35 * _noise(contact, rng, 2.0)
    film = film * np.clip(0.9 * supply + 0.42 * fibre, 0, 1.15)
    if optics.meniscus:
        # Surplus ink is dragged outward over the edge.
        near = np.clip(1 - np.abs(contact.outside) / optics.meniscus, 0, 1)
        drag = _blur(contact.touching, 0.25, contact) * near
        film = np.maximum(film, drag * np.clip(0.8 + 0.5 * fibre, 0, 1.2))
    speck = np.clip(_noise(contact, rng, 0.04) - 2.2, 0, 1) * np.exp(-np.abs(contact.outside))
    return np.asarray(np.maximum(film, 0.8 * speck), np.float32)


def _lifted_ridges(contact: Contact) -> Array:
    """Ridges that do not touch, seen through the plate: fainter and less sharp as the gap opens."""
    beyond = np.maximum(contact.outside, 0)
    crest = (1 + np.cos(contact.phase)) / 2
    return np.asarray(crest * np.exp(-(beyond**1.5) / 0.8), np.float32)


def _density(contact: Contact, optics: Optics, rng: Rng) -> Array:
    if optics.device == "ink":
        return _inked(contact, optics, rng)
    density = _wetted(contact, optics, rng)
    if optics.device == "front-lit":
        lifted = _blur(_lifted_ridges(contact), 0.05, contact)
        body = np.clip(1 - np.maximum(contact.outside, 0) / 5, 0, 1) ** 0.7
        density = np.maximum(density, 0.22 * lifted) + 0.18 * _blur(body, 0.3, contact)
    if optics.latent:
        across = rng.uniform(-3, 3) / contact.mm
        shift = np.array([[0.97, 0.17, across], [-0.17, 0.97, 2.5 / contact.mm]])
        rows, columns = density.shape
        earlier = cv2.warpAffine(contact.touching.astype(np.float32), shift, (columns, rows))
        grease = 0.5 + 0.5 * np.clip(_noise(contact, rng, 1.5) + 0.5, 0, 1)
        density = np.maximum(density, optics.latent * grease * _blur(earlier, 0.05, contact))
    beyond = np.maximum(contact.outside, 0)
    patchy = 1 + 0.4 * _noise(contact, rng, 1.2)
    veil = optics.halo * patchy * np.exp(-beyond / optics.halo_mm)
    # A bright veil is light that the skin throws back; it does not reach through the touching ridges.
    density = density + veil * (1 - density)
    return np.asarray(density, np.float32)


def _add_dirt(picture: Array, count: int, rng: Rng) -> None:
    """Grains, fibres and scratches, anywhere."""
    rows, columns = picture.shape
    for _ in range(count):
        start = rng.uniform(0, 1, 2) * (columns, rows)
        grey = float(np.clip(picture.mean() + rng.choice([-0.45, 0.2]) * rng.uniform(0.3, 1), 0, 1))
        if rng.random() < 0.6:
            cv2.circle(picture, start.astype(int).tolist(), int(rng.integers(1, 3)), grey, -1, cv2.LINE_AA)
        else:
            turns = rng.uniform(0, 2 * np.pi) + np.cumsum(rng.normal(0, 0.25, 12))
            steps = rng.uniform(2, 6) * np.stack([np.cos(turns), np.sin(turns)], axis=1)
            path = (start + np.cumsum(steps, axis=0)).astype(np.int32)
            cv2.polylines(picture, [path], False, grey, 1, cv2.LINE_AA)


def _lit(density: Array, optics: Optics, rng: Rng) -> Array:
    """Brightness of each pixel, 0 to 1."""
    rows, columns = density.shape
    y, x = np.mgrid[-1 : 1 : rows * 1j, -1 : 1 : columns * 1j]
    direction = rng.uniform(0, 2 * np.pi)
    light = 1 + optics.light * (x * np.cos(direction) + y * np.sin(direction))
    light = light * (1 - optics.vignetting * (x**2 + y**2) / 2)
    texture = smooth_noise(rng, density.shape, 1.5) + smooth_noise(rng, density.shape, 12)
    if optics.device == "side-lit":
        mottled = density * (1 + 0.12 * smooth_noise(rng, density.shape, 2))
        picture = (optics.background + optics.contrast * mottled) * light
    else:
        picture = (optics.background - optics.contrast * density) * light
    picture = picture + optics.texture * texture
    if optics.device == "live-scan":
        # Levels are stretched, edges sharpened, and the background clipped to white.
        picture = picture + 0.8 * (picture - cv2.GaussianBlur(picture, (0, 0), 1.5))
        local = smooth_noise(rng, density.shape, 1.2) * cv2.GaussianBlur(density, (0, 0), 8) * 0.1
        picture = 1.06 * picture / optics.background + local * 0.6
    return picture


def photograph(contact: Contact, optics: Optics, pixels: int, rng: Rng) -> Pixels:
    """Return the 8-bit picture; each pixel is `pixels` × `pixels` points of the fine grid."""
    density = _density(contact, optics, rng)
    density = cv2.GaussianBlur(density, (0, 0), max(optics.blur * pixels, 0.3))
    rows, columns = (n // pixels for n in density.shape)
    picture = _lit(cv2.resize(density, (columns, rows), interpolation=cv2.INTER_AREA), optics, rng)
    picture = np.ascontiguousarray(picture)
    _add_dirt(picture, optics.dirt, rng)
    shot = np.sqrt(np.clip(picture, 0.05, 1)) * optics.noise
    picture = picture + shot * rng.normal(size=picture.shape)
    return eight_bit(picture, optics.jpeg)
