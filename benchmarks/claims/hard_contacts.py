"""Contact images in conditions in which intervals miss the truth, or ridge areas are wrong."""

from typing import Final

from benchmarks.claims.contact_areas import HEAD, cells, compare
from benchmarks.tables import table
from benchmarks.truth.image_sets import draw

CONDITIONS: Final = {
    "stripes": ("prism, dark rim", "prism, bell", "prism, moist", "scanner, moist"),
    "elastic ridges": (
        "light touch, ridges along the edge", "bell-shaped pressure", "prism, moist", "plate lit from above",
        "ink, much",
    ),
}  # fmt: skip


def report(count: int = 12, seed: int = 8) -> None:
    """Print errors, coverage and flags of each condition."""
    found = {
        f"{name}: {each}": [compare(draw(name, each, number, seed)) for number in range(count)]
        for name, conditions in CONDITIONS.items()
        for each in conditions
    }
    rows = (cells(name, some, flags=True) for name, some in found.items())
    table(("condition", *HEAD, "flagged"), rows)
