"""The work on the pictures of a film, each part of it a task of its own."""

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fingerpad._files import file_stem, make_folder
from fingerpad.image import (
    Frame,
    Imprint,
    Reading,
    SequenceSummary,
    Survey,
    learn_reading,
    measure_frames,
    open_frames,
    survey_frames,
    write_overlay,
)
from fingerpad.study.corrections.changes import ContactCorrection
from fingerpad.study.corrections.corrected import NOTHING, CorrectedImprint, corrected_imprint, place_of
from fingerpad.study.engine.task import Record
from fingerpad.study.manifest import ContactSequence
from fingerpad.study.measuring.measure import from_imprint, program_columns
from fingerpad.study.measuring.scales import FoundScale
from fingerpad.study.words import in_study


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


class Gist(NamedTuple):
    """What the frames of a film come to.

    Attributes
    ----------
    summary : SequenceSummary
        In numbers.
    chosen : mapping of str to int
        Frames worth drawing, by the role for which they were chosen.
    """

    summary: SequenceSummary
    chosen: Mapping[str, int]


@dataclass(frozen=True, slots=True, kw_only=True)
class Footage:
    """The pictures of a film.

    Each method is the work of a task: it takes the study folder and one to draw into, and returns plain
    values. A piece is its first frame and the one after its last.

    Attributes
    ----------
    sequence : ContactSequence
        What the manifest says of it.
    found : FoundScale
        Its scale, which all its frames share.
    corrections : mapping of int to ContactCorrection
        What people want of single frames.
    """

    sequence: ContactSequence
    found: FoundScale
    corrections: Mapping[int, ContactCorrection] = field(default_factory=dict)

    def survey(self, piece: tuple[int, int], folder: Path, _out: Path) -> Record:
        """Look at the texture of a piece's frames."""
        frames = open_frames(folder / self.sequence.path).between(*piece)
        survey = survey_frames(frames, self.found.scale, **place_of(self.sequence, folder))
        return {
            "index": survey.index.tolist(),
            "texture": survey.texture.tolist(),
            "unreadable": survey.reason and in_study(survey.reason, folder),
        }

    def learn(self, survey: Survey, folder: Path, _out: Path) -> Record:
        """Learn from the frames of the largest contact how to read all of them."""
        reading = learn_reading(
            open_frames(folder / self.sequence.path),
            self.found.scale,
            survey=survey,
            dark_on_light=self.sequence.dark_on_light,
            threshold=self.sequence.threshold,
            **place_of(self.sequence, folder),
        )
        return {"settings": dict(reading.settings), "learnt_from": list(reading.learnt_from)}

    def measure(self, reading: Reading, piece: tuple[int, int], folder: Path, _out: Path) -> Record:
        """Measure the frames of a piece."""
        measured: dict[int, Record] = {}
        corrected: dict[int, CorrectedImprint] = {}
        digests: dict[int, str] = {}

        def keep(index: int, _: object, imprint: Imprint) -> None:
            measured[index] = self._record(imprint)

        def seen(frames: Iterator[Frame]) -> Iterator[Frame]:
            for frame in frames:
                digests[frame.index] = frame.digest
                if frame.index in self.corrections and frame.pixels is not None:
                    corrected[frame.index] = self._corrected(frame, reading, folder)
                yield frame

        frames = seen(open_frames(folder / self.sequence.path).between(*piece))
        place = place_of(self.sequence, folder)
        results = list(measure_frames(frames, self.found.scale, reading, watch=keep, **place))
        reasons = {result.index: result.reason for result in results}
        for index, one in corrected.items():
            reasons[index] = one.reason
            measured.pop(index, None)
            if one.imprint is not None:
                record = self._record(one.imprint)
                measured[index] = record | {"columns": record["columns"] | program_columns(one)}
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

    def _corrected(self, frame: Frame, reading: Reading, folder: Path) -> CorrectedImprint:
        """Measure one frame as a person wants it, if anybody does."""
        assert frame.pixels is not None
        change = self.corrections.get(frame.index, NOTHING)
        settings = reading.settings
        return corrected_imprint(
            frame.pixels, self.found.scale, self.sequence, folder, change, settings=settings
        )

    def _record(self, imprint: Imprint) -> Record:
        record = from_imprint(imprint, self.sequence, self.found)
        return {**record, "covariance": record["covariance"].tolist()}

    def draw(self, reading: Reading, gist: Gist, folder: Path, out: Path) -> Record:
        """Draw the chosen frames, each once, and return what there is to be said of the film."""
        frames = open_frames(folder / self.sequence.path)
        overlays: dict[int, FrameOverlay] = {}
        for role, index in gist.chosen.items():
            if index in overlays:
                continue
            file = f"overlays/sequences/{file_stem(self.sequence.name)}_frame_{index:06d}.png"
            overlays[index] = FrameOverlay(role, index, file)
            label = f"{'synthetic, ' if self.sequence.synthetic else ''}frame {index}, {role}"
            frame = frames.at(index)
            imprint = self._corrected(frame, reading, folder).imprint
            assert frame.pixels is not None  # it was measured
            assert imprint is not None
            make_folder((out / file).parent)
            write_overlay(out / file, frame.pixels, imprint, label=label)
        return {
            "summary": asdict(gist.summary),
            "overlays": [list(overlay) for overlay in overlays.values()],
        }


def survey_from(record: Record) -> Survey:
    """Return a survey from its record."""
    return Survey(
        index=np.array(record["index"], dtype=np.int64),
        texture=np.array(record["texture"], dtype=np.float64),
        reason=record["unreadable"],
    )
