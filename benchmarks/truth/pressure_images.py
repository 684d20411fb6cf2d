"""Contact images made from a pressure field.

Written from the physics, without a look at the measurement. Nothing is shared with it: neither how ridges
are made, nor what the edge is. The gross contact is where the pad's pressure is positive, by formula; the
ridge contact is counted on a grid at least four times finer than the image, before any optics. Matters of
definition: near the edge ridges may not touch although pressure is positive (see the hull of the touching
ridges); sweat and ink beside a ridge count as optics.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from benchmarks.truth.contact_optics import Optics, photograph
from benchmarks.truth.pressed_pad import Press, Skin, boundary_of, press_pad
from benchmarks.truth.ridge_growth import SINGULARITIES
from benchmarks.truth.true_image import TrueImage

_FINEST, _MARGIN_MM = 0.011, 2.4
_LIVE = {
    "device": "live-scan",
    "background": 0.93,
    "contrast": 0.68,
    "fade": 0.4,
    "mottle": 0.4,
    "light": 0.02,
}
_LIVE |= {"vignetting": 0.0, "texture": 0.004, "jpeg": 80}
_INK = {"device": "ink", "background": 0.84, "contrast": 0.7, "blur": 0.55, "texture": 0.015, "fade": 0.45}
_SIDE = {"device": "side-lit", "background": 0.1, "contrast": 0.6, "noise": 0.025, "light": 0.3}
_SIDE |= {"vignetting": 0.3, "halo": 0.12, "dirt": 4}
_ABOVE = {"device": "front-lit", "background": 0.8, "contrast": 0.5, "light": 0.2, "blur": 0.8, "fade": 0.15}


@dataclass(frozen=True)
class Condition:
    """What is particular to a condition; lengths in mm, areas in mm²."""

    press: dict[str, Any] = field(default_factory=dict)
    skin: dict[str, Any] = field(default_factory=dict)
    optics: dict[str, Any] = field(default_factory=dict)
    areas: tuple[float, float] = (80, 170)
    mm_per_px: tuple[float, float] = (0.035, 0.0508)


CONDITIONS = {
    "prism, Hertz pressure": Condition(),
    "prism, flat pressure": Condition(press={"exponent": 0.2}),
    "prism, pressure falls slowly": Condition(press={"exponent": 1.0}),
    "prism, bell-shaped pressure": Condition(press={"exponent": 1.6}),
    "prism, moist": Condition(
        skin={"widest": 0.85, "jump_width": 0.25, "pores": 0.1},
        optics={"meniscus": 0.04, "islands": 0.1, "fade": 0.1},
    ),
    "prism, dry": Condition(
        skin={"roughness": 0.2, "roughness_mm": 0.1, "jump_width": 0.02, "widest": 0.6, "threshold": 1.0},
        optics={"fade": 0.6, "contrast": 0.6},
    ),
    "prism, dark halo": Condition(optics={"halo": 0.25, "halo_mm": 1.2}),
    "prism, light halo, earlier print": Condition(
        optics={"background": 0.65, "contrast": 0.5, "halo": -0.2, "halo_mm": 0.7, "latent": 0.18}
    ),
    "live-scan": Condition(optics=_LIVE, mm_per_px=(0.0508, 0.0508)),
    "live-scan, creases, pores, dirt": Condition(
        skin={"creases": 5, "pores": 0.9}, optics={**_LIVE, "dirt": 14}, mm_per_px=(0.0508, 0.0508)
    ),
    "ink": Condition(optics=_INK, mm_per_px=(0.035, 0.0508)),
    "ink, smeared rim": Condition(optics={**_INK, "meniscus": 0.35, "dirt": 6}, mm_per_px=(0.035, 0.0508)),
    "plate lit from the side": Condition(optics=_SIDE),
    "plate lit from above": Condition(optics=_ABOVE),
    "light touch": Condition(areas=(30, 45), mm_per_px=(0.02, 0.03)),
    "light touch, ridges along the edge": Condition(areas=(30, 45), skin={"kind": "whorl"}),
    "high load, coarse pixels": Condition(areas=(200, 250), mm_per_px=(0.05, 0.06), optics={"blur": 0.8}),
    "superellipse, egg": Condition(press={"power": 2.5, "egg": 0.08}),
}


def pressure_image(name: str, number: int, area: float | None = None, **skin: Any) -> TrueImage:
    """Make an image of a condition; `area` in mm² and `skin` override what it draws at random."""
    condition = CONDITIONS[name]
    rng = np.random.default_rng([sum(name.encode()), number])
    drawn = rng.uniform(*condition.areas)
    area = drawn if area is None else area
    kinds = sorted(SINGULARITIES)
    press = Press(
        **{"area": area, "aspect": rng.uniform(1.1, 1.55), "tilt": rng.normal(0, 0.35), **condition.press}
    )
    chosen = {
        "kind": kinds[number % len(kinds)],
        "seed": number % 2,
        "period": rng.uniform(0.45 if area > 180 else 0.40, 0.55),
        "plastic": bool(rng.random() < 0.4),
        "widest": rng.uniform(0.55, 0.75),
        "half_pressure": rng.uniform(2, 6),
        "jump_width": rng.uniform(0.05, 0.25),
        "threshold": rng.uniform(0.1, 0.6),
        "creases": int(rng.integers(0, 3)),
    }
    ridges = Skin(**{**chosen, **condition.skin, **skin})
    optics = Optics(**{"blur": rng.uniform(0.4, 0.9), "light": rng.uniform(0.05, 0.2), **condition.optics})
    mm_per_px = rng.uniform(*condition.mm_per_px)
    pixels = max(4, int(np.ceil(mm_per_px / _FINEST)))
    extent = 2 * np.abs(boundary_of(press)).max(axis=0) + 2 * _MARGIN_MM
    columns, rows = np.ceil(extent / mm_per_px).astype(int) * pixels
    contact = press_pad(press, ridges, mm=mm_per_px / pixels, shape=(rows, columns), rng=rng)
    picture = photograph(contact, optics, pixels, rng)
    return TrueImage(picture, mm_per_px, press.area, contact.ridge_area, contact.semi_axes)
