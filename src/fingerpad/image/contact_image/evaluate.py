"""The numbers of a contact, their uncertainty and the doubts about them, from its region, edge and ridges."""

import math
from collections.abc import Set
from typing import Final

import cv2
import numpy as np

from fingerpad._arrays import BoolArray, FloatArray
from fingerpad.flags import FLAGS
from fingerpad.geometry.ellipse import Ellipse
from fingerpad.image._masks import UInt8, filled_polygon
from fingerpad.image.contact_image.calibration import RIDGE_AREA
from fingerpad.image.contact_image.edge import (
    Edge,
    axis_weights,
    edge_offset_std,
    outline_noise,
    running_mean,
)
from fingerpad.image.contact_image.region import Region
from fingerpad.image.contact_image.result import ContactImageResult
from fingerpad.image.contact_image.ridges import RidgeMap, Ridges, ridge_map
from fingerpad.image.contact_image.spectra import shows_ridges
from fingerpad.image.contact_image.view import View
from fingerpad.image.ellipse import AreaMoments, polygon_moments
from fingerpad.image.scale import PLAUSIBLE_RIDGE_PERIOD_MM

# Contrast over noise below which the contact hardly stands out from noise.
LOW_CONTRAST: Final = 5.0
_POOR_OVERLAP: Final = 0.85
# Share of the contact beyond which its ridges may have been joined by sweat or ink.
_MANY_RIDGES: Final = 0.59
# Over windows of so many periods resolved ridges spread by more than so many levels of 255; where their mean
# is below this, nothing touches.
_WINDOW: Final = 3.0
_MIN_SPREAD: Final = 76.0
_NOTHING: Final = 64.0
# Dimension of (semi_major, semi_minor, gross_area, ridge_area) in lengths.
_POWERS: Final = np.array([1, 1, 2, 2])


def evaluate(view: View, ridges: Ridges, region: Region, edge: Edge, *, edited: bool) -> ContactImageResult:
    """Measure a contact inside its edge."""
    scale = view.scale
    outline = view.to_picture(edge.points)
    moments = polygon_moments(outline)
    fine = ridge_map(view, edge.points, ridges.threshold)
    smeared = np.ones_like(region.patch)
    if edge.resolved:
        smeared = _blurred_ridges(ridges.amount, region.patch, view.period)
    # Where ridges are not resolved any part may be ridge: half of it, uniform from none to all.
    ridge_area, unknown = fine.area(smeared, view)
    noise, edge_effect = _outline_uncertainty(view, edge, moments, outline, ridge_area)
    known = ridge_area - unknown / 2
    noise[3, 3] += unknown**2 / 12 + _ridge_area_std(edge, fine, known, moments.area) ** 2
    period = view.ridge_period * scale.mm_per_px
    merged = ridge_area > _MANY_RIDGES * moments.area
    doubts = {
        "low_contrast": view.contrast < LOW_CONTRAST * view.noise,
        "scale_doubtful": not PLAUSIBLE_RIDGE_PERIOD_MM[0] <= period <= PLAUSIBLE_RIDGE_PERIOD_MM[1],
        "not_a_contact_image": not shows_ridges(view.contact, edge.points, scale.mm_per_px, view.step),
        "ridges_merge": merged,
        # Dark places tell of print only between ridges that are seen apart.
        "printed_marks": fine.has_print and view.resolved and not merged,
        "edited_manually": edited,
    }
    return contact_result(
        view,
        region,
        edge,
        moments,
        noise=noise,
        edge_effect=edge_effect,
        threshold=ridges.median_level(region.patch),
        doubts={flag for flag, seen in doubts.items() if seen},
        ridge_area=ridge_area,
        ridge_border=fine.border() * scale.mm_per_px if view.resolved else math.nan,
        ridges=fine,
    )


def contact_result(
    view: View,
    region: Region,
    edge: Edge,
    moments: AreaMoments,
    *,
    noise: FloatArray,
    edge_effect: FloatArray,
    threshold: float,
    doubts: Set[str],
    ridge_area: float = math.nan,
    ridge_border: float = math.nan,
    ridges: RidgeMap | None = None,
) -> ContactImageResult:
    """Return what was measured in px of the picture, or mm of the ridges' borders, as a result in mm.

    Here are the doubts that contacts with ridges and without share.
    """
    mm_per_px = view.scale.mm_per_px
    units = mm_per_px**_POWERS
    values = np.array([*moments.semi_axes, moments.area, ridge_area]) * units
    semi_major, semi_minor, gross_area, ridge_area = values.tolist()
    column, row = moments.centroid
    overlap = _overlap(edge.points, view.to_copy(moments.ellipse.points(120)[:, ::-1]))
    shared = {
        # Beyond the edge seen, fading is a guess.
        "touches_border": view.touches_border(edge.moved(-edge.fade), edge.steps),
        "cut_by_mask": view.cut_by_mask(edge.points, edge.steps),
        "several_regions": region.several,
        "poor_ellipse": overlap < _POOR_OVERLAP,
    }
    return ContactImageResult(
        ellipse=Ellipse(semi_major, semi_minor),
        orientation=moments.orientation,
        centroid=(float(row), float(column)),
        outline=view.to_picture(edge.points)[:, ::-1],
        gross_area=gross_area,
        ridge_area=ridge_area,
        ridge_border=ridge_border,
        ridge_period=view.ridge_period * mm_per_px,
        overlap=overlap,
        noise_covariance=noise * np.outer(units, units),
        edge_effect=edge_effect * units,
        mm_per_px=mm_per_px,
        scale_effect=_POWERS * view.scale.relative_std * values,
        threshold=threshold,
        contrast=view.contrast,
        dark_on_light=view.dark_on_light,
        flags=tuple(flag for flag in FLAGS["contact"] if flag in doubts or shared.get(flag, False)),
        surface="smooth" if ridges is None else "ridged",
        _shape=view.shape,
        _ridges=ridges,
    )


def _outline_uncertainty(
    view: View, edge: Edge, moments: AreaMoments, outline: FloatArray, ridge_area: float
) -> tuple[FloatArray, FloatArray]:
    """Return the covariance by errors of this image's outline, and the change by a shared one of the edge.

    Of (semi_major, semi_minor, gross_area, ridge_area), px of the picture.
    """
    weights = axis_weights(moments, outline) * view.step**2
    # A wider outline takes in more ridges, thinner than those of the interior.
    response = np.vstack([np.eye(3), [0, 0, RIDGE_AREA.at_rim * ridge_area / moments.area]])
    noise = response @ outline_noise(edge, weights) @ response.T
    # An outline that is no ellipse has other semi-axes by other definitions.
    extents = np.ptp(running_mean(outline, round(edge.period * view.step)) @ moments.axes.T, axis=0)
    other = extents / 2 - moments.semi_axes
    noise[:2, :2] += np.outer(other, other) / 3
    offset = edge_offset_std(edge) * view.step
    return noise, response @ [offset, offset, offset * edge.steps.sum() * view.step]


def _ridge_area_std(edge: Edge, ridges: RidgeMap, known: float, gross_area: float) -> float:
    """Return the standard uncertainty of the area of resolved ridges inside a given outline."""
    level_std = math.hypot(
        RIDGE_AREA.level_std,
        RIDGE_AREA.level_by_grain * ridges.grain,
        RIDGE_AREA.level_by_clipping * ridges.clipped,
    )
    fade = edge.fade / edge.period - RIDGE_AREA.sharp_fade
    return known * math.hypot(
        RIDGE_AREA.least_std,
        ridges.softness * level_std,
        RIDGE_AREA.by_noise * edge.noise,
        RIDGE_AREA.by_rim * edge.rim,
        RIDGE_AREA.by_fade * min(max(0.0, fade), RIDGE_AREA.most_fade),
        RIDGE_AREA.by_moisture * max(0.0, known / gross_area - RIDGE_AREA.dry_share),
    )


def _blurred_ridges(amount: UInt8, patch: BoolArray, period: float) -> BoolArray:
    """Return where in a patch ridges are blurred into one another, as a quarter of its pixels shows."""
    part = np.ascontiguousarray(amount[::2, ::2])
    side = 2 * round(_WINDOW * period / 4) + 1
    mean, square = (box(part, cv2.CV_32F, (side, side)) for box in (cv2.boxFilter, cv2.sqrBoxFilter))
    smooth = ((square - mean * mean < _MIN_SPREAD**2) & (mean > _NOTHING)).astype(np.uint8)
    return patch & (cv2.resize(smooth, patch.shape[::-1], interpolation=cv2.INTER_NEAREST) > 0)


def _overlap(outline: FloatArray, ellipse: FloatArray) -> float:
    """Return the intersection over union of two outlines (x, y)."""
    corner = np.minimum(outline.min(axis=0), ellipse.min(axis=0)) - 1
    columns, rows = np.ceil(np.maximum(outline.max(axis=0), ellipse.max(axis=0)) - corner).astype(int) + 2
    both, other = (filled_polygon(points - corner, (rows, columns)) for points in (outline, ellipse))
    return float(np.count_nonzero(both & other) / np.count_nonzero(both | other))
