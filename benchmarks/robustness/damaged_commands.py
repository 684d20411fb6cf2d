"""Damaged manifests and tables through the commands that read them.

Values, types, keys and bytes are changed at random. Each command must give a result in time or
refuse in words.
"""

import random
import shutil
import signal
import traceback
from pathlib import Path
from typing import Final

from typer.testing import CliRunner

from benchmarks.robustness.damaged_studies import DEMO, Outcomes, damaged
from fingerpad.cli import app
from fingerpad.report import write_report
from fingerpad.study.pipeline import run_study

PATIENCE_S: Final = 120.0
RUN_EVERY, FIT_EVERY = 40, 50
RESULTS: Final = " ,Label,Major,Minor,Angle\n1,a_30deg_2N.png,300,200,90\n2,b_45deg_1N.png,280,210,80\n"
SMALL: Final = """
title = "small"
observations_csv = "observations.csv"
[uncertainty]
wedge_angle_deg_std = 0.5
load_relative_std = 0.01
[scales.reader]
ppi = 500
[[fingers]]
name = "index"
semi_axes_mm = { palmar = 8, distal = 14, radial_ulnar = 12 }
semi_axes_mm_std = { palmar = 0.1, distal = 0.1, radial_ulnar = 0.1 }
[[observations]]
name = "first"
finger = "index"
wedge_angle_deg = 30
load_N = 2
ellipse_mm = { semi_major = 6, semi_minor = 5, std = 0.1 }
[[curves]]
finger = "index"
wedge_angle_deg = 30
loading_radius_mm = 14.5
"""
ROWS: Final = (
    "name,finger,wedge_angle_deg,load_N,semi_major_mm,semi_minor_mm,ellipse_mm_std\n"
    "second,index,45,1,5,4,0.1\nthird,index,45,2,6,5,0.1\n"
)


DAMAGED: Final = (
    "demo/study.toml", "demo/observations.csv", "small/study.toml", "small/observations.csv", "Results.csv",
    "curve.csv", "whole/results.json", "whole/summary.json", "whole/results.csv",
)  # fmt: skip


class TooLate(BaseException):
    """A command took longer than it may."""


def _too_late(*_: object) -> None:
    raise TooLate


def _run(*arguments: object) -> tuple[str, str]:
    """Run a command in this process; return what became of it, and what the program is to blame for."""
    before = signal.signal(signal.SIGALRM, _too_late)
    signal.setitimer(signal.ITIMER_REAL, PATIENCE_S)
    try:
        done = CliRunner().invoke(app, [str(one) for one in arguments])
    except TooLate:
        return "hang", f"over {PATIENCE_S:g} s"
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    unforeseen = "this cannot be done (" in done.stderr or "Traceback" in done.stderr
    if unforeseen or not isinstance(done.exception, SystemExit | None):
        trace = "".join(traceback.format_exception(done.exception)[-3:])
        return "traceback", f"{done.stderr.strip()} {trace}"
    if done.exit_code in {0, 3}:
        return "accepted", ""
    return "refused", "" if done.stderr.strip() else "refused without a word"


def try_commands(folder: Path, count: int) -> Outcomes:
    """Damage a study so many times, and run each command on it; outcomes are by command."""
    found = Outcomes()

    def run(*arguments: object) -> str:
        outcome, fault = _run(*arguments)
        found.counts[str(arguments[0]), outcome] += 1
        if fault:
            found.faults.append(f"seed {seed}: {arguments}: {fault}")
        return outcome

    shutil.copytree(DEMO, folder / "demo")
    (folder / "small").mkdir()
    for name, text in (("study.toml", SMALL), ("observations.csv", ROWS)):
        (folder / "small" / name).write_text(text, encoding="utf-8")
    (folder / "Results.csv").write_text(RESULTS, encoding="utf-8")
    shutil.copy(next((DEMO / "synthetic").glob("curve_*.csv")), folder / "curve.csv")
    run_study(folder / "small", folder / "whole", write_report=write_report)
    originals = {path: path.read_bytes() for path in (folder / name for name in DAMAGED)}
    for seed in range(count):
        rng = random.Random(seed)
        for path, content in originals.items():
            path.write_bytes(content if rng.random() < 0.6 else damaged(content, rng))
        run("status", folder / "demo", "--out", folder / "none")
        run("verify", folder / "small", "--out", folder / "whole")
        run("compare", folder / "whole")
        out = folder / "imported.csv"
        run("import", "fiji", folder / "Results.csv", "--std-mm", 0.1, "--ppi", 500, "--out", out)
        out.unlink(missing_ok=True)
        valid = run("status", folder / "small", "--out", folder / "none") == "accepted"
        if valid and not seed % RUN_EVERY:
            run("run", folder / "small", "--out", folder / "out")
            shutil.rmtree(folder / "out", ignore_errors=True)
        if not seed % FIT_EVERY:
            run("fit", folder / "curve.csv")
    return found
