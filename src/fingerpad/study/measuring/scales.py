"""Scales of a study: from a table of the manifest, or by the name that several pictures share."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from fingerpad.exceptions import CalibrationError, FingerpadError
from fingerpad.image import Grid, Scale, measure_coin, measure_grid, read_image
from fingerpad.study.engine.store import from_record, to_record
from fingerpad.study.engine.task import Record, in_study
from fingerpad.study.manifest.models import (
    CircleScale,
    CoinScale,
    GridScale,
    LineScale,
    PitchScale,
    ResolutionScale,
    ScaleKey,
    ScaleTable,
    Study,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundScale:
    """A scale with what must be known of it."""

    scale: Scale
    name: str | None = None  # where pictures share it: one uncertain number for all
    flags: tuple[str, ...] = ()


# Every scale of a study by its `scale_key`, or why there is none.
Scales: TypeAlias = Mapping[str, FoundScale | str]


def scale_key(key: ScaleKey) -> str:
    """Return what a scale is known by: its name, or what its table says; no name holds a brace."""
    return key if isinstance(key, str) else key.model_dump_json()


def scale_tables(study: Study) -> dict[str, tuple[str | None, ScaleTable]]:
    """Return the name, if it has one, and the table of each scale of a study."""
    named = {name: (name, table) for name, table in study.scales.items()}
    return {
        **named,
        **{scale_key(one): (None, one) for one in study.scales_in_use() if not isinstance(one, str)},
    }


def scale_record(name: str | None, table: ScaleTable, folder: Path, _out: Path) -> Record:
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


def measure_scale(table: ScaleTable, folder: Path, name: str | None = None) -> FoundScale:
    """Return the scale that a table means; `CalibrationError` where no coin or grid is found."""
    match table:
        case GridScale():
            grid = grid_of(table, read_image(folder / table.grid).pixels)
            return FoundScale(scale=grid.scale, name=name, flags=grid.flags)
        case CoinScale():
            pixels = read_image(folder / table.coin).pixels
            try:
                coin = measure_coin(pixels)
            except CalibrationError as error:
                raise CalibrationError(f"{table.coin}: {error}") from error
            scale = coin.scale(table.diameter_mm, table.diameter_mm_std)
            return FoundScale(scale=scale, name=name, flags=coin.flags)
        case LineScale():
            (row, column), (end_row, end_column) = table.line
            scale = Scale.of_line(
                table.length_mm,
                (row, column),
                (end_row, end_column),
                length_mm_std=table.length_mm_std,
                point_px_std=table.ends_px_std,
            )
        case CircleScale():
            scale = Scale.of_circle(
                table.diameter_mm,
                [(row, column) for row, column in table.circle],
                diameter_mm_std=table.diameter_mm_std,
                point_px_std=table.points_px_std,
            )
        case PitchScale():
            scale = Scale(table.mm_per_px, table.mm_per_px * table.relative_std)
        case ResolutionScale():
            scale = Scale.of_ppi(table.ppi, table.ppi * table.relative_std)
    return FoundScale(scale=scale, name=name)


def grid_of(table: GridScale, pixels: npt.NDArray[np.generic]) -> Grid:
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
