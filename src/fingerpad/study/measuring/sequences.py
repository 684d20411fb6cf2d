"""An image sequence of one press, measured piece by piece: each frame in contact becomes a row.

The pieces are tasks of their own, so that a run goes on within a sequence, and several processes share one.
Three stages follow one another: all frames are surveyed, one reading is learnt, and the frames are measured
by it.
"""

import math
from collections.abc import Iterable, Iterator, Mapping
from contextlib import closing, contextmanager, suppress
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property, partial
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np

from fingerpad import image
from fingerpad._columns import columns_in_toml, columns_named_by
from fingerpad._files import file_stem, make_folder
from fingerpad._records import fields_from, from_record
from fingerpad.exceptions import FingerpadError, LoadingError, StoreError, reason_of
from fingerpad.image.sequence.frames import played_rate
from fingerpad.loading.contact_point import first_contact
from fingerpad.study.corrections import apply
from fingerpad.study.corrections.changes import ContactCorrection
from fingerpad.study.corrections.log import frames_of, phases_item, sequence_frames
from fingerpad.study.engine.store import DamagedResultError
from fingerpad.study.engine.task import CHANGED, ChangedError, Record, Task, Work, in_study
from fingerpad.study.manifest.models import ContactSequence
from fingerpad.study.measuring.contacts import Measurement, from_contact_image, reviewed, with_automatic_axes
from fingerpad.study.measuring.context import FoundScale, Item, RunContext, cache_key, require_scale

IN_CONTACT: Final = frozenset(("loading", "hold", "unloading"))
# Below so many ridges from the centre to the nearest edge an ellipse is drawn by single ridges.
LEAST_RIDGES: Final = 5
# A piece is what an interrupted run loses at most. Each opens the sequence again, so there are not too many.
_FRAMES: Final = "frames"
_LEAST_PIECE: Final = 50
_MOST_PIECES: Final = 256
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
    )


def _header(path: str, folder: Path, _out: Path) -> Record:
    header = asdict(image.open_frames(folder / path))
    del header["path"]
    return {"header": header}


class FrameOverlay(NamedTuple):
    """A frame drawn with its measurement."""

    role: str  # `first contact`, `largest load` or `last contact`
    frame: int
    file: str


@dataclass(frozen=True, slots=True, kw_only=True)
class SequenceImages:
    """The pictures of a sequence; methods are the work of tasks, on pieces from a frame to before another."""

    sequence: ContactSequence
    found: FoundScale  # which all its frames share
    corrections: Mapping[int, ContactCorrection] = field(default_factory=dict)

    def scan(self, piece: tuple[int, int], folder: Path, _out: Path) -> Record:
        """Look at the texture of a piece's frames."""
        options = apply.contact_options(self.sequence, folder)
        with closing(sequence_frames(self.sequence, folder).between(*piece)) as frames:
            scan = image.scan_texture(frames, self.found.scale, **options)
        return {"scan": replace(scan, reason=scan.reason and in_study(scan.reason, folder))}

    def learn(self, scan: image.TextureScan, folder: Path, _out: Path) -> Record:
        """Learn from the frames of the largest contact how to read all of them."""
        settings = image.estimate_settings(
            sequence_frames(self.sequence, folder),
            self.found.scale,
            scan=scan,
            **apply.contact_options(self.sequence, folder),
        )
        return {"settings": settings.settings, "learnt_from": settings.learnt_from}

    def measure(
        self, settings: image.SequenceSettings, piece: tuple[int, int], folder: Path, _out: Path
    ) -> Record:
        """Measure the frames of a piece."""
        measured: dict[int, Measurement] = {}
        corrected: dict[int, str | None] = {}  # why a frame that a person corrected shows no contact
        digests: dict[int, str] = {}

        def keep(index: int, _: object, contact_image: image.ContactImageResult) -> None:
            if index not in corrected:
                measured[index] = self._measured(contact_image)

        def seen(frames: Iterator[image.Frame]) -> Iterator[image.Frame]:
            for frame in frames:
                digests[frame.index] = frame.digest
                if frame.index in self.corrections and frame.pixels is not None:
                    one = self._corrected(frame, settings, folder)
                    corrected[frame.index] = one.reason
                    if one.contact_image is not None:
                        measured[frame.index] = with_automatic_axes(self._measured(one.contact_image), one)
                yield frame

        options = apply.contact_options(self.sequence, folder)
        with closing(sequence_frames(self.sequence, folder).between(*piece)) as frames:
            results = list(
                image.measure_frames(seen(frames), self.found.scale, settings, watch=keep, **options)
            )
        reasons = {result.index: result.reason for result in results} | corrected
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

    def _corrected(
        self, frame: image.Frame, settings: image.SequenceSettings, folder: Path
    ) -> apply.CorrectedContactImage:
        """Measure one frame as a person wants it, if anybody does."""
        assert frame.pixels is not None
        change = self.corrections.get(frame.index, apply.NOTHING)
        seen = frame.pixels, self.found.scale, self.sequence, folder, settings.settings
        return apply.ContactPicture(*seen).measured(change)

    def _measured(self, contact_image: image.ContactImageResult) -> Measurement:
        return from_contact_image(contact_image, self.sequence, self.found)

    def draw(
        self,
        settings: image.SequenceSettings,
        summary: image.SequenceSummary,
        chosen: Mapping[str, int],
        folder: Path,
        out: Path,
    ) -> Record:
        """Draw frames chosen for their roles, each once, and return what the sequence comes to."""
        frames = sequence_frames(self.sequence, folder)
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
            image.write_overlay(out / file, frame.pixels, contact_image, label=label)
        return {"summary": summary, "overlays": list(overlays.values())}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SequenceResult:
    """What a sequence comes to."""

    manifest: ContactSequence
    summary: image.SequenceSummary | None = None  # None where it could not be measured
    overlays: tuple[FrameOverlay, ...] = ()
    reason: str | None = None
    phases: apply.ManualPhases | None = None


class OpenedSequence:
    """A sequence of the manifest that is to be measured; `ChangedError` if the store lacks its header."""

    def __init__(self, sequence: ContactSequence, context: RunContext) -> None:
        assert sequence.scale is not None  # the manifest's own rule
        found = require_scale(context.scale(sequence.scale))
        if found.name is None:
            # No name holds a colon: the frames of a sequence share its scale, and nothing else does.
            found = replace(found, name=f"sequence:{sequence.name}")
        known = fields_from(image.Frames, _good(context, header_task(sequence, context))["header"])
        self.sequence, self.context = sequence, context
        self.frames = image.Frames(path=context.folder / sequence.file, **known)  # of which none is read yet
        # By frame, those between key frames included.
        self.active = apply.frame_corrections(context.active_corrections, sequence.name)
        edited = {
            frame: apply.contact_correction(one) for frame, one in self.active.items() if one.change.edits
        }
        # What measures its frames, with those of these corrections that change the measurement.
        self.images = SequenceImages(sequence=sequence, found=found, corrections=edited)
        columns = {str(key): value for key, value in sequence.force_columns.items()}
        with columns_named_by(partial(columns_in_toml, "force_columns")):
            self.force = image.read_force_signal(context.folder / sequence.force, columns)
        self.clock = self._clock()
        # Its phases where a person set them; None where they follow from the force.
        self.phases = apply.manual_phases(context.active_corrections, sequence.name)
        count = max(1, self.frames.count)
        length = max(_LEAST_PIECE, -(-count // _MOST_PIECES))
        # First frame of each piece, and the one after its last.
        self.pieces = [(start, min(start + length, count)) for start in range(0, count, length)]

    def _clock(self) -> image.FrameClock:
        """Return the frames' clock on the force's time."""
        if (times := self.sequence.times) is not None:
            with columns_named_by(lambda _: ""):  # no key of the manifest names columns of this table
                return image.read_frame_stamps(self.context.folder / times)
        start, load = self.sequence.start_s, self.sequence.contact_load_N
        rate, numbers = self.sequence.frames_per_second or self.frames.frames_per_second, self.frames.numbers
        if rate is None:
            file = self.sequence.file
            raise LoadingError(f"{file}: pictures state no rate: give frames_per_second, or times")
        return image.frame_clock(rate, self.force, start_time=start, contact_load=load, numbers=numbers)

    def stages(self, key: str) -> Iterator[list[Task]]:
        """Yield the tasks of each stage, which needs the results of the one before in the store."""
        images = self.images
        yield [self._task("survey", partial(images.scan, piece), piece) for piece in self.pieces]
        surveyed = image.TextureScan.joined(
            from_record(image.TextureScan, self._stored("survey", piece)["scan"]) for piece in self.pieces
        )
        yield [self._task("reading", partial(images.learn, surveyed))]
        learnt = self._stored("reading")
        settings = image.SequenceSettings(
            settings=learnt["settings"], learnt_from=tuple(learnt["learnt_from"]), texture=surveyed.texture
        )
        measure = partial(images.measure, settings)
        yield [
            replace(self._task(_FRAMES, partial(measure, piece), piece), pictures=piece[1] - piece[0])
            for piece in self.pieces
        ]
        draw = partial(images.draw, settings, *self._summary())
        yield [replace(self._task("", draw), name=self.sequence.name, key=key)]

    def _summary(self) -> tuple[image.SequenceSummary, dict[str, int]]:
        """Return what the frames come to, and the few that are worth drawing, by their roles."""
        chosen: dict[str, int] = {}
        largest_load = -math.inf

        def followed() -> Iterator[image.FrameResult]:
            nonlocal largest_load
            for result in self.placed():
                if result.measures is not None and result.phase in IN_CONTACT:
                    chosen.setdefault("first contact", result.index)
                    if result.load > largest_load:
                        largest_load, chosen["largest load"] = result.load, result.index
                    chosen["last contact"] = result.index
                yield result

        summary = image.sequence_summary(followed(), self.force, frames=self.frames, clock=self.clock)
        if isinstance(self.clock, image.FrameRate) and self.sequence.frames_per_second is None:
            summary = replace(summary, notes=(played_rate(self.frames), *summary.notes))
        if self.force.displacement is not None:
            try:
                self._contact()
            except LoadingError as error:
                summary = replace(summary, notes=(*summary.notes, f"{error}: frames have no indentation"))
        return summary, chosen

    def _contact(self) -> float:
        """Return the displacement of first contact, mm; `LoadingError` where it is unknown."""
        return first_contact(self.force.time, self.force.load, self.force.displacement)

    def _task(self, stage: str, work: Work, piece: tuple[int, int] | None = None) -> Task:
        pictures = self.context.key(self.sequence, leave_out=TIMING)
        start, stop = piece if piece is not None and stage == _FRAMES else (0, 0)
        edits = {index: one.edits for index, one in self.images.corrections.items() if start <= index < stop}
        return Task(
            # No name of the manifest holds a blank.
            name=f"{self.sequence.name} {stage}" + ("" if piece is None else f" {piece[0]}-{piece[1]}"),
            item=self.sequence.name,
            file=self.sequence.file,
            key=cache_key(pictures, stage, piece, self.frames.count, edits),
            work=work,
            inputs=self.context.inputs_of(self.sequence),
            reads=1 if piece is None else piece[1] - piece[0],
        )

    def _stored(self, stage: str, piece: tuple[int, int] | None = None) -> Record:
        performed = self._task(stage, partial(_failed, ""), piece)  # whatever the work was
        return _good(self.context, performed)

    def measurements(self, flags: tuple[str, ...]) -> Iterator[Measurement]:
        """Yield what was measured, frame by frame, from what the store holds, with flags of all frames.

        A frame in contact, by the force, gives a measurement; one that cannot be decoded gives its reason;
        one without a contact to be seen, or beyond the force, gives none.
        """
        contact = math.nan
        with suppress(LoadingError):
            contact = self._contact()
        for result in self.placed():
            row = self._row(result, contact)
            if row is not None:
                row = replace(row, flags=(*row.flags, *flags)) if row.reason is None else row
                yield reviewed(row, self.active.get(result.index))

    def digests(self, frames: Iterable[int]) -> dict[int, str]:
        """Return the digests of some frames as they were measured, from what the store holds."""
        corrected = set(frames)
        return {
            frame["index"]: frame["digest"]
            for piece in self.pieces
            if not corrected.isdisjoint(range(*piece))
            for frame in self._stored(_FRAMES, piece)["frames"]
        }

    def placed(self) -> Iterator[image.FrameResult]:
        """Yield each frame with its time, load and phase, and its measurement as the store has it."""
        results = (
            image.FrameResult(
                index=frame["index"],
                readable=frame["readable"],
                reason=frame["reason"],
                measures=frame["measured"],
                flags=tuple(frame["measured"]["flags"]) if frame["measured"] else (),
            )
            for piece in self.pieces
            for frame in self._stored(_FRAMES, piece)["frames"]
        )
        return image.assign_times(
            results,
            np.empty(0),
            clock=self.clock,
            force=self.force,
            phases=self.phases and self.phases.correction.intervals,
        )

    def _row(self, result: image.FrameResult, contact: float) -> Measurement | None:
        if not result.readable:
            seen = Measurement(reason=result.reason)
        elif result.measures is not None and result.phase in IN_CONTACT:
            seen = replace(from_record(Measurement, result.measures), flags=result.flags)
        else:
            return None
        return replace(
            seen,
            observation=f"{self.sequence.name}#{result.index}",
            load_N=result.load,
            sequence=self.sequence.name,
            frame=result.index,
            time_s=result.time,
            phase=result.phase,
            measured_indentation_mm=float(self.force.displacement_at(result.time)) - contact,
            phase_corrected_by=self.phases and self.phases.who,
            counts=result.measures is not None and self._counts(result, seen),
        )

    def _counts(self, result: image.FrameResult, measured: Measurement) -> bool:
        """Tell whether a frame may be pooled: loading, and its ellipse more than a few ridges, if any."""
        if result.phase != "loading":
            return False
        if self.sequence.pool_min_load_N is not None:
            return result.load >= self.sequence.pool_min_load_N
        smooth = self.sequence.surface == "smooth"
        return smooth or measured.semi_minor_mm >= LEAST_RIDGES * measured.ridge_period_mm


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SequenceItem(Item[ContactSequence]):
    """An image sequence of one press."""

    @property
    def pictures(self) -> int:
        """Number of its frames; 1 if it has not been opened, or cannot be."""
        header = header_task(self.table, self.context)
        try:
            record = self.context.record(header.name, header.key) or {}
        except DamagedResultError:
            return 1
        return int(record["header"]["count"]) if "header" in record else 1

    @cached_property
    def key(self) -> str:
        """Digest of all that its result depends on, corrections of its frames among it."""
        return self.context.key(
            self.table,
            apply.frame_edits(self.context.active_corrections, self.name),
            self.context.edits(phases_item(self.name)),
        )

    def stages(self) -> Iterator[list[Task]]:
        """Yield its tasks, stage by stage; whatever goes wrong costs this sequence only."""
        key, left = self.key, self.pictures
        try:
            for stage in OpenedSequence(self.table, self.context).stages(self.key):
                left -= sum(task.pictures for task in stage)
                yield stage
        except ChangedError:
            key, reason = "", CHANGED.format(self.file)  # never up to date: the next run measures it again
        except StoreError:
            raise
        except Exception as error:  # a force table can be odd in unforeseen ways
            reason = in_study(reason_of(error, f"{self.file}: cannot be measured"), self.context.folder)
        else:
            return
        yield [replace(self.task(partial(_failed, reason)), key=key, pictures=left)]

    def result(self) -> SequenceResult:
        """Return what it came to."""
        return SequenceResult(
            manifest=self.table,
            **fields_from(SequenceResult, self.record),
            phases=apply.manual_phases(self.context.active_corrections, self.name),
        )


def _failed(reason: str, _folder: Path, _out: Path) -> Record:
    return {"reason": reason}


def corrected_frames(sequences: Iterable[SequenceResult], context: RunContext) -> dict[str, str | None]:
    """Return the digests of all frames that people corrected, by item, as they were measured.

    None is that of a frame beyond the end of its sequence.
    """
    found: dict[str, str | None] = {}
    for sequence in sequences:
        name = sequence.manifest.name
        active = frames_of(context.active_corrections, name)
        if sequence.reason is None and active:
            with _all_stored(name, context):
                digests = OpenedSequence(sequence.manifest, context).digests(active)
            found |= {f"{name}#{frame}": digests.get(frame) for frame in active}
    return found


def sequence_measurements(result: SequenceResult, context: RunContext) -> Iterator[Measurement]:
    """Yield the measurements of a sequence that is in the store, or the one that says why it has none."""
    name = result.manifest.name
    if result.reason is not None:
        yield Measurement(observation=name, reason=result.reason, sequence=name)
        return
    flags = () if result.summary is None else result.summary.flags
    with _all_stored(name, context):
        try:
            opened = OpenedSequence(result.manifest, context)
        except LoadingError as error:  # what was stored took the force otherwise
            yield Measurement(observation=name, reason=in_study(str(error), context.folder), sequence=name)
            return
        yield from opened.measurements(flags)


@contextmanager
def _all_stored(name: str, context: RunContext) -> Iterator[None]:
    """Raise `DamagedResultError` where the store has lost a part of a sequence that it holds as measured."""
    try:
        yield
    except ChangedError:
        assert context.store is not None  # it holds the sequence
        raise DamagedResultError(context.store.path, name) from None


def _good(context: RunContext, task: Task) -> Record:
    """Return the record of a task; its reason is raised, `ChangedError` if there is none with its key."""
    record = context.record(task.name, task.key)
    if record is None:
        raise ChangedError
    if record.get("reason") is not None:
        raise FingerpadError(record["reason"])
    return record
