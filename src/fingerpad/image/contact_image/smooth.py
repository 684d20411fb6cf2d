"""Measure a contact without ridges: that of a silicone fingertip, of a gel, or a print that water fills.

Of the five steps of measure.py these contacts share the type of the results and what a person draws. Their
edge (smooth_edge.py) is where the picture steps half-way from the contact to what lies around it.
"""

import math
from dataclasses import replace
from typing import Final, Unpack

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, Float32Array, as_float32
from fingerpad.exceptions import ImageError
from fingerpad.image._masks import filled_polygon
from fingerpad.image.contact_image.calibration import SMOOTH
from fingerpad.image.contact_image.edge import Edge, even_edge
from fingerpad.image.contact_image.region import Region
from fingerpad.image.contact_image.smooth_edge import Step, find_steps
from fingerpad.image.contact_image.view import ContactImageOptions, Crop, View, crop, reduced_shape
from fingerpad.image.ellipse import outward_normals
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
    inside = np.ones(values.shape[:2], dtype=bool) if part.inside is None else part.inside
    steps = find_steps(values, light, inside, dark=options.get("dark_on_light"))
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
    edge = _edge(best, view, nested=_nested(best, values, light, inside))
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
    if step.contrast < SMOOTH.least_contrast * _ground(step):
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


def _ground(step: Step) -> float:
    """Return the spread of the ground that a step must stand out from."""
    return step.noise * (SMOOTH.crest_contrast if step.ring else 1.0)


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
    doubts = {"low_contrast"} if step.contrast < SMOOTH.low_contrast * _ground(step) else set()
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
