"""The work on the pictures of a film, each part of it a task of its own."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fingerpad._files import make_folder
from fingerpad.image import (
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
from fingerpad.study.corrected import place_of
from fingerpad.study.manifest import ContactSequence
from fingerpad.study.measure import from_imprint
from fingerpad.study.scales import FoundScale
from fingerpad.study.tasks import Record
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


class Told(NamedTuple):
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
    """

    sequence: ContactSequence
    found: FoundScale

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

        def keep(index: int, _: object, imprint: Imprint) -> None:
            record = from_imprint(imprint, self.sequence, self.found)
            measured[index] = {**record, "covariance": record["covariance"].tolist()}

        frames = open_frames(folder / self.sequence.path).between(*piece)
        place = place_of(self.sequence, folder)
        results = measure_frames(frames, self.found.scale, reading, watch=keep, **place)
        return {
            "frames": [
                {
                    "index": result.index,
                    "readable": result.readable,
                    "reason": result.reason and in_study(result.reason, folder),
                    "measured": measured.get(result.index),
                }
                for result in results
            ]
        }

    def draw(self, reading: Reading, told: Told, folder: Path, out: Path) -> Record:
        """Draw the chosen frames, each once, and return what there is to be said of the film."""
        frames, place = open_frames(folder / self.sequence.path), place_of(self.sequence, folder)
        overlays: dict[int, FrameOverlay] = {}
        for role, index in told.chosen.items():
            if index in overlays:
                continue
            name = f"{self.sequence.name}_frame_{index:06d}.png"
            overlays[index] = FrameOverlay(role, index, f"overlays/sequences/{name}")
            label = f"{'synthetic, ' if self.sequence.synthetic else ''}frame {index}, {role}"
            frame = frames.between(index, index + 1)
            draw = _draws(out / overlays[index].file, label)
            list(measure_frames(frame, self.found.scale, reading, watch=draw, **place))
        return {
            "summary": asdict(told.summary),
            "overlays": [list(overlay) for overlay in overlays.values()],
        }


def _draws(file: Path, label: str) -> Any:
    """Return a watcher that draws what it sees."""
    make_folder(file.parent)
    return lambda _, pixels, imprint: write_overlay(file, pixels, imprint, label=label)


def survey_from(record: Record) -> Survey:
    """Return a survey from its record."""
    return Survey(
        index=np.array(record["index"], dtype=np.int64),
        texture=np.array(record["texture"], dtype=np.float64),
        reason=record["unreadable"],
    )
