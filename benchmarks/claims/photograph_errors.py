"""Radius of curvature where a wedge touches, from the outline of a side face: errors and coverage."""

from typing import Final

import cv2
import numpy as np

from benchmarks.claims.fingertips import measured
from benchmarks.tables import off, share, stated, table

WEDGES_DEG: Final = (15, 30, 45, 60)


def report(seed: int = 85, sides: int = 5) -> None:
    """Print errors of the radius in the plane of side faces, by the outline alone and by its ellipse."""
    cv2.setNumThreads(1)
    rows: dict[str, list[tuple[float, float, float]]] = {}
    for name, truth, found in measured(sides, seed, ("radial",)):
        if found is None:
            continue
        for angle in np.radians(WEDGES_DEG):
            true, (radius, std) = truth.radius(angle), found.outline_radius(angle)
            ellipse = found.ellipse_radius(angle)
            rows.setdefault(name, []).append((radius / true - 1, std / radius, ellipse / true - 1))
    rows["all"] = [row for some in rows.values() for row in some]
    cells = []
    for name, some in rows.items():
        errors, stds, of_ellipse = np.array(some).T
        seen = np.isfinite(errors)
        of_outline = off(errors[seen]), stated(errors[seen], stds[seen])
        cells.append((name, len(some), share(seen), *of_outline, off(of_ellipse)))
    head = "shape", "n", "seen", "bias, rms error", "stated, held", "of the ellipse: bias, rms error"
    title = "Radius of curvature where a wedge touches, in the plane of a side face: outline alone"
    table(head, cells, title)
