"""Versions that stored results depend on: of the measurements, and of the libraries that compute them."""

from typing import Final, Literal

import cv2
import imagecodecs
import numpy
import PIL
import scipy
import tifffile

# Raise a version with every change that alters a number, or a name that is stored with it.
# tests/study/test_versions.py pins the numbers of each version, so that a change of code without a change of
# numbers measures nothing again.
MEASUREMENT_VERSIONS: Final = {"image": 14, "loading": 12, "uncertainty": 7}


def library_versions() -> dict[str, str]:
    """Return the versions of the libraries that results are computed with, whatever distribution they are of.

    Examples
    --------
    >>> sorted(library_versions())
    ['imagecodecs', 'numpy', 'opencv', 'pillow', 'scipy', 'tifffile']
    """
    return {
        "imagecodecs": imagecodecs.__version__,
        "numpy": numpy.__version__,
        "opencv": cv2.__version__,
        "pillow": PIL.__version__,
        "scipy": scipy.__version__,
        "tifffile": tifffile.__version__,
    }


def versions_of(*measurements: Literal["image", "loading", "uncertainty"]) -> list[object]:
    """Return what belongs into the cache key of results of some kinds of measurement."""
    libraries = library_versions()
    # It only unpacks TIFF without loss: what another release reads otherwise, it refuses.
    libraries.pop("imagecodecs", None)
    return [{kind: MEASUREMENT_VERSIONS[kind] for kind in measurements}, libraries]
