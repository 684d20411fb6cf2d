"""What there is to measure in a study, each task keyed by all that its result depends on."""

import hashlib
import re
from collections.abc import Iterator
from functools import partial
from pathlib import Path, PurePosixPath

from fingerpad._files import file_stem
from fingerpad.study.corrections.apply import contact_correction, photograph_correction
from fingerpad.study.corrections.changes import ContactCorrection
from fingerpad.study.engine.codec import to_record
from fingerpad.study.engine.runner import Executor, records_of
from fingerpad.study.engine.store import Store
from fingerpad.study.engine.task import Record, Task
from fingerpad.study.manifest import Finger, Observation, Photograph
from fingerpad.study.measuring.context import RunContext, cache_key
from fingerpad.study.measuring.fingers import face_record, photograph_item
from fingerpad.study.measuring.measure import measure_observation
from fingerpad.study.measuring.scales import FoundScale, scale_from, scale_record, scale_tables


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


def observation_tasks(context: RunContext) -> Iterator[Task]:
    """Yield a task for each observation."""
    for observation in context.study.observations:
        scale = None if observation.scale is None else context.scale(observation.scale)
        correction = contact_correction(context.active_corrections.get(observation.name))
        yield Task(
            name=observation.name,
            item=observation.name,
            file=observation.file or "",
            key=context.item_key(observation.name, observation),
            work=partial(_observed, observation, scale, correction),
            inputs=context.inputs_of(observation),
        )


def _observed(
    observation: Observation,
    scale: FoundScale | str | None,
    correction: ContactCorrection,
    folder: Path,
    out: Path,
) -> Record:
    return {**to_record(measure_observation(observation, scale, folder, out, correction))}


def photograph_tasks(finger: Finger, context: RunContext) -> Iterator[Task]:
    """Yield a task for each photograph of a finger that is not rejected."""
    for photograph in pictures_of(finger):
        item = photograph_item(finger, photograph)
        if photograph.file is None or context.is_rejected(item):
            continue
        assert photograph.scale is not None  # the manifest's own rule
        yield Task(
            name=item,
            item=item,
            file=photograph.file,
            key=context.item_key(item, photograph),
            work=partial(
                face_record,
                photograph=photograph,
                correction=photograph_correction(context.active_corrections.get(item)),
                overlay=_overlay(finger.name, photograph.face, photograph.file),
                scale=context.scale(photograph.scale),
            ),
            inputs=context.inputs_of(photograph),
        )


def _overlay(finger: str, face: str, file: str) -> str:
    """Return the name of a photograph's overlay, which no other photograph has, now or in another run."""
    name = re.sub(r"[^\w-]+", "-", PurePosixPath(file).stem)  # folders, blanks and # are for the digest
    stem = file_stem(f"{finger}_{face}_{name}_{hashlib.sha256(file.encode()).hexdigest()[:8]}")
    return f"overlays/photographs/{stem}.png"


def pictures_of(finger: Finger) -> list[Photograph]:
    """Return the photographs of a finger that are pictures."""
    return [photograph for photograph in finger.photographs if photograph.file is not None]
