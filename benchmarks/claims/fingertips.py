"""Photographs of fingertips of known curvature: bias, stated uncertainty and coverage of the semi-axes."""

from collections.abc import Iterator
from typing import Final, TypeAlias

from benchmarks.tables import Row, errors_table, or_none, rows_of
from benchmarks.truth.fingertips import SHAPES, ShapedFinger, render
from benchmarks.truth.true_image import named_rng
from fingerpad.image import Face, PhotographFit, Scale, measure_photograph
from fingerpad.image.photograph.faces import Direction

SIDES: Final[dict[Face, Direction | None]] = {"palmar": None, "distal": "up", "radial": "right"}
Finger: TypeAlias = tuple[str, ShapedFinger, PhotographFit | None]


def measured(
    count: int, seed: int, faces: tuple[Face, ...] = ("palmar", "distal", "radial")
) -> Iterator[Finger]:
    """Yield each shape's name, a finger of it and its measurement, None where that is refused."""
    for name in SHAPES:
        for number in range(count):
            face = faces[number % len(faces)]
            truth = render(name, named_rng(seed, name, number), face)
            scale = Scale(truth.mm_per_px)
            yield name, truth, or_none(measure_photograph, truth.pixels, face, scale, palmar=SIDES[face])


def report(count: int = 8, seed: int = 75) -> None:
    """Print errors, stated uncertainty and coverage of the semi-axes by shape."""
    rows: dict[str, list[Row]] = {name: [] for name in SHAPES}
    refused = 0
    for name, truth, found in measured(count, seed):
        if found is None:
            refused += 1
            continue
        flagged = "not_an_ellipse" in found.flags
        rows[name] += rows_of(found.semi_axes, truth.semi_axes, found.covariance, flagged)
    errors_table(f"Semi-axes; {refused} photographs refused", rows)
