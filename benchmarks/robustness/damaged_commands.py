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
from fingerpad.testing import write_study

PATIENCE_S: Final = 120.0
RUN_EVERY, FIT_EVERY = 40, 50
RESULTS: Final = " ,Label,Major,Minor,Angle\n1,a_30deg_2N.png,300,200,90\n2,b_45deg_1N.png,280,210,80\n"
ROWS: Final = (
    "name,finger,wedge_angle_deg,load_N,semi_major_mm,semi_minor_mm,ellipse_mm_std\n"
    "second,synthetic_pad,45,1,5,4,0.1\nthird,synthetic_pad,45,2,6,5,0.1\n"
)
DAMAGED: Final = (
    "demo/study.toml", "demo/observations.csv", "small/study.toml", "small/observations.csv", "Results.csv",
    "small/curve.csv", "whole/results.json", "whole/summary.json", "whole/results.csv",
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
    manifest = write_study(folder / "small", loads=(1.0,)).path
    text = f'observations_csv = "observations.csv"\n{manifest.read_text(encoding="utf-8")}'
    manifest.write_text(text, encoding="utf-8")
    (folder / "small" / "observations.csv").write_text(ROWS, encoding="utf-8")
    (folder / "Results.csv").write_text(RESULTS, encoding="utf-8")
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
            run("fit", folder / "small" / "curve.csv")
    return found
