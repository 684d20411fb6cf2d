"""Damaged images of all formats, read and measured.

Each mutated file goes through every reader, and what can still be read is measured, in a child process of
limited memory and time.
"""

import contextlib
import os
import random
import resource
import subprocess
import sys
import time
import traceback
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

from tests.mutated_images import mutated, originals, use

from benchmarks.memory import peak_mb
from fingerpad.image import MEMORY_LIMIT

PATIENCE_S: Final = 30.0
# What a process holds before it reads anything.
_IDLE_BYTES: Final = 600_000_000
_COUNTS: Final = ("read", "refused", "traceback", "over budget", "over time", "crashed")


def serve() -> None:
    """Use the files named on standard input, one a line, and print what became of each."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)  # decoders print there
    print(peak_mb(), file=answers, flush=True)
    for number, line in enumerate(sys.stdin):
        with contextlib.suppress(OSError):
            Path("/proc/self/clear_refs").write_text("5", encoding="ascii")  # reset the peak
        try:
            outcome = "|".join(use(Path(line.rstrip("\n")), as_photograph=number % 20 == 0))
        except Exception:
            outcome = "traceback: " + traceback.format_exc().replace("\n", " / ")[-600:]
        print(f"{peak_mb():.0f} {outcome}", file=answers, flush=True)


def _started() -> subprocess.Popen[str]:
    child = subprocess.Popen(
        [sys.executable, "-W", "ignore", "-c", f"from {__name__} import serve; serve()"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env=os.environ | {"OMP_NUM_THREADS": "1"},
    )
    assert child.stdout is not None
    child.stdout.readline()
    return child


def _answer(child: subprocess.Popen[str], path: Path) -> str | None:
    """Return what a child says of a file, None where it says nothing in time; "" where it has ended."""
    import select  # noqa: PLC0415 (not on every system)

    assert child.stdin is not None
    assert child.stdout is not None
    child.stdin.write(f"{path}\n")
    child.stdin.flush()
    ready, _, _ = select.select([child.stdout], [], [], PATIENCE_S)
    return child.stdout.readline() if ready else None


def report(count: int = 10_000, first_seed: int = 0) -> Counter[str]:
    """Print and return how many uses of mutated images ended how."""
    whole, counts, faults = originals(), Counter[str](dict.fromkeys(_COUNTS, 0)), []
    worst_mb, slowest_s, began = 0.0, 0.0, time.perf_counter()
    child = _started()
    with TemporaryDirectory() as folder:
        for seed in range(first_seed, first_seed + count):
            rng = random.Random(seed)
            name = rng.choice(sorted(whole))
            path = Path(folder) / name
            path.write_bytes(mutated(whole[name], rng))
            start = time.perf_counter()
            answer = _answer(child, path)
            slowest_s = max(slowest_s, time.perf_counter() - start)
            if not answer:
                outcome = "over time" if answer is None else "crashed"
                child.kill()
                child.wait()
                child = _started()
            else:
                peak, outcome = answer.rstrip("\n").split(" ", maxsplit=1)
                worst_mb = max(worst_mb, float(peak))
                counts["over budget"] += float(peak) * 1e6 > MEMORY_LIMIT + _IDLE_BYTES
            if outcome.startswith("traceback"):
                counts["traceback"] += 1
            else:
                counts.update(outcome.split("|"))
            if set(outcome.split("|")) - {"read", "refused"}:
                faults.append(f"seed {seed} ({name}): {outcome}")
    child.kill()
    child.wait()
    took = time.perf_counter() - began
    print(f"\n{count:,} mutated images through three readers and what measures, {took:.0f} s")
    for outcome, number in counts.items():
        print(f"    {outcome:<12} {number:,}")
    print(f"    slowest {slowest_s:.1f} s, most memory {worst_mb:,.0f} MB")
    for fault in faults[:20]:
        print(f"    {fault}")
    return counts
