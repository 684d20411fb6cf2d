"""The renderer of fingers: seeded, true where it says so, and plain about bad wishes."""

import numpy as np
import pytest

from fingerpad.exceptions import GeometryError, ImageError
from fingerpad.simulate import render_finger

FACES = ("palmar", "distal", "radial", "ulnar")


def test_seed_determines_photograph():
    first, again, other = (render_finger(mm_per_px=0.15, seed=seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first.pixels, again.pixels)
    assert (first.pixels != other.pixels).any()


@pytest.mark.parametrize("face", FACES)
@pytest.mark.parametrize("tip", ["up", "left"])
def test_edge_on_true_arc(face, tip):
    truth = render_finger(
        face,
        tip=tip,
        tilt_deg=3,
        mm_per_px=0.08,
        backdrop="black",
        skin=0,
        noise_std=0,
        jpeg_quality=None,
        shadow=0,
        texture_mm=0,
        seed=4,
        arc_deg=120,
    )
    luma = truth.pixels.astype(float).sum(axis=-1)
    points = truth.arc_points(40)
    out = points - truth.centre
    out /= np.linalg.norm(out, axis=1, keepdims=True)
    inside, outside = (points + step * out for step in (-6, 6))
    bright, dark = (luma[tuple(np.rint(place).astype(int).T)] for place in (inside, outside))
    # A fingertip is dimmer at its limb, and still far lighter than the black behind it.
    assert (bright > dark + 60).all()


@pytest.mark.parametrize(
    "changes",
    [
        {"semi_axes": (-1.0, 5.0)},
        {"mm_per_px": 0.0},
        {"arc_deg": 10},
        {"arc_deg": 200},
        {"departure": 2.0},
        {"mm_per_px": np.nan},
    ],
)
def test_invalid_fingers(changes):
    with pytest.raises(GeometryError, match="must be"):
        render_finger(**changes)


def test_invalid_directions():
    with pytest.raises(ImageError, match="palmar side is"):
        render_finger("radial", palmar="down")
