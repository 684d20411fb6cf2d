"""Measuring all that a study shows, and finding it again in the store."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from itertools import chain
from pathlib import Path
from typing import Literal

from fingerpad.study.durable import keep_files
from fingerpad.study.engine.hands import Hands
from fingerpad.study.engine.progress import Progress
from fingerpad.study.engine.runner import Plan, run_plans
from fingerpad.study.engine.store import Mark, Store
from fingerpad.study.engine.task import CHANGED, Done, Record, Task
from fingerpad.study.manifest import Contact, Finger, Observation
from fingerpad.study.measuring.curves import CurveResult, curve_items, curve_key, curve_results, curve_tasks
from fingerpad.study.measuring.fingers import FingerResult, finger_result, is_rejected, photograph_item
from fingerpad.study.measuring.measure import Measurement, reviewed
from fingerpad.study.measuring.records import measurement_from
from fingerpad.study.measuring.sequences import (
    SequenceResult,
    film_key,
    film_measurements,
    film_plan,
    film_result,
    frames_in,
)
from fingerpad.study.measuring.tasks import (
    Keys,
    Scales,
    item_key,
    observation_tasks,
    photograph_tasks,
    pictures_of,
)


def measure_study(
    keys: Keys,
    scales: Scales,
    store: Store,
    out: Path,
    *,
    hands: Hands,
    on_progress: Callable[[Progress], None],
) -> Progress:
    """Measure what the store lacks, keep each result as it comes, and return where the run stands then.

    Parameters
    ----------
    keys : Keys
        The study and the keys of its tasks.
    scales : mapping
        Its named scales.
    store : Store
        Where results are kept.
    out : Path
        Where overlays are kept.
    hands : Hands
        Who measures.
    on_progress : callable
        Told at the start and after each task.

    Raises
    ------
    KeyboardInterrupt
        After an interrupt, with what was in hand kept.
    StoreError
        If results cannot be kept.
    """
    marks = {name: mark for name, mark in store.marks().items() if _drawn(mark, out)}
    tally = _Tally(keys, marks, on_progress)

    def is_done(task: Task) -> bool:
        mark = marks.get(task.name)
        if mark is None or mark.key != task.key:
            return False
        if task.name != task.item:  # a piece of a film that is not done as a whole
            tally.pictures += task.pictures
        return True

    def keep(task: Task, done: Done) -> None:
        record, key = done.record, task.key
        if not all(store.unchanged(keys.folder / name) for name in task.inputs):
            record, key = {"reason": CHANGED.format(task.file)}, ""
        else:
            keep_files(out, done.pictures)
        store.put(task.name, key, record, seconds=done.seconds, count=task.pictures, drawn=done.pictures)
        tally.tell(task, failed=record.get("reason") is not None, seconds=done.seconds)

    films = (
        film_plan(sequence, keys, scales, store)
        for sequence in keys.study.sequences
        if (mark := marks.get(sequence.name)) is None or mark.key != film_key(sequence, keys)
    )
    fingers = (_finger_plan(finger, keys, scales, store) for finger in keys.study.fingers)
    contacts = (iter(([task],)) for task in observation_tasks(keys, scales))
    tally.tell()
    run_plans(chain(films, fingers, contacts), hands, keep, is_done)
    return tally.now()


def _finger_plan(finger: Finger, keys: Keys, scales: Scales, store: Store) -> Plan:
    """Plan a finger: its photographs, then its loading curves, which are compared with the pad's shape."""
    yield list(photograph_tasks(finger, keys, scales))
    if any(curve.finger == finger.name and curve.file for curve in keys.study.curves):
        yield list(curve_tasks(pad_of(finger, keys, scales, store), keys))


def pad_of(finger: Finger, keys: Keys, scales: Scales, store: Store) -> FingerResult:
    """Return the semi-axes of a finger from what the store holds of its photographs."""
    return finger_result(finger, scales, keys.folder, faces_of(finger, keys, store), keys.rulings)


def faces_of(finger: Finger, keys: Keys, store: Store) -> dict[str, Record]:
    """Return what the store holds of a finger's photographs, by item."""
    items = {photograph_item(finger, one): one for one in pictures_of(finger)}
    return {
        item: _found(store, item, item_key(keys, item, photograph), photograph.image)
        for item, photograph in items.items()
        if not is_rejected(keys.rulings.get(item))
    }


def loading_results(keys: Keys, store: Store) -> list[CurveResult]:
    """Return what the store holds of each loading curve, and those found elsewhere."""
    return curve_results(keys, partial(_found, store))


def film_results(keys: Keys, store: Store) -> list[SequenceResult]:
    """Return what the store holds of each film as a whole."""
    return [
        film_result(sequence, _found(store, sequence.name, film_key(sequence, keys), sequence.path))
        for sequence in keys.study.sequences
    ]


def measurements(
    keys: Keys, scales: Scales, store: Store, films: Iterable[SequenceResult]
) -> Iterator[tuple[Contact, Measurement]]:
    """Yield what was measured of each observation and frame, in the manifest's order, one at a time."""
    for observation in keys.study.observations:
        seen = _observed(observation, keys, store)
        yield observation, reviewed(seen, keys.rulings.get(observation.name))
    for film in films:
        for measured in film_measurements(film, keys, scales, store):
            yield film.manifest, measured


def _observed(observation: Observation, keys: Keys, store: Store) -> Measurement:
    record = _found(store, observation.name, item_key(keys, observation.name, observation), observation.image)
    if record.keys() == {"reason"}:
        return Measurement(name=observation.name, load=observation.load_N, reason=record["reason"])
    return measurement_from(record, observation.load_N)


def _found(store: Store, name: str, key: str, file: str | None) -> Record:
    return store.record(name, key) or {"reason": CHANGED.format(file)}


def items_of(keys: Keys) -> Iterator[tuple[str, Callable[[], str]]]:
    """Yield the name of each photograph, loading curve, observation and film, with what makes its key."""
    for finger in keys.study.fingers:
        for photograph in pictures_of(finger):
            item = photograph_item(finger, photograph)
            if not is_rejected(keys.rulings.get(item)):
                yield item, partial(item_key, keys, item, photograph)
    for item, curve in curve_items(keys.study):
        yield item, partial(curve_key, curve, keys)
    for observation in keys.study.observations:
        yield observation.name, partial(item_key, keys, observation.name, observation)
    for sequence in keys.study.sequences:
        yield sequence.name, partial(film_key, sequence, keys)


def drawn_for(keys: Keys, store: Store) -> set[str]:
    """Return the overlays that belong to the study as it is, relative to the output folder."""
    marks = store.marks()
    found = (marks.get(name) for name, _ in items_of(keys))
    return {file for mark in found if mark is not None for file in mark.drawn.splitlines()}


def _drawn(mark: Mark, out: Path) -> bool:
    """Tell whether all overlays of a result are where they belong."""
    return all((out / file).is_file() for file in mark.drawn.splitlines())


class _Tally:
    """Progress so far."""

    def __init__(
        self, keys: Keys, marks: Mapping[str, Mark], on_progress: Callable[[Progress], None]
    ) -> None:
        self._on_progress = on_progress
        self.pictures = self.failed = self._total = 0
        films = {sequence.name: sequence for sequence in keys.study.sequences}
        for name, key in items_of(keys):
            count = frames_in(films[name], keys.folder) if name in films else 1
            self._total += count
            mark = marks.get(name)
            if mark is not None and mark.key == key():
                self.pictures += count
                self.failed += mark.status == "failed"

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
