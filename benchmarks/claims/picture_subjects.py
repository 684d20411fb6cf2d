"""What pictures are taken for without a word about them.

Rendered contact images, fingers, coins and rulers that share no model with the library, the example study,
real prints where they are on the machine, and pictures of other things. A guess is sure from 0.9 on; the page
asks about the others.
"""

from collections import Counter, defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from tests.image import coin_scenes, ruler_scenes

from benchmarks.claims.fingertips import SHAPES, render
from benchmarks.claims.non_prints import non_prints
from benchmarks.claims.photographs import random_finger
from benchmarks.truth.independent_images import independent_images
from benchmarks.truth.pressure_images import CONDITIONS, pressure_image
from fingerpad.image import Face, guess_subject, read_colour_image
from fingerpad.simulate import render_coin
from fingerpad.study.imports.identify import SURE

ROOT = Path(__file__).resolve().parents[2]
REAL = ROOT.parent / "shared" / "data"
Pixels = npt.NDArray[Any]


def pictures(each: int, seed: int) -> Iterator[tuple[str, Pixels, str]]:
    """Yield what a picture shows, the picture, and the face of a finger."""
    example = ROOT / "examples" / "dzidek2017" / "synthetic"
    for path in sorted(example.glob("*.png")):
        yield "contact", read_colour_image(path), ""
    for path in sorted(REAL.glob("nist_*/*.p[ng][mg]")):
        yield "other: blank card" if "a999" in path.name else "contact", read_colour_image(path), ""
    for number in range(4 * each):
        finger = random_finger(seed + number, 60)
        yield "finger", finger.pixels, finger.face
    faces: tuple[Face, ...] = ("palmar", "distal", "radial")
    for number in range(each):
        name = list(SHAPES)[number % len(SHAPES)]
        for face in faces:
            yield "finger", render(np.random.default_rng([seed, number]), name, face).pixels, face
        yield "coin", render_coin(radius=110.0, seed=seed + number).pixels, ""
        for kind in coin_scenes.KINDS:
            yield "coin", coin_scenes.scene(kind, seed + number).pixels, ""
        for kind in ruler_scenes.KINDS:
            yield "ruler", ruler_scenes.ruler_scene(kind, seed + number), ""
        for name in CONDITIONS:
            yield "contact", pressure_image(name, seed + number).pixels, ""
    for _, image in independent_images(each, seed):
        yield "contact", image.pixels, ""
    for kind, pixels in non_prints(seed):
        if kind not in {"coin", "photograph of a finger"}:
            yield f"other: {kind}", pixels, ""


def report(each: int = 2, seed: int = 900) -> None:
    """Print what each kind of picture is taken for, and how often surely and wrongly."""
    taken: dict[str, Counter[str]] = defaultdict(Counter)
    faces: dict[str, Counter[str]] = defaultdict(Counter)
    for subject, pixels, face in pictures(each, seed):
        guess = guess_subject(pixels)
        best = next(iter(guess.subjects))
        sure = guess.subjects[best] >= SURE
        right = best == subject.partition(":")[0]
        taken[subject][best] += 1
        taken[subject]["asked" if not sure else "surely right" if right else "surely wrong"] += 1
        if face:
            faces[face][next(iter(guess.faces), "none")] += 1
    names = ("contact", "finger", "coin", "ruler", "other", "surely right", "asked", "surely wrong")
    print(f"    {'':<34}", *(f"{name:>13}" for name in names))
    for subject, counts in taken.items():
        print(f"    {subject:<34}", *(f"{counts[name]:13d}" for name in names))
    for face, counts in faces.items():
        print(f"    face {face:<29}", dict(counts))
