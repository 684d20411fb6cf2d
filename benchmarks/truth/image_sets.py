"""Four sets of contact images of known truth that share no model with the measurement, by name and condition.

Independent images have ridges by Gabor filters or the Swift-Hohenberg equation; a pressure field decides over
which width ridges touch; elastic ridges are profiles pressed flat; stripes follow an orientation field.
"""

from collections.abc import Iterable, Iterator, Mapping
from typing import Final

from benchmarks.truth import elastic_ridges, independent_images, pressure_images, stripe_images
from benchmarks.truth.true_image import TrueImage

CONDITIONS: Final[dict[str, Mapping[str, object]]] = {
    "independent images": independent_images.CONDITIONS,
    "pressure field": pressure_images.CONDITIONS,
    "elastic ridges": elastic_ridges.CONDITIONS,
    "stripes": stripe_images.CONDITIONS,
}


def draw(name: str, condition: str, number: int, seed: int) -> TrueImage:
    """Return an image of a condition of a set; it depends on nothing else."""
    if name == "independent images":
        return independent_images.independent_image(condition, number, seed)
    if name == "pressure field":
        return pressure_images.pressure_image(condition, 100 * seed + number)
    if name == "elastic ridges":
        return elastic_ridges.elastic_image(condition, number, seed)
    return stripe_images.stripe_image(condition, number, seed)


def images(
    count: int, seed: int, sets: Iterable[str] = tuple(CONDITIONS), *, without: str | None = None
) -> Iterator[tuple[str, str, TrueImage]]:
    """Yield set, condition and image, ``count`` of each condition; without conditions that are named so."""
    for name in sets:
        for condition in CONDITIONS[name]:
            if without is None or without not in condition:
                for number in range(count):
                    yield name, condition, draw(name, condition, number, seed)
