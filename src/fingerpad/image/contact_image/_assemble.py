"""The measurement of a region of an image: its numbers, their covariance and its flags."""

import math
from dataclasses import dataclass

import cv2
import numpy as np

from fingerpad._arrays import BoolArray, Float32Array
from fingerpad.geometry.ellipse import Ellipse
from fingerpad.image._masks import UInt8
from fingerpad.image.contact_image._outline import ContactEdge
from fingerpad.image.contact_image._patch import measure_patch
from fingerpad.image.contact_image._ridge_map import ridge_map
from fingerpad.image.contact_image._ridges import Signal
from fingerpad.image.contact_image._texture import shows_ridges
from fingerpad.image.contact_image._working_image import WorkingImage
from fingerpad.image.contact_image.result import FLAGS, PLAUSIBLE_RIDGE_PERIOD_MM, ContactImageResult
from fingerpad.image.scale import Scale

# Contrast over noise below which the contact hardly stands out from noise.
LOW_CONTRAST = 5.0

_POOR_OVERLAP = 0.85
# Share of the contact beyond which its ridges may have been joined by sweat or ink.
_MANY_RIDGES = 0.59


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RidgeImage:
    """An image with its ridges found, before the contact is chosen; `period` in px of the picture or NaN."""

    view: WorkingImage
    signal: Signal
    amount: UInt8
    level: Float32Array
    period: float
    threshold: float | None

    @property
    def noise(self) -> float:
        """Noise in parts of the contrast."""
        return self.signal.noise / max(self.signal.contrast, 1e-9)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ContactRegion:
    """The contact, in px of the working copy."""

    patch: BoolArray
    edge: ContactEdge
    several: bool


def assemble_result(
    ridged: RidgeImage, region: ContactRegion, scale: Scale, *, edited: bool
) -> ContactImageResult:
    """Measure a region of a picture."""
    signal, patch = ridged.signal, region.patch
    ridges = ridge_map(ridged.view, signal, region.edge.points, ridged.threshold)
    contact = measure_patch(ridged.view, patch, region.edge, ridged.amount, ridges)
    period = ridged.period * scale.mm_per_px
    merged = contact.ridge_area > _MANY_RIDGES * contact.moments.area
    doubts = {
        "touches_border": contact.touches_border,
        "cut_by_mask": contact.cut_by_mask,
        "low_contrast": signal.contrast < LOW_CONTRAST * signal.noise,
        "several_regions": region.several,
        "poor_ellipse": contact.overlap < _POOR_OVERLAP,
        "scale_doubtful": not PLAUSIBLE_RIDGE_PERIOD_MM[0] <= period <= PLAUSIBLE_RIDGE_PERIOD_MM[1],
        "not_a_contact_image": not shows_ridges(ridged.view, contact.outline, scale.mm_per_px),
        "ridges_merge": merged,
        # Dark places tell of print only between ridges that are seen apart.
        "printed_marks": ridges.has_print and math.isfinite(period) and not merged,
        "edited_manually": edited,
    }
    powers = np.array([1, 1, 2, 2])
    units = scale.mm_per_px**powers
    values = np.array([*contact.moments.semi_axes, contact.moments.area, contact.ridge_area]) * units
    semi_major, semi_minor, gross_area, ridge_area = values.tolist()
    column, row = contact.moments.centroid
    return ContactImageResult(
        ellipse=Ellipse(semi_major, semi_minor),
        orientation=contact.moments.orientation,
        centroid=(float(row), float(column)),
        outline=contact.outline[:, ::-1],
        gross_area=gross_area,
        ridge_area=ridge_area,
        ridge_border=contact.ridge_border * scale.mm_per_px if math.isfinite(period) else math.nan,
        ridge_period=period,
        overlap=contact.overlap,
        noise_covariance=contact.noise_covariance * np.outer(units, units),
        edge_effect=contact.edge_effect * units,
        mm_per_px=scale.mm_per_px,
        scale_effect=powers * scale.relative_std * values,
        threshold=_median_level(ridged.level, patch),
        contrast=signal.contrast,
        dark_on_light=signal.dark_on_light,
        flags=tuple(flag for flag in FLAGS if doubts[flag]),
        _view=ridged.view,
        _ridges=ridges,
    )


def _median_level(level: Float32Array, patch: BoolArray) -> float:
    """Return the median level in a patch; it varies slowly, and some hundred places show it."""
    rows, columns = (np.linspace(0, n - 1, min(n, 60)).astype(int) for n in level.shape)
    size = (columns.size, rows.size)
    inside = cv2.resize(patch.astype(np.uint8), size, interpolation=cv2.INTER_NEAREST) > 0
    some = level[np.ix_(rows, columns)]
    return float(np.median(some[inside] if inside.any() else some))
