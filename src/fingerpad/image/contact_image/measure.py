"""Measure a contact image: the contact ellipse, gross and ridge areas, and the ridge period."""

from dataclasses import replace
from typing import Unpack

import numpy as np

from fingerpad.image.contact_image.options import ContactImageOptions
from fingerpad.image.contact_image.prepare import prepare_contact_image
from fingerpad.image.contact_image.result import ContactImageResult
from fingerpad.image.inputs import ImageLike, ScaleLike, grey_levels


def measure_contact_image(
    image: ImageLike, scale: ScaleLike, **options: Unpack[ContactImageOptions]
) -> ContactImageResult:
    """Measure the contact patch in a grey contact image.

    The ridge period is estimated from local spectra of the image, which is then reduced so that a period is
    4.5 px. Uneven lighting is removed by a smooth surface through the background. Pixels above half the local
    contrast are ridges; closed with a disk of 1.1 ridge periods they give the gross region, which is cut at
    necks (joint creases) and freed of appendages narrower than a third of it. The outline is located to a
    fraction of a pixel where the closed ridges fall through half. Ridge area is, at the resolution of the
    image, what lies in means along the ridges about half-way from the level of the valleys to that of the
    ridges around, inside the outline. That level is shifted by what blur does to ridges of such width, by
    grain within the ridges, and by valleys that the device clips to white; what these leave unknown stands in
    the uncertainty. Sweat and ink beside a ridge count as ridge: where ridges fill more than 59 % of the
    contact, the ridge area is flagged as an upper bound, and less certain.

    The edge of a contact is where its outermost ridges stop touching. A region closed over ridges ends at
    their ends where the outline crosses them, and at the outer border of the last ridge where it follows one.
    There the outline is moved out: if the true edge falls at random on ridges and on valleys of share v of
    the period P, it lies v²P/2 further out on average. Where ridges fade towards the edge, those that are
    still seen just outside the outline show by how much it lies further out; a halo or a rim, which are
    smooth along it, do not count. How far is partly a matter of definition: 0.11 P for sharp edges to 0.3 P
    for those that fade, about 0.05 to 0.15 mm, stand in the covariance as an offset that all of the outline
    shares, and all images of a device. The uncertainty of the semi-axes contains besides what their
    definition leaves open where the outline is no ellipse, and a fade that differs between the tips and the
    sides.

    Parameters
    ----------
    image : array_like, (rows, columns), path-like or Picture
        Grey levels of any real type, or the file that holds them.
    scale : Scale or float
        Millimetres per pixel.
    **options
        Polarity, threshold, region and so on: see `ContactImageOptions`.

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
    >>> truth = render_contact_image(semi_major=3.0, semi_minor=2.5, seed=1)
    >>> contact_image = measure_contact_image(truth.pixels, Scale.of_ppi(500))
    >>> abs(contact_image.gross_area / truth.gross_area - 1) < 0.03, contact_image.flags
    (True, ())
    """
    pixels = grey_levels(image)
    prepared = prepare_contact_image(pixels, scale, **options)
    return replace(prepared.contact_image, _picture=np.asarray(pixels))
