"""One patch of contact, measured in px of the picture."""

import math
from dataclasses import dataclass, replace

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, FloatArray
from fingerpad.image._masks import UInt8, filled_polygon
from fingerpad.image.contact_image._outline import (
    ContactEdge,
    axis_weights,
    contact_outline,
    edge_offset_std,
    edge_shift,
    faded_outline,
    outline_noise,
    running_mean,
)
from fingerpad.image.contact_image._ridge_map import RidgeMap
from fingerpad.image.contact_image._working_image import WorkingImage
from fingerpad.image.ellipse import AreaMoments, polygon_moments

# Levels this near to half-way.
_RAMP = 64
_NEAR_HALF = slice(128 - _RAMP // 2, 128 + _RAMP // 2)
# Standard deviation of the ridges' level in parts of the rise, and by grain and by the share of the valleys
# that is clipped; relative standard deviation of the ridges' area that is left where the level does not
# matter, and by noise in parts of the contrast; and how much of the rim is ridge, relative to the interior.
_LEVEL_STD, _GRAINY, _CLIPPED = 0.025, 0.5, 0.13
_LEAST_STD, _NOISY, _AT_RIM = 0.008, 0.1, 0.5
# The same where a rim covers ridges; where a contact fades, so that its edge lies `_SHARP` periods further
# out, or up to `_SOFT` more; and by the share of ridges above `_DRY`, where sweat or ink may fill valleys.
_RIM_STD, _FADING, _SHARP, _SOFT, _MOIST, _DRY = 0.3, 0.2, 0.08, 0.2, 1.2, 0.54
# Over windows of so many periods resolved ridges spread by more than so many levels; where their mean is
# below this, nothing touches.
_WINDOW, _MIN_SPREAD, _NOTHING = 3.0, 76.0, 64.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Patch:
    """A patch in px of the picture.

    `noise_covariance` and `edge_effect`, the change by one standard uncertainty of the edge's place, are of
    (semi_major, semi_minor, gross_area, ridge_area).
    """

    moments: AreaMoments
    outline: npt.NDArray[np.float64]
    ridge_area: float
    ridge_border: float
    noise_covariance: FloatArray
    edge_effect: FloatArray
    overlap: float
    touches_border: bool
    cut_by_mask: bool


def trace_patch(
    view: WorkingImage,
    patch: BoolArray,
    closed: UInt8,
    amount: UInt8,
    contact: npt.NDArray[np.float32],
    *,
    noise: float,
    resolved: bool,
    by_threshold: bool,
) -> ContactEdge:
    """Trace a patch of the view, given the amount of ridge as found and as closed over the valleys.

    `contact` is the contrast of each place with the ground, `resolved` whether the ridge period was found,
    `by_threshold` whether the ridges' level is given.
    """
    edge = contact_outline(
        patch,
        closed,
        amount,
        view.period,
        noise=noise,
        softness=_softness(amount, patch),
        resolved=resolved,
    )
    # A given level says what counts as contact; without ridges nothing tells fading from blur.
    if resolved and not by_threshold:
        edge = faded_outline(edge, patch, contact)
    rows, columns = patch.shape
    outline = edge.moved(edge_shift(edge)).clip(-0.5, [columns - 0.5, rows - 0.5])
    return replace(edge, points=outline)


def measure_patch(
    view: WorkingImage, patch: BoolArray, edge: ContactEdge, amount: UInt8, ridges: RidgeMap
) -> Patch:
    """Measure a patch of the view inside its traced edge."""
    side = math.sqrt(view.steps[0] * view.steps[1])
    points = view.to_picture(edge.points)
    moments = polygon_moments(points)
    weights = axis_weights(moments, points) * side**2
    smeared = _blurred_ridges(amount, patch, view.period) if edge.resolved else np.ones_like(patch)
    # Where ridges are not resolved any part may be ridge: half of it, uniform from none to all.
    ridge_area, unknown = ridges.area_within(points, ridges.sampled(smeared, view))
    known = ridge_area - unknown / 2
    # A wider outline takes in more ridges, thinner than those of the interior.
    response = np.vstack([np.eye(3), [0, 0, _AT_RIM * ridge_area / moments.area]])
    noise = response @ outline_noise(edge, weights) @ response.T
    # An outline that is no ellipse has other semi-axes by other definitions.
    other = _half_extents(points, moments, edge.period * side) - moments.semi_axes
    noise[:2, :2] += np.outer(other, other) / 3
    level_std = math.hypot(_LEVEL_STD, _GRAINY * ridges.grain, _CLIPPED * ridges.clipped)
    known_std = known * math.hypot(
        _LEAST_STD,
        ridges.softness * level_std,
        _NOISY * edge.noise,
        _RIM_STD * edge.rim,
        _FADING * min(max(0.0, edge.fade / edge.period - _SHARP), _SOFT),
        _MOIST * max(0.0, known / moments.area - _DRY),
    )
    noise[3, 3] += unknown**2 / 12 + known_std**2
    offset = edge_offset_std(edge) * side
    return Patch(
        moments=moments,
        outline=points,
        ridge_area=ridge_area,
        ridge_border=ridges.border_within(points),
        noise_covariance=noise,
        edge_effect=response @ [offset, offset, offset * edge.steps.sum() * side],
        overlap=_overlap(edge.points, polygon_moments(edge.points)),
        # Beyond the edge seen, fading is a guess.
        touches_border=view.touches_border(edge.moved(-edge.fade), edge.steps),
        cut_by_mask=view.cut_by_mask(edge.points, edge.steps),
    )


def _half_extents(points: npt.NDArray[np.float64], moments: AreaMoments, period: float) -> FloatArray:
    """Return half of an outline's extents along its axes, seen at the scale of a ridge period."""
    place = running_mean(points, round(period)) @ moments.axes.T
    return np.asarray(np.ptp(place, axis=0) / 2)


def _softness(amount: UInt8, patch: BoolArray) -> float:
    """Return by what share the ridges' area would change if their level moved by the whole rise."""
    counts = cv2.calcHist([amount], [0], patch.astype(np.uint8), [256], [0, 256]).ravel().astype(np.float64)
    return float(counts[_NEAR_HALF].sum()) * 255 / _RAMP / max(float(counts[128:].sum()), 1.0)


def _blurred_ridges(amount: UInt8, patch: BoolArray, period: float) -> BoolArray:
    """Return where in a patch ridges are blurred into one another, as a quarter of its pixels shows."""
    part = np.ascontiguousarray(amount[::2, ::2])
    side = 2 * round(_WINDOW * period / 4) + 1
    mean, square = (box(part, cv2.CV_32F, (side, side)) for box in (cv2.boxFilter, cv2.sqrBoxFilter))
    smooth = ((square - mean * mean < _MIN_SPREAD**2) & (mean > _NOTHING)).astype(np.uint8)
    return patch & (cv2.resize(smooth, patch.shape[::-1], interpolation=cv2.INTER_NEAREST) > 0)


def _overlap(outline: npt.NDArray[np.float64], moments: AreaMoments) -> float:
    """Return the intersection over union of an outline and its ellipse."""
    t = np.linspace(0, 2 * math.pi, 120, endpoint=False)
    along, across = moments.semi_axes[:, None, None] * moments.axes[:, None, :]
    ellipse = moments.centroid + along * np.cos(t)[:, None] + across * np.sin(t)[:, None]
    corner = np.minimum(outline.min(axis=0), ellipse.min(axis=0)) - 1
    columns, rows = np.ceil(np.maximum(outline.max(axis=0), ellipse.max(axis=0)) - corner).astype(int) + 2
    both, other = (filled_polygon(points - corner, (rows, columns)) for points in (outline, ellipse))
    return float(np.count_nonzero(both & other) / np.count_nonzero(both | other))
