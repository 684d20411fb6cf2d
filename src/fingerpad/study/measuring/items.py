"""Everything that a study measures, item by item; scales, which the others need, are found first."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import partial

from fingerpad.study.engine.runner import Executor, Plan, records_of
from fingerpad.study.engine.store import Store
from fingerpad.study.engine.task import Task
from fingerpad.study.measuring.context import Item, RunContext, cache_key
from fingerpad.study.measuring.curves import CurveItem, CurveResult, curve_names, given_curve
from fingerpad.study.measuring.fingers import FingerResult, PhotographItem, pad_of, photograph_items
from fingerpad.study.measuring.measure import ObservationItem
from fingerpad.study.measuring.scales import FoundScale, scale_from, scale_record, scale_tables
from fingerpad.study.measuring.sequences import SequenceItem


@dataclass(frozen=True, slots=True, eq=False)
class StudyItems:
    """All that counts in the progress of a study, in the order of its tables.

    Attributes
    ----------
    context : RunContext
        What the run knows.
    photographs : dict of str to list of PhotographItem
        By finger; what people rejected is left out.
    curves : list of CurveItem or None
        One for each curve of the manifest, None for one without a file.
    observations, sequences : list of ObservationItem, list of SequenceItem
        One for each.
    """

    context: RunContext
    photographs: dict[str, list[PhotographItem]]
    curves: list[CurveItem | None]
    observations: list[ObservationItem]
    sequences: list[SequenceItem]

    @classmethod
    def of(cls, context: RunContext) -> "StudyItems":
        """Return the items of a study."""
        study = context.study
        fingers = {finger.name: finger for finger in study.fingers}
        photographs = {name: photograph_items(finger, context) for name, finger in fingers.items()}
        curves = [
            None
            if name is None
            else CurveItem(
                context=context,
                name=name,
                curve=curve,
                finger=fingers[curve.finger],
                photographs=photographs[curve.finger],
            )
            for name, curve in zip(curve_names(study), study.curves, strict=True)
        ]
        return cls(
            context,
            photographs,
            curves,
            [ObservationItem(context=context, name=one.name, observation=one) for one in study.observations],
            [SequenceItem(context=context, name=one.name, sequence=one) for one in study.sequences],
        )

    def __iter__(self) -> Iterator[Item]:
        for photographs in self.photographs.values():
            yield from photographs
        yield from filter(None, self.curves)
        yield from self.observations
        yield from self.sequences

    def plans(self, sequences: Iterable[SequenceItem]) -> Iterator[Plan]:
        """Yield the tasks of these sequences, of fingers with their curves, and of observations."""
        for sequence in sequences:
            yield sequence.stages()
        for finger, photographs in self.photographs.items():
            # Curves are compared with the shape of the pad.
            curves = [one for one in self.curves if one is not None and one.curve.finger == finger]
            yield (_tasks(stage) for stage in (photographs, curves))
        for observation in self.observations:
            yield observation.stages()

    def fingers(self) -> dict[str, FingerResult]:
        """Return the semi-axes of each finger from what the store holds."""
        return {
            finger.name: pad_of(finger, self.photographs[finger.name], self.context)
            for finger in self.context.study.fingers
        }

    def curve_results(self) -> list[CurveResult]:
        """Return what the store holds of each loading curve, and those found elsewhere."""
        pairs = zip(self.curves, self.context.study.curves, strict=True)
        return [given_curve(curve) if item is None else item.result() for item, curve in pairs]


def _tasks(items: Iterable[Item]) -> list[Task]:
    """Return the tasks of items of one stage each."""
    return [task for item in items for stage in item.stages() for task in stage]


def item_of(task: str) -> str:
    """Return the item to which a task belongs, by its name: of a piece of a sequence, the sequence."""
    return task if "/" in task else task.partition(" ")[0]


def resolve_scales(context: RunContext, store: Store, executor: Executor) -> dict[str, FoundScale | str]:
    """Return every scale of a study, or why there is none; missing coins and grids are measured."""
    tables = scale_tables(context.study)
    tasks = {
        key: Task(
            name=f"/scale {key}",  # no item's name begins like this
            item=name or file,
            file=file,
            key=cache_key(table.model_dump(mode="json"), context.digest(context.folder / file)),
            work=partial(scale_record, name, table),
            inputs=(file,),
            pictures=0,
        )
        for key, (name, table) in tables.items()
        for _, file in table.files()
    }
    records = dict(zip(tasks, records_of(list(tasks.values()), executor, store, context.folder), strict=True))
    return {
        key: scale_from(records.get(key) or scale_record(name, table, context.folder, context.folder))
        for key, (name, table) in tables.items()
    }
