"""The results of the last run, validated on reading, as they may be imported or damaged."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Final, Self, TypeAlias

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from fingerpad.exceptions import FingerpadError
from fingerpad.study.manifest.models import Length
from fingerpad.study.measuring.fingers import FingerResult, finger_result, stated
from fingerpad.study.results.result_set import (
    RERUN,
    quick_faults,
    result_files,
    result_set_faults,
    result_set_stamp,
)
from fingerpad.study.results.results_reader import read_summary, read_table
from fingerpad.study.results.rows import PLACEMENT, PlacementKey
from fingerpad.study.results.table import ResultsTable, Row
from fingerpad.web.answers.results import BudgetCheck, ModelCheck, ModelHeadline
from fingerpad.web.errors import RequestError
from fingerpad.web.pictures import Cache
from fingerpad.web.study_session import StudySession

_Triple: TypeAlias = Annotated[list[float | None], Field(min_length=3, max_length=3)]
FRAME_COLUMNS: Final = (
    *("phase", "phase_corrected_by", "time_s", "load_N"),
    *("measured_indentation_mm", "gross_area_mm2", "aspect_ratio"),
)


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
        entries = [entry for row in self.covariance_mm2 or [[None]] for entry in row]
        known = None not in axes and None not in entries
        if not known and any(axis is not None for axis in axes):
            raise ValueError("semi-axes and covariance_mm2 belong together")
        if any(entry is not None and entry < 0 for entry in entries[::4]):  # the diagonal
            raise ValueError("covariance_mm2 must not be negative on its diagonal")
        return self


class _Check(BudgetCheck, _Record):
    pass


class _ModelHeadline(ModelHeadline, _Record):
    model_relative_std: float | None


class _ModelCheck(ModelCheck, _Record):
    pass


class _Validity(_Record):
    verdict: str
    headlines: dict[str, _ModelHeadline]
    checks: list[_ModelCheck]


class _Placement(_Record):
    finger: str
    wedge_angle_deg: float
    roll_angle_deg: float
    synthetic: bool
    radius_from_indentation_mm: float | None
    radius_from_indentation_variance_shares: dict[str, float | None] | None = None
    mean_curvature_radius_mm: float | None
    mean_curvature_radius_mm_std: float | None
    loading_radius_mm: float | None
    loading_radius_mm_std: float | None
    uncertainty_check: _Check | None
    validity: _Validity


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
    table : ResultsTable
        The rows of ``results.csv``.
    summary : dict
        Of ``summary.json``.
    """

    table: ResultsTable
    summary: dict[str, Any]

    @classmethod
    def read(cls, out: Path) -> Self:
        """Read and check the tables of a run's output folder.

        Raises
        ------
        FingerpadError
            If there is none, or a table is not as a run writes it.
        """
        summary = read_summary(out)
        try:
            _Summary.model_validate(summary)
        except ValidationError as error:
            fault = error.errors(include_url=False)[0]
            place = ".".join(map(str, fault["loc"])) or "the whole"
            raise FingerpadError(f"summary.json: {place}: {fault['msg']}") from error
        return cls(table=read_table(out), summary=summary)

    @property
    def finished(self) -> str:
        """When they were made."""
        return str(self.summary["provenance"]["made"])

    def contacts(self) -> dict[str, Row]:
        """Return flags and reason of single contacts by their names."""
        contacts = self.table.at(~self.table.known("frame"))
        return {row["observation"]: row for row in contacts.records("observation", "flags", "reason")}

    def frames(self, sequence: str) -> dict[int, Row]:
        """Return what the page lists of a sequence's frames, by their numbers."""
        frames = self.table.at((self.table.column("sequence") == sequence) & self.table.known("frame"))
        columns = ("frame", "status", "flags", "pooled", *FRAME_COLUMNS)
        return {row["frame"]: row for row in frames.records(*columns)}

    def finger(self, name: str) -> dict[str, Any] | None:
        """Return the record of a finger, None where it has none."""
        return next((one for one in self.summary["fingers"] if one["finger"] == name), None)

    def row(self, item: str) -> Row | None:
        """Return the row of an item, None where it has none."""
        places = np.flatnonzero(self.table.column("observation") == item)
        return self.table[int(places[0])] if places.size else None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Reading:
    """What reading the results of a run gave: tables, or what is wrong."""

    results: Results | None
    faults: tuple[str, ...]


# Results kept, of studies that are open in several windows.
_READ: Final[Cache[_Reading]] = Cache(3, lambda _: 1)


def last_results(opened: StudySession) -> Results | None:
    """Return the tables of the last run, None if there are none or they are damaged."""
    return _reading(opened.out).results


def last_headlines(opened: StudySession, placement: PlacementKey) -> dict[str, dict[str, Any]]:
    """Return results with a verdict of the last run, by column; none where it has no such placement."""
    found = last_results(opened)
    for one in found.summary["summaries"] if found else ():
        if tuple(one[name] for name in PLACEMENT) == placement:
            return dict(one["validity"]["headlines"])
    return {}


def results_faults(opened: StudySession) -> list[str]:
    """Return what was wrong with the files of the last run, except overlays, when its tables were read.

    A file that was changed in place later is named by what reads it, and by ``fingerpad verify``.
    """
    return list(_reading(opened.out).faults)


def _reading(out: Path) -> _Reading:
    """Return the results in a folder, checked and read once for each result set."""
    return _READ.get((out, result_set_stamp(out)), lambda: _read(out))


def _read(out: Path) -> _Reading:
    faults = quick_faults(out, lambda name: not name.startswith("overlays/"))
    if faults or not result_files(out):
        return _Reading(results=None, faults=tuple(faults))
    try:
        return _Reading(results=Results.read(out), faults=())
    except FingerpadError as error:
        return _Reading(results=None, faults=(str(error).removesuffix(f"; {RERUN}"),))


def require_file(opened: StudySession, name: str) -> None:
    """Refuse a file of the results that is not what the last run wrote.

    Raises
    ------
    RequestError
        Naming it.
    """
    faults = result_set_faults(opened.out, is_checked=lambda one: one == name)
    if faults:
        raise RequestError.conflict(f"{'; '.join(faults)}: {RERUN}")


def known_finger(opened: StudySession, name: str) -> FingerResult | None:
    """Return a finger's semi-axes, entered or of the last run; None where they are unknown."""
    finger = next((one for one in opened.study().fingers if one.name == name), None)
    if finger is None:
        return None
    if finger.semi_axes_mm is not None:
        return finger_result(finger, {}, opened.folder, {})  # nothing to measure
    found = last_results(opened)
    record = found.finger(name) if found else None
    if not record or record["palmar_mm"] is None:
        return None
    return FingerResult(
        semi_axes=np.array([record[f"{axis}_mm"] for axis in ("palmar", "distal", "radial_ulnar")]),
        covariance=np.array(record["covariance_mm2"]),
        source="photographs",
        outline_radii=tuple(
            tuple(map(tuple, radii))
            for photograph in record["photographs"]
            if (radii := photograph["outline_radii_deg_mm"])
        ),
        scale=record.get("scale"),
        **(stated(finger) | {"synthetic": record["synthetic"]}),
    )
