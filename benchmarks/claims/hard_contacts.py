"""Contact images in conditions in which intervals miss the truth, or ridge areas are wrong."""

from typing import Final

from benchmarks.claims.contact_areas import HEAD, cells, compare, of_condition
from benchmarks.tables import table

CONDITIONS: Final = {
    "pressure field": (
        "prism, bell-shaped pressure",
        "prism, moist",
        "light touch, ridges along the edge",
        "plate lit from above",
    ),
    "elastic ridges": ("prism, moist", "ink, much"),
    "stripes": ("prism, bell", "prism, dark rim", "prism, moist", "scanner, moist"),
}


def report(count: int = 8, seed: int = 8) -> None:
    """Print errors, coverage and flags of each condition."""
    rows = (
        cells(f"{name}: {each}", map(compare, of_condition(name, each, count, seed)), flags=True)
        for name, conditions in CONDITIONS.items()
        for each in conditions
    )
    table(("condition", *HEAD, "flagged"), rows)
