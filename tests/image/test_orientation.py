"""Directions of a finger in a photograph: turns of the picture, mirror images, and what cannot be."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from fingerpad.exceptions import ImageError
from fingerpad.image.photograph.faces import STEPS, face_axes, opposite, palmar_directions

CLOCKWISE = ("up", "right", "down", "left")
TURN = np.array([[0, 1], [-1, 0]])  # a step (row, column) turned to the left, acting from the right


@pytest.mark.parametrize("place", range(4))
def test_directions_turn_with_the_picture(place: int) -> None:
    here, next_one, behind = (CLOCKWISE[(place + turn) % 4] for turn in (0, 1, 2))
    assert_array_equal(np.array(STEPS[next_one]) @ TURN, STEPS[here])
    assert opposite(here) == behind
    for face in ("palmar", "radial", "ulnar"):
        sides = palmar_directions(face, here, None), palmar_directions(face, next_one, None)
        for one, other in zip(*sides, strict=True):
            assert_array_equal(face_axes(face, next_one, other) @ TURN, face_axes(face, here, one))


def test_axes_with_the_tip_up() -> None:
    up, right, down, left = (-1, 0), (0, 1), (1, 0), (0, -1)
    assert_array_equal(face_axes("palmar", "up", "up"), [right, up])
    assert_array_equal(face_axes("radial", "up", "right"), [right, up])
    assert_array_equal(face_axes("distal", "up", "down"), [left, down])


def test_possible_palmar_sides() -> None:
    assert palmar_directions("palmar", "left", None) == ("left",)
    assert palmar_directions("distal", "up", None) == ("down",)
    assert palmar_directions("distal", "up", "left") == ("left",)
    assert set(palmar_directions("radial", "left", None)) == {"up", "down"}
    assert palmar_directions("ulnar", "down", "right") == ("right",)


@pytest.mark.parametrize(
    ("face", "tip", "palmar", "message"),
    [
        ("dorsal", "up", None, "face must be one of palmar, distal, radial, ulnar, found 'dorsal'"),
        ("palmar", None, None, "tip must be one of up, right, down, left, found None"),
        ("radial", "up", "below", "palmar must be one of up, right, down, left, found 'below'"),
        ("palmar", "up", "up", "looks at the camera: leave palmar out, found 'up'"),
        ("radial", "up", "down", "with the tip up the palmar side is right or left, found 'down'"),
    ],
)
def test_impossible_directions(face, tip, palmar, message: str) -> None:
    with pytest.raises(ImageError, match=message):
        palmar_directions(face, tip, palmar)
