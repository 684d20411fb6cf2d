"""The results of the last run, validated on reading, as they may be imported or damaged."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Final, Self, TypeAlias

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from fingerpad.study.manifest.tables import Length
from fingerpad.study.measuring.fingers import FingerResult, finger_result
from fingerpad.study.results.columns import BOOL_COLUMNS, COLUMNS, INT_COLUMNS, TEXT_COLUMNS
from fingerpad.study.results.result_set import quick_faults
from fingerpad.web.study_session import StudySession

_Triple: TypeAlias = Annotated[list[float], Field(min_length=3, max_length=3)]


class _Record(BaseModel):
    """A record of ``summary.json``; keys that the page does not need are not checked."""

    model_config = ConfigDict(extra="allow", strict=True)


class _Finger(_Record):
    finger: str
    synthetic: bool
    palmar_mm: Length | None
    distal_mm: Length | None
    radial_ulnar_mm: Length | None
    covariance_mm2: Annotated[list[_Triple], Field(min_length=3, max_length=3)] | None

    @model_validator(mode="after")
    def _whole(self) -> Self:
        axes = (self.palmar_mm, self.distal_mm, self.radial_ulnar_mm)
        known = self.covariance_mm2 is not None and None not in axes
        if not known and any(axis is not None for axis in axes):
            raise ValueError("semi-axes and covariance_mm2 belong together")
        if self.covariance_mm2 and not all(self.covariance_mm2[k][k] >= 0 for k in range(3)):
            raise ValueError("covariance_mm2 must not be negative on its diagonal")
        return self


class _Check(_Record):
    observation: str
    value: float
    std: float
    valid: bool
    shares: dict[str, float | None]
    total: dict[str, float | None]


class _Placement(_Record):
    finger: str
    wedge_angle_deg: float
    roll_angle_deg: float
    synthetic: bool
    radius_from_indentation_mm: float | None
    radius_from_indentation_mm_std: float | None = None
    radius_from_indentation_variance_shares: dict[str, float | None] | None = None
    mean_curvature_radius_mm: float | None
    mean_curvature_radius_mm_std: float | None
    loading_radius_mm: float | None
    loading_radius_mm_std: float | None
    uncertainty_check: _Check | None


class _Curve(_Record):
    file: str | None
    finger: str
    wedge_angle_deg: float
    reason: str | None


class _Provenance(_Record):
    made: str
    inputs_sha256: dict[str, str]


class _Summary(_Record):
    fingers: list[_Finger]
    summaries: list[_Placement]
    curves: list[_Curve]
    provenance: _Provenance


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Results:
    """The tables of the last run.

    Attributes
    ----------
    rows : list of dict
        Of ``results.json``.
    summary : dict
        Of ``summary.json``.
    finished : str
        When they were made.
    contacts : dict
        Rows of single contacts by their names.
    frames : dict
        Rows of frames by the name of the sequence and the frame's number.
    """

    rows: list[dict[str, Any]]
    summary: dict[str, Any]
    finished: str
    contacts: dict[str, dict[str, Any]]
    frames: dict[str, dict[int, dict[str, Any]]]

    @classmethod
    def of(cls, rows: Any, summary: Any) -> Self:
        """Validate the tables, and index their rows.

        Raises
        ------
        ValueError
            If they are not as a run writes them; the message names the file.
        """
        _require_rows(rows)
        try:
            _Summary.model_validate(summary)
        except ValidationError as error:
            fault = error.errors(include_url=False)[0]
            place = ".".join(map(str, fault["loc"])) or "the document"
            raise ValueError(f"summary.json: {place}: {fault['msg']}") from error
        contacts: dict[str, dict[str, Any]] = {}
        frames: dict[str, dict[int, dict[str, Any]]] = {}
        for row in rows:
            row["item"] = row["observation"]
            if row["frame"] is None:
                contacts[row["item"]] = row
            else:
                frames.setdefault(row["sequence"], {})[row["frame"]] = row
        finished = summary["provenance"]["made"]
        return cls(rows=rows, summary=summary, finished=finished, contacts=contacts, frames=frames)

    def row(self, item: str) -> dict[str, Any] | None:
        """Return the row of an item, None where it has none."""
        sequence, mark, number = item.rpartition("#")
        if not mark:
            return self.contacts.get(item)
        return self.frames.get(sequence, {}).get(int(number)) if number.isdecimal() else None


_NEVER_EMPTY: Final = frozenset(("observation", "finger", "status", "flags"))


def _require_rows(rows: Any) -> None:
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
        raise ValueError("results.json: expected a list of rows")
    for name in COLUMNS:
        kinds: set[type] = {str} if name in TEXT_COLUMNS else {bool} if name in BOOL_COLUMNS else {int}
        kinds |= set() if name in TEXT_COLUMNS | BOOL_COLUMNS | INT_COLUMNS else {float}
        kinds |= set() if name in _NEVER_EMPTY | BOOL_COLUMNS else {type(None)}
        if any(name not in row for row in rows):
            raise ValueError(f"results.json: a row lacks {name}")
        if odd := {type(row[name]) for row in rows} - kinds:
            raise ValueError(f"results.json: {name} is of type {odd.pop().__name__} in a row")


_READ: dict[Path, tuple[object, Results | str]] = {}


def last_results(opened: StudySession) -> Results | None:
    """Return the tables of the last run, None if there are none or they are damaged."""
    found = _read(opened.out)
    return found if isinstance(found, Results) and not results_faults(opened) else None


def results_faults(opened: StudySession) -> list[str]:
    """Return what is wrong with the files of the last run, except overlays."""
    faults = quick_faults(opened.out, lambda name: not name.startswith("overlays/"))
    found = _read(opened.out)
    return faults or ([found] if isinstance(found, str) else [])


def _read(out: Path) -> Results | str | None:
    """Return the tables in a folder, or what is wrong with them; read again if they have changed."""
    paths = [out / f"{name}.json" for name in ("results", "summary")]
    try:
        stamp = [(status.st_mtime_ns, status.st_size) for status in (path.stat() for path in paths)]
        known = _READ.get(out)
        if known is None or known[0] != stamp:
            rows, summary = (json.loads(path.read_text(encoding="utf-8")) for path in paths)
            known = (stamp, Results.of(rows, summary))
    except OSError:
        return None
    except (ValueError, RecursionError) as error:
        known = (stamp, f"the results are not such as a run writes ({error})")
    _READ.clear()
    _READ[out] = known
    return known[1]


def known_finger(opened: StudySession, name: str) -> FingerResult | None:
    """Return a finger's semi-axes, entered or of the last run; None where they are unknown."""
    finger = next((one for one in opened.study().fingers if one.name == name), None)
    if finger is None:
        return None
    if finger.semi_axes_mm is not None:
        return finger_result(finger, {}, opened.folder, {})  # nothing to measure
    found = last_results(opened)
    record = found and next((one for one in found.summary["fingers"] if one["finger"] == name), None)
    if not record or record["palmar_mm"] is None:
        return None
    return FingerResult(
        name=name,
        semi_axes=np.array([record[f"{axis}_mm"] for axis in ("palmar", "distal", "radial_ulnar")]),
        covariance=np.array(record["covariance_mm2"]),
        source="photographs",
        scale=record.get("scale"),
        pad_thickness=finger.pad_thickness_mm,
        synthetic=record["synthetic"],
    )
