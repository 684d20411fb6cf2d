"""Make virtual labs, run ``fingerpad run`` on each, and print whether its 95 % intervals hold the truth."""

import argparse
import json
import os
import shutil
import subprocess
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from pathlib import Path

from .checks import check_simulator
from .lab import make_lab
from .paraboloid import PROGRAM, check_paraboloid
from .reading import Comparison, compare, silent_misses, table, verdicts


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


def main() -> None:
    """Run the labs that the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.virtual_labs", description=__doc__)
    parser.add_argument("--labs", type=int, default=24)
    parser.add_argument("--seed", type=int, default=100, help="of the first lab; the others follow it")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--only", type=int, help="run the lab of this seed alone, and keep its folder")
    parser.add_argument("--keep", action="store_true", help="keep the folders of all labs")
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    lines = ["Checks of the simulator:", *check_simulator()]
    print("\n  ".join(lines), flush=True)
    alone = given.only is not None
    seeds = [given.only] if alone else range(given.seed, given.seed + given.labs)
    comparisons: list[Comparison] = []
    failures = []
    with ProcessPoolExecutor(given.jobs) as pool:
        futures = {s: pool.submit(run_lab, s, given.out, keep=given.keep or alone) for s in seeds}
        for seed, future in futures.items():
            found, failure = future.result()
            comparisons += found
            failures += [failure] if failure else []
            print(
                f"lab {seed}: {len(found)} numbers, silent misses: {sum(c.silent for c in found)}", flush=True
            )
    parts = [table(comparisons), verdicts(comparisons), ["Silent misses:", *silent_misses(comparisons)]]
    parts += [["Failures:", *failures]] if failures else []
    parts += [] if alone else [["Hertzian paraboloid, no layer:", *check_paraboloid(given.out)]]
    text = "\n\n".join("\n".join(part) for part in parts)
    print(f"\n{text}")
    (given.out / "table.txt").write_text("\n".join(lines) + f"\n\n{text}\n")


if __name__ == "__main__":
    main()
