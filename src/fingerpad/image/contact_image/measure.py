"""Measure a contact image: the contact ellipse, gross and ridge areas, and the ridge period."""

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from fingerpad.image.contact_image.prepare import prepare_contact_image
from fingerpad.image.contact_image.result import ContactImageResult
from fingerpad.image.inputs import ImageLike, ScaleLike, as_scale, grey_levels


def measure_contact_image(
    image: ImageLike,
    scale: ScaleLike,
    *,
    dark_on_light: bool | None = None,
    background: npt.ArrayLike | None = None,
    seed: tuple[float, float] | None = None,
    threshold: float | None = None,
    contrast: float | None = None,
    ridge_period: float | None = None,
    mask: npt.ArrayLike | None = None,
    region_of_interest: tuple[int, int, int, int] | None = None,
) -> ContactImageResult:
    """Measure the contact patch in a grey contact image.

    The ridge period comes from local spectra of the picture itself, which is then reduced so that a period
    is 4.5 px. Light is evened by a smooth surface through the quiet ground. Ridges lie above half the local
    contrast; closed with a disk of 1.1 ridge periods they give the gross region, which is cut at necks (joint
    creases) and freed of appendages narrower than a third of it. Its outline is placed to parts of a pixel
    where the closed ridges fall through half.

    A region closed over ridges ends at their ends where the outline crosses them, and at the outer border of
    the last ridge where it follows one. There the outline is moved out: if the true edge falls at random on
    ridges and on valleys of share v of the period P, it lies v²P/2 further out on average.

    Parameters
    ----------
    image : array_like, (rows, columns), path-like or Picture
        Grey levels of any real type, or the file that holds them.
    scale : Scale or float
        Millimetres per pixel.
    dark_on_light : bool, optional
        Whether contact is darker than the ground; found from the picture when None.
    background : array_like, (rows, columns), optional
        The same view without a finger, by which the picture is divided.
    seed : (float, float), optional
        (row, column) of a point in the wanted patch, px; without it, the largest, preferring the centre.
    threshold : float, optional
        Grey levels, from the even ground towards contact, beyond which a place is ridge everywhere in the
        picture. Without it, half of the local contrast.
    contrast : float, optional
        Level of the contact above the ground, grey levels; found from the picture when None. Where nothing
        rises above half of it there is no contact. One value for a whole sequence keeps its frames
        comparable: `ContactImageResult.settings` of a good frame holds it.
    ridge_period : float, optional
        Ridge period, mm; found from the picture when None.
    mask : array_like, optional
        A polygon of (row, column) corners or a bool array of the picture's shape: outside nothing counts.
    region_of_interest : (int, int, int, int), optional
        First row, first column, last row, last column (excluded) of the part to look at.

    Returns
    -------
    ContactImageResult

    Raises
    ------
    ImageError
        If the image is not a grey picture, is not finite, shows no contact, or none at `seed`; or an option
        is not as described.
    CalibrationError
        If a number is no length of a pixel, mm.

    Examples
    --------
    >>> from fingerpad.image import Scale, measure_contact_image
    >>> from fingerpad.simulate import render_contact_image
    >>> truth = render_contact_image(semi_major=8.0, semi_minor=6.0, seed=3)
    >>> contact_image = measure_contact_image(truth.pixels, Scale.of_ppi(500))
    >>> abs(contact_image.gross_area / truth.gross_area - 1) < 0.03, contact_image.flags
    (True, ())
    """
    pixels = grey_levels(image)
    prepared = prepare_contact_image(
        pixels,
        as_scale(scale),
        dark_on_light=dark_on_light,
        background=background,
        seed=seed,
        threshold=threshold,
        contrast=contrast,
        ridge_period=ridge_period,
        mask=mask,
        region_of_interest=region_of_interest,
    )
    return replace(prepared.contact_image, _picture=np.asarray(pixels))
