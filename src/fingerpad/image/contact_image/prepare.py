"""Find the ridges and the contact in an image, ready for manual corrections."""

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, FloatArray, real_array
from fingerpad._display import Displayed
from fingerpad.exceptions import ImageError
from fingerpad.image._masks import longest_contour
from fingerpad.image.contact_image._assemble import LOW_CONTRAST, ContactRegion, RidgeImage, assemble_result
from fingerpad.image.contact_image._cropping import check_not_blank, crop_image
from fingerpad.image.contact_image._patch import trace_patch
from fingerpad.image.contact_image._period import ridge_period_px
from fingerpad.image.contact_image._region import (
    close_ridges,
    contact_patches,
    remove_appendages,
)
from fingerpad.image.contact_image._ridges import Signal, ridge_amount, smoothed, to_signal
from fingerpad.image.contact_image._working_image import WorkingImage
from fingerpad.image.contact_image.manual import RegionEdit, outline_after_strokes, outline_of_ellipse
from fingerpad.image.contact_image.result import ContactImageResult
from fingerpad.image.ellipse import ImageEllipse
from fingerpad.image.inputs import ScaleLike, as_scale
from fingerpad.image.scale import Scale

_NOMINAL_RIDGE_PERIOD_MM = 0.45
# Contrast over noise below which no contact is detectable.
_NO_CONTRAST = 2.5
_OTHER_REGION = 0.2
# Relative standard uncertainty of a threshold that a person chose.
_THRESHOLD_STD = 0.2
_HISTOGRAM_BINS = 128
# Levels are taken from every other pixel where a period has more than so many.
_LEAST_FOR_STEP = 4


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Detection:
    """Ridges of an image at one level, and the contact among them; `reason` where there is none."""

    ridged: RidgeImage
    region: ContactRegion | None
    reason: str | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class PreparedContactImage(Displayed):
    """A contact image with its ridges found, to be measured with several corrections.

    Attributes
    ----------
    scale : Scale
        Millimetres per pixel.
    reason : str or None
        Why no contact was found automatically, or None. A manual outline can still be given.

    Examples
    --------
    >>> from fingerpad.simulate import render_contact_image
    >>> truth = render_contact_image(semi_major=3.0, semi_minor=2.5, seed=1)
    >>> prepared = prepare_contact_image(truth.pixels, Scale(truth.mm_per_px))
    >>> prepared.contact_image.flags, prepared.with_corrections().flags
    ((), ())
    """

    scale: Scale
    reason: str | None
    _found: Detection
    _nearby: tuple[Detection, ...]

    @property
    def contact_image(self) -> ContactImageResult:
        """The automatic measurement.

        Raises
        ------
        ImageError
            Where it found no contact.
        """
        return self.with_corrections()

    def level_histogram(self) -> tuple[FloatArray, FloatArray]:
        """Return how many pixels have which level, to choose a threshold by.

        Returns
        -------
        counts : ndarray, shape (n,)
            Pixels of the part that is measured, at a resolution of some pixels per ridge.
        edges : ndarray, shape (n + 1,)
            Of the bins: grey levels from the background towards contact, as `threshold` is given in.

        Examples
        --------
        >>> from fingerpad.simulate import render_contact_image
        >>> truth = render_contact_image(semi_major=3.0, semi_minor=2.5, seed=1)
        >>> prepared = prepare_contact_image(truth.pixels, Scale(truth.mm_per_px))
        >>> counts, edges = prepared.level_histogram()
        >>> bool(edges[0] < 0 < prepared.contact_image.threshold < edges[-1])
        True
        """
        ridged = self._found.ridged
        levels = smoothed(ridged.signal.values, ridged.view.period)[ridged.view.inside]
        low, high = np.percentile(levels, (0.1, 99.9))
        counts, edges = np.histogram(levels, _HISTOGRAM_BINS, range=(min(low, 0.0), max(high, 1e-9)))
        return counts.astype(np.float64), edges

    def with_corrections(
        self, strokes: Sequence[RegionEdit] = (), ellipse: ImageEllipse | None = None
    ) -> ContactImageResult:
        """Measure the contact with manual corrections.

        Parameters
        ----------
        strokes : sequence of BrushStroke and RegionPolygon
            Painted one after the other over the automatic region; the largest piece that they leave is the
            contact, without holes.
        ellipse : ImageEllipse, optional
            The contact is this ellipse, whatever the region.

        Returns
        -------
        ContactImageResult
            With the flag ``edited_manually``, and the uncertainty of manual drawing where the outline was
            drawn; without corrections the automatic result. A threshold is known to 20 %: the edge's place
            has the uncertainty that this makes.

        Raises
        ------
        ImageError
            If the corrections leave no contact or lie outside the image, or there are none and no contact was
            found automatically.

        Examples
        --------
        >>> from fingerpad.image import BrushStroke, Scale
        >>> from fingerpad.simulate import render_contact_image
        >>> truth = render_contact_image(semi_major=3.0, semi_minor=2.5, seed=1)
        >>> prepared = prepare_contact_image(truth.pixels, Scale.of_ppi(500))
        >>> row, column = prepared.contact_image.centroid
        >>> bite = BrushStroke(action="remove", points=[(row - 60, column)], radius=20)
        >>> prepared.with_corrections([bite]).gross_area < prepared.contact_image.gross_area
        True
        """
        result = self._measure(self._found, strokes, ellipse)
        if not self._nearby:
            return result
        values = np.zeros((2, 4))  # none where there is no contact at that level
        for row, nearby in zip(values, self._nearby, strict=True):
            with suppress(ImageError):
                other = self._measure(nearby, strokes, ellipse)
                row[:] = other.values
        return _with_shared_effect(result, (values[0] - values[1]) / 2)

    def _measure(
        self, found: Detection, strokes: Sequence[RegionEdit], ellipse: ImageEllipse | None
    ) -> ContactImageResult:
        ridged, region = found.ridged, found.region
        if ellipse is not None:
            patch, edge = outline_of_ellipse(ellipse, ridged.view, noise=ridged.noise)
            region = ContactRegion(patch=patch, edge=edge, several=False)
        elif strokes:
            before = None if region is None else (region.patch, region.edge)
            patch, edge, other = outline_after_strokes(before, strokes, ridged.view, noise=ridged.noise)
            replaced = any(edit.action == "replace" for edit in strokes)
            several = other > _OTHER_REGION or (region is not None and region.several and not replaced)
            region = ContactRegion(patch=patch, edge=edge, several=several)
        if region is None:
            raise ImageError(found.reason)
        edited = ellipse is not None or bool(strokes)
        return assemble_result(ridged, region, self.scale, edited=edited)


def prepare_contact_image(
    pixels: npt.ArrayLike,
    scale: ScaleLike,
    *,
    dark_on_light: bool | None = None,
    background: npt.ArrayLike | None = None,
    seed: tuple[float, float] | None = None,
    threshold: float | None = None,
    contrast: float | None = None,
    ridge_period: float | None = None,
    mask: npt.ArrayLike | None = None,
    region_of_interest: tuple[int, int, int, int] | None = None,
) -> PreparedContactImage:
    """Find the ridges and the contact in a grey contact image, ready for manual corrections.

    Parameters
    ----------
    pixels : array_like, shape (rows, columns)
        Grey levels of any real type.
    scale : Scale or float
        Millimetres per pixel.
    dark_on_light, background, seed, threshold, contrast, ridge_period, mask, region_of_interest
        See `ContactImageOptions`.

    Returns
    -------
    PreparedContactImage
        Also where no contact is found: `reason` says why.

    Raises
    ------
    ImageError
        If the array is not a grey picture, is not finite or all of one level, or an option is not as
        described.

    Examples
    --------
    A manual ellipse replaces the automatic region:

    >>> from fingerpad.image import ImageEllipse
    >>> from fingerpad.simulate import render_contact_image
    >>> truth = render_contact_image(semi_major=3.0, semi_minor=2.5, seed=1)
    >>> prepared = prepare_contact_image(truth.pixels, Scale.of_ppi(500))
    >>> drawn = ImageEllipse(centre=truth.centroid, semi_axes=(59.0, 49.0))
    >>> print(f"{prepared.with_corrections(ellipse=drawn).gross_area:.1f} mm²")
    23.4 mm²
    """
    scale = as_scale(scale)
    positive = {"threshold": threshold, "contrast": contrast, "ridge_period": ridge_period}
    for name, value in positive.items():
        if value is not None and not (
            (number := real_array(value, name, ImageError)).ndim == 0 and 1e-15 < number < 1e15
        ):
            raise ImageError(f"{name} must be one number, positive and finite, found {value!r:.100}")
    frame = crop_image(pixels, background=background, mask=mask, region_of_interest=region_of_interest)
    check_not_blank(frame.pixels)
    expected = (ridge_period or _NOMINAL_RIDGE_PERIOD_MM) / scale.mm_per_px
    found = expected if ridge_period else ridge_period_px(frame.pixels, frame.inside, expected)
    resolved = math.isfinite(found)
    period = found if resolved else expected
    if period > min(frame.pixels.shape) / 2:
        raise ImageError(
            f"no contact found: a ridge period of {period:.3g} px is more than half a side of what is "
            f"measured, {frame.pixels.shape[0]} × {frame.pixels.shape[1]} px: check scale and ridge_period"
        )
    view = WorkingImage.of(frame, period)
    _check_seed(seed, view)
    signal = to_signal(view.values, view.inside, view.period, dark_on_light=dark_on_light, contrast=contrast)
    reason = None if threshold is not None else _contrast_problem(signal, resolved=resolved)
    if reason is not None:
        # A manual outline can still be measured: ridges are then those above noise.
        signal = replace(signal, contrast=max(signal.contrast, signal.noise, 1e-3))
    levels = [threshold] if threshold is None else [threshold, *_nearby_levels(threshold)]
    first, *nearby = (_detect(view, signal, found, level, seed=seed, reason=reason) for level in levels)
    return PreparedContactImage(scale=scale, reason=first.reason, _found=first, _nearby=tuple(nearby))


def _with_shared_effect(result: ContactImageResult, effect: FloatArray) -> ContactImageResult:
    """Add a second, independent effect that images of one device share to that of the edge.

    One vector cannot hold both exactly: it gets the direction in which most of their sum lies, relative to
    the values, and what is left counts as the image's own, so that the covariance is that of the sum.
    """
    size = np.where(result.values > 0, result.values, 1.0)
    both = np.array([result.edge_effect, effect]) / size
    _, strength, directions = np.linalg.svd(both, full_matrices=False)
    shared, rest = strength[:, None] * directions * size
    shared = shared if shared[0] >= 0 else -shared
    return replace(
        result, edge_effect=shared, noise_covariance=result.noise_covariance + np.outer(rest, rest)
    )


def _nearby_levels(threshold: float) -> tuple[float, float]:
    """Return the levels one standard uncertainty of a threshold below and above it."""
    return (1 - _THRESHOLD_STD) * threshold, (1 + _THRESHOLD_STD) * threshold


def _detect(
    view: WorkingImage,
    signal: Signal,
    period: float,
    threshold: float | None,
    *,
    seed: tuple[float, float] | None,
    reason: str | None,
) -> Detection:
    """Tell ridges from valleys, and find the contact unless there is a reason against it."""
    step = 2 if view.period >= _LEAST_FOR_STEP else 1
    values = smoothed(signal.values, view.period)
    amount, level = ridge_amount(values, signal.contrast, view.period, threshold, step=step)
    counted = view.card & view.inside
    if not counted.all():
        amount = np.where(counted, amount, np.uint8(0))
    ridged = RidgeImage(
        view=view, signal=signal, amount=amount, level=level, period=period, threshold=threshold
    )
    region = None
    if reason is None:
        try:
            region = _find_region(ridged, seed, resolved=math.isfinite(period))
        except ImageError as error:
            reason = str(error)
    return Detection(ridged=ridged, region=region, reason=reason)


def _find_region(ridged: RidgeImage, seed: tuple[float, float] | None, *, resolved: bool) -> ContactRegion:
    """Find the contact automatically."""
    view = ridged.view
    closed = close_ridges(ridged.amount, view.period)
    patches = contact_patches(closed, view.period)
    chosen = _choose_patch(patches, seed, view)
    patch = remove_appendages(patches[chosen], view.period)
    largest_other = max((np.count_nonzero(p) for k, p in enumerate(patches) if k != chosen), default=0)
    edge = trace_patch(
        view,
        patch,
        closed,
        ridged.amount,
        ridged.signal.values,
        noise=ridged.noise,
        resolved=resolved,
        by_threshold=ridged.threshold is not None,
    )
    several = bool(largest_other > _OTHER_REGION * np.count_nonzero(patches[chosen]))
    return ContactRegion(patch=patch, edge=edge, several=several)


def _contrast_problem(signal: Signal, *, resolved: bool) -> str | None:
    """Return the reason where nothing stands out of the noise, else None."""
    if signal.contrast > (_NO_CONTRAST if resolved else LOW_CONTRAST) * signal.noise:
        return None
    return (
        f"no contact found: contrast {signal.contrast:.3g} against noise {signal.noise:.3g}: "
        "check that the picture shows a print, or give dark_on_light"
    )


def _check_seed(seed: tuple[float, float] | None, view: WorkingImage) -> None:
    if seed is None:
        return
    place = real_array(seed, "seed", ImageError)
    if place.shape != (2,) or not ((place >= 0) & (place < view.shape)).all():
        raise ImageError(f"seed {seed} lies outside the picture of {view.shape} pixels")


def _choose_patch(patches: list[BoolArray], seed: tuple[float, float] | None, view: WorkingImage) -> int:
    """Return the number of the wanted patch: at the seed, or the largest with preference for the centre."""
    if not patches:
        raise ImageError(
            "no contact found: nothing is as large as three ridge periods: check scale and polarity"
        )
    if seed is None:
        return int(np.argmax([_prominence(patch) for patch in patches]))
    place = view.to_copy_pixel(*seed)
    for k, patch in enumerate(patches):
        if place is not None and patch[place]:
            return k
    raise ImageError(f"no contact found at seed {seed}: give a (row, column) within the print")


def _prominence(patch: BoolArray) -> float:
    moments = cv2.moments(longest_contour(patch))
    if not moments["m00"] > 0:
        return 0.0
    row, column = moments["m01"] / moments["m00"], moments["m10"] / moments["m00"]
    off = math.hypot(row / patch.shape[0] - 0.5, column / patch.shape[1] - 0.5)
    return float(moments["m00"]) * (1 - 0.7 * off)
