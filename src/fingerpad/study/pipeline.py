"""The whole way of a study, from its manifest to rows and summaries."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from fingerpad._files import make_folder
from fingerpad.exceptions import ManifestError
from fingerpad.study.check import UncertaintyCheck
from fingerpad.study.curves import CurveResult, curve_result
from fingerpad.study.fingers import FingerResult, finger_result
from fingerpad.study.manifest import Contact, Study, read_study
from fingerpad.study.measure import Measurement
from fingerpad.study.provenance import provenance
from fingerpad.study.rows import Heaviest, make_rows
from fingerpad.study.runner import Measured, measure_all
from fingerpad.study.scales import FoundScale, named_scales
from fingerpad.study.sequences import SequenceResult
from fingerpad.study.store import STORE_NAME, Store
from fingerpad.study.summary import Summary, summaries
from fingerpad.study.table import Table
from fingerpad.study.tasks import Task, pictures_of, stored_of, tasks_of

# What a run writes into its output folder.
OUTPUT_NAMES: Final = frozenset(
    (
        "figures",
        "overlays",
        "report.html",
        "results.csv",
        "results.json",
        "results_columns.csv",
        "summary.json",
    )
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StudyResult:
    """Everything that a run found.

    Attributes
    ----------
    study : Study
        The manifest.
    folder : Path
        The study folder.
    fingers : dict of str to FingerResult
        Semi-axes by finger.
    rows : Table
        One per observation, and one per frame in contact of a sequence.
    sequences : list of SequenceResult
        One per sequence.
    scales : dict of str to FoundScale or str
        Named scales, or why there is none.
    summaries : list of Summary
        One per finger and placement.
    checks : list of UncertaintyCheck or None
        Of the heaviest contact that counts in each summary; None where none does.
    curves : list of CurveResult
        One per loading curve.
    provenance : dict
        Versions, input hashes, formulas.
    """

    study: Study
    folder: Path
    fingers: dict[str, FingerResult]
    rows: Table
    sequences: list[SequenceResult]
    scales: dict[str, FoundScale | str]
    summaries: list[Summary]
    checks: list[UncertaintyCheck | None]
    curves: list[CurveResult]
    provenance: dict[str, Any]

    @property
    def failures(self) -> list[str]:
        """What failed and why, fingers, observations, sequences, scales and curves alike."""
        return [
            *(f"{name}: {reason}" for name, reason in self.failed_contacts),
            *(scale for scale in self.scales.values() if isinstance(scale, str)),
            *(finger.reason for finger in self.fingers.values() if finger.reason is not None),
            *(curve.reason for curve in self.curves if curve.failed and curve.reason is not None),
        ]

    @property
    def failed_contacts(self) -> list[tuple[str, str]]:
        """Names of contacts that failed, with the reason; the frames of a sequence in one line."""
        failed = self.rows.at(self.rows.column("status") == "failed")
        frames = failed.known("frame")
        lines = [(row["observation"], row["reason"]) for row in failed.at(~frames)]
        for (name,), film in failed.at(frames).by("sequence").items():
            first = film[0]
            many = "1 frame" if len(film) == 1 else f"{len(film)} frames; the first:"
            lines.append((name, f"{many} {first['frame']}: {first['reason']}"))
        return lines

    def frames(self) -> list[Table]:
        """Return the rows of frames of each of `sequences`."""
        films = self.rows.at(self.rows.known("frame")).by("sequence")
        return [films.get((film.manifest.name,), self.rows[:0]) for film in self.sequences]


def run_study(
    manifest: Path,
    out: Path,
    *,
    workers: int = 1,
    fresh: bool = False,
    on_start: Callable[[int], None] = lambda _: None,
    on_measured: Callable[[Measured], None] = lambda _: None,
    on_frame: Callable[[], None] = lambda: None,
) -> StudyResult:
    """Run a study: measure every observation, place every finger, apply the model, pool.

    Parameters
    ----------
    manifest : Path
        The study's TOML file.
    out : Path
        Folder for overlays; made if it is not there.
    workers : int
        Number of processes that measure.
    fresh : bool
        Measure everything anew, whatever is stored.
    on_start, on_measured : callable
        Told how many observations and sequences are to be measured, and of each one as it is done.
    on_frame : callable
        Called after each frame of a sequence that is measured in this process.

    Raises
    ------
    ManifestError
        Before any work, if the manifest cannot be acted upon, or results would be written over inputs.
    StoreError
        If the store of results in `out` cannot be used, or another run is writing to it.
    """
    if manifest.is_dir():
        manifest = manifest / "study.toml"
    study = read_study(manifest)
    folder = manifest.absolute().parent
    inputs = [manifest.name, *(name for _, name in study.named_files())]
    _refuse_to_overwrite(inputs, folder, out)
    make_folder(out)
    scales = named_scales(study, folder)
    fingers = {finger.name: finger_result(finger, scales, folder, out) for finger in study.fingers}
    contacts: list[Contact] = [*study.observations, *study.sequences]
    with Store.writing(out / STORE_NAME) as store:
        origin = provenance(inputs, lambda name: store.digest(folder / name))
        tasks = {task.contact.name: task for task in tasks_of(contacts, scales, folder, store.digest)}
        measured = {} if fresh else _stored(tasks, store, out)
        left = [contact for contact in contacts if contact.name not in measured]
        on_start(len(left))
        for one in measure_all(left, scales, folder, out, workers=workers, on_frame=on_frame):
            measured[one.contact] = one
            store.put(one.contact, stored_of(one, tasks[one.contact].key))
            on_measured(one)
    _remove_other_pictures(out, measured.values(), fingers.values())
    return result_of(
        study,
        folder,
        fingers=fingers,
        scales=scales,
        seen=((contact, each) for contact in contacts for each in measured[contact.name].measurements),
        sequences=[film for contact in contacts if (film := measured[contact.name].sequence) is not None],
        origin=origin,
    )


def result_of(
    study: Study,
    folder: Path,
    *,
    fingers: dict[str, FingerResult],
    scales: dict[str, FoundScale | str],
    seen: Iterable[tuple[Contact, Measurement]],
    sequences: list[SequenceResult],
    origin: dict[str, Any],
) -> StudyResult:
    """Return what a study comes to, once everything is measured: rows, summaries and loading curves.

    Parameters
    ----------
    study, folder, fingers, scales, sequences, origin
        As `StudyResult` has them, `origin` its provenance.
    seen : iterable of (Contact, Measurement)
        All measurements in the manifest's order; gone through once, a thousand held at a time.
    """
    rows = make_rows(study, fingers, seen)
    found = summaries(rows)
    return StudyResult(
        study=study,
        folder=folder,
        fingers=fingers,
        rows=rows.table,
        sequences=sequences,
        scales=scales,
        summaries=found,
        checks=[_check(rows.heaviest.get(summary.key)) for summary in found],
        curves=[
            curve_result(curve, fingers[curve.finger], study.poisson_ratio, folder) for curve in study.curves
        ],
        provenance=origin,
    )


def _check(heaviest: Heaviest | None) -> UncertaintyCheck | None:
    return None if heaviest is None else UncertaintyCheck.of(heaviest.observation, heaviest.inputs)


def _refuse_to_overwrite(inputs: list[str], folder: Path, out: Path) -> None:
    """Raise if a file of the study lies where results are written."""
    for name in inputs:
        path = (folder / name).resolve()
        if path.is_relative_to(out.resolve()) and path.relative_to(out.resolve()).parts[0] in OUTPUT_NAMES:
            raise ManifestError(f"{out}: results would be written over {name}; choose another output folder")


def _stored(tasks: Mapping[str, Task], store: Store, out: Path) -> dict[str, Measured]:
    """Return what earlier runs measured and is still good."""
    stored = store.results()
    found = {name: task.done_by(stored.get(name), out) for name, task in tasks.items()}
    return {name: measured for name, measured in found.items() if measured is not None}


def _remove_other_pictures(out: Path, measured: Iterable[Measured], fingers: Iterable[FingerResult]) -> None:
    """Remove overlays and figures of earlier runs, lest they mix with this one's."""
    kept = {name for one in measured for name in pictures_of(one)}
    kept |= {photograph.overlay for finger in fingers for photograph in finger.photographs}
    for pattern in ("overlays/*.png", "overlays/sequences/*.png", "figures/*.png", "figures/*.svg"):
        for path in out.glob(pattern):
            if path.relative_to(out).as_posix() not in kept:
                path.unlink()
