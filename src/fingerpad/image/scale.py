"""The scale of a picture: millimetres per pixel, with its standard uncertainty."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Self, TypeAlias

import numpy as np

from fingerpad._arrays import (
    FloatArray,
    as_float_array,
    check_all,
    finite_pair,
    non_negative_number,
    positive_number,
    set_fields,
)
from fingerpad._display import Displayed
from fingerpad.exceptions import CalibrationError
from fingerpad.image.read import Picture
from fingerpad.units import MM_PER_INCH

# Neighbouring ridges of fingers lie 0.3 to 0.7 mm apart. The spectrum of a small window of a picture resolves
# that to a tenth: waves beyond are no ridges.
WINDOW_RIDGE_PERIOD_MM: Final = (0.28, 0.75)
# The median of a whole contact may lie farther out before its scale is doubted: a scale that is right to some
# tens of percent is no reason to leave a contact out; one that is wrong by half is.
PLAUSIBLE_RIDGE_PERIOD_MM: Final = (0.25, 0.9)
# What cameras, editors and screens write without measuring.
PLACEHOLDER_PPI = (72.0, 96.0)
# What they and scanners' programs write by default: no sign that another scale is wrong.
_DEFAULT_PPI: Final = (*PLACEHOLDER_PPI, 150.0, 180.0, 240.0, 300.0)
_LEAST_SCANNED_PPI, _SAME_PPI = 150.0, 0.02
# Three points less bent than this lie on a line.
_LEAST_BEND: Final = 1e-3
# Files keep whole dots per inch: half a dot either way, rectangular.
_WHOLE_PPI_STD = 0.5 / math.sqrt(3)


@dataclass(frozen=True, slots=True, repr=False)
class Scale(Displayed):
    """Millimetres per pixel.

    Attributes
    ----------
    mm_per_px : float
        Length of one pixel's side, mm.
    mm_per_px_std : float
        Its standard uncertainty, mm, zero when not known.

    Raises
    ------
    CalibrationError
        If a length or number of pixels that gives the scale, as here, is not positive and finite, or an
        uncertainty negative or not finite.

    Examples
    --------
    >>> round(Scale.of_ppi(500).mm_per_px, 6)
    0.0508
    >>> scale = Scale.of_line(10.0, (0, 0), (0, 200), length_mm_std=0.1)
    >>> scale.mm_per_px, scale.relative_std
    (0.05, 0.01)
    """

    mm_per_px: float
    mm_per_px_std: float = 0.0

    def __post_init__(self) -> None:
        size = positive_number(self.mm_per_px, "mm_per_px", CalibrationError)
        check_all(1e-5 <= size <= 100, "mm_per_px", size, "between 0.00001 and 100", CalibrationError)
        std = non_negative_number(self.mm_per_px_std, "mm_per_px_std", CalibrationError)
        set_fields(self, mm_per_px=size, mm_per_px_std=std)

    @classmethod
    def of_ppi(cls, ppi: float, ppi_std: float = 0.0) -> Self:
        """Return a scale from pixels per inch.

        Parameters
        ----------
        ppi, ppi_std : float
            Pixels per inch and the standard uncertainty.

        Returns
        -------
        Scale
        """
        positive_number(ppi, "ppi", CalibrationError)
        non_negative_number(ppi_std, "ppi_std", CalibrationError)
        mm_per_px = MM_PER_INCH / ppi
        return cls(mm_per_px=mm_per_px, mm_per_px_std=mm_per_px * (ppi_std / ppi))

    @classmethod
    def of_picture(cls, picture: Picture) -> Self:
        """Return a scale from the resolution that a picture's own file states.

        The uncertainty is that of rounding to whole dots per inch. The number may be meaningless.

        Parameters
        ----------
        picture : Picture
            From `read_image`.

        Returns
        -------
        Scale

        Raises
        ------
        CalibrationError
            If the file states no resolution, or 72 or 96 dots per inch, which mean nothing.

        Examples
        --------
        >>> picture = Picture(pixels=np.zeros((20, 20), np.uint8), dots_per_inch=500.0)
        >>> round(Scale.of_picture(picture).relative_std, 5)
        0.00058
        """
        if not isinstance(picture, Picture):
            kind = type(picture).__name__
            raise CalibrationError(f"picture must be a Picture, as read_image reads it, found {kind}")
        ppi = picture.dots_per_inch
        way_out = "give pixels per inch, millimetres per pixel, a line or a coin of known length"
        if ppi is None:
            raise CalibrationError(f"the picture's file states no resolution: {way_out}")
        if any(math.isclose(ppi, placeholder, abs_tol=0.5) for placeholder in PLACEHOLDER_PPI):
            raise CalibrationError(
                f"the picture's file states {ppi:g} dots per inch, which programs write without measuring: "
                f"{way_out}"
            )
        return cls.of_ppi(ppi, _WHOLE_PPI_STD)

    @classmethod
    def of_line(
        cls,
        length_mm: float,
        start: tuple[float, float],
        end: tuple[float, float],
        *,
        length_mm_std: float = 0.0,
        point_px_std: float = 0.0,
    ) -> Self:
        """Return a scale from a line of known length on a ruler or across a coin.

        Parameters
        ----------
        length_mm, length_mm_std : float
            True length of the line and its standard uncertainty, mm.
        start, end : (float, float)
            Ends of the line, (row, column), px.
        point_px_std : float
            Standard uncertainty of each end along the line, px.

        Returns
        -------
        Scale

        Raises
        ------
        CalibrationError
            If the line has no length in the picture.
        """
        length_px = _distance(start, end)
        if not length_px > 0:
            raise CalibrationError(
                f"the scale line must have two different ends, found {start} twice: "
                "draw it along a known length"
            )
        return cls._of_length("length_mm", length_mm, length_mm_std, length_px, math.sqrt(2) * point_px_std)

    @classmethod
    def of_circle(
        cls,
        diameter_mm: float,
        points: Sequence[tuple[float, float]],
        *,
        diameter_mm_std: float = 0.0,
        point_px_std: float = 0.0,
    ) -> Self:
        """Return a scale from three points on the rim of a coin, or of any circle seen straight on.

        Parameters
        ----------
        diameter_mm, diameter_mm_std : float
            True diameter and its standard uncertainty, mm.
        points : sequence of (float, float)
            Three places (row, column) on the rim, px; the wider apart, the better.
        point_px_std : float
            Standard uncertainty of each point across the rim, px.

        Returns
        -------
        Scale

        Examples
        --------
        >>> Scale.of_circle(20.0, [(0, 100), (100, 0), (200, 100)]).mm_per_px
        0.1
        """
        _, radius, weights = circle_through(points)
        own_std = 2 * point_px_std * float(np.linalg.norm(weights))
        return cls._of_length("diameter_mm", diameter_mm, diameter_mm_std, 2 * radius, own_std)

    @classmethod
    def _of_length(cls, name: str, length: float, std: float, length_px: float, length_px_std: float) -> Self:
        """Return a scale from a known length, mm, that has the name of an argument, and its length in px."""
        positive_number(length, name, CalibrationError)
        non_negative_number(std, f"{name}_std", CalibrationError)
        non_negative_number(length_px_std, "point_px_std", CalibrationError)
        mm_per_px = length / length_px
        return cls(mm_per_px, mm_per_px * math.hypot(std / length, length_px_std / length_px))

    @property
    def relative_std(self) -> float:
        """Relative standard uncertainty, shared by every length measured in the picture."""
        return self.mm_per_px_std / self.mm_per_px

    @property
    def ppi(self) -> float:
        """Pixels per inch."""
        return MM_PER_INCH / self.mm_per_px

    def length(
        self, start: tuple[float, float], end: tuple[float, float], *, point_px_std: float = 0.0
    ) -> tuple[float, float]:
        """Return the length of a line in the picture and its standard uncertainty.

        Parameters
        ----------
        start, end : (float, float)
            Ends of the line, (row, column), px.
        point_px_std : float
            Standard uncertainty of each end along the line, px.

        Returns
        -------
        length, std : float
            mm.

        Examples
        --------
        >>> Scale(0.05, 0.001).length((0, 0), (0, 200))
        (10.0, 0.2)
        """
        length_px = _distance(start, end)
        own_std = math.sqrt(2) * point_px_std * self.mm_per_px
        return length_px * self.mm_per_px, math.hypot(length_px * self.mm_per_px_std, own_std)


def _distance(start: tuple[float, float], end: tuple[float, float]) -> float:
    return math.dist(finite_pair(start, "start", CalibrationError), finite_pair(end, "end", CalibrationError))


def circle_through(points: Sequence[tuple[float, float]]) -> tuple[FloatArray, float, FloatArray]:
    """Return the centre and the radius of the circle through three points, px.

    With them comes by how much the radius changes for each point that moves outward by one px.
    """
    places = as_float_array(points, "points", CalibrationError)
    if places.shape != (3, 2) or not np.isfinite(places).all():
        raise CalibrationError(f"a circle needs three points (row, column), found shape {places.shape}")
    chords = places[1:] - places[0]
    size = float(np.abs(chords).max())
    if not abs(np.linalg.det(chords)) > _LEAST_BEND * size**2:
        raise CalibrationError("the three points lie on a line: put them far apart on the rim")
    centre = places[0] + np.linalg.solve(chords, (chords**2).sum(axis=1) / 2)
    radius = float(np.linalg.norm(places[0] - centre))
    normals = (places - centre) / radius
    return centre, radius, np.linalg.inv(np.column_stack([normals, np.ones(3)]))[2]


ScaleLike: TypeAlias = Scale | float


def as_scale(scale: ScaleLike) -> Scale:
    """Return a scale; a number is millimetres per pixel, of no uncertainty."""
    return scale if isinstance(scale, Scale) else Scale(scale)


def other_resolution(dots_per_inch: float | None, mm_per_px: float) -> str:
    """Say how the resolution that a picture's file states differs from its scale.

    Empty where it hardly does, and where it is none of a scanner's: cameras, editors and screens write theirs
    without measuring.
    """
    used = MM_PER_INCH / mm_per_px
    if (
        dots_per_inch is None
        or dots_per_inch < _LEAST_SCANNED_PPI
        or any(math.isclose(dots_per_inch, default, abs_tol=0.5) for default in _DEFAULT_PPI)
        or abs(dots_per_inch / used - 1) <= _SAME_PPI
    ):
        return ""
    return f"states {dots_per_inch:.4g} ppi, the scale is {used:.4g} ppi: check which is right"
