"""Measuring all that a study shows, and finding it again in the store."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

from fingerpad.study.engine.runner import Executor, Progress, put_unless_changed, records_of, run_plans
from fingerpad.study.engine.store import Store, TaskStatus
from fingerpad.study.engine.task import Limits, Task, TaskResult
from fingerpad.study.manifest import Contact
from fingerpad.study.measuring.context import RunContext
from fingerpad.study.measuring.curves import CurveResult
from fingerpad.study.measuring.fingers import FingerResult
from fingerpad.study.measuring.items import StudyItems, resolve_scales
from fingerpad.study.measuring.measure import Measurement
from fingerpad.study.measuring.operators import OperatorPair, operator_pairs
from fingerpad.study.measuring.sequence_tasks import header_task
from fingerpad.study.measuring.sequences import (
    SequenceResult,
    sequence_measurements,
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Measured:
    """What was measured of a study.

    Attributes
    ----------
    items : StudyItems
        What there was to measure.
    progress : Progress
        Where the run stands.
    fingers : dict of str to FingerResult
        Semi-axes by finger.
    sequences : list of SequenceResult
        One per sequence.
    curves : list of CurveResult
        One per loading curve.
    contacts : iterable of (Contact, Measurement)
        What was measured of each observation and frame, in the manifest's order; read from the store
        each time it is gone through.
    operator_pairs : list of OperatorPair
        Images that two persons outlined.
    """

    items: StudyItems
    progress: Progress
    fingers: dict[str, FingerResult]
    sequences: list[SequenceResult]
    curves: list[CurveResult]
    contacts: Iterable[tuple[Contact, Measurement]]
    operator_pairs: list[OperatorPair] = field(default_factory=list)

    @property
    def context(self) -> RunContext:
        """What the run knows, all scales included."""
        return self.items.context


def measure_study(
    context: RunContext, store: Store, executor: Executor, on_progress: Callable[[Progress], None]
) -> Measured:
    """Measure what the store lacks, store each result as it comes, and return all that was measured.

    Parameters
    ----------
    context : RunContext
        What the run knows; its scales are measured first.
    store : Store
        The store, open for writing.
    executor : Executor
        Where tasks are performed.
    on_progress : callable
        Called at the start and after each task.

    Raises
    ------
    KeyboardInterrupt
        After an interrupt, with what was at work stored.
    StoreError
        If results cannot be stored.
    """
    context = replace(context, scales=resolve_scales(context, store, executor))
    statuses, items = store.statuses(), StudyItems.of(context)
    headers = [header_task(sequence, context) for sequence in context.study.sequences]
    records_of(headers, executor, store, context.folder)
    tally = _Tally(items, store, executor.limits, statuses, on_progress)

    def is_done(task: Task) -> bool:
        if not store.is_done(task, statuses, executor.limits):
            return False
        if task.name != task.item:  # a piece of a sequence that is not done as a whole
            tally.pictures += task.pictures
        return True

    def store_result(task: Task, result: TaskResult) -> None:
        record = put_unless_changed(store, context.folder, task, result)
        tally.tell(task, failed=record.get("reason") is not None, seconds=result.seconds)

    left = (
        one
        for one in items.sequences
        if (status := statuses.get(one.name)) is None
        or not store.is_current(status, one.key, executor.limits)
    )
    tally.tell()
    run_plans(items.plans(left), executor, store_result, is_done)
    sequences = [one.result() for one in items.sequences]
    return Measured(
        items=items,
        progress=tally.now(),
        fingers=items.fingers(),
        sequences=sequences,
        curves=items.curve_results(),
        contacts=_Contacts(items, sequences),
        operator_pairs=operator_pairs(context, store, executor),
    )


@dataclass(frozen=True, slots=True)
class _Contacts:
    """What was measured of each contact; held is one at a time."""

    items: StudyItems
    sequences: Sequence[SequenceResult]

    def __iter__(self) -> Iterator[tuple[Contact, Measurement]]:
        for one in self.items.observations:
            yield one.observation, one.result()
        for sequence in self.sequences:
            for measured in sequence_measurements(sequence, self.items.context):
                yield sequence.manifest, measured


class _Tally:
    """Progress so far."""

    def __init__(
        self,
        items: StudyItems,
        store: Store,
        limits: Limits,
        statuses: Mapping[str, TaskStatus],
        on_progress: Callable[[Progress], None],
    ) -> None:
        self._on_progress = on_progress
        self.pictures = self.failed = self._total = 0
        for item in items:
            count = item.pictures  # of a sequence, read from the store
            self._total += count
            if (status := statuses.get(item.name)) and store.is_current(status, item.key, limits):
                self.pictures += count
                self.failed += status.status == "failed"

    def tell(self, task: Task | None = None, *, failed: bool = False, seconds: float = 0.0) -> None:
        now = self.now()
        if task is not None:
            self.pictures += task.pictures
            self.failed += failed and task.name == task.item  # a piece fails with its sequence
            status: Literal["done", "failed"] = "failed" if failed else "done"
            now = replace(self.now(), item=task.item, file=task.file, status=status, seconds=seconds)
        self._on_progress(now)

    def now(self) -> Progress:
        return Progress(pictures=self.pictures, failed=self.failed, total=self._total)
