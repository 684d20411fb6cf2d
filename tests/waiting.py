"""Waiting for what other processes and threads do, though never for ever."""

import time
from collections.abc import Callable
from multiprocessing import get_context


def wait_until(true: Callable[[], object], within_s: float = 60.0) -> bool:
    """Return True once something is, False when it has not become so in time."""
    deadline = time.monotonic() + within_s
    while time.monotonic() < deadline:
        if true():
            return True
        time.sleep(0.02)
    return False


def exit_codes(function: Callable[..., object], *calls: tuple) -> list[int | None]:
    """Call a function with each of these arguments at once, each in a process that ends in a minute."""
    processes = [get_context("fork").Process(target=function, args=arguments) for arguments in calls]
    for process in processes:
        process.start()
    for process in processes:
        process.join(60)
    return [process.exitcode for process in processes]
