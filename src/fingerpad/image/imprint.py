"""Measure a contact image: the contact ellipse, gross and ridge areas, and the ridge period."""

import math
from dataclasses import dataclass, replace

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray
from fingerpad.exceptions import ImageError
from fingerpad.geometry.ellipse import Ellipse
from fingerpad.image._card import card_of, touches_edge
from fingerpad.image._region import (
    box_of,
    contact_mask,
    largest,
    outline,
    patches_of,
    shifted,
    without_appendages,
)
from fingerpad.image._ridges import Float32, Signal, ridge_mask, ridge_period_px, signal_of
from fingerpad.image.ellipse_fit import RegionEllipse, equal_area_ellipse
from fingerpad.image.scale import Scale

FLAGS = ("touches_border", "low_contrast", "several_regions", "poor_ellipse", "scale_doubtful")
PLAUSIBLE_RIDGE_PERIOD_MM = (0.25, 0.9)

_NOMINAL_RIDGE_PERIOD_MM = 0.45
_WORKING_PERIOD_PX = 10.0
_LEAST_SIDE_PX = 16
# Contrast over noise: below the first nothing can be told from noise, below the second it is doubtful.
_NO_CONTRAST, _LOW_CONTRAST = 2.0, 3.0
_POOR_OVERLAP = 0.85
_OTHER_REGION = 0.2


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Imprint:
    """What a contact image shows of one contact.

    Standard uncertainties are to first order; each combines the relative uncertainty of the scale (shared by
    all lengths of the picture), half the change when the ridge threshold moves from 0.4 to 0.6 of the local
    contrast (a rectangular distribution, ÷ √3), and for the gross region the position of its edge
    (`measure_imprint`).

    Attributes
    ----------
    ellipse : Ellipse
        Contact ellipse, mm: the region's area, with the axis ratio of its second moments.
    orientation : float
        Angle of the major axis from straight up (the image's row axis), positive counter-clockwise as
        seen on the screen, radians in (−π/2, π/2]. Zero is an upright finger.
    centroid : (float, float)
        (row, column) of the region's centroid, px; pixel centres are whole numbers.
    gross_area, ridge_area : float
        Area inside the contact's outline, and of the ridges within, mm².
    ridge_period : float
        Median distance between neighbouring ridges, mm, NaN where no ridges are resolved.
    overlap : float
        Intersection over union of region and ellipse.
    region, ridges : ndarray of bool, (rows, columns)
        The contact region, and the ridges within it.
    semi_major_std, semi_minor_std, gross_area_std, ridge_area_std : float
        Standard uncertainties, mm and mm².
    flags : tuple of str
        Doubts, from `FLAGS`.
    """

    ellipse: Ellipse
    orientation: float
    centroid: tuple[float, float]
    gross_area: float
    ridge_area: float
    ridge_period: float
    overlap: float
    region: BoolArray
    ridges: BoolArray
    semi_major_std: float
    semi_minor_std: float
    gross_area_std: float
    ridge_area_std: float
    flags: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _View:
    """The picture as the measurement sees it; lengths in px of the full picture."""

    signal: Signal
    card: BoolArray
    period: float
    reduction: float

    def cropped(self, box: tuple[slice, slice]) -> "_View":
        """Look at a part only."""
        return replace(self, signal=replace(self.signal, values=self.signal.values[box]), card=self.card[box])

    def reduced(self, mask: BoolArray) -> BoolArray:
        """Bring a full mask to the working size."""
        if self.reduction == 1:
            return mask
        step = 1 / self.reduction
        small = cv2.resize(mask.astype(np.float32), None, fx=step, fy=step, interpolation=cv2.INTER_AREA)
        return np.asarray(small > 0.5)

    def enlarged(self, mask: BoolArray, shape: tuple[int, ...]) -> BoolArray:
        """Bring a mask of the working size to the full one."""
        if self.reduction == 1:
            return mask
        full = cv2.resize(mask.astype(np.float32), shape[::-1], interpolation=cv2.INTER_LINEAR)
        return np.asarray(full > 0.5)


def measure_imprint(
    pixels: npt.ArrayLike,
    scale: Scale,
    *,
    dark_on_light: bool | None = None,
    background: npt.ArrayLike | None = None,
    seed: tuple[float, float] | None = None,
) -> Imprint:
    """Measure the contact patch in a grey contact image.

    Light is evened by a smooth surface through the quiet ground. The ridge period comes from local spectra
    of the picture itself. Ridges lie above half of the local contrast; closed with a disk of 1.1 ridge
    periods they give the gross region, which is cut at necks (joint creases) and freed of appendages
    narrower than a third of it.

    A region closed over ridges ends at the outer border of its last ridges. If the outline falls at random
    on ridges and on valleys of share v of the period P, the true edge lies v²P/2 further out on average,
    and the region is moved out by that. The edge's own uncertainty is half of this correction, shared round
    the outline, and vP/√12 for each stretch of two periods, independent.

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

    Returns
    -------
    Imprint

    Raises
    ------
    ImageError
        If the array is not a grey picture, is not finite, shows no contact, or none at `seed`.

    Examples
    --------
    >>> from fingerpad.image import Scale, measure_imprint, render_imprint
    >>> truth = render_imprint(semi_major=8.0, semi_minor=6.0, seed=3)
    >>> imprint = measure_imprint(truth.pixels, Scale.of_ppi(500))
    >>> abs(imprint.gross_area / truth.gross_area - 1) < 0.03, imprint.flags
    (True, ())
    """
    values = _checked(pixels, background)
    signal = signal_of(values, dark_on_light=dark_on_light)
    found = ridge_period_px(signal.values)
    _require_contrast(signal, found)
    period = found if math.isfinite(found) else _NOMINAL_RIDGE_PERIOD_MM / scale.mm_per_px
    view = _View(
        signal=signal, card=card_of(values), period=period, reduction=max(1.0, period / _WORKING_PERIOD_PX)
    )
    ridges = ridge_mask(signal, period) & view.card
    patches = patches_of(contact_mask(view.reduced(ridges), period / view.reduction), period / view.reduction)
    chosen = _chosen(patches, seed, view, values.shape)
    whole = without_appendages(patches[chosen], period / view.reduction)
    patch = view.enlarged(whole, values.shape)
    largest_other = max((np.count_nonzero(p) for k, p in enumerate(patches) if k != chosen), default=0)
    several = bool(largest_other > _OTHER_REGION * np.count_nonzero(patches[chosen]))
    return _result(view, patch, ridges, scale, several=several, resolved=math.isfinite(found))


def _checked(pixels: npt.ArrayLike, background: npt.ArrayLike | None) -> Float32:
    values = _grey(pixels, "pixels")
    if background is not None:
        ground = _grey(background, "background")
        if ground.shape != values.shape:
            raise ImageError(f"background must have the picture's shape {values.shape}, found {ground.shape}")
        if not (ground > 0).all():
            raise ImageError(
                "background must be positive everywhere, found zero: it cannot divide the picture"
            )
        values = values / ground * np.float32(np.median(ground))
    if float(np.ptp(values)) == 0:
        raise ImageError(f"no contact found: every pixel has the same level, {values.flat[0]:g}")
    return values


def _grey(pixels: npt.ArrayLike, name: str) -> Float32:
    array = np.asarray(pixels)
    if array.ndim != 2 or array.dtype.kind not in "buif":
        raise ImageError(f"{name} must be a grey (rows, columns) array of numbers, found shape {array.shape}")
    if min(array.shape) < _LEAST_SIDE_PX:
        raise ImageError(
            f"{name} of {array.shape} is too small to hold a contact: use {_LEAST_SIDE_PX} px or more"
        )
    values = array.astype(np.float32)
    if not np.isfinite(values).all():
        raise ImageError(f"{name} holds NaN or infinite values: fill them before measuring")
    return values


def _require_contrast(signal: Signal, period: float) -> None:
    least = _NO_CONTRAST if math.isfinite(period) else _LOW_CONTRAST
    if not signal.contrast > least * signal.noise:
        raise ImageError(
            f"no contact found: contrast {signal.contrast:.3g} against noise {signal.noise:.3g}: "
            "check that the picture shows a print, or give dark_on_light"
        )


def _chosen(
    patches: list[BoolArray], seed: tuple[float, float] | None, view: _View, shape: tuple[int, ...]
) -> int:
    """Return the number of the wanted patch: at the seed, or the largest with preference for the centre."""
    if not patches:
        raise ImageError(
            "no contact found: nothing is as large as three ridge periods: check scale and polarity"
        )
    if seed is None:
        return int(np.argmax([_prominence(patch) for patch in patches]))
    row, column = seed
    if not (0 <= row < shape[0] and 0 <= column < shape[1]):
        raise ImageError(f"seed {seed} lies outside the picture of {shape} pixels")
    for k, patch in enumerate(patches):
        place = (
            min(int(row / view.reduction), patch.shape[0] - 1),
            min(int(column / view.reduction), patch.shape[1] - 1),
        )
        if patch[place]:
            return k
    raise ImageError(f"no contact found at seed {seed}: give a (row, column) within the print")


def _prominence(patch: BoolArray) -> float:
    rows, columns = np.nonzero(patch)
    off = math.hypot(rows.mean() / patch.shape[0] - 0.5, columns.mean() / patch.shape[1] - 0.5)
    return rows.size * (1 - 0.7 * off)


def _edge_shift(valley_share: float, period: float) -> float:
    """Return how far the true edge lies beyond the last ridges on average, px."""
    return valley_share**2 * period / 2


def _measures(region: BoolArray, ridges: BoolArray) -> npt.NDArray[np.float64]:
    """Return semi-major, semi-minor, gross and ridge area, px."""
    ellipse = equal_area_ellipse(region).ellipse
    return np.array(
        [ellipse.semi_major, ellipse.semi_minor, region.sum(), (ridges & region).sum()], dtype=float
    )


def _result(
    view: _View, patch: BoolArray, ridges: BoolArray, scale: Scale, *, several: bool, resolved: bool
) -> Imprint:
    share = 1 - np.count_nonzero(ridges & patch) / np.count_nonzero(patch)
    box = box_of(patch, margin=math.ceil(3 * view.period))
    near = view.cropped(box)
    part = shifted(patch[box], _edge_shift(share, view.period)) & near.card
    found = equal_area_ellipse(part)
    values = _measures(part, ridges[box])
    std = _standard_uncertainties(near, part, values, share, scale)
    overlap = _overlap(part, found)
    size = scale.mm_per_px
    period = view.period * size if resolved else math.nan
    region = np.zeros_like(patch)
    region[box] = part
    doubts = {
        "touches_border": touches_edge(region, view.card, view.period),
        "low_contrast": view.signal.contrast < _LOW_CONTRAST * view.signal.noise,
        "several_regions": several,
        "poor_ellipse": overlap < _POOR_OVERLAP,
        "scale_doubtful": not PLAUSIBLE_RIDGE_PERIOD_MM[0] <= period <= PLAUSIBLE_RIDGE_PERIOD_MM[1],
    }
    return Imprint(
        ellipse=Ellipse.of(found.ellipse.semi_major * size, found.ellipse.semi_minor * size),
        orientation=found.orientation,
        centroid=(found.centroid[0] + box[0].start, found.centroid[1] + box[1].start),
        gross_area=float(values[2]) * size**2,
        ridge_area=float(values[3]) * size**2,
        ridge_period=period,
        overlap=overlap,
        region=region,
        ridges=ridges & region,
        semi_major_std=float(std[0]),
        semi_minor_std=float(std[1]),
        gross_area_std=float(std[2]),
        ridge_area_std=float(std[3]),
        flags=tuple(flag for flag in FLAGS if doubts[flag]),
    )


def _standard_uncertainties(
    view: _View, region: BoolArray, values: npt.NDArray[np.float64], valley_share: float, scale: Scale
) -> npt.NDArray[np.float64]:
    """Return the standard uncertainties of `_measures`, mm and mm²."""
    powers = np.array([1, 1, 2, 2])
    from_scale = powers * scale.relative_std * values
    low, high = (_remeasured(view, region, fraction) for fraction in (0.4, 0.6))
    from_threshold = (high - low) / (2 * math.sqrt(3))
    perimeter = cv2.arcLength(outline(region).astype(np.float32), True)
    stretches = max(perimeter / (2 * view.period), 1.0)
    shared = _edge_shift(valley_share, view.period) / 2
    own = valley_share * view.period / math.sqrt(12 * stretches)
    # An axis feels the random part of about half of the outline.
    semi = math.hypot(shared, math.sqrt(2) * own)
    from_edge = np.array([semi, semi, perimeter * math.hypot(shared, own), 0.0])
    std = np.sqrt(from_scale**2 + from_threshold**2 + from_edge**2)
    return np.asarray(std * scale.mm_per_px**powers, dtype=np.float64)


def _remeasured(view: _View, region: BoolArray, fraction: float) -> npt.NDArray[np.float64]:
    """Measure again with another ridge threshold, not beyond a period from the region."""
    near = shifted(region, view.period) & view.card
    ridges = ridge_mask(view.signal, view.period, fraction) & near
    mask = contact_mask(view.reduced(ridges), view.period / view.reduction)
    patch = view.enlarged(largest(mask), near.shape) if mask.any() else region
    share = 1 - np.count_nonzero(ridges & patch) / np.count_nonzero(patch)
    return _measures(shifted(patch, _edge_shift(share, view.period)) & near, ridges)


def _overlap(region: BoolArray, found: RegionEllipse) -> float:
    """Return the intersection over union of a region and its ellipse."""
    row, column = np.ogrid[: region.shape[0], : region.shape[1]]
    down, right = row - found.centroid[0], column - found.centroid[1]
    cosine, sine = math.cos(found.orientation), math.sin(found.orientation)
    along = (down * cosine + right * sine) / float(found.ellipse.semi_major)
    across = (right * cosine - down * sine) / float(found.ellipse.semi_minor)
    inside = along**2 + across**2 <= 1
    return float(np.count_nonzero(inside & region) / np.count_nonzero(inside | region))
