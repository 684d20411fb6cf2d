"""Run times."""

import time
from collections.abc import Callable


def best(function: Callable[[], object], repeats: int = 9) -> float:
    """Return the shortest of several run times of this thread, in seconds."""
    times = []
    for _ in range(repeats):
        start = time.thread_time()
        function()
        times.append(time.thread_time() - start)
    return min(times)
