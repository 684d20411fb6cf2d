"""Options of measuring a contact image."""

from typing import TypedDict

import numpy.typing as npt


class MeasurementRegion(TypedDict, total=False):
    """Part of the image in which the contact is measured.

    Attributes
    ----------
    background : array_like, (rows, columns)
        The same view without a finger, by which the image is divided.
    seed : (float, float)
        (row, column) of a point in the wanted patch, px; by default the largest patch, preferring the centre.
    mask : array_like
        A polygon of (row, column) corners or a bool array of the image's shape; only what is inside counts.
    region_of_interest : (int, int, int, int)
        First row, first column, last row, last column (excluded) of the part to measure.

    Examples
    --------
    >>> from fingerpad.image import measure_contact_image
    >>> from fingerpad.simulate import render_contact_image
    >>> truth = render_contact_image(semi_major=3.0, semi_minor=2.5, seed=1)
    >>> region = MeasurementRegion(seed=truth.centroid)
    >>> contact = measure_contact_image(truth.pixels, truth.mm_per_px, **region)
    >>> print(f"{contact.gross_area:.1f} mm², truth {truth.gross_area:.1f} mm²")
    23.5 mm², truth 23.6 mm²
    """

    background: npt.ArrayLike | None
    seed: tuple[float, float] | None
    mask: npt.ArrayLike | None
    region_of_interest: tuple[int, int, int, int] | None


class ContactImageOptions(MeasurementRegion, total=False):
    """Keyword arguments of `measure_contact_image` and `prepare_contact_image`; all default to None.

    Attributes
    ----------
    background, seed, mask, region_of_interest
        See `MeasurementRegion`.
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

    Examples
    --------
    >>> from fingerpad.image import measure_contact_image
    >>> from fingerpad.simulate import render_contact_image
    >>> truth = render_contact_image(semi_major=3.0, semi_minor=2.5, seed=1)
    >>> options = ContactImageOptions(dark_on_light=True, ridge_period=0.45)
    >>> measure_contact_image(truth.pixels, truth.mm_per_px, **options).dark_on_light
    True
    """

    dark_on_light: bool | None
    threshold: float | None
    contrast: float | None
    ridge_period: float | None
