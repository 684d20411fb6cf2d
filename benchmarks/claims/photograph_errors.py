"""What the skin's roughness leaves unknown of an axis, and the radius of curvature where a wedge touches."""

import math
from collections.abc import Iterable
from typing import Final

import cv2
import numpy as np

from benchmarks.arrays import Array
from benchmarks.claims.fingertips import Finger, measured
from benchmarks.tables import off, percent, share, stated, table
from fingerpad.image.photograph.arc import fit_arc_ellipse
from fingerpad.simulate._finger_shape import finger_shape, pad_arc

_ROUGHNESS_MM, _DRAWS = 0.015, 200
WEDGES_DEG: Final = (15, 30, 45, 60)


def _on_arc(points: Array, semi_axes: tuple[float, float], arc: tuple[float, float], step: int) -> Array:
    """Return the points on an arc, every so many."""
    middle = (arc[0] + arc[1]) / 2
    turn = np.arctan2(points[:, 1] / semi_axes[1], points[:, 0] / semi_axes[0]) - middle
    turn = (turn + math.pi) % (2 * math.pi) - math.pi
    inside = np.flatnonzero(np.abs(turn) < (arc[1] - arc[0]) / 2)
    return points[inside[np.argsort(turn[inside])]][::step]


def print_roughness() -> None:
    """Print what the skin's roughness alone leaves unknown of the axis along a fingertip seen end on."""
    rows = []
    for arc_deg in (120, 135, 150):
        extent, lengths = math.radians(arc_deg), []
        for number in range(_DRAWS):
            rng = np.random.default_rng([arc_deg, number])
            shape = finger_shape(
                "distal", (11.8, 7.9), extent=extent, departure=0.0, texture=_ROUGHNESS_MM, rng=rng
            )
            points = _on_arc(shape.points, (11.8, 7.9), pad_arc("distal", extent), 3)
            lengths.append(fit_arc_ellipse(points, (0.0, math.radians(5))).ellipse.semi_y / 7.9 - 1)
        rows.append((f"{arc_deg}°", percent(float(np.std(lengths)))))
    title = f"Axis along a fingertip seen end on, roughness of {_ROUGHNESS_MM} mm alone, {_DRAWS} draws"
    table(("arc", "standard deviation"), rows, title)


def print_radii(fingers: Iterable[Finger]) -> None:
    """Print errors of the radius of curvature in the plane of a side face, where wedges touch."""
    rows: dict[str, list[tuple[float, float, float]]] = {}
    for name, truth, found in fingers:
        if found is None or truth.face != "radial":
            continue
        for angle in np.radians(WEDGES_DEG):
            true, (radius, std) = truth.radius(angle), found.outline_radius(angle)
            ellipse = found.ellipse_radius(angle)
            rows.setdefault(name, []).append((radius / true - 1, std / radius, ellipse / true - 1))
    rows["all"] = [row for some in rows.values() for row in some]
    table(
        ("shape", "n", "seen", "bias, rms error", "stated, held", "of the ellipse: bias, rms error"),
        (
            (name, len(some), share(seen), off(e[seen]), stated(e[seen], s[seen]), off(by_ellipse))
            for name, some in rows.items()
            for e, s, by_ellipse in [np.array(some).T]
            for seen in [np.isfinite(e)]
        ),
        "Radius of curvature where a wedge touches, in the plane of a side face: outline alone",
    )


def report(seed: int = 85, sides: int = 5) -> None:
    """Print what roughness leaves of an axis, and errors of radii of curvature."""
    cv2.setNumThreads(1)
    print_roughness()
    print_radii(measured(sides, seed, ("radial",)))
