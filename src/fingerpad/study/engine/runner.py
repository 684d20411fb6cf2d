"""Performing the tasks of a study: those that can are performed at the same time, and stored as they end."""

import signal
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, CancelledError, Future, wait
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal, TypeAlias

from fingerpad.study.engine.cluster import ClusterExecutor
from fingerpad.study.engine.store import Store
from fingerpad.study.engine.task import CHANGED, Record, Task, TaskResult
from fingerpad.study.engine.worker import LocalExecutor

# Tasks stage by stage: those of one stage do not depend on one another, but on all of the stage before.
Plan: TypeAlias = Iterator[list[Task]]

_POLL_S: Final = 1.0


# Performs the tasks of a run.
Executor: TypeAlias = LocalExecutor | ClusterExecutor
# `records_of` some tasks, for a run's executor, store and folder.
Perform: TypeAlias = Callable[[Iterable[Task]], dict[str, Record]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Progress:
    """Where a run stands. Loading curves count as pictures do."""

    item: str = ""  # what has just been dealt with, empty at the start
    file: str = ""
    # After all is measured: the uncertainty of a contact was checked, a file of results is being written.
    status: Literal["started", "done", "failed", "checked", "written"] = "started"
    pictures: int  # and frames, those of earlier runs included
    failed: int  # items
    total: int  # pictures and frames
    seconds: float = 0.0


@dataclass(slots=True)
class _Stage:
    plan: Plan
    left: int


def run_plans(
    plans: Iterable[Plan],
    executor: Executor,
    store_result: Callable[[Task, TaskResult], None],
    is_done: Callable[[Task], bool],
) -> None:
    """Perform all tasks of some plans; results are stored in this thread, in the order in which they come.

    After an interrupt, by the keyboard or raised by `store_result`, no further task is started; those at work
    are finished and stored. A second one by the keyboard does not wait for them.
    """
    coming = iter(plans)
    ready: deque[tuple[Task, _Stage]] = deque()
    at_work: dict[Future[TaskResult], tuple[Task, _Stage]] = {}

    def advance(plan: Plan) -> None:
        """Make the plan's next stage ready, before all others: a sequence ends before more begin."""
        for stage in plan:
            missing = [task for task in stage if not is_done(task)]
            if missing:
                entry = _Stage(plan, len(missing))
                ready.extendleft((task, entry) for task in reversed(missing))
                return

    def fill() -> None:
        while len(at_work) < executor.capacity:
            while not ready:
                plan = next(coming, None)
                if plan is None:
                    return
                advance(plan)
            task, stage = ready.popleft()
            at_work[executor.submit(task)] = (task, stage)

    def finished() -> Iterator[tuple[Task, TaskResult, _Stage]]:
        """Wait for tasks to end, for a moment at most."""
        done = wait(at_work, timeout=_POLL_S, return_when=FIRST_COMPLETED).done
        if not done:
            executor.require_workers()
        for future in done:
            task, stage = at_work.pop(future)
            yield task, future.result(), stage

    with _deferred_interrupts() as interrupts:
        try:
            while True:
                fill()
                if not at_work:
                    return
                for task, result, stage in finished():
                    store_result(task, result)
                    stage.left -= 1
                    if not stage.left:
                        advance(stage.plan)
                if interrupts:
                    raise KeyboardInterrupt  # noqa: TRY301 (as one raised by `store_result`)
        except KeyboardInterrupt:
            for future in [future for future in at_work if future.cancel()]:
                del at_work[future]
            while at_work and len(interrupts) < 2:
                try:
                    for task, result, _ in finished():
                        store_result(task, result)
                except (KeyboardInterrupt, CancelledError):
                    continue  # raised by `store_result`, or of a task that was cancelled meanwhile
            raise


def records_of(
    tasks: Iterable[Task],
    executor: Executor,
    store: Store,
    folder: Path,
    on_done: Callable[[Task], None] = lambda _: None,
) -> dict[str, Record]:
    """Return the records of tasks, asked for as they can be performed, by name; the store's, or performed."""
    names: list[str] = []
    records: dict[str, Record] = {}

    def plans() -> Iterator[Plan]:
        for task in tasks:
            names.append(task.name)
            yield iter([[task]])

    def is_done(task: Task) -> bool:
        status = store.statuses([task.name]).get(task.name)
        if not store.is_current(status, task.key, executor.limits):
            return False
        record = store.record(task.name, task.key)
        if record is not None:
            records[task.name] = record
        return record is not None

    def store_result(task: Task, result: TaskResult) -> None:
        records[task.name] = put_unless_changed(store, folder, task, result)
        on_done(task)

    run_plans(plans(), executor, store_result, is_done)
    return {name: records[name] for name in names}


def put_unless_changed(store: Store, folder: Path, task: Task, result: TaskResult) -> Record:
    """Store a result and return its record, or that its inputs changed while they were measured."""
    key = task.key
    if not all(store.unchanged(folder / name) for name in task.inputs):
        key = ""  # never up to date: the next run measures it again
        result = TaskResult({"reason": CHANGED.format(task.file)}, {}, result.seconds)
    store.put(task.name, key, result, count=task.pictures)
    return result.record


@contextmanager
def _deferred_interrupts() -> Iterator[list[int]]:
    """List interrupts by the keyboard in place of raising them."""
    found: list[int] = []
    if threading.current_thread() is not threading.main_thread():
        yield found
        return
    before = signal.signal(signal.SIGINT, lambda number, _frame: found.append(number))
    try:
        yield found
    finally:
        signal.signal(signal.SIGINT, before)
