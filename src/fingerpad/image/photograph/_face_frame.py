"""The frame of a face: which way its two semi-axes point in a photograph, and where its pad lies."""

import math
from collections.abc import Mapping
from typing import Literal, TypeAlias

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.exceptions import ImageError
from fingerpad.image.photograph.faces import FACE_AXES, Face

Direction: TypeAlias = Literal["up", "down", "left", "right"]

# Steps (row, column) on the screen.
STEPS: Mapping[Direction, tuple[int, int]] = {"up": (-1, 0), "right": (0, 1), "down": (1, 0), "left": (0, -1)}
_TURNS: tuple[Direction, ...] = ("up", "right", "down", "left")

# Middle of the pad's arc as parametric angle from x (across) towards y (along), radians.
PAD_MIDDLE: Mapping[Face, float] = {
    "palmar": math.pi / 2,
    "distal": math.pi / 2,
    "radial": math.pi / 6,
    "ulnar": math.pi / 6,
}
# Widest arc that can be pad, on either side of its middle.
PAD_REACH: Mapping[Face, float] = {
    "palmar": math.radians(100),
    "distal": math.radians(105),
    "radial": math.radians(95),
    "ulnar": math.radians(95),
}


def opposite(direction: Direction) -> Direction:
    """Return the direction half a turn away."""
    return _TURNS[(_TURNS.index(direction) + 2) % 4]


def palmar_directions(face: Face, tip: Direction, palmar: Direction | None) -> tuple[Direction, ...]:
    """Return the directions that the palmar side may have in the photograph, one if it is known.

    Raises
    ------
    ImageError
        If the face or a direction is unknown, or the palmar side cannot lie there.
    """
    if face not in tuple(FACE_AXES):
        raise ImageError(f"face must be one of {', '.join(FACE_AXES)}, found {face!r}")
    for name, direction in (("tip", tip), ("palmar", palmar)):
        if not (direction in tuple(STEPS) or (name == "palmar" and direction is None)):
            raise ImageError(f"{name} must be one of {', '.join(STEPS)}, found {direction!r}")
    if face == "distal":
        return (palmar or "down",)
    if face == "palmar":
        if palmar is not None:
            raise ImageError(f"the palmar face looks at the camera: leave palmar out, found {palmar!r}")
        return (tip,)
    across = tuple(_TURNS[(_TURNS.index(tip) + turn) % 4] for turn in (1, 3))
    if palmar is None:
        return across
    if palmar not in across:
        raise ImageError(
            f"with the tip {tip} the palmar side is {across[0]} or {across[1]}, found {palmar!r}"
        )
    return (palmar,)


def face_axes(face: Face, tip: Direction, palmar: Direction) -> FloatArray:
    """Return the steps (row, column) of the face's x (across) and y (along), one in each row."""
    along = STEPS[palmar] if face == "distal" else STEPS[tip]
    across = STEPS[palmar] if face in ("radial", "ulnar") else (along[1], -along[0])
    return np.array([across, along], dtype=np.float64)


def pad_sides(face: Face, tip: Direction, palmar: Direction) -> tuple[Direction, ...]:
    """Return the sides of the frame that the pad faces, where it must not be cut."""
    return {"palmar": (tip,), "distal": (palmar,)}.get(face, (tip, palmar))
