"""The work on the pictures of a sequence, each part of it a task of its own."""

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Final, NamedTuple

from fingerpad._files import file_stem, make_folder
from fingerpad.image import (
    ContactImageResult,
    Frame,
    SequenceSettings,
    SequenceSummary,
    TextureScan,
    estimate_settings,
    measure_frames,
    open_frames,
    scan_texture,
    write_overlay,
)
from fingerpad.study.corrections.apply import (
    NOTHING,
    CorrectedContactImage,
    contact_options,
    corrected_contact_image,
)
from fingerpad.study.corrections.changes import ContactCorrection
from fingerpad.study.engine.store import DamagedResultError, to_record
from fingerpad.study.engine.task import Record, Task, in_study
from fingerpad.study.manifest.models import ContactSequence
from fingerpad.study.measuring.contacts import Measurement, from_contact_image, with_automatic_axes
from fingerpad.study.measuring.context import RunContext, cache_key
from fingerpad.study.measuring.scales import FoundScale

# What says when a frame was taken and under which load, but nothing of what is seen in it.
TIMING: Final = frozenset(
    ("force", "force_columns", "times", "frames_per_second", "start_s", "contact_load_N")
)


def header_task(sequence: ContactSequence, context: RunContext) -> Task:
    """Return the task that opens a sequence: it counts the frames."""
    return Task(
        name=f"{sequence.name} header",  # no name of the manifest holds a blank
        item=sequence.name,
        file=sequence.file,
        key=cache_key(context.key(sequence, leave_out=TIMING), "header"),
        work=partial(_header, sequence.file),
        inputs=(sequence.file,),
        pictures=0,
    )


def _header(path: str, folder: Path, _out: Path) -> Record:
    header = asdict(open_frames(folder / path))
    del header["path"]
    return {"header": header}


def frame_count(sequence: ContactSequence, context: RunContext) -> int:
    """Return the number of frames of a sequence; 1 if it has not been opened, or cannot be."""
    header = header_task(sequence, context)
    try:
        record = context.record(header.name, header.key)
    except DamagedResultError:
        record = None
    return 1 if record is None or "header" not in record else int(record["header"]["count"])


class FrameOverlay(NamedTuple):
    """A frame drawn with its measurement."""

    role: str  # `first contact`, `largest load` or `last contact`
    frame: int
    file: str


@dataclass(frozen=True, slots=True, kw_only=True)
class SequenceImages:
    """The pictures of a sequence.

    Each method is the work of a task: it takes the study folder and one to draw into, and returns plain
    values. A piece is its first frame and the one after its last.
    """

    sequence: ContactSequence
    found: FoundScale  # which all its frames share
    corrections: Mapping[int, ContactCorrection] = field(default_factory=dict)

    def scan(self, piece: tuple[int, int], folder: Path, _out: Path) -> Record:
        """Look at the texture of a piece's frames."""
        frames = open_frames(folder / self.sequence.file).between(*piece)
        scan = scan_texture(frames, self.found.scale, **contact_options(self.sequence, folder))
        return {"scan": to_record(replace(scan, reason=scan.reason and in_study(scan.reason, folder)))}

    def learn(self, scan: TextureScan, folder: Path, _out: Path) -> Record:
        """Learn from the frames of the largest contact how to read all of them."""
        settings = estimate_settings(
            open_frames(folder / self.sequence.file),
            self.found.scale,
            scan=scan,
            **contact_options(self.sequence, folder),
        )
        return {"settings": dict(settings.settings), "learnt_from": list(settings.learnt_from)}

    def measure(self, settings: SequenceSettings, piece: tuple[int, int], folder: Path, _out: Path) -> Record:
        """Measure the frames of a piece."""
        measured: dict[int, Record] = {}
        corrected: dict[int, CorrectedContactImage] = {}
        digests: dict[int, str] = {}

        def keep(index: int, _: object, contact_image: ContactImageResult) -> None:
            measured[index] = to_record(self._measured(contact_image))

        def seen(frames: Iterator[Frame]) -> Iterator[Frame]:
            for frame in frames:
                digests[frame.index] = frame.digest
                if frame.index in self.corrections and frame.pixels is not None:
                    corrected[frame.index] = self._corrected(frame, settings, folder)
                yield frame

        frames = seen(open_frames(folder / self.sequence.file).between(*piece))
        options = contact_options(self.sequence, folder)
        results = list(measure_frames(frames, self.found.scale, settings, watch=keep, **options))
        reasons = {result.index: result.reason for result in results}
        for index, one in corrected.items():
            reasons[index] = one.reason
            measured.pop(index, None)
            if one.contact_image is not None:
                found = with_automatic_axes(self._measured(one.contact_image), one)
                measured[index] = to_record(found)
        return {
            "frames": [
                {
                    "index": result.index,
                    "readable": result.readable,
                    "reason": (reason := reasons[result.index]) and in_study(reason, folder),
                    "measured": measured.get(result.index),
                    "digest": digests[result.index],
                }
                for result in results
            ]
        }

    def _corrected(self, frame: Frame, settings: SequenceSettings, folder: Path) -> CorrectedContactImage:
        """Measure one frame as a person wants it, if anybody does."""
        assert frame.pixels is not None
        change = self.corrections.get(frame.index, NOTHING)
        return corrected_contact_image(
            frame.pixels, self.found.scale, self.sequence, folder, change, settings=settings.settings
        )

    def _measured(self, contact_image: ContactImageResult) -> Measurement:
        return from_contact_image(contact_image, self.sequence, self.found)

    def draw(
        self,
        settings: SequenceSettings,
        summary: SequenceSummary,
        chosen: Mapping[str, int],
        folder: Path,
        out: Path,
    ) -> Record:
        """Draw frames chosen for their roles, each once, and return what the sequence comes to."""
        frames = open_frames(folder / self.sequence.file)
        overlays: dict[int, FrameOverlay] = {}
        for role, index in chosen.items():
            if index in overlays:
                continue
            file = f"overlays/sequences/{file_stem(self.sequence.name)}_frame_{index:06d}.png"
            overlays[index] = FrameOverlay(role, index, file)
            label = f"{'synthetic, ' if self.sequence.synthetic else ''}frame {index}, {role}"
            frame = frames.at(index)
            contact_image = self._corrected(frame, settings, folder).contact_image
            assert frame.pixels is not None  # it was measured
            assert contact_image is not None
            make_folder((out / file).parent)
            write_overlay(out / file, frame.pixels, contact_image, label=label)
        return {"summary": to_record(summary), "overlays": to_record(list(overlays.values()))}
