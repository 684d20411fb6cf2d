"""Measuring all that a study shows, and finding it again in the store."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from itertools import chain
from typing import Literal

from fingerpad.study.engine.executors import Executor
from fingerpad.study.engine.limits import Limits
from fingerpad.study.engine.progress import Progress
from fingerpad.study.engine.runner import Plan, put_unless_changed, records_of, run_plans
from fingerpad.study.engine.store import Store, TaskStatus
from fingerpad.study.engine.task import CHANGED, Record, Task, TaskResult
from fingerpad.study.manifest import Contact, Finger, Observation
from fingerpad.study.measuring.curves import CurveResult, curve_items, curve_key, curve_results, curve_tasks
from fingerpad.study.measuring.fingers import FingerResult, finger_result, is_rejected, photograph_item
from fingerpad.study.measuring.measure import Measurement, reviewed
from fingerpad.study.measuring.records import measurement_from
from fingerpad.study.measuring.scales import FoundScale, scale_from
from fingerpad.study.measuring.sequences import (
    SequenceResult,
    film_key,
    film_measurements,
    film_plan,
    film_result,
    frame_count,
    header_task,
)
from fingerpad.study.measuring.tasks import (
    CacheKeys,
    Scales,
    item_key,
    observation_tasks,
    photograph_tasks,
    pictures_of,
    scale_tasks,
)


def measured_scales(keys: CacheKeys, store: Store, executor: Executor) -> dict[str, FoundScale | str]:
    """Return each named scale, or why there is none; those that the store lacks are measured."""
    records = records_of(scale_tasks(keys), executor, store, keys.folder)
    return {name: scale_from(name, record) for name, record in zip(keys.study.scales, records, strict=True)}


def measure_study(
    keys: CacheKeys,
    scales: Scales,
    store: Store,
    *,
    executor: Executor,
    on_progress: Callable[[Progress], None],
) -> Progress:
    """Measure what the store lacks, store each result as it comes, and return where the run stands then.

    Parameters
    ----------
    keys : Keys
        The study and the keys of its tasks.
    scales : mapping
        Its named scales.
    store : Store
        Where results are kept.
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
    statuses = store.statuses()
    records_of(
        [header_task(sequence, keys) for sequence in keys.study.sequences], executor, store, keys.folder
    )
    tally = _Tally(keys, store, executor.limits, statuses, on_progress)

    def is_done(task: Task) -> bool:
        if not store.is_done(task, statuses, executor.limits):
            return False
        if task.name != task.item:  # a piece of a sequence that is not done as a whole
            tally.pictures += task.pictures
        return True

    def store_result(task: Task, result: TaskResult) -> None:
        record = put_unless_changed(store, keys.folder, task, result)
        tally.tell(task, failed=record.get("reason") is not None, seconds=result.seconds)

    films = (
        film_plan(sequence, keys, scales, store)
        for sequence in keys.study.sequences
        if (status := statuses.get(sequence.name)) is None
        or not store.is_current(status, film_key(sequence, keys), executor.limits)
    )
    fingers = (_finger_plan(finger, keys, scales, store) for finger in keys.study.fingers)
    contacts = (iter(([task],)) for task in observation_tasks(keys, scales))
    tally.tell()
    run_plans(chain(films, fingers, contacts), executor, store_result, is_done)
    return tally.now()


def _finger_plan(finger: Finger, keys: CacheKeys, scales: Scales, store: Store) -> Plan:
    """Plan a finger: its photographs, then its loading curves, which are compared with the pad's shape."""
    yield list(photograph_tasks(finger, keys, scales))
    if any(curve.finger == finger.name and curve.file for curve in keys.study.curves):
        yield list(curve_tasks(pad_of(finger, keys, scales, store), keys))


def pad_of(finger: Finger, keys: CacheKeys, scales: Scales, store: Store) -> FingerResult:
    """Return the semi-axes of a finger from what the store holds of its photographs."""
    return finger_result(finger, scales, keys.folder, faces_of(finger, keys, store), keys.active_corrections)


def faces_of(finger: Finger, keys: CacheKeys, store: Store) -> dict[str, Record]:
    """Return what the store holds of a finger's photographs, by item."""
    items = {photograph_item(finger, one): one for one in pictures_of(finger)}
    return {
        item: _found(store, item, item_key(keys, item, photograph), photograph.file)
        for item, photograph in items.items()
        if not is_rejected(keys.active_corrections.get(item))
    }


def loading_results(keys: CacheKeys, store: Store) -> list[CurveResult]:
    """Return what the store holds of each loading curve, and those found elsewhere."""
    return curve_results(keys, partial(_found, store))


def film_results(keys: CacheKeys, store: Store) -> list[SequenceResult]:
    """Return what the store holds of each film as a whole."""
    return [
        film_result(sequence, _found(store, sequence.name, film_key(sequence, keys), sequence.file))
        for sequence in keys.study.sequences
    ]


def measurements(
    keys: CacheKeys, scales: Scales, store: Store, films: Iterable[SequenceResult]
) -> Iterator[tuple[Contact, Measurement]]:
    """Yield what was measured of each observation and frame, in the manifest's order, one at a time."""
    for observation in keys.study.observations:
        seen = _observed(observation, keys, store)
        yield observation, reviewed(seen, keys.active_corrections.get(observation.name))
    for film in films:
        for measured in film_measurements(film, keys, scales, store):
            yield film.manifest, measured


def _observed(observation: Observation, keys: CacheKeys, store: Store) -> Measurement:
    record = _found(store, observation.name, item_key(keys, observation.name, observation), observation.file)
    if record.keys() == {"reason"}:
        return Measurement(name=observation.name, load=observation.load_N, reason=record["reason"])
    return measurement_from(record, observation.load_N)


def _found(store: Store, name: str, key: str, file: str | None) -> Record:
    return store.record(name, key) or {"reason": CHANGED.format(file)}


def items_of(keys: CacheKeys) -> Iterator[tuple[str, Callable[[], str]]]:
    """Yield the name of each photograph, loading curve, observation and film, with what makes its key."""
    for finger in keys.study.fingers:
        for photograph in pictures_of(finger):
            item = photograph_item(finger, photograph)
            if not is_rejected(keys.active_corrections.get(item)):
                yield item, partial(item_key, keys, item, photograph)
    for item, curve in curve_items(keys.study):
        yield item, partial(curve_key, curve, keys)
    for observation in keys.study.observations:
        yield observation.name, partial(item_key, keys, observation.name, observation)
    for sequence in keys.study.sequences:
        yield sequence.name, partial(film_key, sequence, keys)


def drawn_for(keys: CacheKeys, store: Store) -> Iterator[tuple[str, str]]:
    """Yield the overlays that belong to the study as it is, by name, each with its digest."""
    statuses = store.statuses()
    for name, _ in items_of(keys):
        if (status := statuses.get(name)) is not None:
            yield from status.drawn.items()


class _Tally:
    """Progress so far."""

    def __init__(
        self,
        keys: CacheKeys,
        store: Store,
        limits: Limits,
        statuses: Mapping[str, TaskStatus],
        on_progress: Callable[[Progress], None],
    ) -> None:
        self._on_progress = on_progress
        self.pictures = self.failed = self._total = 0
        films = {sequence.name: sequence for sequence in keys.study.sequences}
        for name, key in items_of(keys):
            count = frame_count(films[name], keys, store) if name in films else 1
            self._total += count
            if (status := statuses.get(name)) and store.is_current(status, key(), limits):
                self.pictures += count
                self.failed += status.status == "failed"

    def tell(self, task: Task | None = None, *, failed: bool = False, seconds: float = 0.0) -> None:
        now = self.now()
        if task is not None:
            self.pictures += task.pictures
            self.failed += failed
            status: Literal["done", "failed"] = "failed" if failed else "done"
            now = replace(self.now(), item=task.item, file=task.file, status=status, seconds=seconds)
        self._on_progress(now)

    def now(self) -> Progress:
        return Progress(pictures=self.pictures, failed=self.failed, total=self._total)
