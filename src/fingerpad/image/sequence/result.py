"""Results of one frame of a sequence, and a summary of all."""

import math
from array import array
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fingerpad._display import Displayed
from fingerpad._words import joined
from fingerpad.image.sequence.doubts import LoadedFrames, doubts_of
from fingerpad.image.sequence.force import ForceSignal, FrameClock, FrameRate
from fingerpad.image.sequence.frames import Frames
from fingerpad.image.sequence.phases import Phase


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class FrameResult(Displayed):
    """Measurement of one frame of a sequence.

    Attributes
    ----------
    index : int
        Its number, from zero.
    time : float
        When it was taken, s, on the clock of the force signal; NaN where that is not known.
    load : float
        Normal force W, N, less its zero before contact, NaN where there is none.
    phase : {"before", "loading", "hold", "unloading", "after"} or None
        Phase of the press; None outside the force signal.
    measures : mapping or None
        `ContactImageResult.as_record`; None where nothing was measured.
    readable : bool
        Whether the frame could be decoded: a readable frame without measures shows no contact.
    reason : str or None
        Why nothing was measured.
    is_first_contact : bool
        Whether this is the first frame of a contact that persists.
    flags : tuple of str
        Doubts: those of the contact image, ``no_force`` outside the force signal, ``no_time`` without a time,
        ``repeated_frame`` where the picture is the same as before, and the force is not.

    Examples
    --------
    >>> record = FrameResult(index=3, time=0.3, load=0.5, measures={"gross_area_mm2": 42.0}).as_record()
    >>> record["gross_area_mm2"]
    42.0
    """

    index: int
    time: float = math.nan
    load: float = math.nan
    phase: Phase | None = None
    measures: Mapping[str, Any] | None = None
    readable: bool = True
    reason: str | None = None
    is_first_contact: bool = False
    flags: tuple[str, ...] = ()

    def as_record(self) -> dict[str, Any]:
        """Return the frame as a row of a table.

        Returns
        -------
        dict
            By names with units; ``error`` where nothing was measured.
        """
        place = {"frame": self.index, "time_s": self.time, "load_N": self.load, "phase": self.phase}
        if self.measures is None:
            return place | {"error": self.reason, "flags": self.flags}
        return {**place, **self.measures, "flags": self.flags}


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class SequenceSummary(Displayed):
    """Counts over the frames of a sequence.

    Attributes
    ----------
    count, measured, without_contact, failed : int
        Frames in all, with a contact, readable without one, and not readable.
    first_contact : int or None
        First frame of the contact that persists.
    largest : int or None
        Frame of the largest gross area.
    phases : dict of str to int
        Number of frames in each phase.
    notes : tuple of str
        Remarks for the reader.
    flags : tuple of str
        Doubts about all frames: ``out_of_step`` where area and force do not go together.
    """

    count: int
    measured: int
    without_contact: int
    failed: int
    first_contact: int | None
    largest: int | None
    phases: dict[str, int]
    notes: tuple[str, ...]
    flags: tuple[str, ...] = ()


def sequence_summary(
    results: Iterable[FrameResult],
    force: ForceSignal | None = None,
    *,
    frames: Frames | None = None,
    clock: FrameClock | None = None,
) -> SequenceSummary:
    """Count frames by outcome and phase in one pass over the results.

    Parameters
    ----------
    results : iterable of FrameResult
        As `measure_sequence` yields them.
    force : ForceSignal, optional
        The signal they were measured against, for notes on frames outside it.
    frames, clock : Frames and FrameClock, optional
        What was measured and by which clock, for a note on frames that a folder skips.

    Returns
    -------
    SequenceSummary

    Examples
    --------
    >>> results = [
    ...     FrameResult(index=0, reason="no contact"),
    ...     FrameResult(index=1, measures={"gross_area_mm2": 42.0}, is_first_contact=True),
    ... ]
    >>> summary = sequence_summary(results)
    >>> summary.measured, summary.without_contact, summary.largest
    (1, 1, 1)
    """
    counts, phases = Counter[str](), Counter[str]()
    first_contact, largest, largest_area = None, None, 0.0
    start, end, reason = math.inf, -math.inf, None
    repeated: list[str] = []
    loaded = array("d")  # the rows of LoadedFrames
    for result in results:
        counts["all"] += 1
        counts["measured"] += result.measures is not None
        counts["failed"] += not result.readable
        counts["no_force"] += "no_force" in result.flags
        phases[result.phase or "none"] += 1
        if result.is_first_contact:
            first_contact = result.index
        area = 0.0 if result.measures is None else result.measures["gross_area_mm2"]
        if area > largest_area:
            largest, largest_area = result.index, area
        if "repeated_frame" in result.flags:
            repeated.append(str(result.index))
        elif result.readable and math.isfinite(result.load):
            direction = (result.phase == "loading") - (result.phase == "unloading")
            loaded.extend((result.index, result.time, result.load, area, direction))
        if not result.readable and reason is None:
            reason = f"frame {result.index}: {result.reason}"
        if math.isfinite(result.time):
            start, end = min(start, result.time), max(end, result.time)
    notes = []
    if frames is not None:
        skipped = frames.skipped if isinstance(clock, FrameRate) else None
        notes += [note for note in (frames.odd_names, skipped) if note]
    under_load = LoadedFrames(*np.reshape(loaded, (-1, 5)).T)
    doubts, in_step = doubts_of(under_load, counts, (start, end), first_contact, clock=clock, force=force)
    notes += doubts
    if repeated:
        notes.append(
            f"frames {joined(repeated, 6)} are the same picture as one before, while the force changes, and "
            "are not pooled: did the camera stand still?"
        )
    if counts["failed"]:
        notes.append(f"{counts['failed']} of {counts['all']} frames could not be read; first {reason}")
    return SequenceSummary(
        count=counts["all"],
        measured=counts["measured"],
        without_contact=counts["all"] - counts["measured"] - counts["failed"],
        failed=counts["failed"],
        first_contact=first_contact,
        largest=largest,
        phases=dict(phases),
        notes=tuple(notes),
        flags=() if in_step else ("out_of_step",),
    )
