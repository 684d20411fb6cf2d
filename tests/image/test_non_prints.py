"""Pictures without finger ridges are flagged, contact images are not; see benchmarks/claims/non_prints.py."""

import numpy as np
import pytest
from benchmarks.claims.contact_areas import population
from benchmarks.claims.non_prints import FLAG, KINDS, answer, stripes
from benchmarks.truth import image_sets

from fingerpad.image import Scale
from fingerpad.simulate import render_contact_image

PPI_500 = Scale.of_ppi(500)


@pytest.mark.parametrize("kind", KINDS)
def test_pictures_without_ridges_are_refused_or_flagged(kind):
    pictures = [draw(np.random.default_rng([9, k])) for k, draw in enumerate(KINDS[kind][:3])]
    assert {answer(pixels, PPI_500) for pixels in pictures} <= {"refused", FLAG}


@pytest.mark.parametrize(
    "name", ["light rim", "300 ppi", "not an ellipse", "breaks, pores and creases", "everything"]
)
def test_independent_contact_images_are_not_flagged(name):
    image = image_sets.draw("independent images", name, 0, 3)
    assert answer(image.pixels, Scale(image.mm_per_px)) != FLAG


def test_rendered_contact_images_are_not_flagged():
    assert FLAG not in {answer(truth.pixels, PPI_500) for truth in population(4, seed=8)}


@pytest.mark.parametrize("size", [1.2, 1.6, 2, 3])
def test_small_contacts_are_not_flagged(size):
    for seed, pattern in enumerate(("arch", "loop", "whorl")):
        truth = render_contact_image(semi_major=1.2 * size, semi_minor=size, pattern=pattern, seed=seed)
        assert answer(truth.pixels, PPI_500) != FLAG


def test_a_picture_too_coarse_for_ridges_is_not_flagged():
    assert answer(stripes(np.random.default_rng(0), 2.5), Scale(0.13)) != FLAG
