"""The whole way of a study, from its manifest to rows and summaries."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Final

from fingerpad._files import make_folder
from fingerpad.exceptions import ManifestError
from fingerpad.study.corrections.decisions import CORRECTIONS_NAME
from fingerpad.study.corrections.log import CorrectionLog, on_another_picture
from fingerpad.study.durable import remove_others
from fingerpad.study.engine.hands import hands_for
from fingerpad.study.engine.progress import Progress
from fingerpad.study.engine.store import STORE_NAME, Store
from fingerpad.study.manifest import manifest_in, read_study
from fingerpad.study.measuring.run import (
    drawn_for,
    film_results,
    loading_results,
    measure_study,
    measurements,
    pad_of,
)
from fingerpad.study.measuring.scales import named_scales
from fingerpad.study.measuring.sequences import frames_beyond
from fingerpad.study.measuring.tasks import Keys
from fingerpad.study.results.provenance import provenance
from fingerpad.study.results.study_result import StudyResult, result_of

# What a run writes into its output folder.
OUTPUT_NAMES: Final = frozenset(
    (
        "figures",
        "overlays",
        "report",
        "report.html",
        "results.csv",
        "results.json",
        "results_columns.csv",
        "summary.json",
    )
)

_OVERLAYS: Final = ("overlays/*.png", "overlays/sequences/*.png")
_REPLACED: Final = (
    f"{CORRECTIONS_NAME}: {{}} was corrected on another picture than is there now: look at it again"
)
_NOT_THERE: Final = f"{CORRECTIONS_NAME}: {{}} is not in the study: what was decided about it has no effect"


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
            stands = measure_study(keys, scales, store, out, hands=hands, on_progress=on_progress)
            fingers = {finger.name: pad_of(finger, keys, scales, store) for finger in study.fingers}
            films = film_results(keys, store)
            remove_others(out, _OVERLAYS, drawn_for(keys, store))
            return result_of(
                study,
                folder,
                fingers=fingers,
                scales=scales,
                seen=measurements(keys, scales, store, films),
                sequences=films,
                curves=loading_results(keys, store),
                origin=origin,
                hands=hands,
                store=store,
                on_check=lambda name: on_progress(replace(stands, item=name, status="checked")),
                notes=(
                    *log.notes,
                    *map(_REPLACED.format, on_another_picture(rulings, study, folder, keys.digest)),
                    *map(_NOT_THERE.format, (*log.unknown_items(study), *frames_beyond(films, rulings))),
                ),
            )


def _refuse_to_overwrite(inputs: list[str], folder: Path, out: Path) -> None:
    """Raise if a file of the study lies where results are written, or the output folder is a film's."""
    for name in inputs:
        path = (folder / name).resolve()
        if not path.is_relative_to(out.resolve()):
            continue
        inside = path.relative_to(out.resolve()).parts
        if not inside or inside[0] in OUTPUT_NAMES:
            raise ManifestError(f"{out}: results would be written over {name}; choose another output folder")
