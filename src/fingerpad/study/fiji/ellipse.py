"""An ellipse that a person drew, or that stands for what a person traced."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredEllipse:
    """One ellipse, in the unit of its file.

    Attributes
    ----------
    label : str
        What Fiji calls it: the picture's name, or the ROI's.
    place : str
        File and line, or file and ROI, for messages.
    semi_major, semi_minor : float
        Semi-axes: half of what Fiji's Major and Minor are.
    orientation_deg : float or None
        Long axis from straight up in the picture, counter-clockwise, in (−90, 90]; None where not known.
    doubts : tuple of str
        What should be looked at.
    """

    label: str
    place: str
    semi_major: float
    semi_minor: float
    orientation_deg: float | None = None
    doubts: tuple[str, ...] = ()


def upward_deg(angle_deg: float) -> float:
    """Turn an angle from the horizontal, as Fiji gives it, into one from straight up, in (−90, 90].

    Examples
    --------
    >>> upward_deg(90.0), upward_deg(0.0), upward_deg(100.0)
    (0.0, 90.0, 10.0)
    """
    return 90 - (180 - angle_deg) % 180
