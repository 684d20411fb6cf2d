"""What a sequence comes to."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from fingerpad.image import SequenceSummary
from fingerpad.study.corrections.apply import ManualPhases, manual_phases
from fingerpad.study.corrections.items import ActiveCorrection, frames_of
from fingerpad.study.engine.task import Record
from fingerpad.study.manifest import ContactSequence
from fingerpad.study.measuring.context import RunContext
from fingerpad.study.measuring.sequence_tasks import FrameOverlay


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SequenceResult:
    """What a sequence comes to.

    Attributes
    ----------
    manifest : ContactSequence
        What the manifest says of it.
    summary : SequenceSummary or None
        Counts of frames; None where the sequence could not be measured.
    overlays : tuple of FrameOverlay
        A few frames.
    reason : str or None
        Why it could not be measured.
    phases : ManualPhases or None
        Its phases where a person set them; None where they follow from the force.
    """

    manifest: ContactSequence
    summary: SequenceSummary | None = None
    overlays: tuple[FrameOverlay, ...] = ()
    reason: str | None = None
    phases: ManualPhases | None = None


def result_of_sequence(sequence: ContactSequence, record: Record, context: RunContext) -> SequenceResult:
    """Return what a sequence came to, from its record in the store."""
    summary = record.get("summary")
    return SequenceResult(
        manifest=sequence,
        summary=summary and SequenceSummary(**{**summary, "notes": tuple(summary["notes"])}),
        overlays=tuple(FrameOverlay(*overlay) for overlay in record.get("overlays", ())),
        reason=record.get("reason"),
        phases=manual_phases(context.active_corrections, sequence.name),
    )


def frames_beyond(
    sequences: Iterable[SequenceResult], active_corrections: Mapping[str, ActiveCorrection]
) -> Iterator[str]:
    """Yield the corrected frames that lie beyond the end of their sequence."""
    for sequence in sequences:
        if sequence.summary is not None:
            for frame in frames_of(active_corrections, sequence.manifest.name):
                if frame >= sequence.summary.count:
                    yield f"{sequence.manifest.name}#{frame}"
