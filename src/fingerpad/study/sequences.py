"""Measuring a film of one press: each frame in contact becomes a row."""

import math
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final, NamedTuple

from fingerpad._files import make_folder
from fingerpad.exceptions import FingerpadError, LoadingError
from fingerpad.image import (
    ForceSignal,
    FrameClock,
    FrameResult,
    Frames,
    Imprint,
    SequenceSummary,
    frame_clock,
    measure_sequence,
    open_frames,
    read_force_signal,
    read_frame_stamps,
    sequence_summary,
    write_overlay,
)
from fingerpad.study.corrected import place_of
from fingerpad.study.manifest import ContactSequence
from fingerpad.study.measure import ODDITIES, Measurement, from_imprint
from fingerpad.study.scales import FoundScale, find_scale
from fingerpad.study.words import in_study

IN_CONTACT: Final = frozenset(("loading", "hold", "unloading"))
# Below so many ridges from the centre to the nearest edge an ellipse is drawn by single ridges.
LEAST_RIDGES: Final = 5
# `measure_sequence` holds results back until a contact has persisted for so many frames.
_HELD: Final = 3


class FrameOverlay(NamedTuple):
    """A frame drawn with its measurement.

    Attributes
    ----------
    role : str
        Why it was chosen: ``first contact``, ``largest load`` or ``last contact``.
    frame : int
        Its number.
    file : str
        The picture, relative to the output folder.
    """

    role: str
    frame: int
    file: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SequenceResult:
    """What a film comes to.

    Attributes
    ----------
    manifest : ContactSequence
        What the manifest says of it.
    summary : SequenceSummary or None
        Counts of frames; None where the film could not be measured.
    overlays : tuple of FrameOverlay
        A few frames.
    reason : str or None
        Why it could not be measured.
    """

    manifest: ContactSequence
    summary: SequenceSummary | None = None
    overlays: tuple[FrameOverlay, ...] = ()
    reason: str | None = None


def measure_contact_sequence(
    sequence: ContactSequence,
    scales: Mapping[str, FoundScale | str],
    folder: Path,
    out: Path,
    on_frame: Callable[[], None] = lambda: None,
) -> tuple[SequenceResult, list[Measurement]]:
    """Measure a film frame by frame; whatever goes wrong costs this film, or one frame of it, only.

    A frame in contact, by the force, gives a measurement; one that cannot be decoded gives its reason; one
    without a contact to be seen, or beyond the force, gives none and is counted.

    Parameters
    ----------
    sequence : ContactSequence
        A film of the manifest.
    scales : mapping
        The study's named scales.
    folder, out : Path
        The study folder, and the folder of results.
    on_frame : callable
        Called after each frame.
    """
    try:
        film = _Film.open(sequence, scales, folder, out)
        summary = sequence_summary(film.followed(on_frame), film.force)
        notes = tuple(in_study(note, folder) for note in summary.notes)
        overlays = film.write_overlays()
    except FingerpadError as error:
        reason = in_study(error, folder)
    except ODDITIES as error:
        reason = f"{sequence.path}: cannot be measured ({type(error).__name__}: {error})"
    else:
        summary = replace(summary, notes=notes)
        return SequenceResult(manifest=sequence, summary=summary, overlays=overlays), film.measurements
    return SequenceResult(manifest=sequence, reason=reason), [
        Measurement(name=sequence.name, load=math.nan, reason=reason, columns={"sequence": sequence.name})
    ]


class _Seen(NamedTuple):
    """A measured frame, while it may still be drawn."""

    frame: int
    pixels: Any
    imprint: Imprint


@dataclass(slots=True, kw_only=True, eq=False)
class _Film:
    """A film on its way through the measurement: rows are kept, of the pictures only a handful."""

    sequence: ContactSequence
    found: FoundScale
    frames: Frames
    force: ForceSignal
    clock: FrameClock
    folder: Path
    out: Path
    measurements: list[Measurement] = field(default_factory=list)
    _latest: deque[_Seen] = field(default_factory=lambda: deque(maxlen=_HELD))
    _waiting: dict[int, dict[str, Any]] = field(default_factory=dict)
    _drawn: dict[str, _Seen] = field(default_factory=dict)
    _largest_load: float = -math.inf

    @classmethod
    def open(
        cls, sequence: ContactSequence, scales: Mapping[str, FoundScale | str], folder: Path, out: Path
    ) -> "_Film":
        assert sequence.scale is not None  # the manifest's own rule
        found = find_scale(sequence.scale, scales, folder)
        if found.name is None:
            # No name holds a colon: the frames of a film share its scale, and nothing else does.
            found = replace(found, name=f"sequence:{sequence.name}")
        frames = open_frames(folder / sequence.path)
        columns = {str(key): value for key, value in sequence.force_columns.items()}
        force = read_force_signal(folder / sequence.force, columns)
        clock = _clock(sequence, frames, force, folder)
        return cls(
            sequence=sequence, found=found, frames=frames, force=force, clock=clock, folder=folder, out=out
        )

    def followed(self, on_frame: Callable[[], None]) -> Iterator[FrameResult]:
        """Measure each frame, keep its row and hand its result on."""
        for result in measure_sequence(
            self.frames,
            self.found.scale,
            clock=self.clock,
            force=self.force,
            dark_on_light=self.sequence.dark_on_light,
            threshold=self.sequence.threshold,
            watch=self._watch,
            **place_of(self.sequence, self.folder),
        ):
            self._keep(result)
            on_frame()
            yield result

    def _watch(self, index: int, pixels: Any, imprint: Imprint) -> None:
        self._latest.append(_Seen(index, pixels, imprint))
        self._waiting[index] = from_imprint(imprint, self.sequence, self.found)

    def _keep(self, result: FrameResult) -> None:
        measured = self._waiting.pop(result.index, None)
        place = {
            "sequence": self.sequence.name,
            "frame": result.index,
            "time_s": result.time,
            "phase": result.phase,
        }
        name = f"{self.sequence.name}#{result.index}"
        if not result.readable:
            reason = in_study(result.reason, self.folder)
            self.measurements.append(
                Measurement(name=name, load=result.load, reason=reason, columns=place, counts=False)
            )
        elif measured is not None and result.phase in IN_CONTACT:
            measured["columns"] |= place
            measured["flags"] = (*result.flags, *self.found.flags)
            self.measurements.append(
                Measurement(name=name, load=result.load, counts=self._counts(result, measured), **measured)
            )
            self._choose(result)

    def _counts(self, result: FrameResult, measured: Mapping[str, Any]) -> bool:
        """Tell whether a frame may be pooled: loading, and its ellipse more than a few ridges."""
        if result.phase != "loading":
            return False
        if self.sequence.pool_from_N is not None:
            return result.load >= self.sequence.pool_from_N
        return bool(measured["semi_minor"] >= LEAST_RIDGES * measured["columns"]["ridge_period_mm"])

    def _choose(self, result: FrameResult) -> None:
        """Keep a frame's picture if it is to be drawn, as far as is known now."""
        seen = next((seen for seen in self._latest if seen.frame == result.index), None)
        if seen is None:
            return
        self._drawn.setdefault("first contact", seen)
        self._drawn["last contact"] = seen
        if result.load > self._largest_load:
            self._largest_load = result.load
            self._drawn["largest load"] = seen

    def write_overlays(self) -> tuple[FrameOverlay, ...]:
        """Draw the chosen frames, each once."""
        written: dict[int, FrameOverlay] = {}
        roles = {"first contact": 0, "largest load": 1, "last contact": 2}
        for role, seen in sorted(self._drawn.items(), key=lambda entry: roles[entry[0]]):
            if seen.frame in written:
                continue
            file = Path("overlays") / "sequences" / f"{self.sequence.name}_frame_{seen.frame:06d}.png"
            make_folder((self.out / file).parent)
            label = f"{'synthetic, ' if self.sequence.synthetic else ''}frame {seen.frame}, {role}"
            write_overlay(self.out / file, seen.pixels, seen.imprint, label=label)
            written[seen.frame] = FrameOverlay(role, seen.frame, str(file))
        return tuple(written.values())


def _clock(sequence: ContactSequence, frames: Frames, force: ForceSignal, folder: Path) -> FrameClock:
    """Return the frames' clock on the force's time."""
    if sequence.times is not None:
        return read_frame_stamps(folder / sequence.times)
    rate = sequence.frames_per_second or frames.frames_per_second
    if rate is None:
        raise LoadingError(f"{sequence.path}: pictures state no rate: give frames_per_second, or times")
    return frame_clock(rate, force, start_time=sequence.start_s, contact_load=sequence.contact_load_N)
