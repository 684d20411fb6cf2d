"""Measure a contact image: the contact ellipse, gross and ridge areas, and the ridge period."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, Float32Array, FloatArray
from fingerpad.exceptions import ImageError
from fingerpad.geometry.ellipse import Ellipse
from fingerpad.image.imprint._edge import Edge
from fingerpad.image.imprint._frame import frame_of
from fingerpad.image.imprint._patch import Patch, measured, traced
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
from fingerpad.image.imprint.edits import BrushStroke, HandEllipse, brushed, placed
from fingerpad.image.imprint.result import FLAGS, Imprint
from fingerpad.image.scale import Scale

PLAUSIBLE_RIDGE_PERIOD_MM = (0.25, 0.9)

_NOMINAL_RIDGE_PERIOD_MM = 0.45
# Contrast over noise: below the first nothing can be told from noise, below the second it is doubtful.
_NO_CONTRAST, _LOW_CONTRAST = 2.5, 5.0
_POOR_OVERLAP = 0.85
_OTHER_REGION = 0.2


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Ridged:
    """A picture with its ridges told, whatever of them is contact; `period` in px of the picture or NaN."""

    view: View
    signal: Signal
    amount: UInt8
    level: Float32Array
    period: float
    by_threshold: bool

    @property
    def noise(self) -> float:
        """Noise in parts of the contrast."""
        return self.signal.noise / max(self.signal.contrast, 1e-9)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Region:
    """What is taken for the contact, in px of the working copy."""

    patch: BoolArray
    edge: Edge
    several: bool


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PreparedImprint:
    """A contact image up to where a person may have a say: cheap to measure again with other edits.

    Attributes
    ----------
    scale : Scale
        Millimetres per pixel.
    reason : str or None
        Why the program found no contact; None where it did. A person can still draw one.
    """

    scale: Scale
    reason: str | None
    _ridged: _Ridged
    _region: _Region | None

    @property
    def imprint(self) -> Imprint:
        """What the program measures.

        Raises
        ------
        ImageError
            Where it found no contact.
        """
        if self._region is None:
            raise ImageError(self.reason)
        return _imprint(self._ridged, self._region, self.scale, edited=False)

    def with_edits(self, strokes: Sequence[BrushStroke] = (), ellipse: HandEllipse | None = None) -> Imprint:
        """Measure the contact as a person corrects it.

        Parameters
        ----------
        strokes : sequence of BrushStroke
            Painted one after the other over the program's region; the largest piece that they leave is the
            contact, without holes.
        ellipse : HandEllipse, optional
            The contact is this ellipse, whatever the region.

        Returns
        -------
        Imprint
            With the flag ``edited_by_person``, and the uncertainty of a hand wherever the hand drew; without
            edits the program's own.

        Raises
        ------
        ImageError
            If the edits leave no contact, or lie outside the picture, or there are none and the program found
            no contact.

        Examples
        --------
        >>> from fingerpad.image import Scale, render_imprint
        >>> truth = render_imprint(semi_major=8.0, semi_minor=6.0, seed=3)
        >>> prepared = prepare_imprint(truth.pixels, Scale.of_ppi(500))
        >>> row, column = prepared.imprint.centroid
        >>> bite = BrushStroke(action="remove", points=[(row - 150, column)], radius=40)
        >>> prepared.with_edits([bite]).gross_area < prepared.imprint.gross_area
        True
        """
        view, region = self._ridged.view, self._region
        if ellipse is not None:
            patch, edge = placed(ellipse, view, noise=self._ridged.noise)
            several = False
        elif strokes:
            before = None if region is None else (region.patch, region.edge)
            patch, edge, other = brushed(before, strokes, view, noise=self._ridged.noise)
            several = other > _OTHER_REGION or (region is not None and region.several)
        else:
            return self.imprint
        return _imprint(
            self._ridged, _Region(patch=patch, edge=edge, several=several), self.scale, edited=True
        )


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
    return prepare_imprint(
        pixels,
        scale,
        dark_on_light=dark_on_light,
        background=background,
        seed=seed,
        threshold=threshold,
        contrast=contrast,
        ridge_period=ridge_period,
        mask=mask,
        region_of_interest=region_of_interest,
    ).imprint


def prepare_imprint(
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
) -> PreparedImprint:
    """Tell the ridges and the contact in a grey contact image, ready for a person's edits.

    Parameters
    ----------
    pixels, scale, **options
        As for `measure_imprint`.

    Returns
    -------
    PreparedImprint
        Also where no contact is found: its `reason` says why.

    Raises
    ------
    ImageError
        If the array is not a grey picture, is not finite or all of one level, or an option is not as
        described.
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
    _require_seed(seed, view)
    signal = signal_of(view.values, view.inside, view.period, dark_on_light=dark_on_light, contrast=contrast)
    reason = None if threshold is not None else _lack_of_contrast(signal, resolved=resolved)
    if reason is not None:
        # Ridges are then told from noise, should a person see a contact there.
        signal = replace(signal, contrast=max(signal.contrast, signal.noise, 1e-3))
    amount, level = ridge_amount(signal, view.period, threshold)
    counted = view.card & view.inside
    if not counted.all():
        amount = np.where(counted, amount, np.uint8(0))
    ridged = _Ridged(
        view=view,
        signal=signal,
        amount=amount,
        level=level,
        period=found,
        by_threshold=threshold is not None,
    )
    region = None
    if reason is None:
        try:
            region = _region(ridged, seed, resolved=resolved)
        except ImageError as error:
            reason = str(error)
    return PreparedImprint(scale=scale, reason=reason, _ridged=ridged, _region=region)


def _region(ridged: _Ridged, seed: tuple[float, float] | None, *, resolved: bool) -> _Region:
    """Return the contact that the program finds."""
    view = ridged.view
    closed = closed_over(ridged.amount, view.period)
    patches = patches_of(closed, view.period)
    chosen = _chosen(patches, seed, view)
    patch = without_appendages(patches[chosen], view.period)
    largest_other = max((np.count_nonzero(p) for k, p in enumerate(patches) if k != chosen), default=0)
    edge = traced(
        view,
        patch,
        closed,
        ridged.amount,
        ridged.noise,
        resolved=resolved,
        by_threshold=ridged.by_threshold,
    )
    several = bool(largest_other > _OTHER_REGION * np.count_nonzero(patches[chosen]))
    return _Region(patch=patch, edge=edge, several=several)


def _imprint(ridged: _Ridged, region: _Region, scale: Scale, *, edited: bool) -> Imprint:
    """Measure a region of a picture."""
    signal, patch = ridged.signal, region.patch
    contact = measured(ridged.view, patch, region.edge, ridged.amount, by_threshold=ridged.by_threshold)
    period = ridged.period * scale.mm_per_px
    doubts = {
        "touches_border": contact.touches_border,
        "cut_by_mask": contact.cut_by_mask,
        "low_contrast": signal.contrast < _LOW_CONTRAST * signal.noise,
        "several_regions": region.several,
        "poor_ellipse": contact.overlap < _POOR_OVERLAP,
        "scale_doubtful": not PLAUSIBLE_RIDGE_PERIOD_MM[0] <= period <= PLAUSIBLE_RIDGE_PERIOD_MM[1],
        "edited_by_person": edited,
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
        threshold=_median_level(ridged.level, patch),
        contrast=signal.contrast,
        dark_on_light=signal.dark_on_light,
        flags=tuple(flag for flag in FLAGS if doubts[flag]),
        _view=ridged.view,
        _amount=ridged.amount,
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


def _lack_of_contrast(signal: Signal, *, resolved: bool) -> str | None:
    """Say that nothing stands out of the noise; None where something does."""
    if signal.contrast > (_NO_CONTRAST if resolved else _LOW_CONTRAST) * signal.noise:
        return None
    return (
        f"no contact found: contrast {signal.contrast:.3g} against noise {signal.noise:.3g}: "
        "check that the picture shows a print, or give dark_on_light"
    )


def _require_seed(seed: tuple[float, float] | None, view: View) -> None:
    if seed is not None and not (0 <= seed[0] < view.shape[0] and 0 <= seed[1] < view.shape[1]):
        raise ImageError(f"seed {seed} lies outside the picture of {view.shape} pixels")


def _chosen(patches: list[BoolArray], seed: tuple[float, float] | None, view: View) -> int:
    """Return the number of the wanted patch: at the seed, or the largest with preference for the centre."""
    if not patches:
        raise ImageError(
            "no contact found: nothing is as large as three ridge periods: check scale and polarity"
        )
    if seed is None:
        return int(np.argmax([_prominence(patch) for patch in patches]))
    place = view.place_of(*seed)
    for k, patch in enumerate(patches):
        if place is not None and patch[place]:
            return k
    raise ImageError(f"no contact found at seed {seed}: give a (row, column) within the print")


def _prominence(patch: BoolArray) -> float:
    moments = cv2.moments(longest_contour(patch))
    row, column = moments["m01"] / moments["m00"], moments["m10"] / moments["m00"]
    off = math.hypot(row / patch.shape[0] - 0.5, column / patch.shape[1] - 0.5)
    return float(moments["m00"]) * (1 - 0.7 * off)
