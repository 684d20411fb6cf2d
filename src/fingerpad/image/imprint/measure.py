"""Measure a contact image: the contact ellipse, gross and ridge areas, and the ridge period."""

import math
from dataclasses import dataclass
from typing import Any, TypedDict

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, Float32Array, FloatArray
from fingerpad.exceptions import ImageError
from fingerpad.geometry.ellipse import Ellipse
from fingerpad.image.imprint._frame import frame_of
from fingerpad.image.imprint._patch import Patch, measured
from fingerpad.image.imprint._period import ridge_period_px
from fingerpad.image.imprint._region import (
    UInt8,
    closed_over,
    longest_contour,
    patches_of,
    without_appendages,
)
from fingerpad.image.imprint._ridges import Signal, ridge_amount, signal_of
from fingerpad.image.imprint._view import View
from fingerpad.image.scale import Scale

FLAGS = (
    "touches_border",
    "cut_by_mask",
    "low_contrast",
    "several_regions",
    "poor_ellipse",
    "scale_doubtful",
)
PLAUSIBLE_RIDGE_PERIOD_MM = (0.25, 0.9)

_NOMINAL_RIDGE_PERIOD_MM = 0.45
# Contrast over noise: below the first nothing can be told from noise, below the second it is doubtful.
_NO_CONTRAST, _LOW_CONTRAST = 2.5, 5.0
_POOR_OVERLAP = 0.85
_OTHER_REGION = 0.2


class ImprintSettings(TypedDict):
    """What one frame of a sequence can hand on to the others, as keyword arguments of `measure_imprint`."""

    contrast: float
    ridge_period: float | None
    dark_on_light: bool


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Imprint:
    """What a contact image shows of one contact.

    Attributes
    ----------
    ellipse : Ellipse
        Contact ellipse, mm: the region's area, with the axis ratio of its second moments.
    orientation : float
        Angle of the major axis from straight up (the image's row axis), positive counter-clockwise as
        seen on the screen, radians in (−π/2, π/2]. Zero is an upright finger.
    centroid : (float, float)
        (row, column) of the region's centroid, px; pixel centres are whole numbers.
    outline : ndarray, (n, 2)
        (row, column) of points round the contact, px; all areas and axes are those of this polygon.
    gross_area, ridge_area : float
        Area inside the outline, and of the ridges within, mm². Parts in which ridges are blurred into one
        another, or all of a contact without ridges, count as half ridge.
    ridge_period : float
        Median distance between neighbouring ridges, mm, NaN where no ridges are resolved.
    overlap : float
        Intersection over union of region and ellipse.
    covariance : ndarray, (4, 4)
        Of (semi_major, semi_minor, gross_area, ridge_area), mm and mm², to first order: the relative
        uncertainty of the scale, shared by all, the position of the edge, and the ridges' threshold; of
        what counts as half ridge, anything from none to all may be one.
    threshold : float
        Median level that parts ridges from valleys in the patch, grey levels from the ground towards contact.
    contrast : float
        Level of the contact above the ground, grey levels: the scale against which faint places are judged.
    dark_on_light : bool
        Whether contact is darker than the ground.
    flags : tuple of str
        Doubts, from `FLAGS`.
    """

    ellipse: Ellipse
    orientation: float
    centroid: tuple[float, float]
    outline: FloatArray
    gross_area: float
    ridge_area: float
    ridge_period: float
    overlap: float
    covariance: FloatArray
    threshold: float
    contrast: float
    dark_on_light: bool
    flags: tuple[str, ...]
    _view: View
    _amount: UInt8
    _ridge_level: float

    def as_record(self) -> dict[str, Any]:
        """Return the numbers under names with units, for tables and scripts."""
        return {
            "semi_major_mm": float(self.ellipse.semi_major),
            "semi_major_mm_std": self.semi_major_std,
            "semi_minor_mm": float(self.ellipse.semi_minor),
            "semi_minor_mm_std": self.semi_minor_std,
            "orientation_deg": math.degrees(self.orientation),
            "gross_area_mm2": self.gross_area,
            "gross_area_mm2_std": self.gross_area_std,
            "ridge_area_mm2": self.ridge_area,
            "ridge_area_mm2_std": self.ridge_area_std,
            "ridge_period_mm": self.ridge_period,
            "ellipse_iou": self.overlap,
            "centroid_px": self.centroid,
            "flags": self.flags,
        }

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
        """Where the contact is, drawn from the outline on demand, (rows, columns) of the picture."""
        corners = [np.rint(self.outline[:, ::-1] * 256).astype(np.int32)]
        canvas, rim = (np.zeros(self._view.shape, dtype=np.uint8) for _ in range(2))
        cv2.fillPoly(canvas, corners, 1, shift=8)
        # OpenCV fills every pixel that the outline touches; only those whose centre is inside count.
        cv2.polylines(rim, corners, True, 1, 1, shift=8)
        polygon = self.outline[:, ::-1].astype(np.float32)
        for row, column in np.argwhere(rim):
            canvas[row, column] = cv2.pointPolygonTest(polygon, (float(column), float(row)), False) >= 0
        return canvas > 0

    @property
    def ridges(self) -> BoolArray:
        """Where the ridges within the region are, drawn on demand, (rows, columns) of the picture."""
        return np.asarray(self.region & (self._view.enlarged(self._amount) >= self._ridge_level))

    @property
    def settings(self) -> ImprintSettings:
        """Contrast, ridge period (mm) and polarity, to measure other frames alike."""
        period = None if math.isnan(self.ridge_period) else self.ridge_period
        return {"contrast": self.contrast, "ridge_period": period, "dark_on_light": self.dark_on_light}


def measure_imprint(
    pixels: npt.ArrayLike,
    scale: Scale,
    *,
    dark_on_light: bool | None = None,
    background: npt.ArrayLike | None = None,
    seed: tuple[float, float] | None = None,
    threshold: float | None = None,
    contrast: float | None = None,
    ridge_period: float | None = None,
    mask: npt.ArrayLike | None = None,
    region_of_interest: tuple[int, int, int, int] | None = None,
) -> Imprint:
    """Measure the contact patch in a grey contact image.

    The ridge period comes from local spectra of the picture itself, which is then reduced so that a period
    is 4.5 px. Light is evened by a smooth surface through the quiet ground. Ridges lie above half the local
    contrast; closed with a disk of 1.1 ridge periods they give the gross region, which is cut at necks (joint
    creases) and freed of appendages narrower than a third of it. Its outline is placed to parts of a pixel
    where the closed ridges fall through half.

    A region closed over ridges ends at their ends where the outline crosses them, and at the outer border of
    the last ridge where it follows one. There the outline is moved out: if the true edge falls at random on
    ridges and on valleys of share v of the period P, it lies v²P/2 further out on average.

    Parameters
    ----------
    pixels : array_like, (rows, columns)
        Grey levels of any real type.
    scale : Scale
        Millimetres per pixel.
    dark_on_light : bool, optional
        Whether contact is darker than the ground; found from the picture when None.
    background : array_like, (rows, columns), optional
        The same view without a finger, by which the picture is divided.
    seed : (float, float), optional
        (row, column) of a point in the wanted patch, px; without it, the largest, preferring the centre.
    threshold : float, optional
        Grey levels, from the even ground towards contact, beyond which a place is ridge everywhere in the
        picture. Without it, half of the local contrast.
    contrast : float, optional
        Level of the contact above the ground, grey levels; found from the picture when None. Where nothing
        rises above half of it there is no contact. One value for a whole sequence keeps its frames
        comparable: `Imprint.settings` of a good frame holds it.
    ridge_period : float, optional
        Ridge period, mm; found from the picture when None.
    mask : array_like, optional
        A polygon of (row, column) corners or a bool array of the picture's shape: outside nothing counts.
    region_of_interest : (int, int, int, int), optional
        First row, first column, last row, last column (excluded) of the part to look at.

    Returns
    -------
    Imprint

    Raises
    ------
    ImageError
        If the array is not a grey picture, is not finite, shows no contact, or none at `seed`; or an option
        is not as described.

    Examples
    --------
    >>> from fingerpad.image import Scale, measure_imprint, render_imprint
    >>> truth = render_imprint(semi_major=8.0, semi_minor=6.0, seed=3)
    >>> imprint = measure_imprint(truth.pixels, Scale.of_ppi(500))
    >>> abs(imprint.gross_area / truth.gross_area - 1) < 0.03, imprint.flags
    (True, ())
    """
    positive = {"threshold": threshold, "contrast": contrast, "ridge_period": ridge_period}
    for name, value in positive.items():
        if value is not None and not (value > 0 and math.isfinite(value)):
            raise ImageError(f"{name} must be positive and finite, found {value}")
    frame = frame_of(pixels, background=background, mask=mask, region_of_interest=region_of_interest)
    expected = (ridge_period or _NOMINAL_RIDGE_PERIOD_MM) / scale.mm_per_px
    found = expected if ridge_period else ridge_period_px(frame.pixels, frame.inside, expected)
    resolved = math.isfinite(found)
    view = View.of(frame, found if resolved else expected)
    counted = view.card & view.inside
    signal = signal_of(view.values, view.inside, view.period, dark_on_light=dark_on_light, contrast=contrast)
    if threshold is None:
        _require_contrast(signal, resolved=resolved)
    amount, level = ridge_amount(signal, view.period, threshold)
    if not counted.all():
        amount = np.where(counted, amount, np.uint8(0))
    closed = closed_over(amount, view.period)
    patches = patches_of(closed, view.period)
    chosen = _chosen(patches, seed, view)
    patch = without_appendages(patches[chosen], view.period)
    largest_other = max((np.count_nonzero(p) for k, p in enumerate(patches) if k != chosen), default=0)
    several = bool(largest_other > _OTHER_REGION * np.count_nonzero(patches[chosen]))
    noise = signal.noise / max(signal.contrast, 1e-9)
    contact = measured(
        view, patch, closed, amount, noise, resolved=resolved, by_threshold=threshold is not None
    )
    period = found * scale.mm_per_px
    doubts = {
        "touches_border": contact.touches_border,
        "cut_by_mask": contact.cut_by_mask,
        "low_contrast": signal.contrast < _LOW_CONTRAST * signal.noise,
        "several_regions": several,
        "poor_ellipse": contact.overlap < _POOR_OVERLAP,
        "scale_doubtful": not PLAUSIBLE_RIDGE_PERIOD_MM[0] <= period <= PLAUSIBLE_RIDGE_PERIOD_MM[1],
    }
    (semi_major, semi_minor, gross_area, ridge_area), covariance = _in_mm(contact, scale)
    column, row = contact.moments.centroid
    return Imprint(
        ellipse=Ellipse.of(semi_major, semi_minor),
        orientation=contact.moments.orientation,
        centroid=(float(row), float(column)),
        outline=contact.outline[:, ::-1],
        gross_area=float(gross_area),
        ridge_area=float(ridge_area),
        ridge_period=period,
        overlap=contact.overlap,
        covariance=covariance,
        threshold=_median_level(level, patch),
        contrast=signal.contrast,
        dark_on_light=signal.dark_on_light,
        flags=tuple(flag for flag in FLAGS if doubts[flag]),
        _view=view,
        _amount=amount,
        _ridge_level=contact.ridge_level,
    )


def _in_mm(contact: Patch, scale: Scale) -> tuple[FloatArray, FloatArray]:
    """Return semi-axes, gross and ridge area in mm and mm², and their covariance with the scale's."""
    powers = np.array([1, 1, 2, 2])
    units = scale.mm_per_px**powers
    values = np.array([*contact.moments.semi_axes, contact.moments.area, contact.ridge_area]) * units
    shared = powers * scale.relative_std * values
    return values, contact.covariance * np.outer(units, units) + np.outer(shared, shared)


def _median_level(level: Float32Array, patch: BoolArray) -> float:
    """Return the median level in a patch; it varies slowly, and some hundred places show it."""
    rows, columns = (np.linspace(0, n - 1, min(n, 60)).astype(int) for n in level.shape)
    size = (columns.size, rows.size)
    inside = cv2.resize(patch.astype(np.uint8), size, interpolation=cv2.INTER_NEAREST) > 0
    some = level[np.ix_(rows, columns)]
    return float(np.median(some[inside] if inside.any() else some))


def _require_contrast(signal: Signal, *, resolved: bool) -> None:
    least = _NO_CONTRAST if resolved else _LOW_CONTRAST
    if not signal.contrast > least * signal.noise:
        raise ImageError(
            f"no contact found: contrast {signal.contrast:.3g} against noise {signal.noise:.3g}: "
            "check that the picture shows a print, or give dark_on_light"
        )


def _chosen(patches: list[BoolArray], seed: tuple[float, float] | None, view: View) -> int:
    """Return the number of the wanted patch: at the seed, or the largest with preference for the centre."""
    if not patches:
        raise ImageError(
            "no contact found: nothing is as large as three ridge periods: check scale and polarity"
        )
    if seed is None:
        return int(np.argmax([_prominence(patch) for patch in patches]))
    row, column = seed
    if not (0 <= row < view.shape[0] and 0 <= column < view.shape[1]):
        raise ImageError(f"seed {seed} lies outside the picture of {view.shape} pixels")
    place = view.place_of(row, column)
    for k, patch in enumerate(patches):
        if place is not None and patch[place]:
            return k
    raise ImageError(f"no contact found at seed {seed}: give a (row, column) within the print")


def _prominence(patch: BoolArray) -> float:
    moments = cv2.moments(longest_contour(patch))
    row, column = moments["m01"] / moments["m00"], moments["m10"] / moments["m00"]
    off = math.hypot(row / patch.shape[0] - 0.5, column / patch.shape[1] - 0.5)
    return float(moments["m00"]) * (1 - 0.7 * off)
