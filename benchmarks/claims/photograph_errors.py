"""Where errors of photographed faces come from.

Semi-axes from arcs of 120 to 150 degrees: what the skin's roughness leaves, what the picture adds, and what
the outline beyond the arc and the finger's tilt tell. Radii of curvature of side faces where wedges touch, by
shape, and in other windows. Two minutes on one idle core for 120 fingers.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any
from unittest.mock import patch

import cv2
import numpy as np
import numpy.typing as npt

from benchmarks.claims import finger_shapes, fingertips
from benchmarks.claims.photographs import random_finger
from fingerpad.exceptions import FingerpadError
from fingerpad.image import Scale, measure_photograph
from fingerpad.image.photograph import outline
from fingerpad.image.photograph.arc_fit import ArcFit, extend_arc, fit_arc_ellipse, outline_places
from fingerpad.image.photograph.calibration import RADIUS
from fingerpad.simulate import SyntheticFinger, finger
from fingerpad.simulate._finger_shape import FingerShape, finger_shape, pad_arc

Array = npt.NDArray[np.float64]

_ROUGHNESS_MM, _DRAWS = 0.015, 200
_NO_TILT = math.radians(20)


def _on_arc(points: Array, semi_axes: tuple[float, float], arc: tuple[float, float], step: int) -> Array:
    """Return the points on an arc, every so many."""
    middle = (arc[0] + arc[1]) / 2
    turn = np.arctan2(points[:, 1] / semi_axes[1], points[:, 0] / semi_axes[0]) - middle
    turn = (turn + math.pi) % (2 * math.pi) - math.pi
    inside = np.flatnonzero(np.abs(turn) < (arc[1] - arc[0]) / 2)
    return np.asarray(points[inside[np.argsort(turn[inside])]][::step])


def _fits(truth: SyntheticFinger, shape: Array) -> Iterator[tuple[str, ArcFit]]:
    """Yield fits of a finger's true arc, and of its arc in the picture with more and more known."""
    found = measure_photograph(
        truth.pixels,
        truth.face,
        Scale(truth.mm_per_px),
        palmar=None if truth.face == "palmar" else truth.palmar,
        points=truth.arc_points(9),
    )
    arc = found._arc
    true = _on_arc(shape, truth.semi_axes, truth.arc, max(1, round(truth.mm_per_px / 0.02)))
    yield "the true outline, without a picture", fit_arc_ellipse(true / truth.mm_per_px, (0.0, arc.tilt[1]))
    used = np.flatnonzero(arc.used)
    places = outline_places(arc.points)[0][used]
    points = arc.points[used]
    alone = fit_arc_ellipse(points, arc.tilt, places=places, start=arc.start)
    yield "its arc as located in the picture", alone
    yield "that, the tilt unknown", fit_arc_ellipse(points, (0.0, _NO_TILT), places=places, start=arc.start)
    exact = (truth.tilt, 1e-4)
    yield "that, the tilt known exactly", fit_arc_ellipse(points, exact, places=places, start=arc.start)
    yield "with the outline beyond its ends", extend_arc(arc.points, used, alone, arc.tilt)


def print_arcs(count: int, seed: int) -> None:
    """Print errors of the semi-axes from arcs of 120 to 150 degrees."""
    rows: dict[str, list[tuple[float, Array, Array]]] = {}
    refused = 0
    for number in range(count):
        shapes: list[FingerShape] = []

        def kept(*given: Any, shapes: list[FingerShape] = shapes, **named: Any) -> FingerShape:
            shapes.append(finger_shape(*given, **named))
            return shapes[0]

        with patch.object(finger, "finger_shape", kept):
            truth = random_finger(1000 * seed + number, 120, 150)
        arc_deg = math.degrees(truth.arc[1] - truth.arc[0])
        try:
            for name, fit in _fits(truth, shapes[0].points):
                size = fit.ellipse.semi_axes * truth.mm_per_px
                std = np.sqrt(np.diagonal(fit.covariance)[2:4]) / fit.ellipse.semi_axes
                rows.setdefault(name, []).append((arc_deg, size / np.array(truth.semi_axes) - 1, std))
        except FingerpadError:
            refused += 1
    print(f"\nSemi-axes from arcs of 120 to 150 degrees, ends marked: {count} fingers, {refused} refused")
    print(f"    {'fitted':<38} {'n':>4}  median  within 95 %  at 120-130   within 1 %  covered")
    for name, some in rows.items():
        off = np.array([row[1] for row in some])
        short = np.abs([row[1] for row in some if row[0] < 130])
        held = np.mean(np.abs(off) < 1.96 * np.array([row[2] for row in some]))
        off, most = np.abs(off), np.quantile(short, 0.95) if short.size else math.nan
        print(
            f"    {name:<38} {len(some):4}  {np.median(off):6.2%}  {np.quantile(off, 0.95):11.2%}"
            f"  {most:10.2%}  {np.mean(off < 0.01):11.1%}  {held:7.1%}"
        )


def print_roughness() -> None:
    """Print what the skin's roughness alone leaves unknown of the axis along a fingertip seen end on."""
    print(f"\nAxis along a fingertip seen end on, roughness of {_ROUGHNESS_MM} mm alone, {_DRAWS} draws")
    for arc_deg in (120, 135, 150):
        extent, lengths = math.radians(arc_deg), []
        for number in range(_DRAWS):
            rng = np.random.default_rng([arc_deg, number])
            shape = finger_shape(
                "distal", (11.8, 7.9), extent=extent, departure=0.0, texture=_ROUGHNESS_MM, rng=rng
            )
            points = _on_arc(shape.points, (11.8, 7.9), pad_arc("distal", extent), 3)
            lengths.append(fit_arc_ellipse(points, (0.0, math.radians(5))).ellipse.semi_y / 7.9 - 1)
        print(f"    {arc_deg} degrees: standard deviation {np.std(lengths):.2%}")


def print_radii(seed: int) -> None:
    """Print errors of the radius at the place of contact by shape, and in other windows."""
    first = list(finger_shapes.measured(3, seed, ("radial",)))
    second = list(fingertips.measured(5, seed, ("radial",)))
    for some in (first, second):
        finger_shapes.print_radii(some)
    print("\nRoot mean square error, and share of the places seen, in other windows")
    for window, degree in ((0.3, 3), (0.35, 3), (0.4, 3), (0.5, 3), (0.35, 2)):
        with patch.object(outline, "RADIUS", replace(RADIUS, window=window, degree=degree)):
            for name, some in (("first family", first), ("second", second)):
                off = np.array(
                    [
                        found.outline_radius(angle)[0] / truth.radius(angle) - 1
                        for _, truth, found in some
                        if found is not None
                        for angle in np.radians((15, 30, 45, 60))
                    ]
                )
                rms, seen = np.sqrt(np.nanmean(off**2)), np.isfinite(off).mean()
                print(f"    {window:4} radii, degree {degree}, {name:<12} {rms:6.1%}  {seen:6.1%}")


def report(fingers: int = 120, seed: int = 85) -> None:
    """Print errors of arcs, roughness of outlines, and errors of radii."""
    cv2.setNumThreads(1)
    print_arcs(fingers, seed)
    print_roughness()
    print_radii(seed)
