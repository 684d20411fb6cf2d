"""The whole way of a study, from its manifest to rows, summaries and the files that hold them."""

import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, closing
from dataclasses import asdict, replace
from functools import partial
from os import PathLike
from pathlib import Path
from typing import Any, Final, Literal, TypeAlias

from fingerpad._columns import columns_in_toml, unread_notes
from fingerpad._files import make_folder
from fingerpad._plausible import unit_doubts
from fingerpad._words import joined
from fingerpad.exceptions import FingerpadError, LoadingError, ManifestError, StoreError
from fingerpad.image.read import read_resolution
from fingerpad.image.scale import other_resolution
from fingerpad.image.sequence.force import unread_force_columns
from fingerpad.loading.curve import unread_curve_columns
from fingerpad.study.corrections.log import (
    CORRECTIONS_NAME,
    SECOND_OPERATOR_NAME,
    Correctable,
    CorrectionLog,
    on_another_image,
)
from fingerpad.study.engine.cluster import cluster_executor
from fingerpad.study.engine.runner import Executor, Progress, records_of
from fingerpad.study.engine.store import STORE_NAME, DamagedResultError, Store, TaskStatus
from fingerpad.study.engine.task import DEFAULT_LIMITS, Limits, Task
from fingerpad.study.engine.worker import LocalExecutor
from fingerpad.study.manifest.load import load_study, manifest_in
from fingerpad.study.manifest.models import Observation, PitchScale, ResolutionScale, Study
from fingerpad.study.measuring.context import RunContext
from fingerpad.study.measuring.curves import CurveResult
from fingerpad.study.measuring.run import Measured, item_of, measure_study
from fingerpad.study.measuring.sequences import corrected_frames
from fingerpad.study.results import result_set
from fingerpad.study.results.methods import provenance
from fingerpad.study.results.output import write_tables
from fingerpad.study.results.study_result import StudyResult, result_of
from fingerpad.units import MM_PER_INCH

# Draws files into a folder by tasks, each of which is performed again only where its key has changed.
Draw: TypeAlias = Callable[[Iterable[Task], Callable[[Task], None]], None]
# Writes a report of a result into a folder, in which its tables and overlays are.
ReportWriter: TypeAlias = Callable[[StudyResult, Path, Draw, Callable[[str], None]], object]

_REPLACED: Final = (
    f"{CORRECTIONS_NAME}: {{}} was corrected on another picture or force than is there now: look at it again"
)
_NOT_THERE: Final = f"{CORRECTIONS_NAME}: {{}} is not in the study: its correction has no effect"
_DAMAGED: Final = f"{STORE_NAME}: the stored result of {{}} was damaged and is measured again"


def run_study(
    manifest: str | PathLike[str],
    out: str | PathLike[str] | None = None,
    *,
    workers: int = 1,
    scheduler: str | None = None,
    force: bool = False,
    all_columns: bool = False,
    incomplete: bool = False,
    limits: Limits = DEFAULT_LIMITS,
    write_report: ReportWriter | None = None,
    on_progress: Callable[[Progress], None] = lambda _: None,
) -> StudyResult:
    """Run a study: measure every picture, place every finger, apply the model, pool, and write the results.

    The files in `out` are replaced as one when all of them are written; until then, and if the run does not
    come to its end, the results of the run before stay as they are.

    Parameters
    ----------
    manifest : path-like
        The study's TOML file, or its folder.
    out : path-like, optional
        Folder for results, made if it is not there: ``results`` beside the manifest where none is named.
    workers : int
        Number of processes that measure on this machine.
    scheduler : str or None
        Address of a Dask scheduler whose workers measure instead, as ``tcp://host:8786``; or ``local`` for
        one that is started here with so many workers.
    force : bool
        Re-measure all, whatever is stored.
    all_columns : bool
        Write also the columns that few ask for: parts of uncertainties, automatic semi-axes under corrected
        ones, centroids, radii by other routes.
    incomplete : bool
        Run what is complete of a study that lacks entries; the notes name what is left out.
    limits : Limits
        Time and memory that measuring one picture may take.
    write_report : callable, optional
        Writes the report beside the tables, as `fingerpad.report.write_report`.
    on_progress : callable
        Called at the start and whenever something has been measured or written. If it raises
        KeyboardInterrupt, what is at work is finished and stored, and the run ends with KeyboardInterrupt.

    Returns
    -------
    StudyResult
        What was written: `load_results` reads it again.

    Raises
    ------
    ManifestError
        Before any work, if the manifest cannot be acted upon, or results would be written over inputs.
    StoreError
        If the store of results in `out` cannot be used, another run is writing to it, results cannot be
        written, or an input has changed during the run.
    ClusterError
        If the scheduler or its workers cannot be used.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> text = '''
    ... title = "One contact"
    ... [[fingers]]
    ... name = "index"
    ... semi_axes_mm = { palmar = 7.9, distal = 13.8, radial_ulnar = 11.8 }
    ... semi_axes_mm_std = { palmar = 0.1, distal = 0.1, radial_ulnar = 0.1 }
    ... [[observations]]
    ... name = "first"
    ... finger = "index"
    ... wedge_angle_deg = 30
    ... load_N = 2
    ... ellipse_mm = { semi_major = 7.4, semi_minor = 5.0, std = 0.1 }
    ... '''
    >>> with TemporaryDirectory() as folder:
    ...     _ = Path(folder, "study.toml").write_text(text)
    ...     result = run_study(folder, Path(folder, "results"))
    >>> [round(summary.corrected_radius.value, 2) for summary in result.summaries]
    [13.8]
    """
    manifest = manifest_in(Path(manifest))
    out = result_set.results_folder(manifest) if out is None else Path(out)
    folder = manifest.absolute().parent
    loaded = load_study(manifest)
    study, read = loaded.study if incomplete else loaded.complete(), loaded.digests
    left_out = [f"left out, as it is not complete: {line}" for line in loaded.issues]
    del loaded  # of many rows its tables take as much as the study
    log, second = CorrectionLog(folder), CorrectionLog(folder, SECOND_OPERATOR_NAME)
    of_logs = {CORRECTIONS_NAME: log.digest, SECOND_OPERATOR_NAME: second.digest}
    parsed = {**read, **{name: digest for name, digest in of_logs.items() if digest is not None}}
    inputs = [*parsed, *(name for _, name in study.files())]
    _refuse_to_overwrite(inputs, folder, out)
    make_folder(out)
    with Store.writing(out / STORE_NAME) as store:
        result_set.put_in_place(store)
        if force:
            store.discard()
        context = RunContext(
            study=study,
            folder=folder,
            active_corrections=log.active_corrections(),
            store=store,
            second_operator=second.active_corrections(),
        )
        origin = provenance(inputs, lambda name: context.digest(folder / name))
        for name, digest in parsed.items():
            if origin["inputs_sha256"][name] != digest:
                raise ManifestError(f"{name}: was changed while it was read: run again")

        def tell(measured: Measured, item: str, status: Literal["checked", "written"]) -> None:
            on_progress(replace(measured.progress, item=item, status=status))

        def measure_and_write(damaged: Sequence[str] = ()) -> StudyResult:
            """Do what is left to do, with the stored results that were damaged named in the notes."""
            executors: AbstractContextManager[Executor] = (
                closing(LocalExecutor(folder, workers, limits))
                if scheduler is None
                else cluster_executor(manifest, workers, scheduler, limits)
            )
            with executors as executor:
                measured = measure_study(context, store, executor, on_progress)
                result = result_of(
                    measured,
                    origin={**origin, "limits_per_picture": asdict(limits)},
                    notes=(
                        *left_out,
                        *log.notes,
                        *second.notes,
                        *map(_DAMAGED.format, damaged),
                        *_notes(measured, log),
                        *study.doubts(),
                        *_loading_notes(measured.curves),
                        *_repeated_files(measured),
                        *_resolution_notes(study, folder),
                        *_column_notes(study, folder),
                    ),
                    perform=partial(
                        records_of,
                        executor=executor,
                        store=store,
                        folder=folder,
                        on_done=lambda task: tell(measured, task.item, "checked"),
                    ),
                )
            for loc, name in study.files():  # tables that were read beside the pictures
                if loc[-1] in {"outline", "force", "times"} and not store.unchanged(folder / name):
                    raise StoreError(
                        f"{name}: was changed during the run: no results were written; run again to go on"
                    )
            with result_set.new_result_set(store) as new:
                drawn = store.statuses(only_drawn=True)  # of the study as it is, not as it was
                _add_drawn(new, store, (drawn[item.name] for item in measured.items if item.name in drawn))
                written = partial(tell, measured, status="written")
                written("tables")
                write_tables(result, new.folder, all_columns=all_columns)
                if write_report is not None:
                    written("report")
                    with closing(LocalExecutor(new.folder, workers, limits)) as executor:
                        write_report(result, new.folder, partial(_draw, new, store, executor), written)
            return result

        try:
            return measure_and_write()
        except DamagedResultError as error:  # found on reading: where one is damaged there may be more
            damaged = store.damaged() or [error.task]
            store.discard([*damaged, *map(item_of, damaged)])  # an item is measured again with its part
            return measure_and_write(damaged)


def _draw(
    new: result_set.NewResultSet,
    store: Store,
    executor: Executor,
    tasks: Iterable[Task],
    on_drawn: Callable[[Task], None],
) -> None:
    """Draw parts of a report into a new result set; each is drawn again only where its key has changed."""
    records = records_of(tasks, executor, store, new.folder, on_drawn)
    for record in records.values():
        if (reason := record.get("reason")) is not None:
            raise FingerpadError(reason)
    _add_drawn(new, store, store.statuses(records).values())


def _notes(measured: Measured, log: CorrectionLog) -> Iterator[str]:
    """Yield what is odd about people's corrections: of other pictures than are there now, or of none."""
    context = measured.items.context
    frames = corrected_frames(measured.sequences, context)
    known = Correctable(context.study)

    def digest(item: str) -> str:
        image = known.image(item)
        return frames.get(item) or "" if image is None else context.digest(context.folder / image)

    yield from map(_REPLACED.format, on_another_image(context.active_corrections, digest))
    yield from map(_NOT_THERE.format, log.unknown_items(context.study))
    yield from (_NOT_THERE.format(item) for item, digest_then in frames.items() if digest_then is None)


def _loading_notes(curves: Iterable[CurveResult]) -> Iterator[str]:
    """Yield which loading data look as if they were in another unit, and which do not count."""
    curves = list(curves)
    known = {one.manifest.finger_and_wedge for one in curves if math.isfinite(one.loading_radius_std)}
    for curve in curves:
        uncertain = math.isfinite(curve.loading_radius) and not math.isfinite(curve.loading_radius_std)
        if uncertain and curve.manifest.finger_and_wedge in known:
            yield f"{curve.name}: does not count beside loading data of known uncertainty: state its own"
        if curve.curve is not None:
            for doubt in unit_doubts(curve.curve.load, curve.curve.indentation, curve.curve.area):
                yield f"{curve.manifest.file}: {doubt}"


def _repeated_files(measured: Measured) -> Iterator[str]:
    """Yield which files are given twice, so that one press would count twice or has two loads."""
    curves = measured.items.context.study.curves
    for (press, _), count in Counter((one.press, one.finger_and_wedge) for one in curves).items():
        if press and count > 1:
            yield "{}: press {} is given {} times, and counts once".format(*press, count)
    for one_press, words in (
        (True, "which counts once: keep one, or say by region_of_interest_px which part of it each is"),
        (False, "of different presses, none of which counts: does it show another contact?"),
    ):
        pictures = [
            f"{joined(one.name for one in same)} are one "
            + ("picture" if isinstance(same[0], Observation) else "sequence")
            for same, of_one_press in measured.repeated
            if of_one_press == one_press
        ]
        if pictures:
            yield f"{joined(pictures, 2)}, {words}"


def _resolution_notes(study: Study, folder: Path) -> Iterator[str]:
    """Yield which contact images state another resolution than the number that the study gives."""
    found: dict[str, list[str]] = {}
    for one in study.observations:
        scale = study.scales.get(one.scale) if isinstance(one.scale, str) else one.scale
        if one.file is None or not isinstance(scale, ResolutionScale | PitchScale):
            continue
        pitch = scale.mm_per_px if isinstance(scale, PitchScale) else MM_PER_INCH / scale.ppi
        if words := other_resolution(read_resolution(folder / one.file), pitch):
            found.setdefault(words, []).append(one.file)
    for words, files in found.items():
        yield f"{joined(files, 1)}: the file {words}"


def _mapped(key: str, columns: Mapping[str, str], name: str, column: str) -> str:
    return f": {columns_in_toml(key, {**columns, name: column})}"


def _column_notes(study: Study, folder: Path) -> Iterator[str]:
    """Yield which columns of tables were not read that look as if they should be."""
    tables: list[tuple[str | None, str, Callable[..., dict[str, list[str]]], Mapping[Any, str]]] = [
        *((one.file, "file_columns", unread_curve_columns, one.file_columns) for one in study.curves),
        *((one.force, "force_columns", unread_force_columns, one.force_columns) for one in study.sequences),
    ]
    for file, key, unread, named in tables:
        columns = {str(name): column for name, column in named.items()}
        try:
            found = unread(folder / file, columns) if file else {}
        except LoadingError:
            continue  # its own result says so
        yield from (f"{file}: {note}" for note in unread_notes(found, partial(_mapped, key, columns)))


def _add_drawn(new: result_set.NewResultSet, store: Store, statuses: Iterable[TaskStatus]) -> None:
    """Add the files that tasks drew, as overlays."""
    for name, digest in (file for status in statuses for file in status.drawn.items()):
        source = store.drawn_file(name, digest)
        if source is None:
            raise StoreError(f"{store.folder / name}: was changed during the run: run again to go on")
        new.add(name, source, digest)


def _refuse_to_overwrite(inputs: list[str], folder: Path, out: Path) -> None:
    """Raise if a file of the study lies where results are written, or the output folder is a sequence's."""
    for name in inputs:
        path = (folder / name).resolve()
        if not path.is_relative_to(out.resolve()):
            continue
        inside = path.relative_to(out.resolve()).parts
        if not inside or inside[0] in result_set.OUTPUT_NAMES or inside[0].startswith("."):
            raise ManifestError(f"{out}: results would be written over {name}; choose another output folder")
