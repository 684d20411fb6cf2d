"""How tests write a small study: a finger of known semi-axes, and what was measured of it."""

import json
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fingerpad.loading import LoadingCurve
from fingerpad.study.pipeline import run_study
from fingerpad.study.results.study_result import StudyResult

PAD = {"palmar": 7.9, "distal": 13.8, "radial_ulnar": 11.8}


class Table(NamedTuple):
    """One entry of a list in study.toml."""

    kind: str
    keys: dict[str, Any]


def finger(name: str = "f", *, std: float = 0.1, **keys: Any) -> Table:
    """Return a finger whose semi-axes are given; with photographs, these give them."""
    axes = {"semi_axes_mm": PAD, "semi_axes_mm_std": dict.fromkeys(PAD, std)}
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
    named = {key: value for key, value in top.items() if isinstance(value, dict)}
    for header, keys in [*named.items(), *((f"[{table.kind}]", table.keys) for table in tables)]:
        lines += [f"[{header}]", *(f"{key} = {_toml(value)}" for key, value in keys.items())]
    (folder / "study.toml").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return folder / "study.toml"


def run(folder: Path, *tables: Table, **top: Any) -> StudyResult:
    """Write a study, run it into its folder ``out``, and return the result."""
    return run_study(write_study(folder, *tables, **top), folder / "out")


def _place(finger: str, wedge: float, **keys: Any) -> dict[str, Any]:
    name = {"name": keys.pop("name")} if "name" in keys else {}
    return {**name, "finger": finger, "wedge_angle_deg": wedge, **keys}


def _toml(value: object) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_toml(one)}" for key, one in value.items()) + " }"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_toml, value)) + "]"
    if isinstance(value, float):
        value = float(value)  # not NumPy's
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str | bool) else repr(value)


def write_curve(path: Path, made: LoadingCurve) -> None:
    """Write a loading curve as instruments export it."""
    columns = [made.time, made.load, made.indentation, *([] if made.area is None else [made.area])]
    header = "time_s,force_N,displacement_mm" + ("" if made.area is None else ",area_mm2")
    np.savetxt(path, np.stack(columns, axis=-1), delimiter=",", header=header, comments="")
