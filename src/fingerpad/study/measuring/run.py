"""Everything that a study measures: its items, measured or found again in the store."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, Literal

from fingerpad.study.engine.runner import Executor, Plan, Progress, put_unless_changed, records_of, run_plans
from fingerpad.study.engine.store import Store, TaskStatus
from fingerpad.study.engine.task import Limits, Task, TaskResult
from fingerpad.study.manifest.models import Contact
from fingerpad.study.measuring.contacts import (
    REPEATED_PICTURE,
    Measurement,
    ObservationItem,
    OperatorPair,
    operator_pairs,
    repeated_pictures,
)
from fingerpad.study.measuring.context import Item, RunContext, resolve_scales
from fingerpad.study.measuring.curves import CurveItem, CurveResult, curve_names
from fingerpad.study.measuring.fingers import FingerResult, pad_of, photograph_items
from fingerpad.study.measuring.sequences import (
    SequenceItem,
    SequenceResult,
    header_task,
    sequence_measurements,
)


class StudyItems:
    """All that counts in the progress of a study, in the order of its tables."""

    def __init__(self, context: RunContext) -> None:
        self.context, study = context, context.study
        fingers = {finger.name: finger for finger in study.fingers}
        # By finger, without the rejected.
        self.photographs = {finger.name: photograph_items(finger, context) for finger in study.fingers}
        self.curves = [
            CurveItem(
                context=context,
                name=name or "",
                table=curve,
                finger=fingers[curve.finger],
                photographs=self.photographs[curve.finger],
            )
            for name, curve in zip(curve_names(study), study.curves, strict=True)
        ]
        self.observations = [
            ObservationItem(context=context, name=one.name, table=one) for one in study.observations
        ]
        self.sequences = [SequenceItem(context=context, name=one.name, table=one) for one in study.sequences]

    def __iter__(self) -> Iterator[Item[Any]]:
        for photographs in self.photographs.values():
            yield from (one for one in photographs if one.file)
        yield from (one for one in self.curves if one.file)
        yield from self.observations
        yield from self.sequences

    def plans(self, sequences: Iterable[SequenceItem]) -> Iterator[Plan]:
        """Yield the tasks of these sequences, of fingers with their curves, and of observations."""
        for sequence in sequences:
            yield sequence.stages()
        for finger, photographs in self.photographs.items():
            # Curves are compared with the shape of the pad.
            curves = [one for one in self.curves if one.file and one.table.finger == finger]
            stages: list[list[Item[Any]]] = [[one for one in photographs if one.file], [*curves]]
            # Each of them has one stage.
            yield ([task for one in items for (task,) in one.stages()] for items in stages)
        for observation in self.observations:
            yield observation.stages()


def item_of(task: str) -> str:
    """Return the item to which a task belongs, by its name: of a piece of a sequence, the sequence."""
    return task if "/" in task else task.partition(" ")[0]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Measured:
    """What was measured of a study; to go through it gives its contacts, in the manifest's order.

    They are read from the store each time, and held is one at a time.
    """

    items: StudyItems
    progress: Progress
    fingers: dict[str, FingerResult]
    sequences: list[SequenceResult]
    curves: list[CurveResult]
    # Contacts that show one part of one picture or sequence, and whether they state one press.
    repeated: list[tuple[list[Contact], bool]]
    operator_pairs: list[OperatorPair] = field(default_factory=list)

    def __length_hint__(self) -> int:
        """Return how many contacts they may be: not every frame shows one."""
        frames = (1 if one.summary is None else one.summary.count for one in self.sequences)
        return len(self.items.observations) + sum(frames)

    def __iter__(self) -> Iterator[tuple[Contact, Measurement]]:
        repeated = {
            one.name for same, one_press in self.repeated for one in (same[1:] if one_press else same)
        }
        for contact, seen in self._seen():
            again = (REPEATED_PICTURE,) if contact.name in repeated else ()
            yield contact, replace(seen, flags=(*seen.flags, *again)) if again else seen

    def _seen(self) -> Iterator[tuple[Contact, Measurement]]:
        for item in self.items.observations:
            yield item.table, item.result()
        for sequence in self.sequences:
            for measured in sequence_measurements(sequence, self.items.context):
                yield sequence.manifest, measured


def measure_study(
    context: RunContext, store: Store, executor: Executor, on_progress: Callable[[Progress], None]
) -> Measured:
    """Measure what the store lacks, store each result as it comes, and return all that was measured."""
    perform = partial(records_of, executor=executor, store=store, folder=context.folder)
    context = replace(context, scales=resolve_scales(context, perform))
    statuses, items = store.statuses(), StudyItems(context)
    perform(header_task(sequence, context) for sequence in context.study.sequences)
    progress, done = _progress_of(items, store, executor.limits, statuses)

    def is_done(task: Task) -> bool:
        nonlocal progress
        if task.name in done:
            return True
        if not store.is_current(statuses.get(task.name), task.key, executor.limits):
            return False
        if task.name != task.item:  # a piece of a sequence that is not done as a whole
            progress = replace(progress, pictures=progress.pictures + task.pictures)
        return True

    def store_result(task: Task, result: TaskResult) -> None:
        nonlocal progress
        failed = put_unless_changed(store, context.folder, task, result).get("reason") is not None
        progress = replace(
            progress,
            pictures=progress.pictures + task.pictures,
            failed=progress.failed + (failed and task.name == task.item),  # a piece fails with its sequence
        )
        status: Literal["done", "failed"] = "failed" if failed else "done"
        on_progress(replace(progress, item=task.item, file=task.file, status=status, seconds=result.seconds))

    left = (one for one in items.sequences if one.name not in done)
    on_progress(progress)
    run_plans(items.plans(left), executor, store_result, is_done)
    return Measured(
        items=items,
        progress=progress,
        fingers={
            one.name: pad_of(one, items.photographs[one.name], context) for one in context.study.fingers
        },
        sequences=[one.result() for one in items.sequences],
        curves=[one.result() for one in items.curves],
        repeated=list(repeated_pictures(context)),
        operator_pairs=operator_pairs(context, perform),
    )


def _progress_of(
    items: StudyItems, store: Store, limits: Limits, statuses: dict[str, TaskStatus]
) -> tuple[Progress, set[str]]:
    """Return the progress before a run, and the items done; their statuses are removed, to save memory."""
    pictures = failed = total = 0
    done = set()
    for item in items:
        count = item.pictures  # of a sequence, read from the store
        total += count
        if (status := statuses.pop(item.name, None)) and store.is_current(status, item.key, limits):
            pictures += count
            failed += status.status == "failed"
            done.add(item.name)
    return Progress(pictures=pictures, failed=failed, total=total), done
