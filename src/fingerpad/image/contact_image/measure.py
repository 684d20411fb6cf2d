"""Measure a contact image: the contact ellipse, gross and ridge areas, and the ridge period.

Five steps, each with its own type and module:

1. `view_of` (view.py): the picture is checked and cropped, its ridge period found from local spectra
   (spectra.py), and a copy made in which a period is 4.5 px, the ground is even and contact is bright
   (background.py): a `View`.
2. `find_ridges` (ridges.py): where the copy lies above half the local contrast: `Ridges`, also closed over
   the valleys.
3. `find_region` (region.py): the largest patch of closed ridges, cut at necks, without appendages: a
   `Region`.
4. `trace_edge` (edge.py): its outline to a fraction of a pixel, moved out to where the contact ends: an
   `Edge`. What a person draws (manual.py) stands in for steps 3 and 4.
5. `evaluate` (result.py): ridges inside the edge at the picture's own resolution (ridges.py), areas, axes,
   their uncertainty and doubts about them: a `ContactImageResult`.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Final, Unpack, get_args

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import FloatArray
from fingerpad._display import Displayed
from fingerpad.exceptions import ImageError
from fingerpad.image.contact_image.edge import Edge, trace_edge
from fingerpad.image.contact_image.manual import RegionEdit, region_after_strokes, region_of_ellipse
from fingerpad.image.contact_image.region import OTHER_RIDGED, Region, find_region
from fingerpad.image.contact_image.result import LOW_CONTRAST, ContactImageResult, evaluate
from fingerpad.image.contact_image.ridges import CLEAR_RISE, Ridges, find_ridges, smoothed
from fingerpad.image.contact_image.smooth import find_smooth
from fingerpad.image.contact_image.view import ContactImageOptions, Surface, View, view_of
from fingerpad.image.ellipse import ImageEllipse
from fingerpad.image.read import ImageLike, levels_of
from fingerpad.image.scale import ScaleLike, as_scale

_NO_CONTRAST: Final = 2.5  # contrast over noise below which no contact is detectable
_THRESHOLD_STD: Final = 0.2  # relative standard uncertainty of a threshold that a person chose
_HISTOGRAM_BINS: Final = 128
_SMEARED: Final = 0.01  # of the contact; less of it moves no number by more than is stated
_ROUND: Final = 0.96  # regions that overlap less with their ellipse may contain smears


def measure_contact_image(
    image: ImageLike, scale: ScaleLike, **options: Unpack[ContactImageOptions]
) -> ContactImageResult:
    """Measure the contact patch in a grey contact image.

    The edge of a contact is where its outermost ridges stop touching. Where ridges fade towards it, those
    still seen just outside show by how much it lies further out; a halo or a rim, smooth along it, does not
    count. How far is partly a matter of definition: about 0.04 to 0.2 mm stand in the covariance as an offset
    that all of the outline shares, and all images of a device. The uncertainty of the semi-axes contains
    besides what their definition leaves open where the outline is no ellipse.

    A contact without ridges, that of a silicone fingertip or of a gel, is measured with ``surface="smooth"``:
    its edge is half-way on the step from the contact to what lies around it, and with a picture of the empty
    view as `background` reflections do not count. Light passes thin gaps and water fills them: how far the
    visible edge lies outside the contact stands in the shared uncertainty. Colours of the picture count.

    Ridge area is what lies, in means along the ridges, about half-way from the level of the valleys to that
    of the ridges around, shifted by what blur and grain do to it. Where ridges fill more than 59 % of the
    contact, as with sweat or ink, the ridge area is flagged as an upper bound, and less certain.

    Parameters
    ----------
    image : array_like, (rows, columns), path-like or Picture
        Grey levels of any real type, or the file that holds them.
    scale : Scale or float
        Millimetres per pixel.
    **options
        Polarity, threshold, region and so on: see `ContactImageOptions`.

    Returns
    -------
    ContactImageResult

    Raises
    ------
    ImageError
        If the image is not a grey picture, is not finite, shows no contact, or none at `seed`; or an option
        is not as described.
    CalibrationError
        If a number is no length of a pixel, mm.

    Examples
    --------
    >>> from fingerpad.image import Scale, measure_contact_image
    >>> from fingerpad.simulate import render_contact_image
    >>> truth = render_contact_image(semi_major=3.0, semi_minor=2.5, seed=1)
    >>> contact_image = measure_contact_image(truth.pixels, Scale.of_ppi(500))
    >>> abs(contact_image.gross_area / truth.gross_area - 1) < 0.03, contact_image.flags
    (True, ())
    """
    pixels = levels_of(image, colour=options.get("surface") == "smooth")
    prepared = prepare_contact_image(pixels, scale, **options)
    return replace(prepared.measure(), picture=np.asarray(pixels))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class PreparedContactImage(Displayed):
    """A contact image with its ridges found, to be measured with several corrections."""

    reason: str | None  # why no contact was found automatically; a manual outline can still be given
    _view: View
    _ridges: Ridges | None
    _found: tuple[Region, Edge] | None
    _nearby: tuple["PreparedContactImage", ...] = ()

    @property
    def is_clear(self) -> bool:
        """Whether a contact with ridges up to its edge was found automatically."""
        return self._found is not None and self._view.resolved and not self._found[1].signs.mostly_bare

    def is_within(self, other: "PreparedContactImage") -> bool:
        """Return whether the contact found is a smaller one in that of another, or there is no other."""
        if self._found is None or other._found is None:
            return self._found is not None
        own, its = self._found[0].patch, other._found[0].patch
        column, row = self._view.to_picture(self._found[1].points).mean(axis=0)
        place = other._view.to_copy_pixel(row, column)
        return bool(own.mean() < its.mean() and place is not None and its[place])

    def level_histogram(self) -> tuple[FloatArray, FloatArray]:
        """Return how many pixels have which level, and the bins' edges, to choose a threshold by.

        Levels are those above the background, towards contact, at a resolution of some pixels a ridge.
        """
        if self._ridges is None:
            raise ImageError("a smooth contact has no threshold: its edge is where the picture steps")
        levels = smoothed(self._view)
        if self._view.inside.any():  # a mask of a line leaves no pixel of the copy
            levels = levels[self._view.inside]
        low, high = np.percentile(levels, (0.1, 99.9))
        counts, edges = np.histogram(levels, _HISTOGRAM_BINS, range=(min(low, 0.0), max(high, 1e-9)))
        return counts.astype(np.float64), edges

    def measure(
        self, strokes: Sequence[RegionEdit] = (), ellipse: ImageEllipse | None = None
    ) -> ContactImageResult:
        """Measure the contact, with manual corrections where there are any.

        Strokes are painted one after the other over the automatic region, of which the largest piece without
        holes is the contact; or it is an `ellipse`. A given threshold is known to 20 %, which moves the edge.
        """
        found = self._found
        if ellipse is not None:
            found = region_of_ellipse(ellipse, self._view)
        elif strokes:
            found = region_after_strokes(found, strokes, self._view)
        if found is None:
            raise ImageError(self.reason)
        edited = ellipse is not None or bool(strokes)
        result = evaluate(self._view, self._ridges, *found, edited=edited)
        if not self._nearby:
            return result
        values = np.zeros((2, 4))  # none where there is no contact at that level
        for row, nearby in zip(values, self._nearby, strict=True):
            with suppress(ImageError):
                row[:] = nearby.measure(strokes, ellipse).values
        return _with_shared_effect(result, (values[0] - values[1]) / 2)


def prepare_contact_image(
    pixels: npt.ArrayLike, scale: ScaleLike, **options: Unpack[ContactImageOptions]
) -> PreparedContactImage:
    """Find the ridges and the contact, ready for manual corrections; options are `ContactImageOptions`.

    Where no contact is found, `reason` says why.
    """
    surface = options.get("surface") or "ridged"
    if surface not in get_args(Surface):
        raise ImageError(f"surface must be ridged or smooth, found {surface!r:.100}")
    if surface == "smooth":
        view, found, reason = find_smooth(pixels, as_scale(scale), **options)
        return PreparedContactImage(reason=reason, _view=view, _ridges=None, _found=found)
    scale, seed, threshold = as_scale(scale), options.get("seed"), options.get("threshold")
    view = view_of(pixels, scale, **options)
    if threshold is not None:
        # One standard uncertainty of the threshold below and above shows what it leaves open.
        nearby = [(1 + way * _THRESHOLD_STD) * threshold for way in (-1, 1)]
        first, *others = (_prepared(view, level, seed) for level in (threshold, *nearby))
        return replace(first, _nearby=tuple(others))
    prepared = _prepared(view, None, seed)
    if options.get("dark_on_light") is None and not prepared.is_clear:
        # Dark corners may have been taken for the ground, or a window in a dark mount for the contact in it.
        options["dark_on_light"] = not view.dark_on_light
        other = _prepared(view_of(pixels, scale, **options), None, seed)
        if other.is_clear and other.is_within(prepared) and not other.measure().flags:
            return other
    return prepared


def _prepared(view: View, threshold: float | None, seed: tuple[float, float] | None) -> PreparedContactImage:
    """Tell ridges from valleys, and find the contact unless it is lost in noise."""
    found, reason = None, None
    least = (_NO_CONTRAST if view.resolved else LOW_CONTRAST) * view.noise
    if threshold is None and not view.contrast > least:
        reason = (
            f"no contact found: contrast {view.contrast:.3g} against noise {view.noise:.3g}: "
            "check that the picture shows a print, or give dark_on_light"
        )
        # A manual outline can still be measured: ridges are then those above noise.
        view = replace(view, contrast=max(view.contrast, view.noise, 1e-3))
    ridges = find_ridges(view, threshold)
    if reason is None:
        try:
            region = find_region(view, ridges, seed)
            if threshold is None:
                region = _without_smears(view, ridges, region, seed)
            found = region, trace_edge(view, ridges, region)
        except ImageError as error:
            reason = str(error)
    return PreparedContactImage(reason=reason, _view=view, _ridges=ridges, _found=found)


def _without_smears(view: View, ridges: Ridges, region: Region, seed: tuple[float, float] | None) -> Region:
    """Leave smears and fainter prints out of the contact where it is the rounder for that.

    What lies beside a contact bulges out of its outline; a smudge within leaves a gap in that of the ridges.
    """
    _, rise = ridges.within(region.patch)
    if np.mean(rise < CLEAR_RISE * view.contrast) < _SMEARED or region.roundness > _ROUND:
        return region
    with suppress(ImageError):
        # A place is ridge above half of the rise: what rises by less than `CLEAR_RISE` does not get there.
        part = find_region(view, find_ridges(view, None, 2 * CLEAR_RISE), seed)
        common = np.count_nonzero(part.patch & region.patch)
        left_out = np.count_nonzero(region.patch) - common
        if left_out < common and part.roundness > region.roundness:
            other = bool(left_out > OTHER_RIDGED * np.count_nonzero(part.patch))
            return replace(part, several=part.several or other)
    return region


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
