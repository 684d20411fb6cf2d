"""Run times, and the largest memory that a process has held, in MB of a million bytes."""

import resource
import time
import timeit
from collections.abc import Callable
from pathlib import Path

_MB_PER_KIB = 1.024e-3


def best(function: Callable[[], object], repeats: int = 9) -> float:
    """Return the shortest of several run times of this thread, in seconds."""
    return min(timeit.repeat(function, timer=time.thread_time, number=1, repeat=repeats))


def peak_mb() -> float:
    """Return the memory of this process, imports included, since it was started."""
    # not by getrusage, which begins with what the parent held
    status = Path("/proc/self/status").read_text(encoding="ascii")
    return _MB_PER_KIB * int(status.split("VmHWM:")[1].split()[0])


def peak_of_children_mb() -> float:
    """Return that of the largest child that has ended."""
    return _MB_PER_KIB * resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
