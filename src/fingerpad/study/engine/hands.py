"""Who does the measuring: this process, or several on this machine."""

import os
import signal
import threading
from collections.abc import Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context, parent_process
from pathlib import Path
from typing import Protocol

from fingerpad._threads import ONE_THREAD
from fingerpad.study.engine.cluster import cluster_hands
from fingerpad.study.engine.task import Done, Task, perform, settle_worker


class Hands(Protocol):
    """Whoever does the tasks of a run."""

    @property
    def capacity(self) -> int:
        """Number of tasks that can be in hand, so that nobody waits for work."""

    def submit(self, task: Task) -> Future[Done]:
        """Take a task in hand."""


class OwnHands:
    """One task after another, in this process."""

    capacity = 1

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def submit(self, task: Task) -> Future[Done]:
        """Do a task at once."""
        future: Future[Done] = Future()
        future.set_result(perform(task.work, task.file, self._folder))
        return future


class PoolHands:
    """Several processes on this machine."""

    def __init__(self, pool: ProcessPoolExecutor, workers: int, folder: Path) -> None:
        self.capacity = 2 * workers
        self._pool, self._folder = pool, folder

    def submit(self, task: Task) -> Future[Done]:
        """Hand a task to the pool."""
        return self._pool.submit(perform, task.work, task.file, self._folder)


@contextmanager
def hands_for(manifest: Path, workers: int, scheduler: str | None) -> Iterator[Hands]:
    """Give the hands that are asked for, and let them go in the end.

    Parameters
    ----------
    manifest : Path
        The study's manifest.
    workers : int
        Number of processes on this machine; one measures in this process.
    scheduler : str or None
        Dask's, if it is to be used.

    Raises
    ------
    ClusterError
        If the scheduler or its workers cannot be used.
    """
    if scheduler is None:
        given = local_hands(manifest.absolute().parent, workers)
    else:
        given = cluster_hands(manifest, workers, scheduler)
    with given as hands:
        yield hands


@contextmanager
def local_hands(folder: Path, workers: int) -> Iterator[Hands]:
    """Give so many processes of this machine, or this one alone, and let them go in the end."""
    if workers == 1:
        yield OwnHands(folder)
        return
    pool = ProcessPoolExecutor(workers, mp_context=get_context("spawn"), initializer=_start_worker)
    with _one_thread_each():
        try:
            yield PoolHands(pool, workers, folder)
        finally:
            pool.shutdown(cancel_futures=True)


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """Let linear algebra in processes that start meanwhile use one thread: all cores are at work already."""
    before = {name: os.environ.get(name) for name in ONE_THREAD}
    os.environ.update(ONE_THREAD)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


def _start_worker() -> None:
    """Leave interrupts to the parent, the other cores to the other workers, and end with the parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    settle_worker()
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    """End when the parent is killed, which tells nobody: workers would wait for work for ever."""
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
