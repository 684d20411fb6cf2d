"""A contact image as it is measured: checked, cropped, and reduced to a copy in which contact is bright."""

import math
from dataclasses import dataclass
from typing import Final, Literal, NamedTuple, TypeAlias, TypedDict, Unpack

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, Float32Array, FloatArray, as_float32, as_float_array, real_array
from fingerpad.exceptions import ImageError
from fingerpad.image._masks import bounding_box, disk, filled_polygon, region_window
from fingerpad.image.contact_image.background import flattened, without_added_border
from fingerpad.image.contact_image.spectra import Pixels, ridge_period_px
from fingerpad.image.levels import check_finite, checked_picture, picture_array
from fingerpad.image.scale import Scale

Surface: TypeAlias = Literal["ridged", "smooth"]

_COPY_PERIOD_PX: Final = 4.5  # pixels of the copy to a ridge period
_USUAL_PERIOD_MM: Final = 0.45  # of the ridges of fingers, where neither the picture nor the caller tells
_MIN_SIDE_PX: Final = 16
_MAX_LEVEL: Final = 1e15  # squares of levels,
_MIN_RANGE: Final = 1e-15  # and 1 over them, stay within single precision
_FARTHEST_CORNER_PX: Final = 1e6  # corners of a polygon become sixteenths of a pixel, in 32 bits
_AT_SIDE: Final = 1.5  # an outline this near to a side of the copy, px, reaches it


class ContactImageOptions(TypedDict, total=False):
    """What is known of a contact image, or wanted: keyword arguments that all default to None.

    Attributes
    ----------
    background : array_like, (rows, columns)
        The same view without a finger, by which the image is divided.
    mask : array_like
        A polygon of (row, column) corners or a bool array of the image's shape; only what is inside counts.
    region_of_interest : (int, int, int, int)
        First row, first column, last row, last column (excluded) of the part to measure.
    seed : (float, float)
        (row, column) of a point in the wanted patch, px; by default the largest patch, preferring the centre.
    dark_on_light : bool
        Whether the contact is darker than the background; found from the image by default.
    threshold : float
        Difference from the background, in grey levels, above which a pixel is ridge everywhere in the image.
        By default the local threshold is half of the local contrast.
    contrast : float
        Level of the contact above the background, grey levels; found from the image by default. A region that
        nowhere exceeds half of it is no contact. One value for a whole sequence keeps its frames comparable:
        `ContactImageResult.settings` of a good frame holds it.
    ridge_period : float
        Ridge period, mm; found from the image by default.
    added_border : bool
        Whether an even border may have been added round the picture; by default one is looked for.
    surface : {"ridged", "smooth"}
        Whether the contact has ridges, as a finger has, or none, as that of a silicone fingertip; never found
        from the image. Ridged by default.

    Examples
    --------
    >>> from fingerpad.image import measure_contact_image
    >>> from fingerpad.simulate import render_contact_image
    >>> truth = render_contact_image(semi_major=3.0, semi_minor=2.5, seed=1)
    >>> options = ContactImageOptions(dark_on_light=True, seed=truth.centroid)
    >>> contact = measure_contact_image(truth.pixels, truth.mm_per_px, **options)
    >>> print(f"{contact.gross_area:.1f} mm², truth {truth.gross_area:.1f} mm²")
    23.3 mm², truth 23.6 mm²
    """

    background: npt.ArrayLike | None
    mask: npt.ArrayLike | None
    region_of_interest: tuple[int, int, int, int] | None
    seed: tuple[float, float] | None
    dark_on_light: bool | None
    threshold: float | None
    contrast: float | None
    ridge_period: float | None
    added_border: bool | None
    surface: Surface | None


class Crop(NamedTuple):
    """The part of a picture that is measured."""

    pixels: Pixels  # (rows, columns); its grey levels, or (rows, columns, 3) colours
    inside: BoolArray | None  # (rows, columns); where the part counts; None means everywhere
    corner: tuple[int, int]  # (row, column) of its first pixel in the whole picture
    shape: tuple[int, int]  # of the whole picture
    may_have_border: bool  # whether an even border may have been added round it

    def shown(self, shape: tuple[int, int]) -> BoolArray:
        """Return where a copy of this shape shows anything: all but an added even border."""
        if not self.may_have_border:
            return np.ones(shape, dtype=bool)
        return without_added_border(self.pixels, shape)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class View:
    """A picture, and its copy in which a ridge period is 4.5 px and contact is bright on a ground of zero.

    Points are (x, y), px of the copy or of the whole picture; pixel centres are whole numbers.
    """

    part: Crop  # what is measured of the picture, in grey levels
    scale: Scale  # millimetres per pixel of the picture
    ridge_period: float  # found or given, px of the picture; NaN where no ridges are resolved
    contact: Float32Array  # (rows, columns); the copy: how far each place lies above the ground, grey levels
    ground: Float32Array  # (rows, columns); the level subtracted from the picture with contact bright
    noise: float  # standard deviation of the quiet ground, grey levels
    contrast: float  # level of the contact above the ground, grey levels
    dark_on_light: bool  # whether contact is darker than the ground in the picture
    shown: BoolArray  # (rows, columns); where the picture shows anything: all but an added even border
    inside: BoolArray  # (rows, columns); where the caller lets it count
    period: float  # ridge period, px of the copy; where it is not resolved, that of usual fingers

    @property
    def steps(self) -> tuple[float, float]:
        """Pixels of the picture in one of the copy, along rows and columns."""
        (rows, columns), (few_rows, few_columns) = self.part.pixels.shape, self.contact.shape
        return rows / few_rows, columns / few_columns

    @property
    def resolved(self) -> bool:
        """Whether the ridge period was seen in the picture or given."""
        return math.isfinite(self.ridge_period)

    @property
    def step(self) -> float:
        """Pixels of the picture in one of the copy, in the mean of both directions."""
        return math.sqrt(self.steps[0] * self.steps[1])

    def to_picture(self, points: FloatArray) -> FloatArray:
        """Return points of the copy as points of the picture."""
        return np.asarray((points + 0.5) * self.steps[::-1] - 0.5 + np.array(self.part.corner[::-1]))

    def to_copy(self, points: FloatArray) -> FloatArray:
        """Return points of the picture as points of the copy."""
        return np.asarray((points + 0.5 - np.array(self.part.corner[::-1])) / self.steps[::-1] - 0.5)

    def to_copy_pixel(self, row: float, column: float) -> tuple[int, int] | None:
        """Return the pixel of the copy that shows a place of the picture, None where it shows none."""
        y = int((row + 0.5 - self.part.corner[0]) // self.steps[0])
        x = int((column + 0.5 - self.part.corner[1]) // self.steps[1])
        return (y, x) if 0 <= y < self.contact.shape[0] and 0 <= x < self.contact.shape[1] else None

    def touches_border(self, points: FloatArray, lengths: FloatArray) -> bool:
        """Return whether an outline reaches the picture's frame or an added border, or runs along one.

        Scanners leave a blank margin of a few px: ten periods of outline within one of it are a cut too.
        """
        at_side = self._length_near(points, lengths, _AT_SIDE, border=0.5 * self.period, own=True)
        near = self._length_near(points, lengths, self.period, border=self.period, own=True)
        return at_side > 2 * self.period or near > 10 * self.period

    def cut_by_mask(self, points: FloatArray, lengths: FloatArray) -> bool:
        """Return whether an outline reaches the edge of the caller's mask."""
        return self._length_near(points, lengths, _AT_SIDE, border=2.0, own=False) > 2 * self.period

    def _length_near(
        self, points: FloatArray, lengths: FloatArray, margin: float, *, border: float, own: bool
    ) -> float:
        """Return the length of an outline near what the picture does not show, or the caller leaves out."""
        mask = self.shown if own else self.inside
        rows, columns = mask.shape
        x, y = points.T
        # The top, left, bottom and right side are the caller's where they cut the picture, or its own.
        corner = np.array(self.part.corner)
        cut = np.concatenate([corner > 0, corner + self.part.pixels.shape < self.part.shape])
        sides, whole = cut != own, bool(mask.all())
        if whole and not sides.any():
            return 0.0
        off = np.array([y + 0.5, x + 0.5, rows - 0.5 - y, columns - 0.5 - x])
        near = (off[sides] < margin).any(axis=0)
        if not whole:
            plain = cv2.erode(mask.astype(np.uint8), disk(max(1.0, border)))
            place = np.rint(y).astype(int).clip(0, rows - 1), np.rint(x).astype(int).clip(0, columns - 1)
            near |= plain[place] == 0
        return float(lengths[near].sum())


def view_of(pixels: npt.ArrayLike, scale: Scale, **options: Unpack[ContactImageOptions]) -> View:
    """Check a picture and what limits it, find its ridge period, and reduce it so that this is 4.5 px."""
    given, part = options.get("ridge_period"), crop(pixels, **options)
    low, high, _, _ = cv2.minMaxLoc(part.pixels)
    if not high - low > _MIN_RANGE:
        raise ImageError(f"no contact found: every pixel has the same level, {low:g}")
    expected = (given or _USUAL_PERIOD_MM) / scale.mm_per_px
    found = expected if given else ridge_period_px(part.pixels, part.inside, expected)
    period = found if math.isfinite(found) else expected
    rows, columns = part.pixels.shape
    if period > min(rows, columns) / 2:
        raise ImageError(
            f"no contact found: a ridge period of {period:.3g} px is more than half a side of what is "
            f"measured, {rows} × {columns} px: check scale and ridge_period"
        )
    shape = reduced_shape((rows, columns), period / _COPY_PERIOD_PX)
    inside = np.ones(shape, dtype=bool)
    if part.inside is not None:
        share = cv2.resize(part.inside.astype(np.float32), shape[::-1], interpolation=cv2.INTER_AREA)
        inside = share > 0.5
    # Area means keep the place of an edge in their grey levels, and over whole numbers of pixels take a small
    # part of the time: linear interpolation first brings the picture to a multiple of the copy near its size.
    whole = math.ceil(rows / shape[0] - 0.25)
    multiple = cv2.resize(part.pixels, (shape[1] * whole, shape[0] * whole), interpolation=cv2.INTER_LINEAR)
    copy = as_float32(cv2.resize(multiple, shape[::-1], interpolation=cv2.INTER_AREA))
    period_of_copy = period / float(np.sqrt(rows / shape[0] * (columns / shape[1])))
    contact, noise, contrast, dark = flattened(
        copy, inside, period_of_copy, options.get("dark_on_light"), options.get("contrast")
    )
    return View(
        part=part,
        scale=scale,
        ridge_period=found,
        contact=contact,
        ground=as_float32((-copy if dark else copy) - contact),
        noise=noise,
        contrast=contrast,
        dark_on_light=dark,
        shown=part.shown(shape),
        inside=inside,
        period=period_of_copy,
    )


def reduced_shape(shape: tuple[int, ...], reduction: float) -> tuple[int, int]:
    """Return the shape of a copy reduced by a factor, where that is above 1, to no less than 8 px a side."""
    rows, columns = (max(8, round(n / max(1.0, reduction))) for n in shape[:2])
    return rows, columns


def crop(
    pixels: npt.ArrayLike, *, may_have_colours: bool = False, **options: Unpack[ContactImageOptions]
) -> Crop:
    """Check a picture and what limits it, and crop it; it may be blank. Other options do not count."""
    if unknown := sorted(options.keys() - ContactImageOptions.__annotations__.keys()):
        raise TypeError(f"unknown option {unknown[0]!r}: see ContactImageOptions")
    levels = {"threshold": options.get("threshold"), "contrast": options.get("contrast")}
    for name, value in {**levels, "ridge_period": options.get("ridge_period")}.items():
        if value is not None:
            number = real_array(value, name, ImageError)
            if number.ndim or not 1e-15 < number < 1e15:
                raise ImageError(f"{name} must be one number, positive and finite, found {value!r:.100}")
    values = _levels(pixels, "pixels", may_have_colours=may_have_colours)
    shape = (values.shape[0], values.shape[1])
    if (seed := options.get("seed")) is not None:
        place = real_array(seed, "seed", ImageError)
        if place.shape != (2,) or not ((place >= 0) & (place < shape)).all():
            raise ImageError(f"seed {seed} lies outside the picture of {shape} pixels")
    mask, background = options.get("mask"), options.get("background")
    inside = None if mask is None else _inside(mask, shape)
    region = options.get("region_of_interest")
    box = region_window((0, 0, *shape) if region is None else region, shape, _MIN_SIDE_PX)
    if inside is not None:
        box = _crop_to_mask(box, inside)
        inside = inside[box]
    part = _finite(values[box], "pixels")
    if background is not None:
        ground = _levels(background, "background")
        if ground.shape != shape:
            raise ImageError(f"background must have the picture's shape {shape}, found {ground.shape}")
        light = _finite(ground[box], "background").astype(np.float32)
        middle = np.float32(np.median(light))
        if not (light > _MIN_RANGE * middle).all() or middle < _MIN_RANGE:
            raise ImageError(
                "background must be positive everywhere, found zero: it cannot divide the picture"
            )
        part = as_float32(part.astype(np.float32) / light * middle)
    corner = (box[0].start, box[1].start)
    return Crop(part, inside, corner, shape, options.get("added_border") is not False)


def _levels(pixels: npt.ArrayLike, name: str, *, may_have_colours: bool = False) -> npt.NDArray[np.number]:
    array = checked_picture(pixels, name, colour=may_have_colours)
    array = array[..., :3] if array.ndim == 3 else array
    if min(array.shape[:2]) < _MIN_SIDE_PX:
        raise ImageError(
            f"{name}: {array.shape[0]} × {array.shape[1]} px is too small to hold a contact: "
            f"{_MIN_SIDE_PX} px a side are the least"
        )
    return array


def _finite(values: npt.NDArray[np.number], name: str) -> Pixels:
    if values.dtype == np.uint8:
        return np.ascontiguousarray(values)
    with np.errstate(over="ignore"):
        single = np.ascontiguousarray(values, dtype=np.float32)
    check_finite(values, name)
    if max(abs(float(single.min())), abs(float(single.max()))) > _MAX_LEVEL:
        raise ImageError(f"{name} holds levels beyond ±{_MAX_LEVEL:g}: divide them by a constant")
    return single


def _inside(mask: npt.ArrayLike, shape: tuple[int, int]) -> BoolArray:
    """Return where a mask, or a polygon of (row, column) corners, lets the picture count."""
    array = picture_array(mask, "mask")
    if array.shape == shape and array.dtype.kind in "bui":
        inside = array > 0
    elif array.ndim == 2 and array.shape[1] == 2 and len(array) >= 3 and array.dtype.kind in "uif":
        if not (np.abs(array) <= _FARTHEST_CORNER_PX).all():
            raise ImageError(
                f"mask: the corners of the polygon must be finite and within ±{_FARTHEST_CORNER_PX:g} px"
            )
        inside = filled_polygon(as_float_array(array[:, ::-1]), shape) > 0
    else:
        raise ImageError(
            f"mask must be a bool array of the picture's shape {shape}, or a polygon of three or more "
            f"(row, column) corners, found shape {array.shape}"
        )
    if not inside.any():
        raise ImageError("mask leaves nothing of the picture")
    return np.asarray(inside)


def _crop_to_mask(box: tuple[slice, slice], inside: BoolArray) -> tuple[slice, slice]:
    """Crop to what a mask leaves of a box, at least the least side where the picture has room."""
    within = np.zeros_like(inside)
    within[box] = inside[box]
    if not within.any():
        raise ImageError("mask and region_of_interest have nothing in common")
    narrow = []
    for whole, hit in zip(box, bounding_box(within, margin=0), strict=True):
        start = max(whole.start, hit.start - max(0, _MIN_SIDE_PX - (hit.stop - hit.start)))
        narrow.append(slice(start, min(whole.stop, max(hit.stop, start + _MIN_SIDE_PX))))
    return narrow[0], narrow[1]
