"""Pictures of rulers: a board with a graduation in millimetres and numerals, seen by a camera.

Drawn from what a school ruler or a steel rule looks like (marks each millimetre, longer each five and each
ten, numerals each centimetre); nothing of the library is used.
"""

import math

import cv2
import numpy as np
import numpy.typing as npt

UInt8 = npt.NDArray[np.uint8]

KINDS = ("white", "steel", "wood", "dark", "filling the frame", "clear on dark")
_BOARDS = {  # colour of the board and of its marks, red, green and blue
    "white": ((236, 235, 230), (25, 25, 30)),
    "steel": ((172, 174, 178), (35, 35, 38)),
    "wood": ((205, 168, 112), (45, 35, 28)),
    "dark": ((38, 40, 44), (225, 225, 220)),
    "filling the frame": ((228, 226, 218), (30, 30, 35)),
    "clear on dark": ((96, 100, 104), (232, 232, 232)),
}
_DRAWN_PX_PER_MM = 16


def ruler_scene(kind: str, seed: int, side: int = 640) -> UInt8:
    """Return a colour picture of a ruler, (rows, columns, 3); the same seed gives the same one."""
    rng = np.random.default_rng([seed, KINDS.index(kind)])
    board = _board(kind, rng)
    rows, columns = round(0.75 * side), side
    filling = kind == "filling the frame"
    seen_mm = rng.uniform(25, 55) if filling else rng.uniform(50, 130)
    zoom = columns / seen_mm / _DRAWN_PX_PER_MM
    turn = rng.normal(0, 0.12) + (math.pi / 2 if rng.random() < 0.3 else 0.0) + math.pi * (rng.random() < 0.3)
    height, width = board.shape[:2]
    centre = (width * rng.uniform(0.35, 0.65), height * (0.35 if filling else 0.5))
    move = cv2.getRotationMatrix2D(centre, math.degrees(turn), zoom)
    move[:, 2] += np.array([columns, rows]) * rng.uniform(0.42, 0.58, 2) - centre
    whole = np.vstack([move, [*rng.normal(0, 1.5e-4 / side * 640, 2) * zoom, 1]])
    smooth = cv2.GaussianBlur(board, (0, 0), 0.5 / zoom) if zoom < 1 else board
    seen = cv2.warpPerspective(smooth, whole, (columns, rows), flags=cv2.INTER_LINEAR)
    mask = cv2.warpPerspective(np.ones((height, width), np.float32), whole, (columns, rows))[..., None]
    table = _table(rng, rows, columns)
    light = 1 + 0.15 * np.add.outer(
        rng.normal() * np.linspace(-1, 1, rows), rng.normal() * np.linspace(-1, 1, columns)
    )
    picture = (seen * mask + table * (1 - mask)) * light[..., None]
    blurred = cv2.GaussianBlur(picture.astype(np.float32), (0, 0), rng.uniform(0.5, 1.1))
    noisy = blurred + rng.normal(0, rng.uniform(1, 4), blurred.shape)
    return np.asarray(np.clip(np.rint(noisy), 0, 255), dtype=np.uint8)


def _board(kind: str, rng: np.random.Generator) -> UInt8:
    colour, ink = _BOARDS[kind]
    scale = _DRAWN_PX_PER_MM
    length, width = 160, int(rng.integers(18, 32))
    board = np.empty((width * scale, length * scale, 3), np.uint8)
    board[:] = colour
    if kind == "wood":
        grain = cv2.GaussianBlur(rng.standard_normal(board.shape[:2]), (0, 0), sigmaX=60, sigmaY=2)
        board = np.clip(board + (9 * grain / grain.std())[..., None], 0, 255).astype(np.uint8)
    for mm in range(2, length - 1):
        reach = {0: 6.5, 5: 4.8}.get(mm % 10, 3.2)
        x = mm * scale
        cv2.line(board, (x, 0), (x, round(reach * scale)), ink, 3)
        if mm % 10 == 0:
            words = str(mm // 10)
            place = (x - 8 * len(words) * scale // 16, round(9.5 * scale))
            cv2.putText(board, words, place, cv2.FONT_HERSHEY_SIMPLEX, 1.5, ink, 4, cv2.LINE_AA)
    return board


def _table(rng: np.random.Generator, rows: int, columns: int) -> npt.NDArray[np.float32]:
    colour = rng.uniform(40, 215, 3) * 0.4 + rng.uniform(40, 215) * 0.6
    grain = cv2.GaussianBlur(rng.standard_normal((rows, columns)), (0, 0), rng.uniform(0.7, 12))
    return np.asarray(colour + (rng.uniform(1, 6) * grain / grain.std())[..., None], dtype=np.float32)
