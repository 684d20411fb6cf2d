"""Pictures that show no finger's contact, drawn by code, to see whether they are taken for one."""

from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from functools import partial
from typing import Final

import cv2
import numpy as np
import numpy.typing as npt

from benchmarks.arrays import Array, Pixels, Rng
from benchmarks.tables import table
from benchmarks.truth.independent_images import independent_images
from fingerpad.exceptions import ImageError
from fingerpad.image import Face, Scale, measure_contact_image
from fingerpad.simulate import render_finger

PPI: Final = 500
SIDE: Final = 480
FLAG: Final = "not_a_contact_image"


def _levels(values: npt.ArrayLike) -> Pixels:
    return np.asarray(np.clip(np.rint(np.asarray(values, dtype=float)), 0, 255), dtype=np.uint8)


def _noise(rng: Rng, length: float) -> Array:
    """Return noise of unit variance, smooth over a length in px."""
    noise = rng.standard_normal((SIDE, SIDE))
    smooth = cv2.GaussianBlur(noise, (0, 0), length) if length else noise
    return smooth / smooth.std()


def _coordinates() -> tuple[Array, Array]:
    """Return x and y of each pixel from the middle, as shares of half a side."""
    y, x = np.mgrid[-1 : 1 : SIDE * 1j, -1 : 1 : SIDE * 1j]
    return x, y


def _in_ellipse(texture: npt.ArrayLike, ground: float = 235) -> Pixels:
    """Return a texture seen in an ellipse of a contact's size on an even ground."""
    x, y = _coordinates()
    return _levels(np.where((x / 0.55) ** 2 + (y / 0.75) ** 2 < 1, texture, ground))


def _spectrum(rng: Rng, power: float) -> Array:
    """Return noise whose amplitude falls with a power of the frequency, as in pictures of scenes."""
    frequency = np.hypot(*np.meshgrid(np.fft.fftfreq(SIDE), np.fft.fftfreq(SIDE)))
    frequency[0, 0] = 1
    field = np.fft.ifft2(np.fft.fft2(rng.standard_normal((SIDE, SIDE))) / frequency**power).real
    return field / field.std()


def landscape(rng: Rng) -> Pixels:
    """Draw hills of grass and rock under a sky."""
    picture, row = 215 + 10 * _noise(rng, 40), np.arange(SIDE)[:, None]
    for k in range(4):
        ridge = SIDE * (0.35 + 0.15 * k) + 30 * _spectrum(rng, 1.5)[0]
        hill = 150 - 25 * k + 22 * _spectrum(rng, 0.8)
        picture = np.where(row > ridge, hill, picture)
    return _levels(picture)


def face(rng: Rng) -> Pixels:
    """Draw a face by its shading: head, hair, eyes, nose and mouth."""
    x, y = _coordinates()
    light = 150 + 60 * np.sqrt(np.clip(1 - (x / 0.5) ** 2 - (y / 0.7) ** 2, 0, 1)) + 25 * x
    picture = np.where((x / 0.5) ** 2 + (y / 0.7) ** 2 < 1, light, 90 + 10 * _noise(rng, 30))
    hair = ((x / 0.56) ** 2 + (y / 0.76) ** 2 < 1) & (y < -0.35 + 0.1 * np.cos(4 * x))
    picture = np.where(hair, 45 + 12 * _noise(rng, 2), picture)
    for sign in (-1, 1):
        far = ((x - sign * 0.2) / 0.1) ** 2 + ((y + 0.1) / 0.05) ** 2
        picture = picture - 90 * np.exp(-far)
    picture -= 40 * np.exp(-((x / 0.06) ** 2) - ((y - 0.1) / 0.12) ** 2)
    picture -= 70 * np.exp(-((x / 0.2) ** 2) - ((y - 0.35 - 0.2 * x**2) / 0.03) ** 2)
    return _levels(cv2.GaussianBlur(picture, (0, 0), 1.5) + 4 * _noise(rng, 0))


def coin(rng: Rng) -> Pixels:
    """Draw a coin: rim, milling and a relief."""
    x, y = _coordinates()
    radius, turn = np.hypot(x, y), np.arctan2(y, x)
    relief = cv2.GaussianBlur((_noise(rng, 14) > 0.3).astype(float), (0, 0), 2)
    shade = 130 + 250 * cv2.Sobel(relief, cv2.CV_64F, 1, 0, ksize=3) * (radius < 0.55)
    shade = shade + 45 * np.sign(np.sin(90 * turn)) * ((radius > 0.7) & (radius < 0.76))
    return _levels(np.where(radius < 0.76, shade, 230) + 3 * _noise(rng, 0))


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
    x, y = _coordinates()
    along = (np.cos(turn) * x + np.sin(turn) * y) * SIDE / 2 * 25.4 / PPI
    return _in_ellipse(140 + 90 * np.cos(2 * np.pi * along / period_mm))


def checkerboard(_: Rng, side_mm: float) -> Pixels:
    """Draw a checkerboard."""
    index = np.floor(np.arange(SIDE) * 25.4 / PPI / side_mm).astype(int)
    return _levels(np.where((index[:, None] + index) % 2, 40, 220))


def bricks(rng: Rng) -> Pixels:
    """Draw a wall of bricks."""
    row, column = np.mgrid[:SIDE, :SIDE]
    shift = np.where(row // 40 % 2, 0, 40)
    joint = (row % 40 < 5) | ((column + shift) % 80 < 5)
    return _levels(np.where(joint, 210, 110) + 12 * _noise(rng, 1))


def wood(rng: Rng) -> Pixels:
    """Draw the grain of wood: rings of uneven width, and fibres."""
    x, y = _coordinates()
    rings = np.sin(25 * (x + 0.15 * _noise(rng, 60) + 0.1 * y**2) + 2 * _noise(rng, 50))
    fibres = cv2.GaussianBlur(rng.standard_normal((SIDE, SIDE)), (0, 0), sigmaX=0.7, sigmaY=25)
    return _levels(150 + 35 * rings + 25 * fibres / fibres.std())


def cloth(rng: Rng, period_px: float = 14.0) -> Pixels:
    """Draw a plain weave."""
    row, column = np.mgrid[:SIDE, :SIDE] * (2 * np.pi / period_px)
    return _levels(140 + 40 * np.sin(row) * np.sin(column) + 8 * _noise(rng, 0.7))


def pebbles(rng: Rng, radius: tuple[int, int], count: int) -> Pixels:
    """Draw overlapping discs, each shaded."""
    picture = np.full((SIDE, SIDE), 200.0)
    for _ in range(count):
        centre, size = rng.integers(60, SIDE - 60, 2), int(rng.integers(*radius))
        cv2.circle(picture, tuple(int(k) for k in centre), size, float(rng.uniform(40, 180)), -1)
    return _levels(cv2.GaussianBlur(picture, (0, 0), 1) + 4 * _noise(rng, 0))


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


def chart(rng: Rng) -> Pixels:
    """Draw a bar chart with its grid."""
    picture = np.full((SIDE, SIDE), 245.0)
    for row in range(60, 420, 40):
        cv2.line(picture, (50, row), (430, row), 190.0, 1)
    for column in range(70, 420, 45):
        top = (column, int(rng.integers(80, 380)))
        cv2.rectangle(picture, top, (column + 30, 420), float(rng.uniform(40, 150)), -1)
    return _levels(picture)


def hand_photograph(rng: Rng, face: Face) -> Pixels:
    """Render a photograph of a finger, in grey, to be measured as if at 500 ppi."""
    pixels = render_finger(face, seed=int(rng.integers(1000))).pixels
    return _levels(pixels @ np.array([0.299, 0.587, 0.114]))


def _gradient(_: Rng, kind: str) -> Pixels:
    x, y = _coordinates()
    return _levels(
        {
            "linear": 128 + 100 * x,
            "radial": 240 - 150 * np.hypot(x, y),
            "spot": 235 - 170 * np.exp(-3 * (x**2 + y**2)),
            "vignette": 240 - 120 * (x**2 + y**2) ** 2,
        }[kind]
    )


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
    "gradient": tuple(partial(_gradient, kind=kind) for kind in ("linear", "radial", "spot", "vignette")),
    "face": (face, face),
    "coin": (coin, coin),
    "landscape": (landscape, landscape, landscape),
    "text": (
        text,
        lambda rng: text(rng, 0.35, 11),
        lambda rng: text(rng, 1.0, 32),
        lambda rng: text(rng, 2.5, 80),
        lambda rng: _in_ellipse(text(rng, 0.3, 9)),
    ),
    "checkerboard": tuple(partial(checkerboard, side_mm=side) for side in (0.2, 0.45, 1.0, 3.0)),
    "stripes, too coarse or fine": tuple(
        partial(stripes, period_mm=period) for period in (0.12, 0.18, 0.95, 1.4, 2.5)
    ),
    "texture": (
        bricks,
        wood,
        wood,
        cloth,
        lambda rng: cloth(rng, 9.0),
        lambda rng: cloth(rng, 30.0),
        lambda rng: pebbles(rng, (4, 9), 3000),
        lambda rng: pebbles(rng, (10, 30), 400),
    ),
    "shape": tuple(partial(shape, corners=corners) for corners in (0, 3, 4, 6)),
    "drawing": (scribble, chart),
    "photograph of a finger": tuple(
        partial(hand_photograph, face=face)
        for face in ("palmar", "distal", "radial", "ulnar", "palmar", "radial")
    ),
}


def non_prints(seed: int = 0) -> Iterator[tuple[str, Pixels]]:
    """Yield pictures without a finger's contact, each with its kind."""
    for number, (kind, draws) in enumerate(KINDS.items()):
        for k, draw in enumerate(draws):
            yield kind, draw(np.random.default_rng([seed, number, k]))


def answer(pixels: npt.ArrayLike, scale: Scale) -> str:
    """Return how a picture is taken: refused, flagged as no contact image, flagged otherwise, or accepted."""
    try:
        flags = measure_contact_image(pixels, scale).flags
    except ImageError:
        return "refused"
    return FLAG if FLAG in flags else "other flags" if flags else "accepted"


def rates(seed: int = 0, prints: int = 4) -> dict[str, dict[str, int]]:
    """Return how often each kind of picture, and of independently rendered contact, is taken how."""
    counts: dict[str, dict[str, int]] = defaultdict(Counter)
    for kind, pixels in non_prints(seed):
        counts[kind][answer(pixels, Scale.of_ppi(PPI))] += 1
    for _, image in independent_images(prints, seed):
        counts["contact images"][answer(image.pixels, Scale(image.mm_per_px))] += 1
    return counts


def report() -> None:
    """Print how pictures without a contact, and contact images, are taken."""
    answers = "refused", FLAG, "other flags", "accepted"
    counts = rates()
    table(
        ("picture of", *(name.replace(FLAG, f"`{FLAG}`") for name in answers)),
        ((kind, *(taken[name] for name in answers)) for kind, taken in counts.items()),
    )
