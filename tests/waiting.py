"""Waiting for what other processes and threads do, though never for ever."""

import time
from collections.abc import Callable


def wait_until(true: Callable[[], object], within_s: float = 60.0) -> bool:
    """Return True once something is, False when it has not become so in time."""
    deadline = time.monotonic() + within_s
    while time.monotonic() < deadline:
        if true():
            return True
        time.sleep(0.02)
    return False
