"""The faces of a finger: which semi-axes each shows, and in which directions they lie in a photograph."""

from collections.abc import Mapping
from typing import Literal, TypeAlias

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.exceptions import ImageError

Face: TypeAlias = Literal["palmar", "distal", "radial", "ulnar"]
Direction: TypeAlias = Literal["up", "down", "left", "right"]

SEMI_AXES = ("palmar", "distal", "radial_ulnar")
# The semi-axes that (x, y), that is (across, along), show in a photograph of each face.
FACE_AXES: Mapping[Face, tuple[str, str]] = {
    "palmar": ("radial_ulnar", "distal"),
    "distal": ("radial_ulnar", "palmar"),
    "radial": ("palmar", "distal"),
    "ulnar": ("palmar", "distal"),
}
# One step in each direction, (row, column).
STEPS: Mapping[Direction, tuple[int, int]] = {"up": (-1, 0), "right": (0, 1), "down": (1, 0), "left": (0, -1)}
_TURNS: tuple[Direction, ...] = ("up", "right", "down", "left")


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
