"""What `pad_uncertainty` refuses."""

import numpy as np
import pytest
from tests.uncertainty.pads import ELLIPSE, LENGTHS, PAD

import fingerpad as fp

DEGREES = ".*for degrees use np.radians\\(30\\)"
CONTRADICTION = {
    ("palmar", "distal"): 0.9,
    ("distal", "radial_ulnar"): 0.9,
    ("palmar", "radial_ulnar"): -0.9,
}


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"wedge_angle": (5, 0.1)}, "wedge_angle must be between 0 and π/2" + DEGREES),
        ({"wedge_angle": ([0.5, 30], 0.01)}, "found 30 at index 1"),
        ({"wedge_angle": (0.5, 3)}, "standard uncertainty of wedge_angle must be at most π/2" + DEGREES),
        ({"roll_angle": (-10, 0.1)}, "roll_angle must be between -π/2 and π/2" + DEGREES),
        ({"roll_angle": (0, 3)}, "standard uncertainty of roll_angle" + DEGREES),
        ({"palmar": -7.9}, "palmar must be positive, found -7.9"),
        ({"semi_minor": ([5, 0], 0.1)}, "semi_minor must be positive, found 0 at index 1"),
        ({"load": -2}, "load must be positive or zero, found -2"),
        ({"image_scale": 0}, "image_scale must be positive"),
        ({"poisson_ratio": (3, 0.1)}, r"poisson_ratio must be within \[-1, 0.5\], found 3"),
        ({"load": (2.0, -0.1)}, "standard uncertainty of load must be positive or zero, found -0.1"),
        ({"load": (2.0, np.nan)}, "covariance must be finite"),
        ({"wedge": 0.5}, "no quantity 'wedge'; there are palmar, distal, .*semi_minor, thickness"),
        ({"contact_radius": 6.0}, "no quantity 'contact_radius'"),
        ({"correlations": {("palmar", "distl"): 0.9}}, "no input 'distl'; there are palmar, distal,"),
        ({"correlations": CONTRADICTION}, "smallest eigenvalue"),
    ],
)
def test_impossible_quantities_are_refused(given: dict[str, object], words: str) -> None:
    with pytest.raises(fp.FingerpadError, match=words):
        fp.pad_uncertainty(**PAD | given)


def test_a_missing_quantity_is_named() -> None:
    with pytest.raises(fp.FingerpadError, match="give wedge_angle too, each as a number or"):
        fp.pad_uncertainty(**LENGTHS, **ELLIPSE)


def test_flat_and_upright_are_accepted() -> None:
    for wedge in (0.0, np.pi / 2):
        result = fp.pad_uncertainty(**PAD | {"wedge_angle": (wedge, 0.05)})
        assert np.isfinite(result["radius_from_indentation"].value)
