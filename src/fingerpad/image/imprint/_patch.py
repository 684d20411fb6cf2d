"""One patch of contact, measured in px of the picture."""

import math
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, FloatArray
from fingerpad.image.imprint._edge import (
    Moments,
    axis_weights,
    edge_covariance,
    edge_of,
    edge_shift,
    moments_of,
)
from fingerpad.image.imprint._region import UInt8
from fingerpad.image.imprint._view import View

# Levels, of 255, between which the ridges' right threshold lies: 0.45 to 0.55 of the local rise, fitted so
# that intervals of the ridge area cover the truth (`accuracy_and_coverage` in benchmarks/imprints.py).
_DOUBTED = slice(115, 141)
# Half-way through a ramp of this many levels on each side, a pixel counts as half a ridge.
_RAMP = 64
_LEVELS = np.arange(256)
_RIDGE_SHARE = np.clip((_LEVELS - 127.5) / (2 * _RAMP) + 0.5, 0, 1)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Patch:
    """A patch in px of the picture: `covariance` is of (semi_major, semi_minor, gross_area, ridge_area)."""

    moments: Moments
    outline: npt.NDArray[np.float64]
    ridge_area: float
    covariance: FloatArray
    overlap: float
    touches_border: bool
    cut_by_mask: bool


def measured(view: View, patch: BoolArray, closed: UInt8, amount: UInt8, noise: float) -> Patch:
    """Measure a patch of the view, given the amount of ridge as found and as closed over the valleys."""
    pixel = view.steps[0] * view.steps[1]
    counts = cv2.calcHist([amount], [0], patch.astype(np.uint8), [256], [0, 256]).ravel().astype(np.float64)
    edge = edge_of(patch, closed, amount, view.period, noise)
    outline = edge.moved(edge_shift(edge))
    rows, columns = patch.shape
    outline = outline.clip(-0.5, [columns - 0.5, rows - 0.5])
    points = view.to_picture(outline)
    moments = moments_of(points)
    covariance = np.zeros((4, 4))
    weights = axis_weights(moments, points) * pixel
    covariance[:3, :3] = edge_covariance(edge, weights)
    # The right threshold is somewhere within the doubted levels.
    covariance[3, 3] = (counts[_DOUBTED].sum() * pixel) ** 2 / 12
    return Patch(
        moments=moments,
        outline=points,
        ridge_area=float(counts @ _RIDGE_SHARE) * pixel,
        covariance=covariance,
        overlap=_overlap(outline, moments_of(outline)),
        touches_border=view.touches_border(outline, edge.steps),
        cut_by_mask=view.cut_by_mask(outline, edge.steps),
    )


def _overlap(outline: npt.NDArray[np.float64], moments: Moments) -> float:
    """Return the intersection over union of an outline and its ellipse."""
    t = np.linspace(0, 2 * math.pi, 120, endpoint=False)
    along, across = moments.semi_axes[:, None, None] * moments.axes[:, None, :]
    ellipse = moments.centroid + along * np.cos(t)[:, None] + across * np.sin(t)[:, None]
    corner = np.minimum(outline.min(axis=0), ellipse.min(axis=0)) - 1
    columns, rows = np.ceil(np.maximum(outline.max(axis=0), ellipse.max(axis=0)) - corner).astype(int) + 2
    both = np.zeros((rows, columns), dtype=np.uint8)
    other = np.zeros_like(both)
    for canvas, points in ((both, outline), (other, ellipse)):
        cv2.fillPoly(canvas, [np.rint((points - corner) * 16).astype(np.int32)], 1, shift=4)
    return float(np.count_nonzero(both & other) / np.count_nonzero(both | other))
