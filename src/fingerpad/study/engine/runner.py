"""Doing the tasks of a study: what can be done at the same time is, and what is done is kept at once."""

import signal
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import TypeAlias

from fingerpad.exceptions import StoreError
from fingerpad.study.engine.hands import Hands
from fingerpad.study.engine.store import Store
from fingerpad.study.engine.task import Done, Record, Task

# Tasks stage by stage: those of one stage do not depend on one another, but on all of the stage before.
Plan: TypeAlias = Iterator[list[Task]]


@dataclass(slots=True)
class _Stage:
    plan: Plan
    left: int


def run_plans(
    plans: Iterable[Plan],
    hands: Hands,
    keep: Callable[[Task, Done], None],
    is_done: Callable[[Task], bool],
) -> None:
    """Do all tasks of some plans.

    An interrupt, by the keyboard or raised by `keep`, lets what is in hand be finished and kept.

    Parameters
    ----------
    plans : iterable of iterators of lists of Task
        What there is to do. A plan is asked for its next stage when all of the one before is kept.
    hands : Hands
        Who does it.
    keep : callable
        Called in this thread with each task and its result, in the order in which they come.
    is_done : callable
        Whether a task need not be done again.

    Raises
    ------
    KeyboardInterrupt
        After an interrupt.
    StoreError
        If a process that measures dies.
    """
    coming = iter(plans)
    ready: deque[tuple[Task, _Stage]] = deque()
    in_hand: dict[Future[Done], tuple[Task, _Stage]] = {}

    def advance(plan: Plan) -> None:
        """Make the plan's next stage ready, before all others: a film ends before more begin."""
        for stage in plan:
            missing = [task for task in stage if not is_done(task)]
            if missing:
                entry = _Stage(plan, len(missing))
                ready.extendleft((task, entry) for task in reversed(missing))
                return

    def fill() -> None:
        while len(in_hand) < hands.capacity:
            while not ready:
                plan = next(coming, None)
                if plan is None:
                    return
                advance(plan)
            task, stage = ready.popleft()
            in_hand[hands.submit(task)] = (task, stage)

    with _interrupts_told() as interrupted:
        try:
            while True:
                fill()
                if not in_hand:
                    return
                for future in wait(in_hand, return_when=FIRST_COMPLETED).done:
                    task, stage = in_hand.pop(future)
                    keep(task, future.result())
                    stage.left -= 1
                    if not stage.left:
                        advance(stage.plan)
                _raise_if(interrupted)
        except KeyboardInterrupt:
            for future, (task, _) in in_hand.items():
                if not future.cancel():
                    with suppress(KeyboardInterrupt):
                        keep(task, future.result())
            raise
        except BrokenProcessPool as error:
            raise StoreError(
                "a process that measured has died, perhaps for want of memory: run again to go on, with "
                "fewer --workers"
            ) from error


def records_of(
    tasks: Sequence[Task], hands: Hands, store: Store, on_done: Callable[[Task], None] = lambda _: None
) -> list[Record]:
    """Return the records of tasks that read no files, in their order; those that the store lacks are done.

    Raises
    ------
    KeyboardInterrupt
        After an interrupt.
    StoreError
        If a process dies, or records cannot be kept.
    """
    known = {task.name: store.record(task.name, task.key) for task in tasks}
    found = {name: record for name, record in known.items() if record is not None}

    def keep(task: Task, done: Done) -> None:
        store.put(task.name, task.key, done.record, seconds=done.seconds, count=task.pictures)
        found[task.name] = done.record
        on_done(task)

    run_plans([iter([list(tasks)])], hands, keep, lambda task: task.name in found)
    return [found[task.name] for task in tasks]


def _raise_if(interrupted: threading.Event) -> None:
    if interrupted.is_set():
        raise KeyboardInterrupt


@contextmanager
def _interrupts_told() -> Iterator[threading.Event]:
    """Let an interrupt by the keyboard wait until it is asked for; a second one does not wait."""
    told = threading.Event()
    if threading.current_thread() is not threading.main_thread():
        yield told
        return

    def tell(*_: object) -> None:
        told.set()
        signal.signal(signal.SIGINT, before)

    before = signal.signal(signal.SIGINT, tell)
    try:
        yield told
    finally:
        signal.signal(signal.SIGINT, before)
