"""Measure a contact without ridges: that of a silicone fingertip, of a gel, or a print that water fills.

Of the five steps of measure.py these contacts share the type of the results and what a person draws. Their
edge is where the picture steps half-way from the contact to what lies around it. Signals are how far a
picture lies above or below its ground, or how far its colour lies from it. In each a rough patch is found,
profiles are read across its outline, and the outline is moved to where they step. The signal whose step is
clearest all round shows the contact.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final, Unpack

import cv2
import numpy as np
import numpy.typing as npt
from numpy.lib.stride_tricks import sliding_window_view
from scipy.ndimage import gaussian_filter1d

from fingerpad._arrays import BoolArray, Float32Array, FloatArray, as_float32, as_float_array, robust_std
from fingerpad.exceptions import ImageError
from fingerpad.image._masks import (
    disk,
    distance_to,
    fill_holes,
    filled_polygon,
    largest_piece,
    longest_contour,
)
from fingerpad.image.contact_image.calibration import SMOOTH
from fingerpad.image.contact_image.edge import Edge, even_edge, profiles
from fingerpad.image.contact_image.region import Region
from fingerpad.image.contact_image.view import ContactImageOptions, Crop, View, crop, reduced_shape
from fingerpad.image.ellipse import evenly_spaced, outward_normals, polygon_moments, shifted, signed_area
from fingerpad.image.levels import quadratic_surface, quadratic_terms
from fingerpad.image.scale import Scale

_COPY_SIDE: Final = 500  # longer side of the copy, px, in which regions are drawn
_DRAWN_MM: Final = 0.45  # a person draws an edge as exactly as this,
_DRAWN_PX: Final = 3.0  # but no more so than to so many px of the copy
_WELL_INSIDE: Final = 0.9  # a step within this share of another is one inside it,
_NESTED_SCORE: Final = 0.6  # where it is as clear as this
_NESTED_HEIGHT: Final = 0.1  # and as high, as a share
_LARGE_BUBBLE: Final = 0.4  # one the other way is a contact rather than a bubble if so large beside the other
_LEAST_AROUND_PX: Final = 20
_AROUND: Final = (1.05, 1.25)  # of the contact's size; the ground lies there
_CLIPPED: Final = (0, 1, 255, 1023, 4095, 16383, 65535)  # levels that a camera shows without noise
_REFUSED: Final = (
    "no contact found: a smooth contact is one compact patch, brighter or darker than the ground or of "
    "another colour, with an edge that is seen all round"
)

# The search for steps.
_ROUGH_SIDE: Final = 200  # longer side of the copy in which patches are found, px
_ROUGH_BLUR: Final = 1.2  # px of it, before
_LEVELS: Final = (1.0, 0.6, 1.6)  # that are tried, in parts of Otsu's
_LEAST_AREA: Final = 0.003
_MOST_AREA: Final = 0.9
_APPENDAGE: Final = 0.4  # parts of a patch narrower than this share of its width are reflections, not contact
_CLEAR: Final = 0.4  # beyond this score signals of another kind are not tried,
_VERY_CLEAR: Final = 0.85  # and beyond this one neither other levels nor signals
# A second edge is as steep, and drops, by no less than this share of the main one: a film may be nearly as
# dark as the contact.
_LEAST_SECOND: Final = 0.2
_SEEN: Final = 0.85  # a contact of which less of the outline is seen may leave the frame
_DIRECTIONS: Final = 180
# How far profiles reach to both sides, in parts of the contact's mean radius, round by round.
_REACHES: Final = (0.45, 0.4, 0.3, 0.25, 0.25)
_ORDERS: Final = (2, 2, 4, 12, 12)  # waves round the outline: few first, which no reflection draws along
_SEARCH: Final = 0.25  # of that reach; no contact is an ellipse, so its edge is sought at least so far off
# Times the wave number to the fourth power: where nothing is seen, fine waves stay small.
_STIFF: Final = 3e-5
_SETTLED: Final = 0.01  # px; an outline that a round moves by less moves no more
_BEYOND: Final = 0.1, 1.0  # of the radius; reflections over the edge are seen so far beyond it
_CHORD: Final = 12  # points of the outline between which its bend is looked at
_DENT: Final = 0.032  # of the radius; an edge that far off the other waves counts still a little


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Step:
    """The step of a picture along an outline, px of the picture."""

    points: FloatArray  # (n, 2); (x, y) of the outline, evenly spaced
    off: FloatArray  # (n,); how far out from it the edge lies in each profile; NaN where none is seen
    seen: float  # share of the outline at which the edge is seen
    height: float  # level of the contact above what lies around it, median along the outline, grey levels
    width: float  # width of the step at half height of its slope
    sign: int  # +1 where the contact is brighter than the ground, -1 where darker, 0 where of another colour
    ring: bool  # whether the edge is a crest, not a step
    narrow: bool  # whether that crest is a narrow ring round a level floor
    second: float  # how far outside a second edge lies, 0 for none
    contrast: float  # level of the contact above the ground, that of a film between them left out
    overshoot: float  # how far the first fringe outside rises beyond the ground, over the height; 0 for none
    fringe: float  # how far outside the edge it lies
    begin: float  # how far inside it the fall from the contact's level begins, on average; 0 of a crest
    noise: float = 0.0  # standard deviation of the level around the contact, grey levels
    cut: bool = False  # whether the contact leaves the picture
    overlap: float = 1.0  # intersection over union of the contact and its ellipse
    bend: float = math.inf  # least curvature, times the radius, where a reflection may lie over the outline

    @property
    def radius(self) -> float:
        """Mean radius of the contact."""
        return math.sqrt(abs(signed_area(self.points)) / math.pi)

    @property
    def clearness(self) -> float:
        """Contrast over the spread of the ground that it must stand out from."""
        spread = self.noise * (SMOOTH.crest_contrast if self.ring else 1.0)
        return self.contrast / spread if spread else math.inf

    @property
    def scatter(self) -> float:
        """Robust standard deviation of the edge in profiles about the outline."""
        off = self.off[np.isfinite(self.off)]
        return robust_std(off - np.median(off)) if len(off) else math.inf

    @property
    def score(self) -> float:
        """How clear the step is, 0 to 1."""
        sharp = 1 / (1 + (self.width / (0.25 * self.radius)) ** 2)
        straight = 1 / (1 + (self.scatter / (0.03 * self.radius + 0.5)) ** 2)
        clear = self.height / (self.height + 2 * self.noise)
        return self.seen * sharp * straight * clear * self.overlap


def find_smooth(
    pixels: npt.ArrayLike, scale: Scale, **options: Unpack[ContactImageOptions]
) -> tuple[View, tuple[Region, Edge] | None, str | None]:
    """Find the contact in a picture without ridges: its view, region and edge, or why there is none."""
    for name in ("threshold", "ridge_period"):
        if options.get(name) is not None:
            raise ImageError(
                f"{name} tells ridges from valleys, and a smooth contact has none: leave it out, "
                "or say that the surface is ridged"
            )
    part, values, light = _parts(pixels, options)
    inside = np.ones(part.pixels.shape, dtype=bool) if part.inside is None else part.inside
    shown = inside & part.shown(part.pixels.shape)
    steps = find_steps(values, light, shown, dark=options.get("dark_on_light"))
    seed = options.get("seed")
    if seed is not None:
        place = (float(seed[1]) - part.corner[1], float(seed[0]) - part.corner[0])
        steps = [one for one in steps if cv2.pointPolygonTest(as_float32(one.points), place, False) >= 0]
    view = _view(part, values, inside, scale, steps[0] if steps else None)
    if not steps:
        if seed is not None:
            return view, None, f"no contact found at seed {seed}: give a (row, column) within the contact"
        return view, None, f"{_REFUSED}; none was found: {_way_out(pixels, options)}"
    best = steps[0]
    if problem := _problem(best, options.get("contrast")):
        return view, None, f"{problem}: {_way_out(pixels, options)}"
    edge = _edge(best, view, nested=_nested(best, values, light, shown))
    patch = filled_polygon(edge.points, view.inside.shape) > 0
    return view, (Region(patch=np.asarray(patch), several=_several(steps)), edge), None


def _parts(
    pixels: npt.ArrayLike, options: ContactImageOptions
) -> tuple[Crop, Float32Array, Float32Array | None]:
    """Return the part that is measured, its colours, and those of the background there."""
    background = options.get("background")
    limits: ContactImageOptions = {**options, "background": None}
    part = crop(pixels, may_have_colours=True, **limits)
    values = np.atleast_3d(as_float32(part.pixels))
    if np.ptp(values) < 1e-15:
        raise ImageError(f"no contact found: every pixel has the same level, {values.flat[0]:g}")
    if part.pixels.ndim == 3:
        part = part._replace(pixels=as_float32(part.pixels.mean(axis=2)))
    if background is None:
        return part, values, None
    light = crop(background, may_have_colours=True, **limits)
    if light.shape != part.shape:
        raise ImageError(f"background must have the picture's shape {part.shape}, found {light.shape}")
    return part, values, np.atleast_3d(as_float32(light.pixels))


def _problem(step: Step, contrast: float | None) -> str | None:
    """Return why a step is no contact's, None where it may be."""
    if contrast is not None and step.contrast < contrast / 2:
        return f"no contact found: contrast {step.contrast:.3g} is less than half of the given {contrast:.3g}"
    if step.clearness < SMOOTH.least_contrast:
        return (
            f"no contact found: contrast {step.contrast:.3g} against {step.noise:.3g} of the ground around it"
        )
    if step.score < (SMOOTH.least_score_cut if step.cut else SMOOTH.least_score):
        return (
            f"{_REFUSED}; the clearest patch shows its edge in {100 * step.seen:.0f} % of all directions, "
            f"{step.width:.3g} px wide at a radius of {step.radius:.3g} px"
        )
    return None


def _way_out(pixels: npt.ArrayLike, options: ContactImageOptions) -> str:
    """Return what helps where no contact is found."""
    background = options.get("background")
    if background is None:
        return "give background, the same view without a finger, or draw the contact"
    if np.ndim(pixels) != np.ndim(background):
        return "give picture and background both in colour, or both in grey: else no colours count"
    return "draw the contact, if there is one"


def _nested(step: Step, values: Float32Array, light: Float32Array | None, inside: BoolArray) -> bool:
    """Return whether another step lies inside: that of the contact in the body around it, or a bubble's."""
    if step.radius < _LEAST_AROUND_PX:
        return False
    centre = step.points.mean(axis=0)
    within = filled_polygon(centre + _WELL_INSIDE * (step.points - centre), inside.shape) > 0
    return any(
        (one.sign == step.sign or one.radius > _LARGE_BUBBLE * step.radius)
        and min(one.score, one.seen) > _NESTED_SCORE
        and one.height > _NESTED_HEIGHT * step.height
        for one in find_steps(values, light, inside & within, levels=(1.0,))
    )


def _several(steps: list[Step]) -> bool:
    """Return whether another step of some clarity lies round another patch."""
    best = steps[0]
    centre = best.points.mean(axis=0)
    return any(
        step.score > 0.7 * best.score
        and step.radius > 0.45 * best.radius
        and float(np.linalg.norm(step.points.mean(axis=0) - centre)) > best.radius
        for step in steps[1:]
    )


def _view(part: Crop, values: Float32Array, inside: BoolArray, scale: Scale, step: Step | None) -> View:
    shape = reduced_shape(part.pixels.shape, max(part.pixels.shape) / _COPY_SIDE)
    size = shape[::-1]
    dark = step is not None and step.sign < 0
    copy = as_float32(cv2.resize(as_float32(values.mean(axis=2)), size, interpolation=cv2.INTER_AREA))
    turned = -copy if dark else copy
    ground = np.full_like(copy, np.median(turned))
    in_copy = cv2.resize(inside.astype(np.uint8), size, interpolation=cv2.INTER_NEAREST) > 0
    rows, columns = (whole / own for whole, own in zip(part.pixels.shape, shape, strict=True))
    return View(
        part=part,
        scale=scale,
        ridge_period=math.nan,
        contact=as_float32(turned - ground),
        ground=ground,
        noise=0.0 if step is None else step.noise,
        contrast=0.0 if step is None else step.contrast,
        dark_on_light=dark,
        shown=part.shown(shape),
        inside=np.asarray(in_copy),
        period=max(_DRAWN_PX, _DRAWN_MM / scale.mm_per_px / math.sqrt(rows * columns)),
    )


def _edge(step: Step, view: View, *, nested: bool = False) -> Edge:
    """Return a step as the edge of a contact in the copy, moved to where the contact ends."""
    shift, shared, unclear = _beyond(step)
    doubts = {"low_contrast"} if step.clearness < SMOOTH.low_contrast else set()
    if step.cut or _cut_out(step, view.part.pixels):
        doubts.add("touches_border")
    elif step.seen < SMOOTH.least_seen or step.bend < SMOOTH.straight:
        doubts.add("edge_hidden")
    if nested or unclear or shared > SMOOTH.most_shared * step.radius:
        doubts.add("edge_unclear")
    points = step.points + outward_normals(step.points, 2) * shift
    corner = np.array(view.part.corner[::-1])
    rows, columns = view.contact.shape
    edge = even_edge(view.to_copy(points + corner).clip(-0.5, [columns - 0.5, rows - 0.5]), view)
    hidden = SMOOTH.cut if step.cut else SMOOTH.hidden * (1 - step.seen) ** 1.5
    reflected = SMOOTH.reflected * min(max(2 - step.bend / SMOOTH.straight, 0.0), 1.0)
    return replace(
        edge,
        offset_std=shared / view.step,
        varying_std=math.hypot(hidden, reflected) * step.radius / view.step,
        doubts=frozenset(doubts),
    )


def _cut_out(step: Step, pixels: npt.NDArray[np.number]) -> bool:
    """Return whether no noise lies around a step: what was cut out of a picture was put on an even ground."""
    centre = step.points.mean(axis=0)
    inner, outer = (
        filled_polygon(centre + size * (step.points - centre), pixels.shape) > 0 for size in _AROUND
    )
    levels = pixels[outer & ~inner]
    return bool(levels.size and np.ptp(levels) == 0 and levels[0] not in _CLIPPED)


def _beyond(step: Step) -> tuple[float, float, bool]:
    """Return how far out from a step the contact ends, its standard uncertainty, and whether that is unclear.

    Light passes gaps thinner than its wavelength and water fills those at the edge: the visible edge lies
    outside the contact.
    """
    terms = [SMOOTH.pixel, SMOOTH.by_width * step.width, SMOOTH.by_scatter * step.scatter]
    shift, unclear = 0.0, True
    if step.ring:
        # The slope of a gel is steepest at the edge, and its skin rounds that.
        shift = (-1 if step.narrow else 1) * SMOOTH.crest * step.width
        terms.append(SMOOTH.crest_std * step.width)
    elif step.overshoot > SMOOTH.least_overshoot:
        # Fringes tell the gap: a quarter of a wavelength at the first, a twelfth at half level. Blur takes
        # from their height, and moves the first one outward.
        fringe = step.fringe * step.overshoot / (step.overshoot + SMOOTH.fringe_blur)
        shift = -SMOOTH.fringe * fringe
        terms.append(SMOOTH.fringe_std * fringe)
    else:
        # A step wider than that of a sharp camera is one of blur, or of a film or thin gap that blur hides.
        wider = math.sqrt(max(step.width**2 - SMOOTH.sharp**2, 0.0))
        terms += [SMOOTH.second * step.second, SMOOTH.by_wider * wider]
        # Blur alone makes a symmetric step: where the fall begins farther inside, a film lies outside.
        film = SMOOTH.film * step.begin
        share = min(max((step.begin / step.width - SMOOTH.even_begin) / SMOOTH.film_begin, 0.0), 1.0)
        shift = -share * film
        terms += [SMOOTH.film_std * math.sqrt(share) * step.begin, math.sqrt(share * (1 - share)) * film]
        unclear = step.second > 0 or share > 0.5
    return shift, math.hypot(*terms), unclear


def find_steps(
    picture: npt.NDArray[np.number],
    background: npt.NDArray[np.number] | None,
    inside: BoolArray,
    *,
    dark: bool | None = None,
    levels: Sequence[float] = _LEVELS,
) -> list[Step]:
    """Return the steps found round patches, all or only dark or bright ones, the clearest first.

    An edge that only its colour shows is neither. Patches are sought at levels in parts of Otsu's.
    """
    steps: list[Step] = []
    for signal, sign in _signals(picture, background, inside):
        if dark is not None and sign == (1 if dark else -1):
            continue
        # Colour off the ground in any direction shows contacts of gels, and rounds all other edges.
        if max((step.score for step in steps), default=0.0) > (_VERY_CLEAR if sign else _CLEAR):
            break
        for patch, factor in _patches(signal, inside, levels):
            contour = longest_contour(patch).reshape(-1, 2).astype(np.float64)
            step = _refined((contour + 0.5) * factor - 0.5, signal, inside, sign)
            if step is not None:
                # The frame cuts a contact whose outline reaches it, or hides where its patch does.
                reach = np.array(signal.shape[::-1]) - 2.5
                at_frame = bool(((step.points < 1.5) | (step.points > reach)).any())
                beside = int(np.count_nonzero(patch)) - int(np.count_nonzero(patch[1:-1, 1:-1])) > 3
                steps.append(replace(step, cut=at_frame or (step.seen < _SEEN and beside)))
                if step.score > _VERY_CLEAR:
                    break
    return sorted(steps, key=lambda step: -step.score)


def _signals(
    picture: npt.NDArray[np.number], background: npt.NDArray[np.number] | None, inside: BoolArray
) -> Iterator[tuple[Float32Array, int]]:
    """Yield how far a picture lies above and below its ground, and how far off in any way."""
    values = np.atleast_3d(as_float32(picture))
    if background is not None:
        light = np.atleast_3d(as_float32(background))
        if light.shape[2] != values.shape[2]:
            values, light = (each.mean(axis=2, keepdims=True) for each in (values, light))
        rim = _rim(inside)
        some = min(1.0, float(light.max()) / 100)  # keeps the dark from being divided by; levels may end at 1
        gain = np.median((values[rim].mean(axis=1) + some) / (light[rim].mean(axis=1) + some))
        ground = gain * (light + some) - some
    else:
        ground = np.stack([_even_ground(values[..., k], inside) for k in range(values.shape[2])], axis=-1)
    off = values - ground
    off -= np.median(off[_rim(inside)], axis=0)
    off[~inside] = 0
    small = cv2.resize(off, None, fx=0.25, fy=0.25, interpolation=cv2.INTER_AREA).reshape(-1, off.shape[2])
    _, ways = np.linalg.eigh(small.T @ small)
    way = ways[:, -1] * (1 if ways[:, -1].sum() >= 0 else -1)
    level = as_float32(off @ way)
    yield level, 1
    yield as_float32(-level), -1
    soft = np.atleast_3d(cv2.GaussianBlur(off, (0, 0), 1.5))
    yield as_float32(np.sqrt((soft**2).sum(axis=2))), 0


def _rim(inside: BoolArray) -> BoolArray:
    """Return where a picture has its rim, which a contact seldom fills."""
    rows, columns = inside.shape
    rim = inside.copy()
    margin = max(2, round(0.1 * min(rows, columns)))
    rim[margin:-margin, margin:-margin] = False
    return rim if rim.any() else inside


def _even_ground(values: Float32Array, inside: BoolArray) -> Float32Array:
    """Return a smooth surface of second degree through most of a picture."""
    rows, columns = values.shape
    some = np.zeros_like(inside)
    some[:: max(1, rows // 80), :: max(1, columns // 80)] = True
    row, column = np.nonzero(some & inside)
    base = quadratic_terms(np.linspace(-1, 1, columns)[column], np.linspace(-1, 1, rows)[row])
    level, rim = values[row, column], _rim(inside)[row, column]
    weight = np.where(rim.any(), rim, True).astype(np.float64)  # of a mask few places may be at the rim
    for _ in range(12):
        weighted = base.T * weight**2
        found = as_float_array(np.linalg.lstsq(weighted @ base, weighted @ level, rcond=None)[0])
        rest = level - base @ found
        spread = robust_std(rest[weight > 0.1]) + 1e-6
        weight = np.where(rim, 1.0, 0.5) / (1 + (rest / (2 * spread)) ** 2)
    return as_float32(quadratic_surface(found, values.shape))


def _patches(
    signal: Float32Array, inside: BoolArray, levels: Sequence[float]
) -> Iterator[tuple[BoolArray, FloatArray]]:
    """Yield compact patches of a reduced copy above several levels, and the picture's pixels in one of it."""
    rows, columns = signal.shape
    shape = reduced_shape(signal.shape, max(rows, columns) / _ROUGH_SIDE)
    small = cv2.resize(signal, shape[::-1], interpolation=cv2.INTER_AREA)
    small = cv2.GaussianBlur(small, (0, 0), _ROUGH_BLUR)
    counts = cv2.resize(inside.astype(np.uint8), shape[::-1], interpolation=cv2.INTER_NEAREST) > 0
    low, high = np.percentile(small[counts], (2, 99.5))
    if not high > low:
        return
    scaled = ((small - low) / (high - low) * 255).clip(0, 255).astype(np.uint8)
    otsu, _ = cv2.threshold(scaled[counts].reshape(-1, 1), 0, 255, cv2.THRESH_BINARY | cv2.THRESH_OTSU)
    factor = np.array([columns / shape[1], rows / shape[0]])
    seen: list[BoolArray] = []
    for part in levels:
        patch = _compact((scaled > part * otsu) & counts)
        if patch is None or any(np.array_equal(patch, other) for other in seen):
            continue
        seen.append(patch)
        yield patch, factor


def _compact(mask: BoolArray) -> BoolArray | None:
    """Return the largest compact piece of a mask, without holes, None where there is none of some size."""
    closed = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_CLOSE, disk(3)) > 0
    filled = fill_holes(closed)
    pad = 40
    wide = np.pad(filled, pad, mode="edge")
    within = distance_to(~np.pad(filled, 1))[1:-1, 1:-1]
    _, labels = cv2.connectedComponents(filled.astype(np.uint8))
    radius = max(2.0, min(pad - 2.0, _APPENDAGE * float(within.max())))
    part = np.pad(np.asarray(labels == labels.flat[within.argmax()]), pad, mode="edge") & wide
    opened = cv2.morphologyEx(part.astype(np.uint8), cv2.MORPH_OPEN, disk(radius))[pad:-pad, pad:-pad] > 0
    patch = largest_piece(opened)
    return patch if _LEAST_AREA < np.count_nonzero(patch) / mask.size < _MOST_AREA else None


def _refined(contour: FloatArray, signal: Float32Array, inside: BoolArray, sign: int) -> Step | None:
    """Move a rough outline to the step of a signal."""
    moments = polygon_moments(contour)
    (row, column), (major, minor) = moments.ellipse.centre, moments.semi_axes
    if not minor > 3:
        return None
    t = np.linspace(0, 2 * math.pi, 720, endpoint=False)
    rough = (column, row) + np.stack([np.cos(t) * major, np.sin(t) * minor], axis=1) @ moments.axes
    points = evenly_spaced(rough, math.inf, min_count=_DIRECTIONS)
    seen = np.where(inside, signal, np.float32(np.nan))
    for reach, order in zip(_REACHES, _ORDERS, strict=True):
        step = _step_across(points, seen, sign, reach)
        if step is None:
            return None
        shift = _low_order(step.off, order, step.radius)
        if shift is None:
            return None
        limit = 0.5 * reach * step.radius
        moved = points + outward_normals(points) * shift.clip(-limit, limit)[:, None]
        points = evenly_spaced(moved, math.inf, min_count=_DIRECTIONS)
        if not abs(signed_area(points)) > 20:
            return None
    moments = polygon_moments(points)
    if not moments.spread[1] > 0:  # an outline that crosses itself
        return None
    step = _step_across(points, seen, sign, _REACHES[-1])
    return step and replace(
        step,
        overlap=moments.overlap(points),
        noise=_ground_spread(step, signal, inside),
        bend=_reflected_bend(step, seen),
    )


def _low_order(off: FloatArray, order: int, radius: float) -> FloatArray | None:
    """Return a robust sum of waves round the outline, up to an order, through what is seen of it."""
    good = np.isfinite(off)
    if np.count_nonzero(good) < 0.25 * len(off):
        return None
    t = 2 * math.pi * np.arange(len(off)) / len(off)
    waves = [np.ones_like(t)] + [each(k * t) for k in range(1, order + 1) for each in (np.cos, np.sin)]
    base = np.stack(waves, axis=1)
    number = (np.arange(base.shape[1]) + 1) // 2
    stiff = np.diag(_STIFF * len(off) * number**4 + 1e-6)
    values, weight = np.where(good, off, 0.0), good.astype(np.float64)
    shift = np.full(len(off), np.median(off[good]))
    for _ in range(15):
        rest = values - shift
        spread = robust_std(rest[good]) + 0.05 + _DENT / 4 * radius
        weight = good * np.maximum(0.0, 1 - (rest / (4 * spread)) ** 2) ** 2
        normal = base.T @ (base * weight[:, None]) + stiff
        before, shift = shift, base @ np.linalg.solve(normal, base.T @ (weight * values))
        if np.abs(shift - before).max() < _SETTLED:
            break
    return np.asarray(shift)


def _step_across(points: FloatArray, signal: Float32Array, sign: int, reach: float) -> Step | None:
    """Return the step along an outline as profiles across it show it; the signal is NaN where nothing is."""
    radius = math.sqrt(abs(signed_area(points)) / math.pi)
    far = max(6.0, reach * radius)
    spacing = max(0.5, far / 200)
    across = np.arange(-far, far + spacing / 2, spacing)
    levels = profiles(signal, points, outward_normals(points), across, math.nan).T  # a row for each point
    seen = np.isfinite(levels).mean(axis=0) > 0.3
    if not seen.all():
        across, levels = across[seen], levels[:, seen]
    if len(across) < 12:
        return None
    typical = _nanmedian(levels, axis=0)
    sigma = max(0.7, 0.6 / spacing)
    smooth = gaussian_filter1d(typical, sigma, mode="nearest", radius=math.ceil(3 * sigma))
    place, width, others, ring = _edge_of(smooth, across, sign)
    if place is None or (sign == 0 and not ring):
        return None
    near = _near(width, radius)
    inner = (across < place - near) & (across > place - near - max(4.0, 0.12 * radius))
    outer = (across > place + near) & (across < place + near + max(4.0, 0.12 * radius))
    if (inner.sum() < 3 and not ring) or outer.sum() < 3:
        return None
    top = float(np.median(smooth[inner])) if inner.any() else math.nan  # of a ring no plateau is seen
    ground = float(np.median(smooth[len(smooth) - int(outer.sum()) :]))
    # The first fringe lies where the profile is first least beyond the edge.
    beyond = smooth[across > place]
    first = int(np.append(np.flatnonzero(np.diff(beyond) > 0), len(beyond) - 1)[0])
    overshoot = max(0.0, (ground - float(beyond[first])) / max(top - ground, 1e-9))
    fringe = (first + 1) * spacing
    # The fall to a fringe begins at the edge: what lies far beyond a narrow step is the rim of a film.
    if width < SMOOTH.rim * fringe:
        overshoot = 0.0
    second = 0.0 if overshoot > SMOOTH.least_overshoot else min(others, default=place) - place
    between = np.abs(across - place - second / 2) <= second / 4
    if between.sum() > 2:  # the contact ends half-way to the level between two edges
        outer = between
    # Medians over nine neighbours along the outline.
    high, low = (
        _nanmedian(
            sliding_window_view(np.pad(_nanmedian(levels[:, band], axis=1), 4, mode="wrap"), 9), axis=1
        )
        for band in (inner, outer)
    )
    # Along each profile only.
    blur = max(0.5, 0.25 * width / spacing)
    blurred = as_float32(cv2.GaussianBlur(as_float32(np.nan_to_num(levels)), (0, 0), blur, sigmaY=1e-3))
    search = max(3.0, min(0.5 * far, 2.5 * width), _SEARCH * reach * radius)
    if ring:
        search = min(max(search, 0.1 * radius), 0.5 * far)
        off, height = _crests(blurred, across, place, search, low)
    else:
        off, height = _crossings(blurred, across, place, search, (high + low) / 2), high - low
    typical_height = float(np.nanmedian(height))
    if not typical_height > 0:
        return None
    off = np.where(np.isfinite(levels).mean(axis=1) > 0.7, off, np.nan)
    off = np.where(height > 0.35 * typical_height, off, np.nan)
    fall = max(top - float(np.median(smooth[outer])), 1e-9)
    before = smooth[(across < place) & (across > place - 3 * near)]
    begin = 0.0 if ring else 2 * spacing * float(((top - before) / fall).clip(0, 1).sum())
    floor = smooth[(across < place) & (across > place - 0.2 * radius)].min(initial=math.inf)
    narrow = ring and bool(floor < 0.5 * smooth[np.abs(across - place).argmin()])
    return Step(
        points=points,
        off=off,
        seen=float(np.isfinite(off).mean()),
        height=typical_height,
        width=width,
        sign=sign,
        ring=ring,
        narrow=narrow,
        second=second,
        contrast=max(typical_height, top - ground) if second > 0 else typical_height,
        overshoot=overshoot,
        fringe=fringe,
        begin=begin,
    )


def _reflected_bend(step: Step, signal: Float32Array) -> float:
    """Return how little the outline bends where a reflection may lie over the edge, times the radius.

    There the picture steps once more beyond it. An outline that follows the side of a reflection in place of
    the edge is straight or has a dent.
    """
    out = step.radius * np.linspace(*_BEYOND, 40)
    levels = profiles(signal, step.points, outward_normals(step.points), out, math.nan)
    spread = np.subtract(*np.percentile(levels, (95, 5), axis=0))  # NaN where the picture ends
    if not np.isfinite(spread).any():
        return math.inf
    reflected = spread > np.nanmedian(spread) + SMOOTH.beyond * step.height
    before, after = step.points - shifted(step.points, -_CHORD), shifted(step.points, _CHORD) - step.points
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    bend = cross * step.radius / np.linalg.norm(before, axis=1) ** 3
    bend = math.copysign(1.0, signed_area(step.points)) * bend
    return float(bend[reflected].min(initial=math.inf))


def _near(width: float, radius: float) -> float:
    """Return how far from an edge of a width the level is that of what lies there."""
    return min(1.2 * width + 0.5, 0.15 * radius)


def _ground_spread(step: Step, signal: Float32Array, inside: BoolArray) -> float:
    """Return the robust standard deviation of a signal outside a step."""
    every = max(2, round(max(signal.shape) / _ROUGH_SIDE))
    rows, columns = signal.shape[0] // every, signal.shape[1] // every
    whole = np.s_[: rows * every, : columns * every]
    small = cv2.resize(signal[whole], (columns, rows), interpolation=cv2.INTER_AREA)
    counts = cv2.resize(inside[whole].astype(np.uint8), (columns, rows), interpolation=cv2.INTER_NEAREST)
    far = step.second + _near(step.width, step.radius)
    centre, larger = step.points.mean(axis=0), 1 + far / step.radius
    wide = (centre + (step.points - centre) * larger + 0.5) / every - 0.5
    ground = small[(filled_polygon(wide, small.shape) == 0) & (counts > 0)]
    if len(ground) < 20:
        return 0.0
    return float(np.subtract(*np.percentile(ground, (84, 16)))) / 2


def _nanmedian(values: npt.NDArray[np.floating], axis: int) -> FloatArray:
    """Return medians along an axis, NaN where there is nothing; NumPy's take ten times as long."""
    if not values.size:
        return np.full(np.delete(values.shape, axis), np.nan)
    ordered = np.sort(values, axis=axis)  # NaN last
    last = np.maximum(np.isfinite(values).sum(axis=axis, keepdims=True) - 1, 0)
    low, high = (np.take_along_axis(ordered, place, axis) for place in (last // 2, (last + 1) // 2))
    return as_float_array((low + high) / 2).squeeze(axis)


def _edge_of(
    profile: FloatArray, across: FloatArray, sign: int
) -> tuple[float | None, float, list[float], bool]:
    """Return the place of the main edge of a profile that falls outward, its width, and other edges."""
    spacing = float(across[1] - across[0])
    slope = -np.gradient(profile, spacing)
    if sign == 0:
        found = _crest_of(profile, across)
        if found is not None:
            return (*found, [], True)
    rises, falls = slope[1:-1] >= slope[:-2], slope[1:-1] > slope[2:]
    peaks = (np.flatnonzero(rises & falls & (slope[1:-1] > 0)) + 1).tolist()
    if not peaks:
        return None, 0.0, [], False
    best = max(peaks, key=lambda k: slope[k])
    strong = [k for k in peaks if slope[k] > _LEAST_SECOND * slope[best]]
    width = _width_at(slope, best) * spacing
    least = _LEAST_SECOND * _drop(profile, slope, best)
    edges = [best]
    for k in strong:
        low, high = sorted((k, best))
        # Between two edges lies a level stretch.
        level = slope[low : high + 1].min() < 0.4 * slope[k]
        if level and across[high] - across[low] > 1.2 * width and _drop(profile, slope, k) > least:
            edges.append(k)
    chosen = min(edges)
    rest = [float(across[k]) for k in edges if k != chosen]
    return float(across[chosen]), _width_at(slope, chosen) * spacing, rest, False


def _drop(profile: FloatArray, slope: FloatArray, k: int) -> float:
    """Return by how much a profile falls across a peak of its slope."""
    reach = round(_width_at(slope, k))
    return float(profile[max(0, k - reach)] - profile[min(len(profile) - 1, k + reach)])


def _crest_of(profile: FloatArray, across: FloatArray) -> tuple[float, float] | None:
    """Return the place and the width of a crest that is lower on both sides, None where there is none."""
    k = int(profile.argmax())
    if not 2 < k < len(profile) - 3:
        return None
    inner, outer = float(profile[:k].min()), float(profile[k:].min())
    top = float(profile[k])
    if not top - inner > 0.25 * (top - outer):
        return None
    spacing = float(across[1] - across[0])
    lower, centre, upper = profile[k - 1 : k + 2]
    shift = 0.5 * (lower - upper) / min(lower - 2 * centre + upper, -1e-12)
    # The outer flank tells how sharp it is.
    slope = -np.gradient(profile, spacing)
    flank = k + int(slope[k : k + max(3, len(slope) // 4)].argmax())
    return float(across[k] + shift * spacing), float(2 * (across[flank] - across[k]) + spacing)


def _width_at(values: FloatArray, k: int) -> float:
    """Return the full width of a peak at half of its height, in samples."""
    less = np.flatnonzero(values <= values[k] / 2)
    low, high = less[less < k].max(initial=0), less[less > k].min(initial=len(values) - 1)
    return max(1.0, float(high - low - 1))


def _crossings(
    profiles: npt.NDArray[np.floating], across: FloatArray, place: float, search: float, level: FloatArray
) -> FloatArray:
    """Return where each profile falls through its level nearest to a place, NaN where it does not."""
    above = profiles - level[:, None]
    falls = (above[:, :-1] > 0) & (above[:, 1:] <= 0)
    middle = (across[:-1] + across[1:]) / 2
    distance = np.where(falls, np.abs(middle - place), np.inf)
    k = distance.argmin(axis=1)
    row = np.arange(len(profiles))
    first, second = above[row, k], above[row, k + 1]
    share = first / np.where(first > second, first - second, 1.0)
    found = across[k] + share * (across[1] - across[0])
    return np.where(distance[row, k] < search, found, np.nan)


def _crests(
    profiles: npt.NDArray[np.floating], across: FloatArray, place: float, search: float, low: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return where each profile is highest near a place, and how high."""
    near = np.abs(across - place) < search
    band, where = profiles[:, near], across[near]
    k = band.argmax(axis=1)
    row = np.arange(len(band))
    edge = (k == 0) | (k == len(where) - 1)
    k = k.clip(1, len(where) - 2)
    lower, centre, upper = band[row, k - 1], band[row, k], band[row, k + 1]
    shift = 0.5 * (lower - upper) / np.minimum(lower - 2 * centre + upper, -1e-12)
    found = where[k] + shift.clip(-1, 1) * (across[1] - across[0])
    return np.where(edge, np.nan, found), centre - low
