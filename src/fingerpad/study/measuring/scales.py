"""Scales of a study: from a table of the manifest, or by the name that several pictures share."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from fingerpad.exceptions import CalibrationError, FingerpadError
from fingerpad.image import Scale, measure_coin, read_image
from fingerpad.study.engine.task import Record
from fingerpad.study.error_text import in_study
from fingerpad.study.manifest import CoinScale, LineScale, PitchScale, ScaleKey, ScaleTable, Study


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundScale:
    """A scale with what must be known of it.

    Attributes
    ----------
    scale : Scale
        Millimetres per pixel.
    name : str or None
        Its name, where pictures share it: they have one uncertain number in common.
    flags : tuple of str
        Doubts: ``coin_shadow``.
    """

    scale: Scale
    name: str | None = None
    flags: tuple[str, ...] = ()


def named_scales(study: Study, folder: Path) -> dict[str, FoundScale | str]:
    """Return each named scale of a study, or why there is none; each is measured once."""
    return {name: _named_scale(table, folder, name) for name, table in study.scales.items()}


def _named_scale(table: ScaleTable, folder: Path, name: str) -> FoundScale | str:
    try:
        return _found(table, folder, name)
    except FingerpadError as error:
        return in_study(f"scale {name}: {error}", folder)


def scale_record(name: str, table: ScaleTable, folder: Path, _out: Path) -> Record:
    """Measure a named scale, and return what was found as plain values."""
    found = _named_scale(table, folder, name)
    if isinstance(found, str):
        return {"reason": found}
    return {**asdict(found.scale), "flags": list(found.flags)}


def scale_from(name: str, record: Record) -> FoundScale | str:
    """Return a named scale from its record."""
    if (reason := record.get("reason")) is not None:
        return str(reason)
    scale = Scale(mm_per_px=record["mm_per_px"], mm_per_px_std=record["mm_per_px_std"])
    return FoundScale(scale=scale, name=name, flags=tuple(record["flags"]))


def find_scale(key: ScaleKey, known: Mapping[str, FoundScale | str], folder: Path) -> FoundScale:
    """Return the scale that a key of the manifest means.

    Raises
    ------
    CalibrationError
        If there is none, as where no coin is found.
    ImageError
        If a coin's picture cannot be read.
    """
    if not isinstance(key, str):
        return _found(key, folder)
    found = known[key]
    if isinstance(found, str):
        raise CalibrationError(found)
    return found


def _found(table: ScaleTable, folder: Path, name: str | None = None) -> FoundScale:
    if isinstance(table, CoinScale):
        return _coin(table, folder, name)
    if isinstance(table, LineScale):
        (row, column), (end_row, end_column) = table.line
        scale = Scale.of_line(
            table.length_mm,
            (row, column),
            (end_row, end_column),
            length_mm_std=table.length_mm_std,
            point_px_std=table.ends_px_std,
        )
    elif isinstance(table, PitchScale):
        scale = Scale(table.mm_per_px, table.mm_per_px * table.relative_std)
    else:
        scale = Scale.of_ppi(table.ppi, table.ppi * table.relative_std)
    return FoundScale(scale=scale, name=name)


def _coin(table: CoinScale, folder: Path, name: str | None) -> FoundScale:
    pixels = read_image(folder / table.coin).pixels
    try:
        coin = measure_coin(pixels)
    except CalibrationError as error:
        raise CalibrationError(f"{table.coin}: {error}") from error
    return FoundScale(
        scale=coin.scale(table.diameter_mm, table.diameter_mm_std),
        name=name,
        flags=tuple(f"coin_{flag}" for flag in coin.flags),
    )
