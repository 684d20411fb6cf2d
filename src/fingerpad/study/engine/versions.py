"""Versions that stored results depend on: of the measurements, and of the libraries that compute them."""

from functools import cache
from importlib.metadata import PackageNotFoundError, version
from typing import Final, Literal

# Raise a version with every change that alters a number. tests/study/test_versions.py pins the numbers of
# each version, so that a change of code without a change of numbers measures nothing again.
MEASUREMENT_VERSIONS: Final = {"image": 1, "loading": 1, "uncertainty": 1}
LIBRARIES: Final = ("numpy", "opencv-python-headless", "pillow", "scipy", "tifffile")


@cache
def library_versions() -> dict[str, str]:
    """Return the versions of the libraries that results are computed with, by their distribution's name.

    Examples
    --------
    >>> sorted(library_versions())
    ['numpy', 'opencv-python-headless', 'pillow', 'scipy', 'tifffile']
    """
    return {name: _installed(name) for name in LIBRARIES}


def _installed(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:  # another distribution of the same library, as conda's or opencv-python
        return "unknown"


def versions_of(*measurements: Literal["image", "loading", "uncertainty"]) -> list[object]:
    """Return what belongs into the cache key of results of some kinds of measurement."""
    return [{kind: MEASUREMENT_VERSIONS[kind] for kind in measurements}, library_versions()]
