"""Semi-axes as lengths of the outline itself: a second way to them, which supposes no ellipse."""

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.image.photograph.result import PhotographFit

# Half of the window about a place where the outline turns back, in radii of curvature; how much of it must be
# seen on either side.
_WINDOW: Final = 0.35
_SHARE: Final = 0.6
_MIN_POINTS: Final = 12
_ROUNDS: Final = 8
# Shares of half of the width at which the height of the tip is read where the shaft hides the widest place.
_WIDTHS: Final = (0.95, 0.97, 0.98)
# What lengths are off relatively on an ellipse, across and along, in a side face and in others; and what the
# finger's axis is off in a side face beyond the ellipse's own: benchmarks/finger_shapes.py and fingertips.py.
_SIDE_STD: Final = (0.015, 0.02)
_FRONT_STD: Final = (0.015, 0.03)
_AXIS_STD: Final = math.radians(1.0)
# A height read where the outline has nearly half of its width is off by so many times what that width is off.
_HEIGHT_BY_WIDTH: Final = 5.0
# The share of the difference that is added to the uncertainty. Turns by so many standard uncertainties of the
# finger's axis are common.
_ADDED: Final = 0.6
_OF_TILT_STD: Final = 0.5
# A difference so large shows that the outline is no ellipse.
_NO_ELLIPSE: Final = 0.04


def with_lengths(found: PhotographFit, tilt: tuple[float, float]) -> PhotographFit:
    """Return a measured face whose uncertainty allows for the lengths that its outline has.

    The ellipse follows an arc. Where the outline beyond it reaches farther than the ellipse goes on, or less
    far, nothing tells which of the two is the pad: the semi-axes stay, and are as uncertain as that. Where
    the ellipse is tilted otherwise than the finger, another curve was taken for a turned ellipse: its axis is
    uncertain by that turn, and its semi-axes by about as many radians.

    Parameters
    ----------
    found : PhotographFit
        With its outline.
    tilt : (float, float)
        Tilt of the finger's axis and its standard uncertainty, radians.

    Returns
    -------
    PhotographFit
        With the term ``lengths`` in its covariance.
    """
    points = (found.outline - found.centre) @ found.directions.T * found.scale.mm_per_px
    if len(points) < _MIN_POINTS:
        return found
    across, along = found.semi_axes
    if found.face in ("radial", "ulnar"):
        lengths = _side_lengths(points, across, along)
        axis = math.hypot(found.tilt_std, _AXIS_STD)
        stds = np.hypot(_SIDE_STD, np.array([across / along, along / across]) * axis)
    else:
        lengths, hidden = _front_lengths(points, across, along, shaft=found.face == "palmar")
        stds = np.hypot(_FRONT_STD, np.array([1, _HEIGHT_BY_WIDTH]) * hidden / across)
    off = np.nan_to_num(lengths / found.semi_axes - 1)
    beyond = np.sign(off) * np.sqrt(np.maximum(off**2 - stds**2, 0))
    turn = found.tilt - tilt[0] if found.face != "distal" else 0.0
    turn = math.sqrt(max(turn**2 - (_OF_TILT_STD * tilt[1]) ** 2, 0.0))
    added, turned = _ADDED * beyond * found.semi_axes, _ADDED * turn * found.semi_axes
    term = np.outer(added, added) + np.outer(turned, turned)
    return replace(
        found,
        tilt_std=math.hypot(found.tilt_std, _ADDED * turn),
        covariance_terms={**found.covariance_terms, "lengths": term},
    )


def lengths_contradict(found: PhotographFit) -> bool:
    """Return whether the outline's lengths or the finger's axis show that the outline is no ellipse."""
    term = found.covariance_terms.get("lengths")
    if term is None:
        return False
    return float((np.sqrt(np.diagonal(term)) / found.semi_axes).max()) > _ADDED * _NO_ELLIPSE


@dataclass(frozen=True, slots=True, kw_only=True)
class HalfWidths:
    """Half of an outline's width, beside an ellipse.

    Attributes
    ----------
    at_centre : float
        At the level of the ellipse's centre.
    greatest : float
        At the widest place seen. A shaft can be wider than the pad.
    unseen : float
        How much of that at the centre is the ellipse's, where the outline ends above.
    sides : (float, float)
        x of both sides at the centre.
    """

    at_centre: float
    greatest: float
    unseen: float
    sides: tuple[float, float]


def half_widths(points: FloatArray, across: float, along: float) -> HalfWidths:
    """Return half of an outline's width.

    Parameters
    ----------
    points : ndarray, (n, 2)
        Points (x, y) of the outline about the ellipse's centre, in order, along the finger's axis.
    across, along : float
        Semi-axes of the ellipse.
    """
    top = int(points[:, 1].argmax())
    ends, unseen = [], 0.0
    for side in (slice(top, None), slice(top, None, -1)):
        x, y = points[side, 0], np.minimum.accumulate(points[side, 1])
        short = min(max(float(y[-1]) / along, 0.0), 1.0)
        missing = across * (1 - math.sqrt(1 - short**2))
        at = float(np.interp(0.0, -y, x))
        ends.append(at + math.copysign(missing, at))
        unseen += missing / 2
    right, left = ends
    return HalfWidths(
        at_centre=abs(right - left) / 2,
        greatest=float(np.ptp(points[:, 0])) / 2,
        unseen=unseen,
        sides=(right, left),
    )


def _side_lengths(points: FloatArray, across: float, along: float) -> FloatArray:
    """Return how far the palmar side lies from the tip, and the tip from the palmar side."""
    tip_x, tip_y = _turning_point(points, across**2 / along)
    side_y, side_x = _turning_point(points[:, ::-1], along**2 / across)
    return np.array([side_x - tip_x, tip_y - side_y])


def _front_lengths(
    points: FloatArray, across: float, along: float, *, shaft: bool
) -> tuple[FloatArray, float]:
    """Return half of the width and the height of the tip above the widest place, and what hides of the width.

    The shaft hides that place: its height is that of an ellipse through the places of nearly that width. How
    much wider the shaft is than the outline at the ellipse's centre, nothing tells whether it is pad.
    """
    tip_y = _turning_point(points, across**2 / along)[1]
    widths = half_widths(points, across, along)
    at_centre = shaft or widths.unseen > 0
    half_width = widths.at_centre if at_centre else widths.greatest
    ends = widths.sides if at_centre else (points[:, 0].max(), points[:, 0].min())
    x = points[:, 0] - sum(ends) / 2
    top = int(points[:, 1].argmax())
    heights = []
    for side in (slice(top, None), slice(top, None, -1)):
        out, y = np.maximum.accumulate(np.abs(x[side])), points[side, 1]
        for share in _WIDTHS:
            at = float(np.interp(share * half_width, out, y))
            heights.append((tip_y - at) / (1 - math.sqrt(1 - share**2)))
    hidden = max(widths.greatest - half_width, 0.0) + widths.unseen
    return np.array([half_width, np.mean(heights)]), hidden


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
