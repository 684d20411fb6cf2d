"""Shift of a contact's edge, on the three sets of images of known truth and sharp renders.

Each image gives the displacement of its outline that makes the gross area true, and what the edge model looks
at. Sets weigh alike. The constant is put midway between the most different sets, since they differ by what an
edge is. Limits of the signs were put where such fits err least.

Slopes in use depart from what is printed here. Bells alone, whose outermost ring touches nothing, want twice
the paleness: with it, areas of two more renderers, whose bells touch everywhere, come out 4 to 9 % too large,
2 to 5 % with the slope in use. It was chosen by hand, and the constant then moved in by some hundredths of a
period until small sharp contacts were right to 1 %.

An hour on one core for four images of each condition.
"""

import math
from collections.abc import Iterator
from typing import Any, Final

import numpy as np
import pandas as pd

from benchmarks.arrays import Array
from benchmarks.claims.contact_areas import sharp
from benchmarks.truth import image_sets
from benchmarks.truth.true_image import TrueImage
from fingerpad.exceptions import ImageError
from fingerpad.image.contact_image import edge as edges
from fingerpad.image.contact_image.calibration import EDGE
from fingerpad.image.contact_image.region import find_region
from fingerpad.image.contact_image.ridges import find_ridges
from fingerpad.image.contact_image.view import view_of
from fingerpad.image.ellipse import signed_area
from fingerpad.image.scale import Scale

MODEL = EDGE
_SIGNS: Final = list(edges.telling(edges.FadeSigns()))


def images(count: int, seed: int) -> Iterator[tuple[str, TrueImage]]:
    """Yield images with their set."""
    for render in sharp(6 * count, seed):
        yield "sharp", render
    for name, _, image in image_sets.images(count, seed):
        yield name, image


def look(name: str, image: TrueImage) -> dict[str, Any] | None:
    """Return the set of an image, the true displacement of its outline, periods, and what the model looks at.

    None where there is no contact with ridges.
    """
    view = view_of(image.pixels, Scale(image.mm_per_px))
    ridges = find_ridges(view, None)
    try:
        region = find_region(view, ridges, None)
        outline = edges._outline(view, ridges, region.patch)
        shown, _ = edges.fade_signs(outline, view.contact, ridges.amount, region.patch)
    except ImageError:
        return None
    if not view.resolved:
        return None
    length = float(outline.steps.sum())
    lacks = image.gross_area / (view.step * image.mm_per_px) ** 2 - abs(signed_area(outline.points))
    displacement = (math.sqrt(max(length**2 + 4 * math.pi * lacks, 0.0)) - length) / (2 * math.pi)
    # Where a contact is not found whole, nothing is learned of its edge.
    found = {"name": name, "displacement": np.clip(displacement / outline.period, -0.6, 1.6)}
    return found | edges.telling(shown)


def fit(seen: pd.DataFrame) -> Array:
    """Return the shift without signs of fading, and what each sign adds to it; sets weigh alike."""
    weights = 1 / np.sqrt(seen.groupby("name")["name"].transform("size").to_numpy())
    design = weights[:, None] * np.column_stack([np.ones(len(seen)), seen[_SIGNS]])
    found: Array = np.linalg.lstsq(design, weights * seen["displacement"], rcond=None)[0]
    errors = _errors_by_set(seen, found)
    found[0] -= (max(errors.values()) + min(errors.values())) / 2
    return found


def _errors_by_set(seen: pd.DataFrame, found: Array) -> dict[str, float]:
    errors = found[0] + seen[_SIGNS] @ found[1:] - seen["displacement"]
    return dict(errors.groupby(seen["name"], sort=False).mean())


def show(count: int, seed: int, other: int) -> None:
    """Print the fit, and the mean error of each set where it is left out of the fit, and on other images."""
    looked = ([look(*image) for image in images(count, each)] for each in (seed, other))
    seen, unseen = (pd.DataFrame([one for one in some if one is not None]) for some in looked)
    found = fit(seen)
    print(f"    sharp, by_{', by_'.join(_SIGNS)}")
    print("fitted", np.round([found[0] - EDGE.ends, *found[1:]], 3))
    slopes = [getattr(EDGE, f"by_{sign}") for sign in _SIGNS]
    print("in use", [EDGE.sharp, *slopes])
    in_use = np.array([EDGE.ends + EDGE.sharp, *slopes])
    print("Mean errors in periods, outward: left out of the fit; on other images fitted, in use")
    fitted, used = _errors_by_set(unseen, found), _errors_by_set(unseen, in_use)
    for name in fitted:
        left_out = _errors_by_set(seen, fit(seen[seen["name"] != name]))[name]
        print(f"    {name:<15} {left_out:+.3f}   {fitted[name]:+.3f} {used[name]:+.3f}")
