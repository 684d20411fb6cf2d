"""Whole studies of virtual labs: whether the 95 % intervals of ``fingerpad run`` hold the truth."""

import os
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.tables import table
from benchmarks.truth.virtual_labs.checks import check_simulator
from benchmarks.truth.virtual_labs.lab import make_lab
from benchmarks.truth.virtual_labs.reading import Comparison, by_quantity, compare


def run_lab(seed: int, out: Path) -> list[Comparison]:
    """Make a lab, run its study on one core, and compare."""
    folder = out / f"lab{seed}"
    truth = make_lab(seed, folder)
    one_core = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    command = [sys.executable, "-m", "fingerpad", "run", str(folder / "study.toml")]
    done = subprocess.run(command, capture_output=True, text=True, env=one_core, check=False)
    if not (folder / "results/summary.json").is_file():
        raise RuntimeError(f"seed {seed}: exit code {done.returncode}: {(done.stdout + done.stderr)[-500:]}")
    return list(compare(truth, folder / "results"))


def report(labs: int = 24, first_seed: int = 300, jobs: int = 1) -> None:
    """Run labs and print their table, and how well the simulator does on known contacts."""
    checks = check_simulator()
    with TemporaryDirectory() as folder, ProcessPoolExecutor(jobs) as pool:
        seeds = range(first_seed, first_seed + labs)
        found = list(pool.map(run_lab, seeds, [Path(folder)] * labs))
    table(
        ("quantity", "n", "rms error", "stated", "held", "flagged", "missed in silence"),
        by_quantity([one for some in found for one in some]),
        "Errors in per cent of the truth, x₀ in µm; rows of one lab share errors",
    )
    checked = "\n".join(f"- {line}" for line in checks)
    print(f"\n<details><summary>Checks of the simulator</summary>\n\n{checked}\n\n</details>")
