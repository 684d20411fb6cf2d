"""What the documentation states of accuracy, speed and robustness, measured again.

``claims``
    One module for each table: ``python -m benchmarks NAME`` prints it with its date, commit and sample;
    ``--store`` also writes it to ``results/NAME.md``, which the documentation includes.
``figures``
    Draws the figures of the documentation: ``python -m benchmarks.figures``.
``derive``
    Constants of the library fitted again: ``python -m benchmarks.derive NAME``.
``robustness``
    Mutants of the code, to see what tests do not notice.
``truth``
    Simulators that share no model with the library. Tests use them too.
"""

import pkgutil
from pathlib import Path

ROOT = Path(__file__).parents[1]
RESULTS = Path(__file__).parent / "results"


def modules() -> dict[str, str]:
    """Return the names of what can be measured, each with its module."""
    claims = pkgutil.iter_modules([str(Path(__file__).parent / "claims")])
    return {found.name: f"benchmarks.claims.{found.name}" for found in claims}
