"""Pages of TIFF files that Pillow refuses or flattens: deep colour, doubles, other units of resolution."""

from typing import Any

import numpy as np
import tifffile

from fingerpad.image._grayscale import Pixels, grey_of_array, upright

ORIENTATION_TAG = 274


def grey_of_page(page: Any) -> Pixels:
    """Return the grey levels of one page, a `tifffile.TiffPage`, upright.

    Raises
    ------
    ImageError
        If the page is not a picture. Damage, and a compression that tifffile lacks, raise its own errors.
    """
    array = page.asarray()
    if array.ndim == 3 and page.planarconfig == tifffile.PLANARCONFIG.SEPARATE:
        array = np.moveaxis(array, 0, -1)
    if page.photometric == tifffile.PHOTOMETRIC.MINISWHITE and array.dtype.kind == "u":
        array = np.iinfo(array.dtype).max - array
    tag = page.tags.get(ORIENTATION_TAG)
    return grey_of_array(upright(array, 1 if tag is None else int(tag.value)))


def size_of_page(page: Any) -> tuple[int, int]:
    """Return the (columns, rows) that the header of a page promises."""
    return int(page.imagewidth), int(page.imagelength)


def resolution_of_page(page: Any) -> tuple[float, float] | None:
    """Return the pixels per inch of a page, across and down, None where the file names no unit."""
    if int(page.resolutionunit) < 2:
        return None
    across, down = page.get_resolution(tifffile.RESUNIT.INCH)
    return float(across), float(down)
