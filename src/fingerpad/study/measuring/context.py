"""What a run knows: the study, people's corrections, its scales and the store; and what it measures."""

import hashlib
import json
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property, partial
from pathlib import Path
from typing import Any, Final, Generic, TypeAlias, TypeVar

import numpy as np
import numpy.typing as npt

from fingerpad._records import from_record, to_record
from fingerpad.exceptions import CalibrationError, FingerpadError
from fingerpad.image import Grid, Scale, measure_coin, measure_grid, read_image
from fingerpad.study.corrections.log import ActiveCorrection, is_rejected
from fingerpad.study.engine.runner import Perform
from fingerpad.study.engine.store import Store
from fingerpad.study.engine.task import CHANGED, Record, Task, Work, in_study, versions_of
from fingerpad.study.manifest import models


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundScale:
    """A scale with what must be known of it."""

    scale: Scale
    name: str | None = None  # where pictures share it: one uncertain number for all
    flags: tuple[str, ...] = ()


# Every scale of a study by its `scale_key`, or why there is none.
Scales: TypeAlias = Mapping[str, FoundScale | str]


def scale_key(key: models.ScaleKey) -> str:
    """Return what a scale is known by: its name, or what its table says; no name holds a brace."""
    return key if isinstance(key, str) else key.model_dump_json()


def scale_tables(study: models.Study) -> dict[str, tuple[str | None, models.ScaleTable]]:
    """Return the name, if it has one, and the table of each scale of a study."""
    named = {name: (name, table) for name, table in study.scales.items()}
    return {
        **named,
        **{scale_key(one): (None, one) for one in study.scales_in_use() if not isinstance(one, str)},
    }


def scale_record(name: str | None, table: models.ScaleTable, folder: Path, _out: Path) -> Record:
    """Measure a scale, and return what was found as plain values."""
    try:
        found = measure_scale(table, folder, name)
    except FingerpadError as error:
        return {"reason": in_study(error if name is None else f"scale {name}: {error}", folder)}
    return {**to_record(found)}


def scale_from(record: Record) -> FoundScale | str:
    """Return a scale from its record."""
    if (reason := record.get("reason")) is not None:
        return str(reason)
    return from_record(FoundScale, record)


def require_scale(found: FoundScale | str) -> FoundScale:
    """Return a scale that was found; `CalibrationError` says why it was not."""
    if isinstance(found, str):
        raise CalibrationError(found)
    return found


def measure_scale(table: models.ScaleTable, folder: Path, name: str | None = None) -> FoundScale:
    """Return the scale that a table means; `CalibrationError` where no coin or grid is found."""
    match table:
        case models.GridScale():
            grid = grid_of(table, read_image(folder / table.grid).pixels)
            return FoundScale(scale=grid.scale, name=name, flags=grid.flags)
        case models.CoinScale():
            pixels = read_image(folder / table.coin).pixels
            try:
                coin = measure_coin(pixels)
            except CalibrationError as error:
                raise CalibrationError(f"{table.coin}: {error}") from error
            scale = coin.scale(table.diameter_mm, table.diameter_mm_std)
            return FoundScale(scale=scale, name=name, flags=coin.flags)
        case models.LineScale():
            (row, column), (end_row, end_column) = table.line
            scale = Scale.of_line(
                table.length_mm,
                (row, column),
                (end_row, end_column),
                length_mm_std=table.length_mm_std,
                point_px_std=table.ends_px_std,
            )
        case models.CircleScale():
            scale = Scale.of_circle(
                table.diameter_mm,
                [(row, column) for row, column in table.circle],
                diameter_mm_std=table.diameter_mm_std,
                point_px_std=table.points_px_std,
            )
        case models.PitchScale():
            scale = Scale(table.mm_per_px, table.mm_per_px * table.relative_std)
        case models.ResolutionScale():
            scale = Scale.of_ppi(table.ppi, table.ppi * table.relative_std)
    return FoundScale(scale=scale, name=name)


def grid_of(table: models.GridScale, pixels: npt.NDArray[np.generic]) -> Grid:
    """Find the grid of a table in its picture; `CalibrationError` if it is not found."""
    try:
        return measure_grid(
            pixels,
            (table.points[0], table.points[1]),
            table.spacing_mm,
            spacing_mm_std=table.spacing_mm_std,
            pattern=table.pattern,
        )
    except CalibrationError as error:
        raise CalibrationError(f"{table.grid}: {error}") from error


# What of a contact's table changes nothing in what is measured on its picture.
_NOT_MEASURED: Final = {
    *("finger", "wedge_angle_deg", "roll_angle_deg", "load_N"),
    *("session", "notes", "scale", "pool_min_load_N"),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class RunContext:
    """What a run knows."""

    study: models.Study
    folder: Path
    active_corrections: Mapping[str, ActiveCorrection] = field(default_factory=dict)
    second_operator: Mapping[str, ActiveCorrection] = field(default_factory=dict)
    store: Store | None = None  # None where nothing was measured yet
    scales: Scales = field(default_factory=dict)  # empty before they are measured
    digests: dict[Path, str] = field(default_factory=dict, repr=False)  # of files that were asked for

    def digest(self, path: Path) -> str:
        """Return the digest of a file or folder, which is read once; its path where there is no store."""
        if path not in self.digests:
            self.digests[path] = str(path) if self.store is None else self.store.digest(path)
        return self.digests[path]

    def scale(self, key: models.ScaleKey) -> FoundScale | str:
        """Return the scale that a key of the manifest means, or why there is none."""
        return self.scales[scale_key(key)]

    def edits(self, item: str) -> dict[str, Any]:
        """Return what a person changed in the measurement of an item."""
        active_correction = self.active_corrections.get(item)
        return {} if active_correction is None else active_correction.change.edits

    def is_rejected(self, item: str) -> bool:
        """Tell whether a person rejected an item."""
        return is_rejected(self.active_corrections.get(item))

    def record(self, name: str, key: str) -> Record | None:
        """Return what the store holds of a task, None where there is nothing with this key."""
        return None if self.store is None else self.store.record(name, key)

    def key(self, table: models.ManifestModel, *more: object, leave_out: frozenset[str] = frozenset()) -> str:
        """Return the key of what a table of the manifest says, but for the keys of `leave_out`, and more."""
        parameters = table.model_dump(mode="json", exclude=_NOT_MEASURED | leave_out)
        key = getattr(table, "scale", None)
        name = key if isinstance(key, str) else None
        of = key if name is None else self.study.scales[name]
        scale = None if of is None else of.model_dump(mode="json")
        digests = {file: self.digest(self.folder / file) for file in self.inputs_of(table, leave_out)}
        return cache_key(parameters, name, scale, digests, *more)

    def inputs_of(
        self, table: models.ManifestModel, leave_out: frozenset[str] = frozenset()
    ) -> tuple[str, ...]:
        """Return the files and folders that a table names, but for those of some keys."""
        scale = getattr(table, "scale", None)
        shared = self.study.scales[scale].files() if isinstance(scale, str) else ()
        return tuple(file for loc, file in (*table.files(), *shared) if loc[0] not in leave_out)


def resolve_scales(context: RunContext, perform: Perform) -> Scales:
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
        )
        for key, (name, table) in tables.items()
        for _, file in table.files()
    }
    records = dict(zip(tasks, perform(tasks.values()).values(), strict=True))
    return {
        key: scale_from(records.get(key) or scale_record(name, table, context.folder, context.folder))
        for key, (name, table) in tables.items()
    }


TableOf = TypeVar("TableOf", bound=models.ManifestModel)


@dataclass(frozen=True, kw_only=True, eq=False)
class Item(ABC, Generic[TableOf]):
    """Something of a study that is measured on its own and counts as one."""

    context: RunContext
    name: str  # in the store, in corrections, and in the progress of a run

    table: TableOf  # what the manifest says of it

    @property
    def file(self) -> str:
        """The file that it shows, empty without any."""
        return getattr(self.table, "file", None) or ""

    @property
    def correction(self) -> ActiveCorrection | None:
        """What a person corrected of it, None without any."""
        return self.context.active_corrections.get(self.name)

    @property
    def scale(self) -> FoundScale | str | None:
        """Its scale, or why there is none; None where none is stated."""
        key = getattr(self.table, "scale", None)
        return None if key is None else self.context.scale(key)

    @property
    def pictures(self) -> int:
        """Number of pictures or frames by which it advances the run."""
        return 1

    @cached_property
    def key(self) -> str:
        """Digest of all that its result depends on."""
        return self.context.key(self.table, self.context.edits(self.name))

    @abstractmethod
    def stages(self) -> Iterator[list[Task]]:
        """Yield its tasks; those of one stage need all of the stage before in the store."""

    @property
    def record(self) -> Record:
        """What the store holds of it, or the reason why there is nothing."""
        return self.context.record(self.name, self.key) or {"reason": CHANGED.format(self.file)}

    def task(self, work: Work) -> Task:
        """Return the task whose result is the item's own."""
        return Task(
            name=self.name,
            item=self.name,
            file=self.file,
            key=self.key,
            work=work,
            inputs=self.context.inputs_of(self.table),
            pictures=self.pictures,
        )


class OneTaskItem(Item[TableOf]):
    """An item that is measured by one task."""

    @abstractmethod
    def work(self) -> Work:
        """Return what measures it."""

    def stages(self) -> Iterator[list[Task]]:
        """Yield its one task."""
        yield [self.task(self.work())]


def cache_key(*parts: object) -> str:
    """Return a digest of some parameters and of the versions that images are measured with."""
    return hashlib.sha256(json.dumps([*parts, versions_of("image")], sort_keys=True).encode()).hexdigest()
