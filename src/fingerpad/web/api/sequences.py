"""Sequences: their frames with what the last run measured on them, and the force beside it."""

from functools import partial
from typing import Annotated, Any, Final, TypeAlias

import numpy as np
from pydantic import Field

from fingerpad._arrays import FloatArray
from fingerpad._columns import columns_in_toml, columns_named_by
from fingerpad.exceptions import FingerpadError
from fingerpad.figures.loading import extremes
from fingerpad.image import ForceSignal, alignment_scatter, phase_intervals, read_force_signal
from fingerpad.study.corrections.apply import InterpolatedCorrection, frame_corrections
from fingerpad.study.corrections.changes import PhaseStart
from fingerpad.study.engine.task import in_study
from fingerpad.study.manifest.models import ContactSequence
from fingerpad.study.results.table import COLUMNS, Row, records
from fingerpad.web.answers import Answer, RequestError, Review, review_of
from fingerpad.web.api.base import Opened, router
from fingerpad.web.study_session import StudySession

_SHIFTS: Final = 81
# Frames are displaced by up to this share of the time that they cover.
_FARTHEST: Final = 0.2
_Name: TypeAlias = Annotated[str, Field(max_length=100)]


class FrameEntry(Review):
    """A frame of a sequence."""

    item: str
    frame: int
    status: str
    flags: list[str]
    phase: str | None
    phase_corrected_by: str | None
    time_s: float | None
    load_N: float | None  # noqa: N815
    measured_indentation_mm: float | None
    gross_area_mm2: float | None
    aspect_ratio: float | None
    interpolated: bool


_FRAME_COLUMNS: Final = tuple(name for name in COLUMNS if name in FrameEntry.model_fields)


class Frames(Answer):
    """Some frames of a sequence, and how many there are."""

    total: int
    frames: list[FrameEntry]


class SequenceSignal(Answer):
    """Force of a sequence over time, thinned for drawing, and how well displaced frames agree with it.

    `time_s` and `load_N` are the extremes in some thousand steps of time. `phases` are those found from the
    force; what a person set is the correction of ``SEQUENCE#phases``. `start_s` is the time of frame 0 on the
    force's clock, None where each frame has a time of its own or no run has measured them. `area_scatter` is
    the relative scatter of the areas of the last run about a power law of the load, with all frames later by
    `shift_s`.
    """

    time_s: list[float]
    load_N: list[float]  # noqa: N815
    phases: list[PhaseStart]
    start_s: float | None
    shift_s: list[float]
    area_scatter: list[float | None]


@router.get("/frames")
def frames(
    opened: Opened,
    sequence: _Name,
    offset: Annotated[int, Field(ge=0, le=10**9)] = 0,
    limit: Annotated[int, Field(ge=1, le=5000)] = 2000,
) -> Frames:
    """Return frames of a sequence, with the results of the last run."""
    table = opened.read().table("sequence", sequence)
    file = table.stated.get("file") if table else None
    if not isinstance(file, str):
        raise RequestError.not_there(f"no sequence is named {sequence!r}")
    total = opened.count_frames(file) or 0
    rows = _rows(opened, sequence)
    shown = range(min(offset, total), min(offset + limit, total))
    active = frame_corrections(opened.corrections.active_corrections(), sequence, shown)

    def entry(number: int) -> FrameEntry:
        row, correction = rows.get(number, {}), active.get(number)
        return FrameEntry.of(
            row,
            **review_of(correction),
            item=f"{sequence}#{number}",
            frame=number,
            status=row.get("status", "none"),
            flags=(row.get("flags") or "").split(),
            interpolated=correction is not None and isinstance(correction.change, InterpolatedCorrection),
        )

    return Frames(total=total, frames=[entry(number) for number in shown])


def _rows(opened: StudySession, sequence: str) -> dict[int, Row]:
    """Return what the last run measured on the frames of a sequence, by their numbers."""
    if (found := opened.results()) is None:
        return {}
    of_it = found.table[(found.table["sequence"] == sequence) & found.table["frame"].notna()]
    return {row["frame"]: row for row in records(of_it, *_FRAME_COLUMNS)}


@router.get("/signal")
def signal(opened: Opened, sequence: _Name) -> SequenceSignal:
    """Return the force of a sequence over time, and how well its frames agree with it."""
    stated = opened.sequence(sequence)
    if not stated.force:
        raise RequestError.impossible("state the force of the sequence")
    columns = {str(name): column for name, column in stated.force_columns.items()}
    try:
        with columns_named_by(partial(columns_in_toml, "force_columns")):
            force = read_force_signal(opened.folder / stated.force, columns)
    except FingerpadError as error:
        raise RequestError.impossible(in_study(error, opened.folder)) from error
    timed = {frame: row for frame, row in _rows(opened, sequence).items() if row["time_s"] is not None}
    drawn, phases = extremes(force.load), phase_intervals(force.time, force.load)
    return SequenceSignal.of(
        time_s=force.time[drawn],
        load_N=force.load[drawn],
        phases=[{"phase": one, "start_s": at} for one, at in zip(phases.phase, phases.start, strict=True)],
        **_alignment(stated, force, timed),
    )


def _alignment(sequence: ContactSequence, force: ForceSignal, timed: dict[int, Row]) -> dict[str, Any]:
    """Return the time of frame 0, and the scatter of areas by how much later the frames would be."""
    if sequence.times is not None or len(timed) < 2:
        return {"start_s": None, "shift_s": [], "area_scatter": []}
    time: FloatArray = np.array([row["time_s"] for row in timed.values()])
    area: FloatArray = np.array([row["gross_area_mm2"] or np.nan for row in timed.values()])
    step, start = np.polyfit(list(timed), time, 1)
    shift = np.linspace(-_FARTHEST, _FARTHEST, _SHIFTS) * max(float(np.ptp(time)), step)
    scatter = alignment_scatter(time, area, force, shift)
    return {"start_s": start, "shift_s": shift, "area_scatter": scatter}
