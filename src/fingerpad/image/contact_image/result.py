"""The numbers of a contact, their uncertainty and the doubts about them, from its region, edge and ridges."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, ClassVar, Final

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, FloatArray
from fingerpad._display import Recorded
from fingerpad.flags import FLAGS
from fingerpad.geometry.ellipse import Ellipse
from fingerpad.image._masks import UInt8, centres_inside
from fingerpad.image.contact_image.background import quantile
from fingerpad.image.contact_image.calibration import RIDGE_AREA
from fingerpad.image.contact_image.edge import Edge, axis_weights, flattest, outline_noise, running_mean
from fingerpad.image.contact_image.region import Region
from fingerpad.image.contact_image.ridges import RidgeMap, Ridges, ridge_map
from fingerpad.image.contact_image.spectra import shows_ridges
from fingerpad.image.contact_image.view import ContactImageOptions, Surface, View
from fingerpad.image.ellipse import AreaMoments, ImageEllipse, polygon_moments
from fingerpad.image.scale import PLAUSIBLE_RIDGE_PERIOD_MM

LOW_CONTRAST: Final = 5.0  # over noise; a contact of less hardly stands out from it
_POOR_OVERLAP: Final = 0.85
# Of the outline a piece of 0.6 of the root of the area, about a sixth of it, departs less from a line only
# where something cuts the contact: those of whole ones by 0.0030 or more of that root.
_PIECE, _STRAIGHT = 0.6, 0.0025
_MANY_RIDGES: Final = 0.59  # of the contact; more may have been joined by sweat or ink
_WINDOW: Final = 3.0  # ridge periods; over such windows
_MIN_SPREAD: Final = 76.0  # of 255 levels; resolved ridges spread by more
_NOTHING: Final = 64.0  # of 255 levels; where the mean is below this, nothing touches
# Dimension of (semi_major, semi_minor, gross_area, ridge_area) in lengths.
_POWERS: Final = np.array([1, 1, 2, 2])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ContactImageResult(Recorded):
    """Measurement of one contact in a contact image.

    Attributes
    ----------
    ellipse : Ellipse
        Contact ellipse, mm: the region's area, with the axis ratio of its second moments.
    orientation : float
        Angle of the major axis from straight up (the image's row axis), positive counter-clockwise as
        seen on the screen, radians in (−π/2, π/2]. Zero is an upright finger.
    centroid : (float, float)
        (row, column) of the region's centroid, px; pixel centres are whole numbers.
    outline : ndarray, shape (n, 2)
        (row, column) of points round the contact, px; all areas and axes are those of this polygon.
    gross_area, ridge_area : float
        Area inside the outline, and of the ridges within, mm². Parts in which ridges are blurred into one
        another, or all of a contact without ridges, count as half ridge. Sweat or ink beside a ridge counts
        as ridge: no image tells it from contact.
    ridge_border : float
        Length of the borders of these ridges, mm, NaN where no ridges are resolved. A film of width w beside
        each ridge makes the ridge area larger by w times this.
    ridge_period : float
        Median distance between neighbouring ridges, mm, NaN where no ridges are resolved.
    overlap : float
        Intersection over union of region and ellipse.
    noise_covariance : ndarray, shape (4, 4)
        Of (semi_major, semi_minor, gross_area, ridge_area), mm and mm², to first order, from errors that
        this image shares with no other: of the outline, and of the ridges' threshold; the share of ridges
        in parts that count as half ridge lies anywhere from none to all.
    edge_effect : ndarray, shape (4,)
        Change of the same by one standard uncertainty of the edge's place, which images of one device share:
        a wider edge displaces both semi-axes by as much.
    mm_per_px : float
        Length of a pixel's side in the picture, mm.
    scale_effect : ndarray, shape (4,)
        Change of the same by one standard uncertainty of the scale.
    threshold : float
        Median level that separates ridges from valleys in the patch, grey levels from the background
        towards contact.
    contrast : float
        Level of the contact above the background, grey levels.
    dark_on_light : bool
        Whether the contact is darker than the background.
    flags : tuple of str
        Doubts, by their codes in `fingerpad.flags`.
    surface : str
        ``ridged``, or ``smooth``: then all that concerns ridges is NaN, and the threshold is half of the
        contrast.
    shape : (int, int)
        Rows and columns of the picture that was measured.
    picture : ndarray or None
        Its levels, where they are kept.

    Examples
    --------
    >>> from fingerpad.image import measure_contact_image
    >>> from fingerpad.simulate import render_contact_image
    >>> truth = render_contact_image(semi_major=3.0, semi_minor=2.5, seed=1)
    >>> contact = measure_contact_image(truth.pixels, truth.mm_per_px)
    >>> print(f"{contact.ellipse.semi_major:.2f} ± {contact.semi_major_std:.2f} mm")
    2.96 ± 0.08 mm
    >>> contact.outline.shape[1], contact.flags
    (2, ())
    """

    _title: ClassVar[str] = "Contact image"

    ellipse: Ellipse
    orientation: float
    centroid: tuple[float, float]
    outline: FloatArray
    gross_area: float
    ridge_area: float
    ridge_border: float
    ridge_period: float
    overlap: float
    noise_covariance: FloatArray
    edge_effect: FloatArray
    mm_per_px: float
    scale_effect: FloatArray
    threshold: float
    contrast: float
    dark_on_light: bool
    flags: tuple[str, ...]
    surface: Surface = "ridged"
    shape: tuple[int, int] = field(repr=False)
    picture: npt.NDArray[Any] | None = field(default=None, repr=False)
    _ridges: RidgeMap | None

    @property
    def ellipse_px(self) -> ImageEllipse:
        """The contact ellipse in the picture."""
        lengths = self.ellipse.semi_major, self.ellipse.semi_minor
        major, minor = (float(length) / self.mm_per_px for length in lengths)
        return ImageEllipse(centre=self.centroid, semi_axes=(major, minor), orientation=self.orientation)

    def as_record(self) -> dict[str, Any]:
        """Return the numbers by names that end in units.

        Returns
        -------
        dict
            For tables and scripts.
        """
        major_std, minor_std, gross_std, ridge_std = np.sqrt(np.diagonal(self.covariance)).tolist()
        return {
            "semi_major_mm": float(self.ellipse.semi_major),
            "semi_major_mm_std": major_std,
            "semi_minor_mm": float(self.ellipse.semi_minor),
            "semi_minor_mm_std": minor_std,
            "orientation_deg": math.degrees(self.orientation),
            "gross_area_mm2": self.gross_area,
            "gross_area_mm2_std": gross_std,
            "gross_area_mm2_noise_std": math.sqrt(self.noise_covariance[2, 2]),
            "gross_area_mm2_edge_std": float(self.edge_effect[2]),
            "ridge_area_mm2": self.ridge_area,
            "ridge_area_mm2_std": ridge_std,
            "ridge_border_mm": self.ridge_border,
            "edge_offset_mm_std": self.edge_offset_std,
            "ridge_period_mm": self.ridge_period,
            "ellipse_iou": self.overlap,
            "centroid_px": self.centroid,
            "flags": self.flags,
        }

    @property
    def values(self) -> FloatArray:
        """(semi_major, semi_minor, gross_area, ridge_area), mm and mm²."""
        axes = self.ellipse.semi_major, self.ellipse.semi_minor
        return np.array([*axes, self.gross_area, self.ridge_area], dtype=float)

    @property
    def covariance(self) -> FloatArray:
        """Covariance of (semi_major, semi_minor, gross_area, ridge_area), mm and mm²: noise, edge, scale."""
        shared = np.outer(self.edge_effect, self.edge_effect) + np.outer(self.scale_effect, self.scale_effect)
        return self.noise_covariance + shared

    @property
    def edge_offset_std(self) -> float:
        """Standard uncertainty of the edge's place, mm: of an equal offset of both semi-axes.

        After a manual threshold the effects on them differ; the offset changes the ellipse's area as they do.
        """
        return float(np.average(self.edge_effect[:2], weights=self.values[1::-1]))

    @property
    def semi_major_std(self) -> float:
        """Standard uncertainty of the semi-major axis, mm."""
        return math.sqrt(self.covariance[0, 0])

    @property
    def semi_minor_std(self) -> float:
        """Standard uncertainty of the semi-minor axis, mm."""
        return math.sqrt(self.covariance[1, 1])

    @property
    def gross_area_std(self) -> float:
        """Standard uncertainty of the gross area, mm²."""
        return math.sqrt(self.covariance[2, 2])

    @property
    def ridge_area_std(self) -> float:
        """Standard uncertainty of the ridge area, mm²."""
        return math.sqrt(self.covariance[3, 3])

    @property
    def region(self) -> BoolArray:
        """Mask of the contact, computed from the outline on demand, (rows, columns) of the picture."""
        return centres_inside(self.outline, self.shape)

    @property
    def ridges(self) -> BoolArray:
        """Where the ridges within the region are, drawn on demand, (rows, columns) of the picture."""
        if self._ridges is None:
            return np.zeros(self.shape, dtype=bool)
        return np.asarray(self.region & self._ridges.in_picture(self.shape))

    @property
    def settings(self) -> ContactImageOptions:
        """Contrast, ridge period (mm) and polarity, as options to measure other frames alike."""
        period = None if math.isnan(self.ridge_period) else self.ridge_period
        settings: ContactImageOptions = {
            "contrast": self.contrast,
            "ridge_period": period,
            "dark_on_light": self.dark_on_light,
        }
        return settings if self.surface == "ridged" else {**settings, "surface": self.surface}


def evaluate(
    view: View, ridges: Ridges | None, region: Region, edge: Edge, *, edited: bool
) -> ContactImageResult:
    """Measure a contact inside its edge; one without ridges has none."""
    mm_per_px = view.scale.mm_per_px
    outline = view.to_picture(edge.points)
    moments = polygon_moments(outline)
    overlap = moments.overlap(outline)
    doubts = {
        # Beyond the edge seen, fading is a guess.
        "touches_border": view.touches_border(edge.moved(-edge.fade), edge.steps),
        "cut_by_mask": view.cut_by_mask(edge.points, edge.steps),
        "several_regions": region.several,
        "poor_ellipse": overlap < _POOR_OVERLAP,
        "edited_manually": edited,
        **dict.fromkeys(edge.doubts, True),
    }
    fine, ridge_area, area_variance, border, threshold = None, math.nan, math.nan, math.nan, view.contrast / 2
    if ridges is not None:
        fine = ridge_map(view, edge.points, ridges.threshold)
        smeared = np.ones_like(region.patch)
        if edge.resolved:
            smeared = _blurred_ridges(ridges.amount, region.patch, view.period)
        # Where ridges are not resolved any part may be ridge: half of it, uniform from none to all.
        ridge_area, unknown = fine.area(smeared)
        known = ridge_area - unknown / 2
        area_variance = unknown**2 / 12 + _ridge_area_std(edge, fine, known, moments.area) ** 2
        border = fine.border() * mm_per_px if view.resolved else math.nan
        threshold = quantile(ridges.within(region.patch)[0], 0.5)
        # One without ridges follows its edge so well that a flat side looks cut.
        doubts["straight_side"] = not edited and flattest(edge.points, _PIECE) < _STRAIGHT
        doubts |= _doubts_of_ridges(view, edge, fine, merged=ridge_area > _MANY_RIDGES * moments.area)
    noise, edge_effect = _outline_uncertainty(view, edge, moments, outline, ridge_area)
    noise[3, 3] += area_variance
    units = mm_per_px**_POWERS
    values = np.array([*moments.semi_axes, moments.area, ridge_area]) * units
    semi_major, semi_minor, gross_area, ridge_area = values.tolist()
    column, row = moments.centroid
    return ContactImageResult(
        ellipse=Ellipse(semi_major, semi_minor),
        orientation=moments.orientation,
        centroid=(float(row), float(column)),
        outline=outline[:, ::-1],
        gross_area=gross_area,
        ridge_area=ridge_area,
        ridge_border=border,
        ridge_period=view.ridge_period * mm_per_px,
        overlap=overlap,
        noise_covariance=noise * np.outer(units, units),
        edge_effect=edge_effect * units,
        mm_per_px=mm_per_px,
        scale_effect=_POWERS * view.scale.relative_std * values,
        threshold=threshold,
        contrast=view.contrast,
        dark_on_light=view.dark_on_light,
        flags=tuple(flag for flag in FLAGS["contact"] if doubts.get(flag, False)),
        surface="smooth" if ridges is None else "ridged",
        shape=view.part.shape,
        _ridges=fine,
    )


def _doubts_of_ridges(view: View, edge: Edge, ridges: RidgeMap, *, merged: bool) -> dict[str, bool]:
    mm_per_px, (low, high) = view.scale.mm_per_px, PLAUSIBLE_RIDGE_PERIOD_MM
    return {
        "low_contrast": view.contrast < LOW_CONTRAST * view.noise,
        "scale_doubtful": not low <= view.ridge_period * mm_per_px <= high,
        "not_a_contact_image": not shows_ridges(view.contact, edge.points, mm_per_px, view.step),
        "ridges_merge": merged,
        "edge_without_ridges": edge.signs.mostly_bare,
        # Dark places tell of print only between ridges that are seen apart.
        "printed_marks": ridges.has_print and view.resolved and not merged,
    }


def _outline_uncertainty(
    view: View, edge: Edge, moments: AreaMoments, outline: FloatArray, ridge_area: float
) -> tuple[FloatArray, FloatArray]:
    """Return the covariance by errors of this image's outline, and the change by a shared one of the edge.

    Of (semi_major, semi_minor, gross_area, ridge_area), px of the picture; a smooth contact's ridge area, and
    what concerns it, is NaN.
    """
    weights = axis_weights(moments, outline) * view.step**2
    # A wider outline takes in more ridges, thinner than those of the interior.
    response = np.vstack([np.eye(3), [0, 0, RIDGE_AREA.at_rim * ridge_area / moments.area]])
    noise = response @ outline_noise(edge, weights) @ response.T
    if math.isfinite(ridge_area):
        outline = running_mean(outline, round(edge.period * view.step))
    # An outline that is no ellipse has other semi-axes by other definitions.
    other = np.ptp(outline @ moments.axes.T, axis=0) / 2 - moments.semi_axes
    noise[:2, :2] += np.outer(other, other) / 3
    offset = edge.offset_std * view.step
    return noise, response @ [offset, offset, offset * edge.steps.sum() * view.step]


def _ridge_area_std(edge: Edge, ridges: RidgeMap, known: float, gross_area: float) -> float:
    """Return the standard uncertainty of the area of resolved ridges inside a given outline."""
    share = known / gross_area
    grain = min(ridges.grain * ridges.softness * share, RIDGE_AREA.most_grain)
    fade = edge.fade / edge.period - RIDGE_AREA.sharp_fade
    return known * math.hypot(
        RIDGE_AREA.least_std,
        RIDGE_AREA.level_std * ridges.softness,
        RIDGE_AREA.by_grain * max(0.0, grain - RIDGE_AREA.usual_grain),
        RIDGE_AREA.by_rim * edge.signs.cover**2,
        RIDGE_AREA.by_fade * min(max(0.0, fade), RIDGE_AREA.most_fade),
        RIDGE_AREA.by_moisture * max(0.0, min(share, RIDGE_AREA.wet_share) - RIDGE_AREA.dry_share),
        RIDGE_AREA.by_thinness * max(0.0, RIDGE_AREA.thin_share - share),
    )


def _blurred_ridges(amount: UInt8, patch: BoolArray, period: float) -> BoolArray:
    """Return where in a patch ridges are blurred into one another, as a quarter of its pixels shows."""
    part = np.ascontiguousarray(amount[::2, ::2])
    side = 2 * round(_WINDOW * period / 4) + 1
    mean, square = (box(part, cv2.CV_32F, (side, side)) for box in (cv2.boxFilter, cv2.sqrBoxFilter))
    smooth = ((square - mean * mean < _MIN_SPREAD**2) & (mean > _NOTHING)).astype(np.uint8)
    return patch & (cv2.resize(smooth, patch.shape[::-1], interpolation=cv2.INTER_NEAREST) > 0)
