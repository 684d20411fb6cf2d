"""The finger's own axis, from the sides of its outline."""

import math

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.image.photograph.orientation import Face

# From the tip in widths: where the sides begin to run along the finger.
_SIDES_FROM = {"palmar": 1.15, "radial": 2.1, "ulnar": 2.1}
_MIN_LENGTH = 0.35
# How far the middle line of the sides can be off the ellipse's axis: a finger tapers unevenly.
_AXIS_STD = {"palmar": math.radians(1.5), "radial": math.radians(3.0), "ulnar": math.radians(3.0)}
# A finger held upright by eye.
_UPRIGHT_STD = math.radians(5.0)
_MAX_TILT = math.radians(35)


def finger_tilt(points: FloatArray, face: Face) -> tuple[float, float]:
    """Return the tilt of the finger from x towards y, and its standard uncertainty, radians.

    The middle line between the two sides below the pad, where they show; upright within 5 degrees where
    they do not, as when the finger is seen end on.

    Parameters
    ----------
    points : ndarray, (n, 2)
        Outline in the face's frame, px, in order.
    face : Face
        The face.
    """
    if face == "distal":
        return 0.0, _UPRIGHT_STD
    tip = int(points[:, 1].argmax())
    end = points[tip, 1]
    near = points[points[:, 1] > end - 0.6 * np.ptp(points[:, 0])]
    width = float(np.ptp(near[:, 0]))
    first, second = points[:tip], points[tip:]
    top = end - _SIDES_FROM[face] * width
    bottom = max(first[:, 1].min(initial=end), second[:, 1].min(initial=end)) + 2
    if top - bottom < _MIN_LENGTH * width:
        return 0.0, _UPRIGHT_STD
    levels = np.linspace(bottom, top, 40)
    middle = (_side(first, levels) + _side(second, levels)) / 2
    slope = np.polynomial.Polynomial.fit(levels, middle, 1).convert().coef[1]
    tilt = -math.atan(float(slope))
    if abs(tilt) > _MAX_TILT:
        return 0.0, _UPRIGHT_STD
    # A short stretch of the sides determines the axis less.
    return tilt, _AXIS_STD[face] * max(1.0, width / float(top - bottom))


def _side(points: FloatArray, levels: FloatArray) -> FloatArray:
    """Return x of one side at the given y."""
    order = np.argsort(points[:, 1])
    return np.asarray(np.interp(levels, points[order, 1], points[order, 0]), dtype=np.float64)
