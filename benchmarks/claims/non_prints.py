"""Pictures that show no finger's contact, photographs and drawings, to see whether they are taken for one."""

from collections import Counter, defaultdict
from collections.abc import Callable
from functools import partial
from typing import Final

import cv2
import numpy as np
import numpy.typing as npt
import skimage.data

from benchmarks.arrays import Array, Pixels, Rng
from benchmarks.tables import or_none, table
from benchmarks.truth import image_sets
from fingerpad.image import Face, Scale, measure_contact_image
from fingerpad.simulate import render_finger

PPI: Final = 500
SIDE: Final = 480
FLAG: Final = "not_a_contact_image"
# x and y of each pixel from the middle, as shares of half a side
_Y, _X = np.mgrid[-1 : 1 : SIDE * 1j, -1 : 1 : SIDE * 1j]


def _levels(values: npt.ArrayLike) -> Pixels:
    return np.asarray(np.clip(np.rint(np.asarray(values, dtype=float)), 0, 255), dtype=np.uint8)


def _noise(rng: Rng, length: float) -> Array:
    """Return noise of unit variance, smooth over a length in px."""
    noise = rng.standard_normal((SIDE, SIDE))
    smooth = cv2.GaussianBlur(noise, (0, 0), length) if length else noise
    return smooth / smooth.std()


def _in_ellipse(texture: npt.ArrayLike) -> Pixels:
    """Return a texture seen in an ellipse of a contact's size on an even ground."""
    return _levels(np.where((_X / 0.55) ** 2 + (_Y / 0.75) ** 2 < 1, texture, 235))


def _spectrum(rng: Rng, power: float) -> Array:
    """Return noise whose amplitude falls with a power of the frequency, as in pictures of scenes."""
    frequency = np.hypot(*np.meshgrid(np.fft.fftfreq(SIDE), np.fft.fftfreq(SIDE)))
    frequency[0, 0] = 1
    field = np.fft.ifft2(np.fft.fft2(rng.standard_normal((SIDE, SIDE))) / frequency**power).real
    return field / field.std()


def photograph(_: Rng, name: str) -> Pixels:
    """Return the middle square of a picture that comes with scikit-image, in grey."""
    pixels = getattr(skimage.data, name)()
    grey = cv2.cvtColor(pixels, cv2.COLOR_RGB2GRAY) if pixels.ndim == 3 else pixels
    side = min(grey.shape)
    top, left = ((size - side) // 2 for size in grey.shape)
    square = grey[top : top + side, left : left + side]
    return np.asarray(cv2.resize(square, (SIDE, SIDE), interpolation=cv2.INTER_AREA), np.uint8)


def text(rng: Rng, size: float = 0.5, step: int = 16) -> Pixels:
    """Draw lines of printed letters."""
    picture = np.full((SIDE, SIDE), 240, np.uint8)
    letters = list("ABCDEFGHIJKLMNOPQRSTUVWXYZ abcdefghijklmnopqrstuvwxyz")
    for row in range(60, SIDE - 40, step):
        line = "".join(rng.choice(letters, size=200))
        width = cv2.getTextSize(line, cv2.FONT_HERSHEY_SIMPLEX, size, 1)[0][0]
        line = line[: int(200 * (SIDE - 100) / width)]
        cv2.putText(picture, line, (50, row), cv2.FONT_HERSHEY_SIMPLEX, size, 30, 1, cv2.LINE_AA)
    return picture


def stripes(_: Rng, period_mm: float, turn: float = 0.3) -> Pixels:
    """Draw straight stripes within an ellipse."""
    along = (np.cos(turn) * _X + np.sin(turn) * _Y) * SIDE / 2 * 25.4 / PPI
    return _in_ellipse(140 + 90 * np.cos(2 * np.pi * along / period_mm))


def checkerboard(_: Rng, side_mm: float) -> Pixels:
    """Draw a checkerboard."""
    index = np.floor(np.arange(SIDE) * 25.4 / PPI / side_mm).astype(int)
    return _levels(np.where((index[:, None] + index) % 2, 40, 220))


def shape(rng: Rng, corners: int) -> Pixels:
    """Draw a dark polygon, or a disc without corners, on a light ground."""
    picture = np.full((SIDE, SIDE), 225.0)
    if corners:
        angles = 2 * np.pi * np.arange(corners) / corners + rng.uniform(0, 1)
        points = SIDE / 2 + 0.35 * SIDE * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
        cv2.fillPoly(picture, [np.rint(points).astype(np.int32)], 60.0)
    else:
        cv2.circle(picture, (SIDE // 2, SIDE // 2), SIDE // 3, 60.0, -1)
    return _levels(picture + 5 * _noise(rng, 0))


def scribble(rng: Rng) -> Pixels:
    """Draw the lines of a pen that wanders."""
    picture = np.full((SIDE, SIDE), 235.0)
    path = SIDE / 2 + 150 * np.stack([np.sin(np.linspace(0, 40, 900)), np.cos(np.linspace(0, 29, 900))], -1)
    cv2.polylines(picture, [np.rint(path + rng.normal(0, 2, path.shape)).astype(np.int32)], False, 30.0, 2)
    return _levels(picture + 3 * _noise(rng, 0))


def hand_photograph(rng: Rng, face: Face) -> Pixels:
    """Render a photograph of a finger, in grey, to be measured as if at 500 ppi."""
    return _levels(render_finger(face, seed=int(rng.integers(1000))).pixels @ np.array([0.299, 0.587, 0.114]))


def chart(rng: Rng) -> Pixels:
    """Draw a bar chart with its grid."""
    picture = np.full((SIDE, SIDE), 245.0)
    for row in range(60, 420, 40):
        cv2.line(picture, (50, row), (430, row), 190.0, 1)
    for column in range(70, 420, 45):
        top = (column, int(rng.integers(80, 380)))
        cv2.rectangle(picture, top, (column + 30, 420), float(rng.uniform(40, 150)), -1)
    return _levels(picture)


FACES: Final[tuple[Face, ...]] = ("palmar", "distal", "radial", "ulnar", "palmar", "radial")
# Pictures that come with scikit-image, by what they show.
PHOTOGRAPHS: Final = {
    "photograph of a face": ("astronaut", "camera", "cat"),
    "photograph of coins": ("coins",),
    "photograph of something else": (
        "rocket", "coffee", "clock", "moon", "hubble_deep_field", "page", "text",
    ),
    "photograph of brick, grass, gravel": ("brick", "grass", "gravel"),
    "picture by a microscope": ("cell", "immunohistochemistry", "microaneurysms", "retina"),
}  # fmt: skip
Draw = Callable[[Rng], Pixels]
KINDS: Final[dict[str, tuple[Draw, ...]]] = {
    "blank paper": (
        lambda rng: _levels(245 + 0 * _noise(rng, 0)),
        lambda rng: _levels(240 + 2 * _noise(rng, 0)),
        lambda rng: _levels(225 + 6 * _noise(rng, 1.5) + 10 * _noise(rng, 80)),
        lambda rng: _levels(235 + 8 * _noise(rng, 3)),
    ),
    "noise": (
        *(lambda rng, length=length: _levels(128 + 40 * _noise(rng, length)) for length in (0, 1.5, 3, 8)),
        *(lambda rng, length=length: _in_ellipse(110 + 40 * _noise(rng, length)) for length in (0, 2, 4)),
        lambda rng: _in_ellipse(110 + 40 * (_noise(rng, 1.5) - _noise(rng, 4))),
        lambda rng: _levels(128 + 45 * _spectrum(rng, 1)),
        lambda rng: _levels(128 + 45 * _spectrum(rng, 1.6)),
    ),
    "gradient": (
        lambda _: _levels(128 + 100 * _X),
        lambda _: _levels(240 - 150 * np.hypot(_X, _Y)),
        lambda _: _levels(235 - 170 * np.exp(-3 * (_X**2 + _Y**2))),
        lambda _: _levels(240 - 120 * (_X**2 + _Y**2) ** 2),
    ),
    **{of: tuple(partial(photograph, name=name) for name in names) for of, names in PHOTOGRAPHS.items()},
    "text": (
        text,
        lambda rng: text(rng, 0.35, 11),
        lambda rng: text(rng, 1.0, 32),
        lambda rng: text(rng, 2.5, 80),
        lambda rng: _in_ellipse(text(rng, 0.3, 9)),
    ),
    "checkerboard": tuple(partial(checkerboard, side_mm=side) for side in (0.2, 0.45, 1.0, 3.0)),
    "stripes, too coarse or fine": tuple(partial(stripes, period_mm=p) for p in (0.12, 0.18, 0.95, 1.4, 2.5)),
    "shape": tuple(partial(shape, corners=corners) for corners in (0, 3, 4, 6)),
    "drawing": (scribble, chart),
    "photograph of a finger": tuple(partial(hand_photograph, face=face) for face in FACES),
}


def answer(pixels: npt.ArrayLike, scale: Scale) -> str:
    """Return how a picture is taken: refused, flagged as no contact image, flagged otherwise, or accepted."""
    if (found := or_none(measure_contact_image, pixels, scale)) is None:
        return "refused"
    return FLAG if FLAG in found.flags else "other flags" if found.flags else "accepted"


def report() -> None:
    """Print how pictures without a contact, and independently rendered contact images, are taken."""
    counts: dict[str, dict[str, int]] = defaultdict(Counter)
    for number, (kind, draws) in enumerate(KINDS.items()):
        for k, draw in enumerate(draws):
            counts[kind][answer(draw(np.random.default_rng([0, number, k])), Scale.of_ppi(PPI))] += 1
    for *_, image in image_sets.images(4, 0, ("independent images",)):
        counts["contact images"][answer(image.pixels, Scale(image.mm_per_px))] += 1
    answers = "refused", FLAG, "other flags", "accepted"
    table(
        ("picture of", *(name.replace(FLAG, f"`{FLAG}`") for name in answers)),
        ((kind, *(taken[name] for name in answers)) for kind, taken in counts.items()),
    )
