"""What there is to measure in a study, each task keyed by all that its result depends on."""

import hashlib
import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, Final, TypeAlias

from fingerpad._files import file_stem
from fingerpad.study.corrections.changes import ContactCorrection
from fingerpad.study.corrections.history import ActiveCorrection
from fingerpad.study.engine.task import Record, Task
from fingerpad.study.engine.versions import versions_of
from fingerpad.study.manifest import CoinScale, Finger, Observation, Photograph, ScaleTable, Study
from fingerpad.study.manifest.tables import ManifestModel
from fingerpad.study.measuring.fingers import face_record, is_rejected, photograph_item
from fingerpad.study.measuring.measure import contact_correction, measure_observation
from fingerpad.study.measuring.records import measurement_record
from fingerpad.study.measuring.scales import FoundScale, scale_record

Scales: TypeAlias = Mapping[str, FoundScale | str]

# What of a contact's table changes nothing in what is measured on its picture.
_NOT_MEASURED: Final = frozenset(
    ("finger", "wedge_angle_deg", "roll_angle_deg", "load_N", "notes", "scale", "pool_min_load_N")
)


@dataclass(frozen=True, slots=True, kw_only=True)
class CacheKeys:
    """Keys of a study's tasks.

    Attributes
    ----------
    study : Study
        The manifest.
    folder : Path
        The study folder.
    digest : callable
        That of a file or folder.
    active_corrections : mapping
        What people corrected, by item.
    """

    study: Study
    folder: Path
    digest: Callable[[Path], str]
    active_corrections: Mapping[str, ActiveCorrection] = field(default_factory=dict)

    def edits(self, item: str) -> dict[str, Any]:
        """Return what a person changed in the measurement of an item."""
        active_correction = self.active_corrections.get(item)
        return {} if active_correction is None else active_correction.change.edits

    def of(self, table: ManifestModel, *more: object, leave_out: frozenset[str] = frozenset()) -> str:
        """Return the key of what the manifest says in a table.

        Parameters
        ----------
        table : ManifestModel
            Of an observation, a sequence or a photograph.
        *more
            Further parameters of the result.
        leave_out : frozenset of str
            Keys of the table that do not bear on it.
        """
        parameters = table.model_dump(mode="json", exclude=set(_NOT_MEASURED | leave_out))
        name = getattr(table, "scale", None)
        scale = self.study.scales[name].model_dump(mode="json") if isinstance(name, str) else None
        if scale is None and isinstance(name, ManifestModel):
            scale = name.model_dump(mode="json")
        digests = {file: self.digest(self.folder / file) for file in self.inputs_of(table, leave_out)}
        return cache_key(parameters, name if isinstance(name, str) else None, scale, digests, *more)

    def coin_digest(self, table: ScaleTable) -> str | None:
        """Return the digest of the picture that a scale is measured in, None where it needs none."""
        return self.digest(self.folder / table.coin) if isinstance(table, CoinScale) else None

    def inputs_of(self, table: ManifestModel, leave_out: frozenset[str] = frozenset()) -> tuple[str, ...]:
        """Return the files and folders that a table names, but for those of some keys."""
        scale = getattr(table, "scale", None)
        shared = self.study.scales[scale].files() if isinstance(scale, str) else ()
        return tuple(file for loc, file in (*table.files(), *shared) if loc[0] not in leave_out)


def cache_key(*parts: object) -> str:
    """Return a digest of some parameters and of the versions that images are measured with."""
    return hashlib.sha256(json.dumps([*parts, versions_of("image")], sort_keys=True).encode()).hexdigest()


def scale_tasks(keys: CacheKeys) -> list[Task]:
    """Return a task for each named scale."""
    return [
        Task(
            name=f"/scale {name}",  # no item's name begins like this
            item=name,
            file=table.coin if isinstance(table, CoinScale) else "",
            key=cache_key(table.model_dump(mode="json"), keys.coin_digest(table)),
            work=partial(scale_record, name, table),
            inputs=(table.coin,) if isinstance(table, CoinScale) else (),
            pictures=0,
        )
        for name, table in keys.study.scales.items()
    ]


def observation_tasks(keys: CacheKeys, scales: Scales) -> Iterator[Task]:
    """Yield a task for each observation."""
    for observation in keys.study.observations:
        correction = contact_correction(keys.active_corrections.get(observation.name))
        yield Task(
            name=observation.name,
            item=observation.name,
            file=observation.file or "",
            key=item_key(keys, observation.name, observation),
            work=partial(_observed, observation, scales, correction),
            inputs=keys.inputs_of(observation),
        )


def _observed(
    observation: Observation, scales: Scales, correction: ContactCorrection, folder: Path, out: Path
) -> Record:
    return measurement_record(measure_observation(observation, scales, folder, out, correction))


def photograph_tasks(finger: Finger, keys: CacheKeys, scales: Scales) -> Iterator[Task]:
    """Yield a task for each photograph of a finger that is not rejected."""
    for number, photograph in enumerate(pictures_of(finger), start=1):
        item = photograph_item(finger, photograph)
        active_correction = keys.active_corrections.get(item)
        if photograph.file is None or is_rejected(active_correction):
            continue
        change = None if active_correction is None else active_correction.change
        assert not isinstance(change, ContactCorrection)  # the items' own rule
        yield Task(
            name=item,
            item=item,
            file=photograph.file,
            key=item_key(keys, item, photograph),
            work=partial(
                face_record,
                photograph=photograph,
                correction=change,
                overlay=f"overlays/photographs/{file_stem(f'{finger.name}_{photograph.face}_{number}')}.png",
                scales=scales,
            ),
            inputs=keys.inputs_of(photograph),
        )


def pictures_of(finger: Finger) -> list[Photograph]:
    """Return the photographs of a finger that are pictures."""
    return [photograph for photograph in finger.photographs if photograph.file is not None]


def item_key(keys: CacheKeys, item: str, table: ManifestModel) -> str:
    """Return the key of an observation or a photograph."""
    return keys.of(table, keys.edits(item))
