"""Contact areas and semi-axes on three sets of images that share no model with the measurement."""

from collections.abc import Iterable, Iterator
from typing import Final, Literal, NamedTuple

import numpy as np

from benchmarks.arrays import Array
from benchmarks.tables import off, or_none, share, stated, table
from benchmarks.truth import image_sets
from benchmarks.truth.true_image import TrueImage
from fingerpad.image import ContactImageResult, measure_contact_image
from fingerpad.simulate import SyntheticContactImage, render_contact_image

LOOKS: tuple[Literal["ink", "livescan", "prism"], ...] = ("ink", "livescan", "prism")
PATTERNS: tuple[Literal["arch", "loop", "whorl"], ...] = ("arch", "loop", "whorl")
NOISES = (4.0, 12.0, 25.0)


def population(count: int, seed: int = 1) -> Iterator[SyntheticContactImage]:
    """Render a broad population: sizes, outlines, looks, patterns, noise, blur, light, compression."""
    rng = np.random.default_rng(seed)
    for k in range(count):
        area, ratio = rng.uniform(100, 300), rng.uniform(1.0, 1.8)
        semi_minor = np.sqrt(area / np.pi / ratio)
        yield render_contact_image(
            semi_major=semi_minor * ratio,
            semi_minor=semi_minor,
            orientation=rng.uniform(-np.pi / 2, np.pi / 2),
            ridge_period=rng.uniform(0.38, 0.55),
            pattern=PATTERNS[k // 8 % 3],
            look=LOOKS[k % 3],
            noise_std=NOISES[rng.integers(3)],
            blur=rng.uniform(0, 0.08),
            lighting=rng.uniform(0, 0.4),
            irregularity=rng.choice([0, rng.uniform(0, 0.04)]),
            creases=int(rng.integers(0, 4)),
            jpeg_quality=int(rng.integers(60, 96)),
            seed=int(rng.integers(1 << 31)),
            ridge_seed=int(1000 * seed + k // 8),
        )


class Compared(NamedTuple):
    """Relative errors of gross area, ridge area and semi-axes, with their relative standard uncertainties.

    They are NaN where nothing was measured.
    """

    errors: Array
    stds: Array
    flags: tuple[str, ...]

    @property
    def held(self) -> Array:
        """Whether the 95 % intervals hold the truth."""
        return np.abs(self.errors) < 1.96 * self.stds


def compare(image: TrueImage) -> Compared:
    """Measure an image as a user would: pixels and scale, nothing else."""
    found, none = or_none(measure_contact_image, image.pixels, image.mm_per_px), np.full(4, np.nan)
    return compared(image, found) if found else Compared(none, none, ("refused",))


def compared(image: TrueImage, found: ContactImageResult) -> Compared:
    """Return the errors of what was measured in an image."""
    ellipse, truth = found.ellipse, np.array([image.gross_area, image.ridge_area, *image.semi_axes])
    values = [found.gross_area, found.ridge_area, float(ellipse.semi_major), float(ellipse.semi_minor)]
    stds = np.sqrt(np.diag(found.covariance))
    return Compared(np.array(values) / truth - 1, stds[[2, 3, 0, 1]] / truth, found.flags)


def sharp(count: int, seed: int) -> Iterator[TrueImage]:
    """Yield images of the library's own renderer."""
    for one in population(count, seed):
        axes = float(one.ellipse.semi_major), float(one.ellipse.semi_minor)
        yield TrueImage(one.pixels, one.mm_per_px, one.gross_area, one.ridge_area, axes)


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


def report(count: int = 3, seed: int = 7) -> None:
    """Print errors and coverage of each set, then of each condition."""
    found: dict[str, dict[str, list[Compared]]] = {}
    for name, condition, image in image_sets.images(count, seed):
        found.setdefault(name, {}).setdefault(condition, []).append(compare(image))
    found["sharp renders"] = {"sharp renders": [compare(one) for one in sharp(9 * count, seed)]}
    by_set = {name: [one for some in of.values() for one in some] for name, of in found.items()}
    table(("set", *HEAD), (cells(name, some) for name, some in by_set.items()))
    print("\n<details><summary>Each condition</summary>")
    for name, conditions in found.items():
        rows = (cells(condition, some, flags=True) for condition, some in conditions.items())
        table(("condition", *HEAD, "flagged"), rows, name[0].upper() + name[1:])
    print("\n</details>")
