"""Three sets of contact images of known truth that share no model with the measurement.

Independent images have ridges by Gabor filters or the Swift-Hohenberg equation; elastic ridges are profiles
pressed flat; stripes follow an orientation field.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Final

from benchmarks.truth import elastic_ridges, independent_images, stripe_images
from benchmarks.truth.true_image import TrueImage

# Conditions of each set, and what makes an image of one with a number and a seed.
_SETS: Final[dict[str, tuple[Mapping[str, object], Callable[[str, int, int], TrueImage]]]] = {
    "independent images": (independent_images.CONDITIONS, independent_images.independent_image),
    "elastic ridges": (elastic_ridges.CONDITIONS, elastic_ridges.elastic_image),
    "stripes": (stripe_images.CONDITIONS, stripe_images.stripe_image),
}
CONDITIONS: Final = {name: conditions for name, (conditions, _) in _SETS.items()}


def draw(name: str, condition: str, number: int, seed: int) -> TrueImage:
    """Return an image of a condition of a set; it depends on nothing else."""
    return _SETS[name][1](condition, number, seed)


def images(
    count: int, seed: int, sets: Iterable[str] = tuple(CONDITIONS), *, without: str | None = None
) -> Iterator[tuple[str, str, TrueImage]]:
    """Yield set, condition and image, ``count`` of each condition; without conditions that are named so."""
    for name in sets:
        for condition in CONDITIONS[name]:
            if without is None or without not in condition:
                for number in range(count):
                    yield name, condition, draw(name, condition, number, seed)
