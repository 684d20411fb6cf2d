"""The force of a sequence, beside what the last run measured on its frames."""

from functools import partial
from itertools import pairwise
from typing import Annotated, Any, Final

import numpy as np
from pydantic import Field

from fingerpad._arrays import FloatArray
from fingerpad._columns import columns_in_toml, columns_named_by
from fingerpad.exceptions import FingerpadError
from fingerpad.image import ForceSignal, alignment_scatter, phase_intervals, read_force_signal
from fingerpad.study.corrections.changes import PhaseStart
from fingerpad.study.engine.task import in_study
from fingerpad.study.manifest.models import ContactSequence
from fingerpad.web.answers import Answer
from fingerpad.web.api.base import Opened, Params, Query, router
from fingerpad.web.errors import RequestError
from fingerpad.web.last_results import frame_rows, last_results

_STEPS: Final = 1000
_SHIFTS: Final = 81
# Frames are displaced by up to this share of the time that they cover.
_FARTHEST: Final = 0.2


class SequenceSignal(Answer):
    """Force of a sequence over time, thinned for drawing, and how well displaced frames agree with it.

    `phases` are those found from the force; what a person set is the correction of ``SEQUENCE#phases``.

    `time_s` and `load_N` are the extremes in some thousand steps of time. `area_scatter` is the relative
    scatter of the areas of the last run about a power law of the load, with all frames later by `shift_s`.
    `start_s` is the time of frame 0 on the force's clock, None where each frame has a time of its own or no
    run has measured them.
    """

    time_s: list[float]
    load_N: list[float]  # noqa: N815
    phases: list[PhaseStart]
    start_s: float | None
    shift_s: list[float]
    area_scatter: list[float | None]


class SignalParams(Params):
    """A sequence."""

    sequence: Annotated[str, Field(max_length=100)]


@router.get("/signal")
def signal(opened: Opened, params: Query[SignalParams]) -> SequenceSignal:
    """Return the force of a sequence over time, and how well its frames agree with it."""
    sequence = opened.sequence(params.sequence)
    if not sequence.force:
        raise RequestError.impossible("state the force of the sequence")
    columns = {str(name): column for name, column in sequence.force_columns.items()}
    try:
        with columns_named_by(partial(columns_in_toml, "force_columns")):
            force = read_force_signal(opened.folder / sequence.force, columns)
    except FingerpadError as error:
        raise RequestError.impossible(in_study(error, opened.folder)) from error
    found = last_results(opened)
    rows = frame_rows(found.table, sequence.name, "time_s", "gross_area_mm2") if found else {}
    timed = {frame: row for frame, row in rows.items() if row["time_s"] is not None}
    drawn, phases = _extremes(force), phase_intervals(force.time, force.load)
    return SequenceSignal.of(
        time_s=force.time[drawn],
        load_N=force.load[drawn],
        phases=[
            {"phase": phase, "start_s": start}
            for phase, start in zip(phases.phase, phases.start, strict=True)
        ],
        **_alignment(sequence, force, timed),
    )


def _extremes(force: ForceSignal) -> Any:
    """Return the samples of least and greatest load in each of many steps of time."""
    if force.load.size <= 2 * _STEPS:
        return np.arange(force.load.size)
    ends = np.linspace(0, force.load.size, _STEPS + 1).astype(int)
    steps = [(start, force.load[start:stop]) for start, stop in pairwise(ends)]
    return np.unique([start + end(loads) for start, loads in steps for end in (np.argmin, np.argmax)])


def _alignment(
    sequence: ContactSequence, force: ForceSignal, timed: dict[int, dict[str, Any]]
) -> dict[str, Any]:
    """Return the time of frame 0, and the scatter of areas by how much later the frames would be."""
    if sequence.times is not None or len(timed) < 2:
        return {"start_s": None, "shift_s": [], "area_scatter": []}
    time: FloatArray = np.array([row["time_s"] for row in timed.values()])
    area: FloatArray = np.array([row["gross_area_mm2"] or np.nan for row in timed.values()])
    step, start = np.polyfit(list(timed), time, 1)
    shift = np.linspace(-_FARTHEST, _FARTHEST, _SHIFTS) * max(float(np.ptp(time)), step)
    scatter = alignment_scatter(time, area, force, shift)
    return {"start_s": start, "shift_s": shift, "area_scatter": scatter}
