"""What `pad_uncertainty` refuses."""

import numpy as np
import pytest

import fingerpad as fp

GIVEN = {
    "palmar": (7.9, 0.1),
    "distal": (13.8, 0.1),
    "radial_ulnar": (11.8, 0.1),
    "load": (2, 0.02),
    "semi_major": (7.4, 0.1),
    "semi_minor": (5.0, 0.1),
}


@pytest.mark.parametrize(
    ("angles", "words"),
    [
        ({"wedge_angle": (30, 0.5)}, "wedge_angle must be between 0 and π/2"),
        ({"wedge_angle": (5, 0.1)}, "wedge_angle must be between 0 and π/2"),
        ({"wedge_angle": ([0.5, 30], 0.01)}, "found 30 at index 1"),
        ({"wedge_angle": (0.5, 3)}, "standard uncertainty of wedge_angle must be at most π/2"),
        ({"wedge_angle": 0.5, "roll_angle": (-10, 0.1)}, "roll_angle must be between -π/2 and π/2"),
        ({"wedge_angle": 0.5, "roll_angle": (0, 3)}, "standard uncertainty of roll_angle"),
    ],
)
def test_degrees_are_refused(angles: dict[str, object], words: str) -> None:
    with pytest.raises(fp.FingerpadError, match=words) as caught:
        fp.pad_uncertainty(**GIVEN, **angles)
    assert "for degrees use np.radians(30)" in str(caught.value)


def test_flat_and_upright_are_accepted() -> None:
    for wedge in (0.0, np.pi / 2):
        result = fp.pad_uncertainty(**GIVEN, wedge_angle=(wedge, 0.05), roll_angle=(0.1, 0.05))
        assert np.isfinite(result["radius_from_indentation"].value)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"palmar": -7.9}, "palmar must be positive, found -7.9"),
        ({"semi_major": (-7, 0.1)}, "semi_major must be positive, found -7"),
        ({"semi_minor": ([5, 0], 0.1)}, "semi_minor must be positive, found 0 at index 1"),
        ({"load": -2}, "load must be positive or zero, found -2"),
        ({"image_scale": 0}, "image_scale must be positive"),
        ({"poisson_ratio": (3, 0.1)}, r"poisson_ratio must be within \[-1, 0.5\], found 3"),
    ],
)
def test_impossible_values_are_refused(given: dict[str, object], message: str) -> None:
    with pytest.raises(fp.FingerpadError, match=message):
        fp.pad_uncertainty(**GIVEN | {"wedge_angle": 0.5} | given)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"wedge": 0.5}, "no quantity 'wedge'; there are palmar, distal, .*semi_minor, thickness"),
        ({"contact_radius": 6.0}, "no quantity 'contact_radius'"),
        ({}, "give wedge_angle too, each as a number or"),
    ],
)
def test_quantities_have_names(changed: dict[str, object], message: str) -> None:
    with pytest.raises(fp.FingerpadError, match=message):
        fp.pad_uncertainty(**GIVEN | changed)
