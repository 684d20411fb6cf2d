"""The whole way of a study, from its manifest to rows and summaries."""

from collections.abc import Callable, Container, Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Final

from fingerpad._files import make_folder
from fingerpad.exceptions import ManifestError
from fingerpad.study.check import UncertaintyCheck
from fingerpad.study.corrections import CorrectionLog
from fingerpad.study.curves import CurveResult, curve_result
from fingerpad.study.decisions import CORRECTIONS_NAME
from fingerpad.study.fingers import FingerResult, finger_result
from fingerpad.study.hands import hands_for
from fingerpad.study.manifest import Contact, Study, manifest_in, read_study
from fingerpad.study.measure import Measurement
from fingerpad.study.measuring import drawn_for, faces_of, film_results, measure_study, measurements
from fingerpad.study.progress import Progress
from fingerpad.study.provenance import provenance
from fingerpad.study.rows import Heaviest, make_rows
from fingerpad.study.scales import FoundScale, named_scales
from fingerpad.study.sequences import SequenceResult
from fingerpad.study.store import STORE_NAME, Store
from fingerpad.study.summary import Summary, summaries
from fingerpad.study.table import Table
from fingerpad.study.tasks import Keys

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

_NOT_THERE: Final = f"{CORRECTIONS_NAME}: {{}} is not in the study: what was decided about it has no effect"


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
    notes : tuple of str
        What is odd about people's corrections.
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
    notes: tuple[str, ...] = ()

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
    scheduler: str | None = None,
    fresh: bool = False,
    on_progress: Callable[[Progress], None] = lambda _: None,
) -> StudyResult:
    """Run a study: measure every picture, place every finger, apply the model, pool.

    Parameters
    ----------
    manifest : Path
        The study's TOML file, or its folder.
    out : Path
        Folder for results; made if it is not there.
    workers : int
        Number of processes that measure on this machine.
    scheduler : str or None
        Address of a Dask scheduler whose workers measure instead, as ``tcp://host:8786``; or ``local`` for
        one that is started here with so many workers.
    fresh : bool
        Measure everything anew, whatever is stored.
    on_progress : callable
        Told at the start and whenever something has been measured. If it raises KeyboardInterrupt, what is
        in hand is finished and kept, and the run ends with KeyboardInterrupt.

    Raises
    ------
    ManifestError
        Before any work, if the manifest cannot be acted upon, or results would be written over inputs.
    StoreError
        If the store of results in `out` cannot be used, another run is writing to it, or results cannot be
        kept.
    ClusterError
        If the scheduler or its workers cannot be used.
    """
    manifest = manifest_in(manifest)
    study, folder = read_study(manifest), manifest.absolute().parent
    log = CorrectionLog(folder)
    rulings = log.rulings()
    decided = [CORRECTIONS_NAME] if (folder / CORRECTIONS_NAME).is_file() else []
    inputs = [manifest.name, *decided, *(name for _, name in study.named_files())]
    _refuse_to_overwrite(inputs, folder, out)
    make_folder(out)
    with Store.writing(out / STORE_NAME) as store:
        if fresh:
            store.forget()
        keys = Keys(study=study, folder=folder, digest=cache(store.digest), rulings=rulings)
        origin = provenance(inputs, lambda name: keys.digest(folder / name))
        scales = named_scales(study, folder)
        with hands_for(manifest, workers, scheduler) as hands:
            measure_study(keys, scales, store, out, hands=hands, on_progress=on_progress)
        fingers = {
            finger.name: finger_result(finger, scales, folder, faces_of(finger, keys, store), rulings)
            for finger in study.fingers
        }
        films = film_results(keys, store)
        _remove_other_pictures(out, drawn_for(keys, store))
        return result_of(
            study,
            folder,
            fingers=fingers,
            scales=scales,
            seen=measurements(keys, scales, store, films),
            sequences=films,
            origin=origin,
            notes=(
                *log.notes,
                *(f"{CORRECTIONS_NAME}: {item} is not in the study" for item in log.unknown_items(study)),
            ),
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
    notes: tuple[str, ...] = (),
) -> StudyResult:
    """Return what a study comes to, once everything is measured: rows, summaries and loading curves.

    Parameters
    ----------
    study, folder, fingers, scales, sequences, origin, notes
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
        notes=notes,
    )


def _check(heaviest: Heaviest | None) -> UncertaintyCheck | None:
    return None if heaviest is None else UncertaintyCheck.of(heaviest.observation, heaviest.inputs)


def _refuse_to_overwrite(inputs: list[str], folder: Path, out: Path) -> None:
    """Raise if a file of the study lies where results are written."""
    for name in inputs:
        path = (folder / name).resolve()
        if path.is_relative_to(out.resolve()) and path.relative_to(out.resolve()).parts[0] in OUTPUT_NAMES:
            raise ManifestError(f"{out}: results would be written over {name}; choose another output folder")


def _remove_other_pictures(out: Path, kept: Container[str]) -> None:
    """Remove overlays and figures of earlier runs, lest they mix with this one's."""
    for pattern in ("overlays/*.png", "overlays/sequences/*.png", "figures/*.png", "figures/*.svg"):
        for path in out.glob(pattern):
            if path.relative_to(out).as_posix() not in kept:
                path.unlink()
