"""What was measured of a pad: each quantity with its standard uncertainty."""

from typing import Any

import numpy as np

LENGTHS = {"palmar": (7.9, 0.1), "distal": (13.8, 0.12), "radial_ulnar": (11.8, 0.08)}
PLACED = {**LENGTHS, "wedge_angle": (np.radians(30), np.radians(0.5)), "roll_angle": (0.05, np.radians(1))}
ELLIPSE = {"load": (2.0, 0.02), "semi_major": (7.4, 0.1), "semi_minor": (5.0, 0.1)}
PAD: dict[str, Any] = {
    **PLACED,
    "poisson_ratio": (0.5, 0.01),
    "image_scale": (1.0, 0.01),
    "edge_offset": (0.0, 0.06),
    **ELLIPSE,
    "radius_deviation": (0.0, 0.015),
    "elongation_deviation": (0.0, 0.03),
}
EXACT = {name: float(pair[0]) for name, pair in PAD.items()}
