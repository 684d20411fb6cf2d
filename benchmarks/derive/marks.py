"""What tells printed letters in a contact from its ridges, on independent renders with and without them.

A choice between two answers has no least squares: each field is moved alone, by the factors of a grid, and
put in the middle of the values that err least, a letter missed and a print taken for one counting alike.
"""

from dataclasses import fields
from itertools import product
from typing import Any, Final, TypeAlias
from unittest.mock import patch

import cv2
import numpy as np

from benchmarks.arrays import Array, Rng
from benchmarks.derive.fit import changed, meanings
from benchmarks.truth import image_sets
from fingerpad.exceptions import ImageError
from fingerpad.image import Scale
from fingerpad.image.contact_image import ridges
from fingerpad.image.contact_image.calibration import PRINTED_MARKS, PrintedMarks
from fingerpad.image.contact_image.edge import trace_edge
from fingerpad.image.contact_image.region import find_region
from fingerpad.image.contact_image.view import view_of

MODEL = PRINTED_MARKS
_FACTORS: Final = np.geomspace(0.5, 2, 13)
_FONTS: Final = (cv2.FONT_HERSHEY_SIMPLEX, cv2.FONT_HERSHEY_COMPLEX, cv2.FONT_HERSHEY_SCRIPT_COMPLEX)
_HEIGHT_MM: Final = (1.7, 2.5)  # of letters on forms
_STROKE: Final = 0.16  # of the height


# What `ridges._has_print` is given, and whether there are letters.
Seen: TypeAlias = tuple[tuple[Any, ...], bool]


def _with_text(pixels: Array, mm_per_px: float, rng: Rng) -> Array:
    """Write a line across the middle half of an image, as dark as its darkest ridges."""
    height = rng.uniform(*_HEIGHT_MM) / mm_per_px
    font, stroke = int(rng.choice(_FONTS)), max(1, round(_STROKE * height))
    row = round(rng.uniform(0.35, 0.65) * len(pixels) + height / 2)
    text = np.zeros(pixels.shape, np.uint8)
    size = cv2.getFontScaleFromHeight(font, round(height), stroke)
    cv2.putText(text, "FINGERS TAKEN SIMUL " * 3, (0, row), font, size, 255, stroke, cv2.LINE_AA)
    share = text / 255
    return np.asarray(np.rint((1 - share) * pixels + share * 0.5 * pixels.min()), dtype=pixels.dtype)


def sample(count: int, seed: int) -> list[Seen]:
    """Return what is seen of each image, with letters and without, where ridges are dark and resolved."""
    rng = np.random.default_rng(seed)
    images = (one for *_, one in image_sets.images(count, seed, ("independent images", "elastic ridges")))
    found = []
    for one, letters in product(images, (False, True)):
        pixels = _with_text(one.pixels, one.mm_per_px, rng) if letters else one.pixels
        view = view_of(pixels, Scale(one.mm_per_px))
        if not (view.dark_on_light and view.resolved):
            continue
        try:
            rough = ridges.find_ridges(view, None)
            edge = trace_edge(view, rough, find_region(view, rough, None))
        except ImageError:
            continue
        with patch.object(ridges, "_has_print", lambda *given: given):
            given: Any = ridges.ridge_map(view, edge.points, None).has_print
        found.append((given, letters))
    return found


def errors(model: PrintedMarks, seen: list[Seen]) -> tuple[float, float]:
    """Return the share of images whose letters are missed, and of those where ridges pass for letters."""
    with patch.object(ridges, "PRINTED_MARKS", model):
        wrong = [[ridges._has_print(*given) != letters, letters] for given, letters in seen]
    off, letters = np.array(wrong).T
    return float(off[letters].mean()), float(off[~letters].mean())


def fitted(seen: list[Seen]) -> dict[str, tuple[float, float, float]]:
    """Return for each field the middle, the least and the greatest of the values that err least."""
    found = {}
    for each in fields(MODEL):
        used = getattr(MODEL, each.name)
        values = [1, 2, 3, 4] if each.type is int else (used * _FACTORS).tolist()
        models = [changed(MODEL, (each.name,), np.array([value])) for value in values]
        wrong = [sum(errors(model, seen)) for model in models]
        best = [value for value, share in zip(values, wrong, strict=True) if share <= min(wrong) + 1e-9]
        found[each.name] = (best[len(best) // 2], best[0], best[-1])
    return found


def show(count: int, seed: int, other: int) -> None:
    """Print the values that err least, and how both do on other images."""
    seen = sample(count, seed)
    print(f"PrintedMarks, {len(seen)} images of seed {seed}")
    print(f"    {'field':<10} {'in the code':>12} {'fitted':>8}   err least          unit; meaning")
    found, comments = fitted(seen), meanings(MODEL)
    for name, (value, least, most) in found.items():
        used = getattr(MODEL, name)
        print(f"    {name:<10} {used!s:>12} {value:>8.3g}   {least:<6.3g} to {most:<6.3g}  {comments[name]}")
    unseen = sample(count, other)
    print(f"    on {len(unseen)} images of seed {other}:")
    models = {f"{name} fitted": changed(MODEL, (name,), np.array([one[0]])) for name, one in found.items()}
    for words, model in {"in the code": MODEL, **models}.items():
        missed, taken = errors(model, unseen)
        print(f"    {words:<18} letters missed {missed:.1%}, ridges taken for letters {taken:.1%}")
