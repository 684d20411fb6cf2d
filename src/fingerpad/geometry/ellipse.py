"""The plane ellipse: the outline of a contact, or of one face of the finger."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, broadcast_named, check_all, set_fields
from fingerpad._display import Displayed
from fingerpad.exceptions import GeometryError


@dataclass(frozen=True, slots=True, init=False, eq=False, repr=False)
class Ellipse(Displayed):
    """An ellipse by its semi-axes.

    Attributes
    ----------
    semi_major, semi_minor : array_like
        Semi-axes, ``semi_major >= semi_minor > 0``, in one unit of length, of any shapes that broadcast.

    Raises
    ------
    GeometryError
        If an axis is not positive and finite, or the minor axis exceeds the major.

    Examples
    --------
    The contact of Table 3 in Dzidek et al. (2017) at a wedge angle of 30°:

    >>> ellipse = Ellipse(7.4, 5.0)
    >>> round(float(ellipse.area), 1), round(float(ellipse.eccentricity), 4)
    (116.2, 0.7372)
    """

    semi_major: FloatArray
    semi_minor: FloatArray

    def __init__(self, semi_major: ArrayLike, semi_minor: ArrayLike) -> None:
        major, minor = broadcast_named(semi_major=semi_major, semi_minor=semi_minor)
        check_all(np.isfinite(major) & (major > 0), "semi_major", major, "positive and finite", GeometryError)
        check_all(np.isfinite(minor) & (minor > 0), "semi_minor", minor, "positive and finite", GeometryError)
        check_all(
            minor <= major,
            "semi_minor",
            minor,
            "no longer than semi_major (are the two swapped?)",
            GeometryError,
        )
        set_fields(self, semi_major=major, semi_minor=minor)

    @property
    def axis_ratio(self) -> FloatArray:
        """Minor over major axis, k = ℓe/ℓd, 1 for a circle."""
        return self.semi_minor / self.semi_major

    @property
    def eccentricity(self) -> FloatArray:
        """Eccentricity e = √(1 − k²)."""
        return np.sqrt((1 - self.axis_ratio) * (1 + self.axis_ratio))

    @property
    def area(self) -> FloatArray:
        """Area π ℓd ℓe."""
        return np.pi * self.semi_major * self.semi_minor
