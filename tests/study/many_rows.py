"""Studies of many rows without pictures: ellipses drawn about elliptical Hertz theory."""

import math
from collections.abc import Iterator
from concurrent.futures import Future
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from tests.studies import PAD, Table, finger, sequence, study_of

from fingerpad.image import SequenceSummary
from fingerpad.study.engine.runner import Progress
from fingerpad.study.engine.store import STORE_NAME, Store
from fingerpad.study.engine.task import DEFAULT_LIMITS, Limits, Task, TaskResult, perform
from fingerpad.study.manifest.models import Contact, ContactSequence
from fingerpad.study.measuring.contacts import Measurement
from fingerpad.study.measuring.context import RunContext
from fingerpad.study.measuring.fingers import FingerResult
from fingerpad.study.measuring.run import Measured, StudyItems
from fingerpad.study.measuring.sequences import SequenceResult
from fingerpad.study.results.methods import provenance
from fingerpad.study.results.study_result import StudyResult, result_of

FRAMES, FINGERS, WEDGES = 2000, 5, (15.0, 45.0)
AXES, AXES_STD = tuple(PAD.values()), 0.1
EDGE_STD, SCALE_STD = 0.05, 0.01


def sequences_of(rows: int) -> list[ContactSequence]:
    """Return the sequences of so many rows: at most `FRAMES` each, over fingers and angles."""
    return [
        ContactSequence.model_validate(
            sequence(
                f"sequence_{number}",
                f"sequence_{number}.tif",
                finger=f"finger_{number % FINGERS}",
                wedge=WEDGES[number // FINGERS % 2],
                force=f"sequence_{number}.csv",
                scale={"ppi": 500},
                synthetic=True,
            ).keys
        )
        for number in range(math.ceil(rows / FRAMES))
    ]


def measurements_of(sequence: ContactSequence, count: int) -> Iterator[Measurement]:
    """Yield the frames of a press to 2 N and back; one of a hundred cannot be read, one is cut."""
    rng = np.random.default_rng(int(sequence.name.removeprefix("sequence_")))
    for frame in range(count):
        load = 0.1 + 1.9 * (1 - abs(2 * frame / max(count - 1, 1) - 1))
        phase = "loading" if 2 * frame < count else "unloading"
        place: dict[str, Any] = {
            "sequence": sequence.name,
            "frame": frame,
            "time_s": frame / 500,
            "phase": phase,
        }
        name = f"{sequence.name}#{frame}"
        if frame % 100 == 7:
            yield Measurement(
                observation=name, load_N=load, reason="the page is damaged", **place, counts=False
            )
            continue
        axes = np.array([5.6, 4.7]) * load**0.3 * np.exp(rng.normal(0, 0.01, 2))
        area = np.pi * axes.prod()
        yield Measurement(
            observation=name,
            load_N=load,
            semi_major_mm=float(axes[0]),
            semi_minor_mm=float(axes[1]),
            covariance_mm2=EDGE_STD**2 * np.eye(2) + SCALE_STD**2 * np.outer(axes, axes),
            scale=f"sequence:{sequence.name}",
            relative_scale_std=SCALE_STD,
            long_axis="along",
            gross_area_mm2=area,
            gross_area_mm2_std=0.02 * area,
            ridge_area_mm2=0.5 * area,
            ridge_area_mm2_std=0.03 * area,
            ridge_period_mm=0.45,
            ellipse_iou=0.95,
            orientation_deg=float(rng.normal(0, 3)),
            centroid_row_px=200.0,
            centroid_column_px=300.0,
            mm_per_px=0.0508,
            mm_per_px_std=0.0508 * SCALE_STD,
            **place,
            flags=("touches_border",) if frame % 100 == 11 else (),
            counts=phase == "loading",
        )


def study_result(rows: int, folder: Path) -> StudyResult:
    """Return the result of a synthetic study of so many rows, its measurements streamed."""
    sequences = sequences_of(rows)
    counts = [min(FRAMES, rows - FRAMES * number) for number in range(len(sequences))]
    names = dict.fromkeys(sequence.finger for sequence in sequences)
    study = study_of(
        *(finger(name, std=AXES_STD) for name in names),
        *(Table("sequences", one.model_dump(exclude_defaults=True)) for one in sequences),
        title=f"Synthetic study of {rows:,} rows",
        uncertainty={"wedge_angle_deg_std": 0.5, "load_relative_std": 0.02},
    )
    known = {
        name: FingerResult(
            name=name,
            semi_axes=np.array(AXES) * (1 + 0.02 * number),
            covariance=AXES_STD**2 * np.eye(3),
            source="given",
            synthetic=True,
        )
        for number, name in enumerate(names)
    }

    def seen() -> Iterator[tuple[Contact, Measurement]]:
        for press, count in zip(sequences, counts, strict=True):
            for measured in measurements_of(press, count):
                yield press, measured

    with Store.writing(folder / STORE_NAME) as store:
        return result_of(
            Measured(
                items=StudyItems.of(RunContext(study=study, folder=folder)),
                progress=Progress(pictures=rows, failed=0, total=rows),
                fingers=known,
                sequences=[
                    _sequence(sequence, count) for sequence, count in zip(sequences, counts, strict=True)
                ],
                curves=[],
                contacts=seen(),
            ),
            notes=(),
            origin={**provenance([], str), "limits_per_picture": asdict(DEFAULT_LIMITS)},
            executor=_InProcess(folder),
            store=store,
        )


class _InProcess:
    """Performs tasks in this process, so that its clock counts them."""

    capacity = 1

    def __init__(self, folder: Path) -> None:
        self.limits: Limits = DEFAULT_LIMITS
        self._folder = folder

    def submit(self, task: Task) -> Future[TaskResult]:
        future: Future[TaskResult] = Future()
        future.set_result(perform(task.work, task.file, self._folder, self.limits))
        return future

    def require_workers(self) -> None:
        pass


def _sequence(sequence: ContactSequence, count: int) -> SequenceResult:
    failed = sum(frame % 100 == 7 for frame in range(count))
    return SequenceResult(
        manifest=sequence,
        summary=SequenceSummary(
            count=count,
            measured=count - failed,
            without_contact=0,
            failed=failed,
            first_contact=0,
            largest=count // 2,
            phases={"loading": count // 2, "unloading": count - count // 2},
            notes=(),
        ),
    )
