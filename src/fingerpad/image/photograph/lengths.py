"""Semi-axes as lengths of the outline itself: a second way to them, which supposes no ellipse."""

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array
from fingerpad.image.photograph.calibration import DOUBT
from fingerpad.image.photograph.faces import Face
from fingerpad.image.photograph.result import PhotographFit

# Half of the window about a place where the outline turns back, in radii of curvature; how much of it must be
# seen on either side.
_WINDOW: Final = 0.35
_SHARE: Final = 0.6
_MIN_POINTS: Final = 12
_ROUNDS: Final = 8
# Shares of half of the width at which the height of the tip is read where the shaft hides the widest place.
_WIDTHS: Final = (0.95, 0.97, 0.98)


def with_lengths(
    found: PhotographFit, outline: FloatArray, tilt: tuple[float, float], *, ellipse: float = 1.0
) -> PhotographFit:
    """Return a measured face whose uncertainty allows for the lengths that its outline has.

    The ellipse follows an arc. Where the outline beyond it reaches farther than the ellipse goes on, or less
    far, nothing tells which of the two is the pad: the semi-axes stay, and are as uncertain as that. Where
    the ellipse is tilted otherwise than the finger, another curve was taken for a turned ellipse: its axis is
    uncertain by that turn, and its semi-axes by about as many radians.

    Parameters
    ----------
    found : PhotographFit
        The face.
    outline : ndarray, (n, 2)
        Points of the outline, (row, column), px, in order; of a palmar face with the shaft.
    tilt : (float, float)
        Tilt of the finger's axis and its standard uncertainty, radians.
    ellipse : float
        Probability that the pad's arc is one of an ellipse.

    Returns
    -------
    PhotographFit
        With the term ``lengths`` in its covariance.
    """
    points = (outline - found.centre) @ found.directions.T * found.scale.mm_per_px
    if len(points) < _MIN_POINTS:
        return found
    across, along = found.semi_axes
    if found.face in ("radial", "ulnar"):
        lengths = _side_lengths(points, across, along)
        axis = math.hypot(found.tilt_std, DOUBT.side_axis_std)
        stds = np.hypot(DOUBT.side_std, np.array([across / along, along / across]) * axis)
    else:
        pad = (found.outline - found.centre) @ found.directions.T * found.scale.mm_per_px
        width = half_width(points, pad, across, along, found.face)
        lengths = _front_lengths(points, across, along, width)
        shaft = (1 + (DOUBT.hidden - 1) * ellipse) * width.hidden / across
        stds = np.hypot(DOUBT.front_std, np.array([1, DOUBT.height_by_width]) * shaft)
    off = np.nan_to_num(lengths / found.semi_axes - 1)
    beyond = _beyond(off, stds)
    turn = (
        0.0 if found.face == "distal" else float(_beyond(found.tilt - tilt[0], DOUBT.of_tilt_std * tilt[1]))
    )
    added, turned = DOUBT.added * beyond * found.semi_axes, DOUBT.added * turn * found.semi_axes
    term = np.outer(added, added) + np.outer(turned, turned)
    return replace(
        found,
        tilt_std=math.hypot(found.tilt_std, DOUBT.added * turn),
        covariance_terms={**found.covariance_terms, "lengths": term},
    )


def lengths_contradict(found: PhotographFit) -> bool:
    """Return whether the outline's lengths or the finger's axis show that the outline is no ellipse."""
    term = found.covariance_terms.get("lengths")
    if term is None:
        return False
    added = float((np.sqrt(np.diagonal(term)) / found.semi_axes).max())
    return added > DOUBT.added * DOUBT.no_ellipse


def _beyond(off: ArrayLike, std: ArrayLike) -> FloatArray:
    """Return what chance does not explain of a difference: all of a large one, little of a small one."""
    off, std = as_float_array(off), as_float_array(std)
    return np.asarray(off**3 / (off**2 + std**2))


@dataclass(frozen=True, slots=True, kw_only=True)
class HalfWidth:
    """Half of an outline's width at the pad's widest place.

    Attributes
    ----------
    value : float
        The length.
    hidden : float
        How much of it is not seen, for the shaft that is wider or because the outline ends above.
    middle : float
        x of the place midway between the sides.
    """

    value: float
    hidden: float
    middle: float


def half_width(points: FloatArray, pad: FloatArray, across: float, along: float, face: Face) -> HalfWidth:
    """Return half of an outline's width.

    Of a palmar face the widest place lies at the ellipse's centre or above: below, the shaft may be wider
    than the pad. How much wider it is beyond what is common, is the pad's.

    Parameters
    ----------
    points : ndarray, (n, 2)
        Points (x, y) of the outline about the ellipse's centre, in order, along the finger's axis.
    pad : ndarray, (n, 2)
        Those that can be pad.
    across, along : float
        Semi-axes of the ellipse.
    face : {"palmar", "distal"}
        The face.
    """
    top = int(points[:, 1].argmax())
    way = math.copysign(1, points[-1, 0] - points[0, 0])
    ends, hidden = [], 0.0
    for sign, side in ((way, slice(top, None)), (-way, slice(top, None, -1))):
        x, y = sign * points[side, 0], np.minimum.accumulate(points[side, 1])
        short = min(max(float(y[-1]) / along, 0.0), 1.0)
        missing = across * (1 - math.sqrt(1 - short**2))
        widest = np.maximum.accumulate(x)
        shown = float(np.interp(0.0, -y, widest) if face == "palmar" else widest[-1])
        ends.append(sign * (shown + missing))
        hidden += missing / 2
    value = abs(ends[0] - ends[1]) / 2
    more = max(float(np.ptp(pad[:, 0])) / 2 - value, 0.0) if face == "palmar" and len(pad) else 0.0
    more_pad = float(_beyond(more, DOUBT.shaft * across))
    return HalfWidth(value=value + more_pad, hidden=hidden + more - more_pad, middle=sum(ends) / 2)


def _side_lengths(points: FloatArray, across: float, along: float) -> FloatArray:
    """Return how far the palmar side lies from the tip, and the tip from the palmar side."""
    tip_x, tip_y = _turning_point(points, across**2 / along)
    side_y, side_x = _turning_point(points[:, ::-1], along**2 / across)
    return np.array([side_x - tip_x, tip_y - side_y])


def _front_lengths(points: FloatArray, across: float, along: float, width: HalfWidth) -> FloatArray:
    """Return half of the width and the height of the tip above the widest place.

    The shaft hides that place: its height is that of an ellipse through the places of nearly that width.
    """
    tip_y = _turning_point(points, across**2 / along)[1]
    x = points[:, 0] - width.middle
    top = int(points[:, 1].argmax())
    heights = []
    for side in (slice(top, None), slice(top, None, -1)):
        out, y = np.maximum.accumulate(np.abs(x[side])), points[side, 1]
        for share in _WIDTHS:
            at = float(np.interp(share * width.value, out, y))
            heights.append((tip_y - at) / (1 - math.sqrt(1 - share**2)))
    return np.array([width.value, np.mean(heights)])


def _turning_point(points: FloatArray, radius: float) -> tuple[float, float]:
    """Return x and y of the place where y is greatest, NaN where the outline does not show it."""
    x, y = points.T
    place, half = float(x[y.argmax()]), _WINDOW * radius
    for _ in range(_ROUNDS):
        near = (np.abs(x - place) < half) & (y > y.max() - half)
        s = (x[near] - place) / half
        if near.sum() < _MIN_POINTS or s.min() > -_SHARE or s.max() < _SHARE:
            return math.nan, math.nan
        curve = np.polynomial.Polynomial.fit(s, y[near], 3, domain=[-1, 1])
        slope, bend = float(curve.deriv(1)(0)), float(curve.deriv(2)(0))
        if not bend < 0:
            return math.nan, math.nan
        step = float(np.clip(-slope / bend, -0.4, 0.4))
        place += step * half
        if abs(step) < 0.01:
            break
    return place, float(curve(step))
