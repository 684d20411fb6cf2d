"""What a picture shows: a contact, a finger, a coin or a ruler, from its pixels alone."""

import math
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, Final, Literal, TypeAlias, get_args

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, FloatArray, as_float32
from fingerpad._display import Displayed
from fingerpad.exceptions import CalibrationError, ImageError
from fingerpad.image.coin import measure_coin
from fingerpad.image.contact_image.spectra import line_texture
from fingerpad.image.levels import eight_bit, picture_levels, reduced
from fingerpad.image.photograph.faces import Direction, Face, opposite
from fingerpad.image.photograph.silhouette import Silhouette, find_silhouette, opponent_light
from fingerpad.image.read import ImageLike, levels_of

Subject: TypeAlias = Literal["contact", "finger", "coin", "ruler", "other"]
SUBJECTS: Final[tuple[Subject, ...]] = get_args(Subject)

# Longest sides of the copies in which lines, a coin and a finger are looked for, px.
_LINES_PX, _COIN_PX, _FINGER_PX = 1400, 480, 360
# Lines fill so much of a contact image; a ruler's marks are parallel and evenly spaced beyond these.
_RIDGED, _MARKS = 0.15, 0.03
_PARALLEL, _EVEN = 0.985, 0.1
_STRAIGHT = 0.8  # straighter lines than these may be those of a table under a coin
# Skin of every tone lies within these limits of Cr and Cb (Chai and Ngan 1999, IEEE Trans. CSVT 9:551).
_SKIN_CR, _SKIN_CB = (133, 173), (77, 127)
_BENT: Final = 0.005  # widths from straight; so bent a middle line is as likely of the front as of a side


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class SubjectGuess(Displayed):
    """What a picture may show, most likely first: numbers that sum to 1, rank, and are no frequencies."""

    subjects: Mapping[Subject, float]  # contact, finger, coin, ruler and other
    faces: Mapping[Face, float]  # empty where no outline was found; the sides look alike


def guess_subject(image: ImageLike) -> SubjectGuess:
    """Guess what a picture shows; no scale is needed.

    Lines of one spacing that turn are ridges, straight ones marks of a ruler; a circular edge is a coin. Skin
    colour, or a smooth body before a plain backdrop, is a finger, and its outline tells the face: end-on it
    is closed, from the front its middle line is straight, from the side it is bent.
    """
    levels = picture_levels(levels_of(image, colour=True), "image", colour=True)
    if min(levels.shape[:2]) < 2:
        raise ImageError(f"image must have two rows and columns or more, found shape {levels.shape}")
    pixels = eight_bit(reduced(levels[..., :3] if levels.ndim == 3 else levels, _LINES_PX))
    grey = cv2.cvtColor(pixels, cv2.COLOR_RGB2GRAY) if pixels.ndim == 3 else pixels
    lines = line_texture(as_float32(grey))
    silhouette, tip = _silhouette(reduced(pixels, _FINGER_PX))
    scores = dict.fromkeys(SUBJECTS, 0.0)
    if lines.parallel > _PARALLEL and lines.spread < _EVEN:
        scores["ruler"] = 6.0 * min(1.0, lines.share / _MARKS)
    else:
        turning = min(1.0, (1 - lines.parallel) / (1 - _PARALLEL) / 2)
        scores["contact"] = 6.0 * min(1.0, lines.share / _RIDGED) * turning
    if scores["contact"] < 4 or lines.parallel > _STRAIGHT:
        with suppress(CalibrationError):
            coin = measure_coin(reduced(grey, _COIN_PX))
            scores["coin"] = 5.5 if coin.semi_minor > 0.9 * coin.semi_major else 1.5
    scores["finger"] = _finger_score(pixels, silhouette)
    scores["other"] = 1.5
    faces = _faces(silhouette, tip) if silhouette is not None else {}
    return SubjectGuess(subjects=_shares(scores), faces=faces)


def _shares(scores: Mapping[Any, float]) -> dict[Any, float]:
    """Return shares of 1 from log scores, largest first."""
    weights = {name: math.exp(score) for name, score in scores.items()}
    whole = sum(weights.values())
    return {name: weights[name] / whole for name in sorted(weights, key=lambda name: -weights[name])}


def _finger_score(pixels: npt.NDArray[np.uint8], silhouette: Silhouette | None) -> float:
    if silhouette is None:
        return 0.0
    if pixels.ndim == 2:
        return 1.5
    rows, columns = silhouette.mask.shape
    small = cv2.resize(pixels, (columns, rows), interpolation=cv2.INTER_AREA)
    _, red, blue = np.moveaxis(cv2.cvtColor(small, cv2.COLOR_RGB2YCrCb), -1, 0)
    skin = (red > _SKIN_CR[0]) & (red < _SKIN_CR[1]) & (blue > _SKIN_CB[0]) & (blue < _SKIN_CB[1])
    return 1.5 + 4.0 * min(1.0, 2 * float(skin[silhouette.mask].mean()))


def _silhouette(pixels: npt.NDArray[np.uint8]) -> tuple[Silhouette | None, Direction | None]:
    """Return the finger, if one stands out from its backdrop, and where its tip points, None end on."""
    light = opponent_light(pixels)
    roots: Iterable[Direction | None] = (None, "down", "up", "left", "right")
    best: tuple[Silhouette | None, Direction | None] = None, None
    for root in roots:
        try:
            found = find_silhouette(light, root, None)
        except ImageError:
            continue
        tip = None if root is None else opposite(root)
        if set(found.cut_sides()) == {root} - {None}:
            return found, tip
        if root in found.cut_sides() and best[0] is None:
            best = found, tip
    return best


def _faces(silhouette: Silhouette, tip: Direction | None) -> dict[Face, float]:
    """Return how likely the outline is of each face."""
    if tip is None:
        scores: dict[Face, float] = {"distal": 3.0, "palmar": 0.0, "radial": 0.0, "ulnar": 0.0}
        return _shares(scores)
    side = 4.0 * math.tanh(1.5 * math.log(max(_middle_line_bend(silhouette.mask, tip), 1e-6) / _BENT))
    return _shares({"palmar": 0.0, "radial": side, "ulnar": side, "distal": -3.0})


def _middle_line_bend(mask: BoolArray, tip: Direction) -> float:
    """Return how far the middle line of a finger departs from straight near its tip, in widths."""
    upright = np.rot90(mask, {"up": 0, "right": 1, "down": 2, "left": 3}[tip])
    rows = np.flatnonzero(upright.any(axis=1))
    if rows.size < 10:
        return 0.0
    upright = upright[rows[0] :]
    left, right = upright.argmax(axis=1), upright.shape[1] - upright[:, ::-1].argmax(axis=1)
    width = float(np.max((right - left)[upright.any(axis=1)]))
    heights: FloatArray = np.arange(0.04 * width, min(1.5 * width, len(upright) - 1))
    if heights.size < 5:
        return 0.0
    at = heights.astype(int)
    middle = (left[at] + right[at]) / 2
    straight = np.polynomial.polynomial.polyfit(heights, middle, 1)
    off = middle - np.polynomial.polynomial.polyval(heights, straight)
    return float(np.sqrt(np.mean(off**2)) / width)
