"""Three sets of contact images of known truth that share no model with the measurement.

Independent images have ridges by Gabor filters or the Swift-Hohenberg equation; elastic ridges are profiles
pressed flat; stripes follow an orientation field.
"""

from collections.abc import Iterable, Iterator
from typing import Any, Final

from benchmarks.truth import elastic_ridges, independent_images, stripe_images
from benchmarks.truth.true_image import TrueImage, named_rng

_SETS: Final[dict[str, Any]] = {
    "independent images": independent_images,
    "elastic ridges": elastic_ridges,
    "stripes": stripe_images,
}
CONDITIONS: Final[dict[str, dict[str, Any]]] = {name: module.CONDITIONS for name, module in _SETS.items()}


def draw(name: str, condition: str, number: int, seed: int) -> TrueImage:
    """Return an image of a condition of a set; it depends on nothing else."""
    image: TrueImage = _SETS[name].render(named_rng(seed, condition, number), CONDITIONS[name][condition])
    return image


def images(
    count: int, seed: int, sets: Iterable[str] = tuple(CONDITIONS)
) -> Iterator[tuple[str, str, TrueImage]]:
    """Yield set, condition and image, ``count`` of each condition."""
    for name in sets:
        for condition in CONDITIONS[name]:
            for number in range(count):
                yield name, condition, draw(name, condition, number, seed)
