"""Whole studies of virtual labs: whether the 95 % intervals of ``fingerpad run`` hold the truth."""

import json
import os
import shutil
import subprocess
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.tables import table
from benchmarks.truth.virtual_labs.checks import check_simulator
from benchmarks.truth.virtual_labs.lab import make_lab
from benchmarks.truth.virtual_labs.paraboloid import PROGRAM, check_paraboloid
from benchmarks.truth.virtual_labs.reading import Comparison, by_quantity, compare, silent_misses, verdicts


def run_lab(seed: int, out: Path, *, keep: bool) -> tuple[list[Comparison], str]:
    """Make a lab, run its study on one core, compare; keep its folder if wanted or if the run failed."""
    folder = out / f"lab{seed}"
    shutil.rmtree(folder, ignore_errors=True)
    truth = make_lab(seed, folder)
    (folder / "truth.json").write_text(json.dumps(asdict(truth), indent=1))
    one_core = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    command = [PROGRAM, "run", str(folder / "study.toml")]
    done = subprocess.run(command, capture_output=True, text=True, env=one_core, check=False)
    (folder / "printed.txt").write_text(done.stdout + done.stderr)
    if not (folder / "results/summary.json").is_file():
        return [], f"seed {seed}: exit code {done.returncode}: {(done.stdout + done.stderr)[-500:]}"
    found = compare(truth, folder / "results")
    (out / f"lab{seed}.json").write_text(json.dumps([asdict(c) for c in found]))
    if not keep and done.returncode == 0:
        shutil.rmtree(folder)
    return found, f"seed {seed}: exit code {done.returncode}" if done.returncode else ""


def report(labs: int = 24, first_seed: int = 100, jobs: int = 1, keep: str = "") -> None:
    """Run labs and print their tables; what they wrote stays in the folder `keep`, if one is named."""
    checks = check_simulator()
    comparisons: list[Comparison] = []
    failures = []
    with TemporaryDirectory() as folder, ProcessPoolExecutor(jobs) as pool:
        out = Path(keep or folder)
        out.mkdir(parents=True, exist_ok=True)
        seeds = range(first_seed, first_seed + labs)
        futures = [pool.submit(run_lab, seed, out, keep=bool(keep)) for seed in seeds]
        for future in futures:
            found, failure = future.result()
            comparisons += found
            failures += [failure] if failure else []
        checks += check_paraboloid(out) if labs > 1 else []
    table(
        ("quantity", "n", "rms error", "stated", "held", "flagged", "missed in silence"),
        by_quantity(comparisons),
        "Errors in per cent of the truth, x₀ in µm; rows of one lab share errors",
    )
    for lines in (verdicts(comparisons), checks, silent_misses(comparisons), failures):
        print("\n" + "\n".join(f"- {line}" for line in lines))
