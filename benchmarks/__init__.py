"""What the documentation states of accuracy, speed and robustness, measured again.

``claims``
    One module for each table: ``python -m benchmarks NAME`` prints it and writes it to ``results/NAME.md``
    with its date, commit and sample.
``derive``
    Constants of the library fitted again: ``python -m benchmarks.derive NAME``.
``robustness``
    Damaged files, kills, full disks, and mutants of the code.
``truth``
    Simulators that share no model with the library. Tests use them too.
"""

import pkgutil
from pathlib import Path

ROOT = Path(__file__).parents[1]
RESULTS = Path(__file__).parent / "results"


def modules() -> dict[str, str]:
    """Return the names of what can be measured, each with its module."""
    folders = {part: str(Path(__file__).parent / part) for part in ("claims", "robustness")}
    return {
        found.name: f"benchmarks.{part}.{found.name}"
        for part, folder in folders.items()
        for found in pkgutil.iter_modules([folder])
        if found.name != "mutation_testing"
    }
