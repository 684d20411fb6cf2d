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
    rows = (
        cells(f"{name}: {each}", [compare(draw(name, each, k, seed)) for k in range(count)], flags=True)
        for name, conditions in CONDITIONS.items()
        for each in conditions
    )
    table(("condition", *HEAD, "flagged"), rows)
