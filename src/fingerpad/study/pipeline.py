"""The whole way of a study, from its manifest to rows and summaries."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from fingerpad._files import make_folder
from fingerpad.exceptions import ManifestError
from fingerpad.study.fingers import FingerResult, finger_result
from fingerpad.study.manifest import Study, read_study
from fingerpad.study.measure import Measurement
from fingerpad.study.provenance import provenance
from fingerpad.study.rows import Row, make_rows
from fingerpad.study.runner import measure_all
from fingerpad.study.summary import CurveResult, Summary, curve_result, summaries

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
    rows : list of Row
        One per observation.
    summaries : list of Summary
        One per finger and placement.
    curves : list of CurveResult
        One per loading curve.
    provenance : dict
        Versions, input hashes, formulas.
    """

    study: Study
    folder: Path
    fingers: dict[str, FingerResult]
    rows: list[Row]
    summaries: list[Summary]
    curves: list[CurveResult]
    provenance: dict[str, Any]

    @property
    def failures(self) -> list[str]:
        """What failed and why, fingers, observations and curves alike."""
        return [
            *(f"{row['observation']}: {row['reason']}" for row in self.rows if row["status"] == "failed"),
            *(finger.reason for finger in self.fingers.values() if finger.reason is not None),
            *(curve.reason for curve in self.curves if curve.reason is not None),
        ]


def run_study(
    manifest: Path,
    out: Path,
    *,
    workers: int = 1,
    on_start: Callable[[int], None] = lambda _: None,
    on_measured: Callable[[Measurement], None] = lambda _: None,
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
    on_start, on_measured : callable
        Told how many observations there are, and of each one as it is done.

    Raises
    ------
    ManifestError
        Before any work, if the manifest cannot be acted upon, or results would be written over inputs.
    """
    if manifest.is_dir():
        manifest = manifest / "study.toml"
    study = read_study(manifest)
    folder = manifest.absolute().parent
    inputs = [manifest.name, *(name for _, name in study.named_files())]
    _refuse_to_overwrite(inputs, folder, out)
    make_folder(out)
    _remove_earlier_pictures(out)
    origin = provenance(folder, inputs)
    fingers = {finger.name: finger_result(finger, folder, out) for finger in study.fingers}
    on_start(len(study.observations))
    measurements = {}
    for measurement in measure_all(study.observations, folder, out, workers=workers):
        measurements[measurement.observation] = measurement
        on_measured(measurement)
    rows = make_rows(study, fingers, measurements)
    return StudyResult(
        study=study,
        folder=folder,
        fingers=fingers,
        rows=rows.rows,
        summaries=summaries(rows),
        curves=[curve_result(curve, folder) for curve in study.curves],
        provenance=origin,
    )


def _refuse_to_overwrite(inputs: list[str], folder: Path, out: Path) -> None:
    """Raise if a file of the study lies where results are written."""
    for name in inputs:
        path = (folder / name).resolve()
        if path.is_relative_to(out.resolve()) and path.relative_to(out.resolve()).parts[0] in OUTPUT_NAMES:
            raise ManifestError(f"{out}: results would be written over {name}; choose another output folder")


def _remove_earlier_pictures(out: Path) -> None:
    """Remove the pictures of an earlier run, which its summary attests, lest they mix with new ones."""
    if (out / "summary.json").is_file():
        for pattern in ("overlays/*.png", "figures/*.png", "figures/*.svg"):
            for path in out.glob(pattern):
                path.unlink()
