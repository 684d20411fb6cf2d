"""Fiji's Results table: as CSV, as tab separated text, or saved again by a spreadsheet program."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Final

from fingerpad._tables import read_table
from fingerpad.exceptions import ManifestError
from fingerpad.study.fiji.ellipse import MeasuredEllipse, upward_deg

_SUMMARY: Final = ["Mean", "SD", "Min", "Max"]  # rows that Fiji's Summarize appends
# Area over that of the ellipse: they differ where holes or a threshold count.
_SAME_AREA: Final = 0.05


def read_results_table(path: Path) -> list[MeasuredEllipse]:
    """Read the fitted ellipses of a Results table, in its own unit.

    Cells may be separated by commas, tabs or semicolons, the latter two with decimal commas. Rows that Fiji's
    *Summarize* appends are left out.

    Parameters
    ----------
    path : Path
        ``Results.csv``, or ``.txt``, ``.tsv``, ``.xls`` as Fiji writes them: text; or an XLSX workbook.

    Raises
    ------
    ManifestError
        Naming file and line, what was found, and what to do in Fiji.
    """
    table = read_table(path, ManifestError)
    missing = [name for name in ("Major", "Minor") if name not in table.header]
    if missing:
        found = ", ".join(filter(None, table.header)) or "none"
        raise ManifestError(
            f"{path}: no column {' and '.join(missing)}; found {found}. "
            "In Fiji choose Analyze > Set Measurements > Fit ellipse, and measure again"
        )
    table.require_headers(ManifestError)
    names = [name for name in ("Major", "Minor", "Area", "Angle") if name in table.header]
    numbers = zip(*table.texts([table.header.index(name) for name in names]), strict=True)
    rows = [
        (
            f"{path.name}, {table.line(line)}",
            {
                **dict(zip(table.header, map(str.strip, cells), strict=False)),
                **dict(zip(names, found, strict=True)),
            },
        )
        for (line, cells), found in zip(table.rows, numbers, strict=True)
    ]
    if [row.get("Label") for _, row in rows[-4:]] == _SUMMARY:
        rows = rows[:-4]
    if not rows:
        raise ManifestError(f"{path}: holds no rows below its first line; measure something first")
    return [_ellipse(row, place, number) for number, (place, row) in enumerate(rows, start=1)]


def _ellipse(row: Mapping[str, str], place: str, number: int) -> MeasuredEllipse:
    major, minor = _number(row, "Major", place), _number(row, "Minor", place)
    if not major >= minor > 0:
        raise ManifestError(
            f"{place}: Major {major:g} and Minor {minor:g} are no full axes of an ellipse; "
            "a line or a point has none: remove the row"
        )
    doubts = []
    if row.get("Area"):
        ratio = _number(row, "Area", place) / (math.pi * major * minor / 4)
        if abs(ratio - 4) < 4 * _SAME_AREA:
            raise ManifestError(
                f"{place}: Area is π times Major times Minor, so these are semi-axes; "
                "Fiji writes full axes: double them, or write observations with semi_major_mm yourself"
            )
        if abs(ratio - 1) > _SAME_AREA:
            doubts.append(f"Area is {ratio:.2f} of the ellipse's; were holes or a threshold measured?")
    angle = _number(row, "Angle", place) if row.get("Angle") else None
    return MeasuredEllipse(
        label=row.get("Label") or f"contact_{number}",
        place=place,
        semi_major=major / 2,
        semi_minor=minor / 2,
        orientation_deg=None if angle is None else upward_deg(angle),
        doubts=tuple(doubts),
    )


def _number(row: Mapping[str, str], column: str, place: str) -> float:
    try:
        value = float(row[column])
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ManifestError(f"{place}: column {column}: expected a number, found {row[column][:40]!r}")
    return value
