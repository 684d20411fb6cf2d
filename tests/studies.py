"""How tests write a small study: a finger of known semi-axes, and what was measured of it."""

import csv
import hashlib
import json
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from fingerpad.loading import LoadingCurve
from fingerpad.report import write_report
from fingerpad.simulate import outline_points
from fingerpad.study.corrections.log import CORRECTIONS_NAME, CorrectionLog
from fingerpad.study.engine.runner import Progress
from fingerpad.study.manifest.load import read_study
from fingerpad.study.manifest.models import Study
from fingerpad.study.pipeline import run_study
from fingerpad.study.results.study_result import StudyResult
from fingerpad.study.results.table import Row, records

OUTLINES = {"palmar": (11.8, 13.8), "distal": (11.8, 7.9), "radial": (7.9, 13.8)}
PAD = {"palmar": 7.9, "distal": 13.8, "radial_ulnar": 11.8}


class Table(NamedTuple):
    """One entry of a list in study.toml."""

    kind: str
    keys: dict[str, Any]


def finger(name: str = "f", *, std: float = 0.1, **keys: Any) -> Table:
    """Return a finger whose semi-axes are given; with photographs, these give them; without, areas alone."""
    axes = {"semi_axes_mm": PAD, "semi_axes_mm_std": dict.fromkeys(PAD, std)} if std else {}
    return Table("fingers", {"name": name, **({} if "photographs" in keys else axes), **keys})


def contact(
    name: str = "x",
    load: float = 2,
    ellipse: tuple[float, float] = (7.4, 5.0),
    *,
    finger: str = "f",
    wedge: float = 30,
    std: float = 0.1,
    axis: str = "along",
    **keys: Any,
) -> Table:
    """Return a contact whose ellipse was measured by hand; with a file, its picture shows it."""
    sizes = {"semi_major": ellipse[0], "semi_minor": ellipse[1], "std": std}
    given = {"ellipse_mm": sizes | ({"long_axis": axis} if axis else {})}
    return Table("observations", {**_place(finger, wedge, name=name, load_N=load), **given, **keys})


def picture(
    name: str, file: str, load: float = 2, *, finger: str = "f", wedge: float = 30, **keys: Any
) -> Table:
    """Return a contact image."""
    return Table("observations", _place(finger, wedge, name=name, load_N=load, file=file, **keys))


def curve(*, finger: str = "f", wedge: float = 30, **keys: Any) -> Table:
    """Return a loading curve, or what is known of one."""
    return Table("curves", _place(finger, wedge, **keys))


def sequence(name: str, file: str, *, finger: str = "f", wedge: float = 30, **keys: Any) -> Table:
    """Return a sequence of contact images."""
    return Table("sequences", _place(finger, wedge, name=name, file=file, **keys))


def write_study(folder: Path, *tables: Table, title: str = "T", **top: Any) -> Path:
    """Write study.toml of tables and of other keys, as ``uncertainty={...}``; return its path."""
    folder.mkdir(parents=True, exist_ok=True)
    plain = {key: value for key, value in top.items() if not isinstance(value, dict)}
    lines = [f"{key} = {_toml(value)}" for key, value in {"title": title, **plain}.items()]
    named = (Table(key, value) for key, value in top.items() if isinstance(value, dict))
    lines += [_toml_table(f"[{table.kind}]", table) for table in named]
    (folder / "study.toml").write_text("\n".join(lines) + "\n", encoding="utf-8")
    append_tables(folder, *tables)
    return folder / "study.toml"


def append_tables(folder: Path, *tables: Table) -> None:
    """Add tables to the end of study.toml."""
    with (folder / "study.toml").open("a", encoding="utf-8") as file:
        file.writelines(_toml_table(f"[[{table.kind}]]", table) + "\n" for table in tables)


def study_of(*tables: Table, title: str = "T", **top: Any) -> Study:
    """Return a study of tables without its files, which need not be there."""
    lists: dict[str, list[dict[str, Any]]] = {}
    for table in tables:
        lists.setdefault(table.kind, []).append(table.keys)
    return Study.model_validate({"title": title, **top, **lists})


def run(folder: Path, *tables: Table, **top: Any) -> StudyResult:
    """Write a study, run it into its folder ``out``, and return the result."""
    return run_study(write_study(folder, *tables, **top), folder / "out")


def run_watched(manifest: Path, out: Path | None = None, **options: Any) -> tuple[StudyResult, list[str]]:
    """Run a study, by default into ``out`` beside its manifest; return the result and what was measured."""
    reported: list[Progress] = []
    out = out or manifest.parent / "out"
    result = run_study(manifest, out, on_progress=reported.append, **options)
    assert reported[0].status == "started"
    assert reported[-1].pictures == reported[-1].total
    return result, [one.item for one in reported if one.item and one.status not in {"checked", "written"}]


def rows_by(result: StudyResult, key: str = "observation") -> dict[Any, Row]:
    """Return the rows of a result by their observation, or by another column."""
    return {row[key]: row for row in records(result.rows)}


def page_of(result: StudyResult, out: Path) -> str:
    """Return the text of the report, written into a folder."""
    return write_report(result, out).read_text(encoding="utf-8")


def _place(finger: str, wedge: float, **keys: Any) -> dict[str, Any]:
    name = {"name": keys.pop("name")} if "name" in keys else {}
    return {**name, "finger": finger, "wedge_angle_deg": wedge, **keys}


def _toml_table(header: str, table: Table) -> str:
    return "\n".join([header, *(f"{key} = {_toml(value)}" for key, value in table.keys.items())])


def _toml(value: object) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_toml(one)}" for key, one in value.items()) + " }"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_toml, value)) + "]"
    if isinstance(value, float):
        value = float(value)  # not NumPy's
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str | bool) else repr(value)


def correct(
    folder: Path, item: str, change: dict[str, Any], *, who: str = "anna", name: str = CORRECTIONS_NAME
) -> None:
    """Append a correction to those of a study."""
    log = CorrectionLog(folder, name)
    study = read_study(folder / "study.toml")
    log.append(item, change, who=who, expected=log.history(item).last_id, study=study)


def rows_of(path: Path) -> list[dict[str, str]]:
    """Return the rows of a CSV that a run wrote, as text."""
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def summary_of(out: Path) -> dict[str, Any]:
    """Return the content of summary.json, as a script reads it."""
    content: dict[str, Any] = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    return content


RESULT_TABLES = ("results.csv", "results.json", "results_columns.csv", "summary.json")


def write_sums(folder: Path) -> Path:
    """List the files of a folder as a run does, by other means; tables that are missing are made, empty."""
    for name in RESULT_TABLES:
        (folder / name).touch()
    files = sorted(path for path in folder.rglob("*") if path.is_file() and path.name != "SHA256SUMS")
    lines = [
        f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.relative_to(folder).as_posix()}\n"
        for path in files
    ]
    (folder / "SHA256SUMS").write_text("".join(lines), encoding="utf-8")
    return folder


def write_numbers(path: Path, header: str, rows: ArrayLike) -> None:
    """Write a CSV of numbers."""
    np.savetxt(path, np.asarray(rows), delimiter=",", header=header, comments="")


def write_outlines(
    folder: Path, axes: dict[str, tuple[float, float]] = OUTLINES, *, decimals: int = 15, **keys: Any
) -> list[dict[str, Any]]:
    """Write the outline of each face, and return what a finger names as photographs."""
    for face, (across, along) in axes.items():
        points = outline_points(across, along).round(decimals)
        write_numbers(folder / f"{face}.csv", "x_mm,y_mm", points)
    return [{"face": face, "outline": f"{face}.csv", **keys} for face in axes]


def write_curve(path: Path, made: LoadingCurve) -> None:
    """Write a loading curve as instruments export it."""
    columns = [made.time, made.load, made.indentation, *([] if made.area is None else [made.area])]
    header = "time_s,force_N,displacement_mm" + ("" if made.area is None else ",area_mm2")
    write_numbers(path, header, np.stack(columns, axis=-1))
