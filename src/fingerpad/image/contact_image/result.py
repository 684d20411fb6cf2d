"""Results of measuring a contact image."""

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, FloatArray
from fingerpad._records import Recorded
from fingerpad.geometry.ellipse import Ellipse
from fingerpad.image._masks import centres_inside
from fingerpad.image.contact_image.ridges import RidgeMap
from fingerpad.image.contact_image.view import ContactImageOptions, Surface


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ContactImageResult(Recorded):
    """Measurement of one contact in a contact image.

    Attributes
    ----------
    ellipse : Ellipse
        Contact ellipse, mm: the region's area, with the axis ratio of its second moments.
    orientation : float
        Angle of the major axis from straight up (the image's row axis), positive counter-clockwise as
        seen on the screen, radians in (−π/2, π/2]. Zero is an upright finger.
    centroid : (float, float)
        (row, column) of the region's centroid, px; pixel centres are whole numbers.
    outline : ndarray, shape (n, 2)
        (row, column) of points round the contact, px; all areas and axes are those of this polygon.
    gross_area, ridge_area : float
        Area inside the outline, and of the ridges within, mm². Parts in which ridges are blurred into one
        another, or all of a contact without ridges, count as half ridge. Sweat or ink beside a ridge counts
        as ridge: no image tells it from contact.
    ridge_border : float
        Length of the borders of these ridges, mm, NaN where no ridges are resolved. A film of width w beside
        each ridge makes the ridge area larger by w times this.
    ridge_period : float
        Median distance between neighbouring ridges, mm, NaN where no ridges are resolved.
    overlap : float
        Intersection over union of region and ellipse.
    noise_covariance : ndarray, shape (4, 4)
        Of (semi_major, semi_minor, gross_area, ridge_area), mm and mm², to first order, from errors that
        this image shares with no other: of the outline, and of the ridges' threshold; the share of ridges
        in parts that count as half ridge lies anywhere from none to all.
    edge_effect : ndarray, shape (4,)
        Change of the same by one standard uncertainty of the edge's place, which images of one device share:
        a wider edge displaces both semi-axes by as much.
    mm_per_px : float
        Length of a pixel's side in the picture, mm.
    scale_effect : ndarray, shape (4,)
        Change of the same by one standard uncertainty of the scale.
    threshold : float
        Median level that separates ridges from valleys in the patch, grey levels from the background
        towards contact.
    contrast : float
        Level of the contact above the background, grey levels.
    dark_on_light : bool
        Whether the contact is darker than the background.
    flags : tuple of str
        Doubts, by their codes in `fingerpad.flags`.
    surface : str
        ``ridged``, or ``smooth``: then all that concerns ridges is NaN, and the threshold is half of the
        contrast.

    Examples
    --------
    >>> from fingerpad.image import measure_contact_image
    >>> from fingerpad.simulate import render_contact_image
    >>> truth = render_contact_image(semi_major=3.0, semi_minor=2.5, seed=1)
    >>> contact = measure_contact_image(truth.pixels, truth.mm_per_px)
    >>> print(f"{contact.ellipse.semi_major:.2f} ± {contact.semi_major_std:.2f} mm")
    2.96 ± 0.05 mm
    >>> contact.outline.shape[1], contact.flags
    (2, ())
    """

    _title: ClassVar[str] = "Contact image"

    ellipse: Ellipse
    orientation: float
    centroid: tuple[float, float]
    outline: FloatArray
    gross_area: float
    ridge_area: float
    ridge_border: float
    ridge_period: float
    overlap: float
    noise_covariance: FloatArray
    edge_effect: FloatArray
    mm_per_px: float
    scale_effect: FloatArray
    threshold: float
    contrast: float
    dark_on_light: bool
    flags: tuple[str, ...]
    surface: Surface = "ridged"
    _shape: tuple[int, int]
    _ridges: RidgeMap | None
    _picture: npt.NDArray[Any] | None = None

    @property
    def picture(self) -> npt.NDArray[Any] | None:
        """The grey levels that were measured, None where they are not kept."""
        return self._picture

    def as_record(self) -> dict[str, Any]:
        """Return the numbers by names that end in units.

        Returns
        -------
        dict
            For tables and scripts.
        """
        return {
            "semi_major_mm": float(self.ellipse.semi_major),
            "semi_major_mm_std": self.semi_major_std,
            "semi_minor_mm": float(self.ellipse.semi_minor),
            "semi_minor_mm_std": self.semi_minor_std,
            "orientation_deg": math.degrees(self.orientation),
            "gross_area_mm2": self.gross_area,
            "gross_area_mm2_std": self.gross_area_std,
            "gross_area_mm2_noise_std": math.sqrt(self.noise_covariance[2, 2]),
            "gross_area_mm2_edge_std": float(self.edge_effect[2]),
            "ridge_area_mm2": self.ridge_area,
            "ridge_area_mm2_std": self.ridge_area_std,
            "ridge_border_mm": self.ridge_border,
            "edge_offset_mm_std": self.edge_offset_std,
            "ridge_period_mm": self.ridge_period,
            "ellipse_iou": self.overlap,
            "centroid_px": self.centroid,
            "flags": self.flags,
        }

    @property
    def values(self) -> FloatArray:
        """(semi_major, semi_minor, gross_area, ridge_area), mm and mm²."""
        return np.array(
            [self.ellipse.semi_major, self.ellipse.semi_minor, self.gross_area, self.ridge_area], dtype=float
        )

    @property
    def covariance(self) -> FloatArray:
        """Covariance of (semi_major, semi_minor, gross_area, ridge_area), mm and mm²: noise, edge, scale."""
        shared = np.outer(self.edge_effect, self.edge_effect) + np.outer(self.scale_effect, self.scale_effect)
        return self.noise_covariance + shared

    @property
    def edge_offset_std(self) -> float:
        """Standard uncertainty of the edge's place, mm: of an offset of both semi-axes."""
        return float(self.edge_effect[0])

    @property
    def semi_major_std(self) -> float:
        """Standard uncertainty of the semi-major axis, mm."""
        return math.sqrt(self.covariance[0, 0])

    @property
    def semi_minor_std(self) -> float:
        """Standard uncertainty of the semi-minor axis, mm."""
        return math.sqrt(self.covariance[1, 1])

    @property
    def gross_area_std(self) -> float:
        """Standard uncertainty of the gross area, mm²."""
        return math.sqrt(self.covariance[2, 2])

    @property
    def ridge_area_std(self) -> float:
        """Standard uncertainty of the ridge area, mm²."""
        return math.sqrt(self.covariance[3, 3])

    @property
    def region(self) -> BoolArray:
        """Mask of the contact, computed from the outline on demand, (rows, columns) of the picture."""
        return centres_inside(self.outline, self._shape)

    @property
    def ridges(self) -> BoolArray:
        """Where the ridges within the region are, drawn on demand, (rows, columns) of the picture."""
        if self._ridges is None:
            return np.zeros(self._shape, dtype=bool)
        return np.asarray(self.region & self._ridges.in_picture(self._shape))

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of the picture that was measured."""
        return self._shape

    @property
    def settings(self) -> ContactImageOptions:
        """Contrast, ridge period (mm) and polarity, as options to measure other frames alike."""
        period = None if math.isnan(self.ridge_period) else self.ridge_period
        settings: ContactImageOptions = {
            "contrast": self.contrast,
            "ridge_period": period,
            "dark_on_light": self.dark_on_light,
        }
        return settings if self.surface == "ridged" else {**settings, "surface": self.surface}
