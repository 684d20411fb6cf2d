"""Where tasks are performed: in processes of this machine, or by the workers of a Dask scheduler."""

from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Protocol

from fingerpad.study.engine.cluster import cluster_executor
from fingerpad.study.engine.limits import DEFAULT_LIMITS, Limits
from fingerpad.study.engine.task import Task, TaskResult
from fingerpad.study.engine.worker import POOL, IsolatedRunner


class Executor(Protocol):
    """Performs the tasks of a run."""

    @property
    def limits(self) -> Limits:
        """What a task may take."""

    @property
    def capacity(self) -> int:
        """Number of tasks that keep it busy."""

    def submit(self, task: Task) -> Future[TaskResult]:
        """Begin a task as soon as possible."""

    def require_workers(self) -> None:
        """Raise `ClusterError` if no worker is left."""


class LocalExecutor:
    """Processes of this machine."""

    def __init__(self, threads: ThreadPoolExecutor, workers: int, runner: IsolatedRunner) -> None:
        self.capacity = 2 * workers
        self.limits = runner.limits
        self._threads, self._runner = threads, runner

    def submit(self, task: Task) -> Future[TaskResult]:
        """Begin a task as soon as a process is free."""
        return self._threads.submit(self._runner.perform, task)

    def require_workers(self) -> None:
        """Do nothing: a process that dies is replaced."""


def executor_for(
    manifest: Path, workers: int, scheduler: str | None, limits: Limits = DEFAULT_LIMITS
) -> AbstractContextManager[Executor]:
    """Return the executor of a run, which is closed in the end.

    Parameters
    ----------
    manifest : Path
        The study's manifest.
    workers : int
        Number of processes on this machine.
    scheduler : str or None
        Address of a Dask scheduler, if one is to be used.
    limits : Limits
        What measuring a picture may take.

    Raises
    ------
    ClusterError
        If the scheduler or its workers cannot be used.
    """
    if scheduler is None:
        return local_executor(manifest.absolute().parent, workers, limits)
    return cluster_executor(manifest, workers, scheduler, limits)


@contextmanager
def local_executor(folder: Path, workers: int, limits: Limits = DEFAULT_LIMITS) -> Iterator[LocalExecutor]:
    """Provide so many processes of this machine, for tasks whose inputs are in `folder`."""
    threads, runner = ThreadPoolExecutor(workers), IsolatedRunner(folder, limits)
    try:
        yield LocalExecutor(threads, workers, runner)
    finally:
        threads.shutdown(wait=False, cancel_futures=True)
        runner.abandon()
        threads.shutdown()
        POOL.trim()
