"""Measuring all that a study shows, and finding it again in the store."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import chain
from typing import Literal

from fingerpad.study.engine.codec import from_record
from fingerpad.study.engine.runner import Executor, Plan, Progress, put_unless_changed, records_of, run_plans
from fingerpad.study.engine.store import Store, TaskStatus
from fingerpad.study.engine.task import Limits, Task, TaskResult
from fingerpad.study.manifest import Contact, Finger
from fingerpad.study.measuring.context import RunContext
from fingerpad.study.measuring.curves import CurveResult, curve_items, curve_key, curve_results, curve_tasks
from fingerpad.study.measuring.fingers import FingerResult, finger_result, photograph_item
from fingerpad.study.measuring.measure import Measurement, reviewed
from fingerpad.study.measuring.operators import OperatorPair, operator_pairs
from fingerpad.study.measuring.sequence_tasks import frame_count, header_task
from fingerpad.study.measuring.sequences import (
    SequenceResult,
    result_of_sequence,
    sequence_key,
    sequence_measurements,
    sequence_plan,
)
from fingerpad.study.measuring.tasks import observation_tasks, photograph_tasks, pictures_of, resolve_scales


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Measured:
    """What was measured of a study.

    Attributes
    ----------
    context : RunContext
        What the run knows, all scales included.
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

    context: RunContext
    progress: Progress
    fingers: dict[str, FingerResult]
    sequences: list[SequenceResult]
    curves: list[CurveResult]
    contacts: Iterable[tuple[Contact, Measurement]]
    operator_pairs: list[OperatorPair] = field(default_factory=list)


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
    study, statuses = context.study, store.statuses()
    headers = [header_task(sequence, context) for sequence in study.sequences]
    records_of(headers, executor, store, context.folder)
    tally = _Tally(context, store, executor.limits, statuses, on_progress)

    def is_done(task: Task) -> bool:
        if not store.is_done(task, statuses, executor.limits):
            return False
        if task.name != task.item:  # a piece of a sequence that is not done as a whole
            tally.pictures += task.pictures
        return True

    def store_result(task: Task, result: TaskResult) -> None:
        record = put_unless_changed(store, context.folder, task, result)
        tally.tell(task, failed=record.get("reason") is not None, seconds=result.seconds)

    plans = (
        sequence_plan(sequence, context)
        for sequence in study.sequences
        if (status := statuses.get(sequence.name)) is None
        or not store.is_current(status, sequence_key(sequence, context), executor.limits)
    )
    fingers = (_finger_plan(finger, context) for finger in study.fingers)
    contacts = (iter(([task],)) for task in observation_tasks(context))
    tally.tell()
    run_plans(chain(plans, fingers, contacts), executor, store_result, is_done)
    sequences = [
        result_of_sequence(
            sequence, context.measured(sequence.name, sequence_key(sequence, context), sequence.file), context
        )
        for sequence in study.sequences
    ]
    return Measured(
        context=context,
        progress=tally.now(),
        fingers={finger.name: pad_of(finger, context) for finger in study.fingers},
        sequences=sequences,
        curves=curve_results(context),
        contacts=_Contacts(context, sequences),
        operator_pairs=operator_pairs(context, store, executor),
    )


@dataclass(frozen=True, slots=True)
class _Contacts:
    """What was measured of each contact; held is one at a time."""

    context: RunContext
    sequences: Sequence[SequenceResult]

    def __iter__(self) -> Iterator[tuple[Contact, Measurement]]:
        context = self.context
        for observation in context.study.observations:
            key = context.item_key(observation.name, observation)
            record = context.measured(observation.name, key, observation.file)
            if record.keys() == {"reason"}:
                seen = Measurement(observation=observation.name, reason=record["reason"])
            else:
                seen = from_record(Measurement, record)
            seen = replace(seen, load_N=observation.load_N)  # which may have changed since
            yield observation, reviewed(seen, context.active_corrections.get(observation.name))
        for sequence in self.sequences:
            for measured in sequence_measurements(sequence, context):
                yield sequence.manifest, measured


def _finger_plan(finger: Finger, context: RunContext) -> Plan:
    """Plan a finger: its photographs, then its loading curves, which are compared with the pad's shape."""
    yield list(photograph_tasks(finger, context))
    if any(curve.finger == finger.name and curve.file for curve in context.study.curves):
        yield list(curve_tasks(pad_of(finger, context), context))


def pad_of(finger: Finger, context: RunContext) -> FingerResult:
    """Return the semi-axes of a finger from what the store holds of its photographs."""
    items = {photograph_item(finger, one): one for one in pictures_of(finger)}
    faces = {
        item: context.measured(item, context.item_key(item, photograph), photograph.file)
        for item, photograph in items.items()
        if not context.is_rejected(item)
    }
    return finger_result(finger, context.scales, context.folder, faces, context.active_corrections)


def items_of(context: RunContext) -> Iterator[tuple[str, Callable[[], str]]]:
    """Yield the name of each photograph, loading curve, observation and sequence, with what makes its key."""
    for finger in context.study.fingers:
        for photograph in pictures_of(finger):
            item = photograph_item(finger, photograph)
            if not context.is_rejected(item):
                yield item, partial(context.item_key, item, photograph)
    for item, curve in curve_items(context.study):
        yield item, partial(curve_key, curve, context)
    for observation in context.study.observations:
        yield observation.name, partial(context.item_key, observation.name, observation)
    for sequence in context.study.sequences:
        yield sequence.name, partial(sequence_key, sequence, context)


def item_of(task: str) -> str:
    """Return the item to which a task belongs, by its name: of a piece of a sequence, the sequence."""
    return task if "/" in task else task.partition(" ")[0]


def drawn_for(context: RunContext, store: Store) -> Iterator[tuple[str, str]]:
    """Yield the overlays that belong to the study as it is, by name, each with its digest."""
    statuses = store.statuses()
    for name, _ in items_of(context):
        if (status := statuses.get(name)) is not None:
            yield from status.drawn.items()


class _Tally:
    """Progress so far."""

    def __init__(
        self,
        context: RunContext,
        store: Store,
        limits: Limits,
        statuses: Mapping[str, TaskStatus],
        on_progress: Callable[[Progress], None],
    ) -> None:
        self._on_progress = on_progress
        self.pictures = self.failed = self._total = 0
        sequences = {sequence.name: sequence for sequence in context.study.sequences}
        for name, key in items_of(context):
            count = frame_count(sequences[name], context) if name in sequences else 1
            self._total += count
            if (status := statuses.get(name)) and store.is_current(status, key(), limits):
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
