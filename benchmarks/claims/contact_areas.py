"""Contact areas and semi-axes on four sets of images that share no model with the measurement, and renders.

Independent images have ridges by Gabor filters or the Swift-Hohenberg equation; a pressure field decides over
which width ridges touch; elastic ridges are profiles pressed flat; stripes follow an orientation field.
"""

from collections.abc import Iterable, Iterator, Mapping
from itertools import chain
from typing import Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from benchmarks.claims.contact_images import population
from benchmarks.tables import off, share, stated, table
from benchmarks.truth import elastic_ridges, pressure_images, stripe_images
from benchmarks.truth.independent_images import IndependentImage, independent_images
from fingerpad.exceptions import ImageError
from fingerpad.image import ContactImageResult, measure_contact_image

Numbers = npt.NDArray[np.float64]


class Image(NamedTuple):
    """An image of a condition with its true gross area, ridge area and semi-axes, mm² and mm."""

    condition: str
    pixels: npt.NDArray[Any]
    mm_per_px: float
    truth: tuple[float, ...]


class Compared(NamedTuple):
    """Relative errors and relative standard uncertainties of the same, NaN where nothing was measured."""

    condition: str
    errors: Numbers
    stds: Numbers
    flags: tuple[str, ...]

    @property
    def held(self) -> npt.NDArray[np.bool_]:
        """Whether the 95 % intervals hold the truth."""
        return np.abs(self.errors) < 1.96 * self.stds


def compare(image: Image) -> Compared:
    """Measure an image as a user would: pixels and scale, nothing else."""
    try:
        found = measure_contact_image(image.pixels, image.mm_per_px)
    except ImageError:
        return Compared(image.condition, np.full(4, np.nan), np.full(4, np.nan), ("refused",))
    return compared(image, found)


def compared(image: Image, found: ContactImageResult) -> Compared:
    """Return the errors of what was measured in an image."""
    ellipse = found.ellipse
    values = [found.gross_area, found.ridge_area, float(ellipse.semi_major), float(ellipse.semi_minor)]
    stds, truth = np.sqrt(np.diag(found.covariance)), np.array(image.truth)
    errors = np.array(values) / truth - 1
    return Compared(image.condition, errors, stds[[2, 3, 0, 1]] / truth, found.flags)


def independent(count: int, seed: int) -> Iterator[Image]:
    """Yield independent images."""
    for name, one in independent_images(count, seed):
        yield grown(one, name)


def grown(one: IndependentImage, name: str = "") -> Image:
    """Return an independent image with its truth."""
    truth = one.gross_area, one.ridge_area, one.semi_major, one.semi_minor
    return Image(name, one.pixels, one.mm_per_px, truth)


def pressed(image: pressure_images.PressureImage, name: str = "") -> Image:
    """Return an image of a pressure field with its truth."""
    one = image.contact
    truth = one.gross_area, one.ridge_area, one.semi_major, one.semi_minor
    return Image(name, image.pixels, image.mm_per_px, truth)


def ridged(image: elastic_ridges.ElasticImage | stripe_images.StripeImage, name: str = "") -> Image:
    """Return an image of elastic ridges or of stripes with its truth."""
    return Image(name, image.pixels, image.mm_per_px, (image.gross_area, image.ridge_area, *image.semi_axes))


def sharp(count: int, seed: int) -> Iterator[Image]:
    """Yield images of the library's own renderer, nine times as many."""
    for one in population(9 * count, seed):
        ellipse = one.ellipse
        truth = one.gross_area, one.ridge_area, float(ellipse.semi_major), float(ellipse.semi_minor)
        yield Image("sharp renders", one.pixels, 25.4 / 500, truth)


CONDITIONS: Final[dict[str, Mapping[str, object]]] = {
    "pressure field": pressure_images.CONDITIONS,
    "elastic ridges": elastic_ridges.CONDITIONS,
    "stripes": stripe_images.CONDITIONS,
}


def images(count: int, seed: int) -> Iterator[tuple[str, Iterator[Image]]]:
    """Yield each set, its images of each condition one after another."""
    yield "independent images", independent(count, seed)
    for name, conditions in CONDITIONS.items():
        yield (
            name,
            chain.from_iterable(of_condition(name, condition, count, seed) for condition in conditions),
        )
    yield "sharp renders", sharp(count, seed)


def cells(name: str, some: Iterable[Compared], *, flags: bool = False) -> tuple[object, ...]:
    """Return a row: errors and what was stated of gross area, ridge area, and both semi-axes."""
    some = list(some)
    errors, stds = (np.array([getattr(one, part) for one in some]) for part in ("errors", "stds"))
    parts = [errors[:, 0], errors[:, 1], errors[:, 2:]], [stds[:, 0], stds[:, 1], stds[:, 2:]]
    numbers = [cell for e, s in zip(*parts, strict=True) for cell in (off(e), stated(e, s))]
    return name, len(some), *numbers, *([share([bool(one.flags) for one in some])] if flags else [])


HEAD: Final = (
    "n", "gross area: bias, rms error", "stated, held", "ridge area", "stated, held", "semi-axes",
    "stated, held",
)  # fmt: skip


# Conditions in which liquid beside ridges counts as ridge.
WET: Final = {
    "moist, pressure field": [("pressure field", "prism, moist")],
    "moist, elastic ridges": [("elastic ridges", "prism, moist")],
    "moist, stripes": [("stripes", "prism, moist"), ("stripes", "scanner, moist")],
    "much ink, elastic ridges": [("elastic ridges", "ink, much")],
}


def report(count: int = 3, seed: int = 7, wet: int = 8) -> None:
    """Print errors and coverage of each set, of more images of wet skin and ink, then of each condition."""
    found = {name: [compare(one) for one in of] for name, of in images(count, seed)}
    every = [one for some in found.values() for one in some]
    table(("set", *HEAD), (cells(name, some) for name, some in [*found.items(), ("all", every)]))
    liquid = (
        (name, [compare(one) for of, condition in some for one in of_condition(of, condition, wet, seed)])
        for name, some in WET.items()
    )
    table(
        ("condition", *HEAD, "flagged"), (cells(*one, flags=True) for one in liquid), "Moist skin, much ink"
    )
    print("\n<details><summary>Each condition</summary>")
    for name, some in found.items():
        conditions = dict.fromkeys(one.condition for one in some)
        table(
            ("condition", *HEAD, "flagged"),
            (cells(c, [one for one in some if one.condition == c], flags=True) for c in conditions),
            name[0].upper() + name[1:],
        )
    print("\n</details>")


def of_condition(name: str, condition: str, count: int, seed: int) -> Iterator[Image]:
    """Yield images of a condition of a set."""
    for number in range(count):
        if name == "pressure field":
            yield pressed(pressure_images.pressure_image(condition, 100 * seed + number), condition)
        elif name == "stripes":
            yield ridged(stripe_images.stripe_image(condition, number, seed), condition)
        else:
            yield ridged(elastic_ridges.elastic_image(condition, number, seed), condition)
