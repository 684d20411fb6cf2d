"""Measuring on several processes, resuming, and long sequences."""

import json
import multiprocessing
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
import tifffile

from benchmarks.memory import peak_mb, peak_of_children_mb
from fingerpad.report import write_report
from fingerpad.simulate import render_sequence
from fingerpad.study.engine.runner import Progress
from fingerpad.study.engine.store import STORE_NAME, Store
from fingerpad.study.engine.task import DEFAULT_LIMITS, TaskResult, perform
from fingerpad.study.manifest.load import read_study
from fingerpad.study.manifest.models import Study
from fingerpad.study.measuring.context import RunContext
from fingerpad.study.measuring.scales import FoundScale, scale_from, scale_record, scale_tables
from fingerpad.study.measuring.sequences import SequenceItem, header_task
from fingerpad.study.pipeline import run_study
from fingerpad.study.status import study_status

FPS = 500
_FINGER = """
[[fingers]]
name = "finger_{number}"
semi_axes_mm = {{ palmar = 7.9, distal = 13.8, radial_ulnar = 11.8 }}
semi_axes_mm_std = {{ palmar = 0.1, distal = 0.1, radial_ulnar = 0.1 }}
synthetic = true
"""
_SEQUENCE = """
[[sequences]]
name = "sequence_{number}"
finger = "finger_{finger}"
wedge_angle_deg = {wedge}
file = "sequence_{number}.tif"
force = "force_{number}.csv"
scale = {{ ppi = {ppi} }}
frames_per_second = 500
synthetic = true
"""


def make_study(folder: Path, *, sequences: int, frames: int, ppi: float, size: float = 1.0) -> Path:
    """Write a study of synthetic sequences, each of a rendered press, and return its manifest."""
    rendered = min(frames, 40)
    loads = np.interp(np.arange(rendered), [0, rendered // 2, rendered - 1], [0.05, 2 * size, 0.05])
    press = render_sequence(loads, radii=(14.3 * size, 13.0 * size), reduced_modulus=0.09, ppi=ppi, seed=1)
    pages = [press.pixels(k) for k in range(rendered)]
    stretched = np.arange(frames) * rendered // frames
    for number in range(sequences):
        with tifffile.TiffWriter(folder / f"sequence_{number}.tif") as writer:
            for page in stretched:
                writer.write(pages[page], contiguous=False)
        rows = "\n".join(f"{k / FPS},{loads[page]}" for k, page in enumerate(stretched))
        (folder / f"force_{number}.csv").write_text(f"time_s,force_N\n{rows}\n", encoding="ascii")
    fingers = "".join(_FINGER.format(number=number) for number in range(5))
    tables = "".join(
        _SEQUENCE.format(number=number, finger=number % 5, wedge=(15, 45)[number // 5 % 2], ppi=ppi)
        for number in range(sequences)
    )
    manifest = folder / "study.toml"
    manifest.write_text(f'title = "Synthetic sequences"\n{fingers}{tables}', encoding="utf-8")
    return manifest


def engines(sequences: int = 4, frames: int = 1500) -> None:
    """Print frames a second of one process, of two, and of two workers of Dask, and what keeping costs."""
    print(f"\nMeasuring {sequences * frames:,} frames of 614 x 582 px, start of processes included")
    with tempfile.TemporaryDirectory() as folder:
        manifest = make_study(Path(folder), sequences=sequences, frames=frames, ppi=1000)
        rates: dict[str, float] = {}
        for name, options in (
            ("one process", {}),
            ("two processes", {"workers": 2}),
            ("Dask, two workers", {"workers": 2, "scheduler": "local"}),
        ):
            seconds, spent = _timed(manifest, Path(folder) / name, **options)
            rates[name] = sequences * frames / seconds
            aside = f", {100 * (seconds / spent - 1):.1f} % of it beside measuring (asked: 5)"
            print(f"    {name:<18} {rates[name]:6.1f} frames/s{aside if not options else ''}")
        pool = rates["two processes"]
        print(f"    two processes over one: {pool / rates['one process']:.2f} (asked: 1.85)")
        print(f"    Dask over two processes: {rates['Dask, two workers'] / pool:.2f} (asked: 0.85)")


def _timed(manifest: Path, out: Path, **options: Any) -> tuple[float, float]:
    """Return the seconds of a run's measuring, and those that its tasks took."""
    reported: list[tuple[float, Progress]] = []

    def report(now: Progress) -> None:
        if now.status not in {"checked", "written"}:
            reported.append((time.perf_counter(), now))

    run_study(manifest, out, on_progress=report, **options)
    return reported[-1][0] - reported[0][0], sum(one.seconds for _, one in reported)


def long_sequence(short: int = 200, long: int = 20_000) -> None:
    """Print the peak memory of measuring a short and a long TIFF, parent and workers."""
    print("\nPeak memory of measuring a TIFF of small frames with two processes")
    peaks = {frames: _in_child(_sequence_memory, frames) for frames in (short, long)}
    for frames, (seconds, own, worker) in peaks.items():
        print(
            f"    {frames:6,} frames: this process {own:.0f} MB, the larger worker {worker:.0f} MB, "
            f"{frames / seconds:.0f} frames/s"
        )
    more = [peaks[long][k] - peaks[short][k] for k in (1, 2)]
    print(f"    the long one needs {more[0]:.0f} and {more[1]:.0f} MB more (asked: 100)")


def _sequence_memory(frames: int) -> tuple[float, float, float]:
    with tempfile.TemporaryDirectory() as folder:
        manifest = make_study(Path(folder), sequences=1, frames=frames, ppi=240, size=0.4)
        seconds, _ = _timed(manifest, Path(folder) / "out", workers=2)
        return seconds, peak_mb(), peak_of_children_mb()


def stored_study(sequences: int = 50, frames: int = 2000) -> None:
    """Print what a finished study of many frames costs: its status, and a run that measures nothing."""
    print(f"\nA finished study of {sequences} sequences, {sequences * frames:,} frames")
    with tempfile.TemporaryDirectory() as folder:
        manifest = make_study(Path(folder), sequences=sequences, frames=frames, ppi=240, size=0.4)
        out = Path(folder) / "out"
        _fill(manifest, out)
        start = time.perf_counter()
        status = study_status(manifest, out)
        seconds = time.perf_counter() - start
        print(f"    status: {seconds:.2f} s (asked: 1), done {status.done} of {status.total}")
        rows, spent, peak = _in_child(_again, manifest, out)
        print(
            f"    run again: {rows:,} rows, tables and report in {spent:.0f} s, {peak:.0f} MB at most "
            f"(asked: 300); store {(out / STORE_NAME).stat().st_size / 1e6:.0f} MB"
        )


def _again(manifest: Path, out: Path) -> tuple[int, float, float]:
    start = time.perf_counter()
    result = run_study(manifest, out, write_report=write_report)
    return len(result.rows), time.perf_counter() - start, peak_mb()


def measured_scales(study: Study, folder: Path) -> dict[str, FoundScale | str]:
    """Return every scale of a study, or why there is none."""
    return {
        key: scale_from(scale_record(name, table, folder, folder))
        for key, (name, table) in scale_tables(study).items()
    }


def _fill(manifest: Path, out: Path) -> None:
    """Measure the first sequence, and store its results for the others, which show the same."""
    out.mkdir()
    study, folder = read_study(manifest), manifest.parent
    first = study.sequences[0].name
    with Store.writing(out / STORE_NAME) as store:
        context = RunContext.of(study, folder, {}, store)
        context = replace(context, scales=measured_scales(study, folder))
        records: dict[str, str] = {}
        for sequence in study.sequences:
            header = header_task(sequence, context)
            stages = SequenceItem(context=context, name=sequence.name, table=sequence).stages()
            for task in chain([header], chain.from_iterable(stages)):
                like = task.name.replace(sequence.name, first, 1)
                if like not in records:
                    record = perform(task.work, task.file, folder, DEFAULT_LIMITS).record
                    records[like] = json.dumps(record | ({"overlays": []} if "overlays" in record else {}))
                record = json.loads(records[like].replace(first, sequence.name))
                store.put(task.name, task.key, TaskResult(record, {}, 1.0), count=task.pictures)


def _in_child(work: Any, *args: Any) -> Any:
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        return pool.submit(work, *args).result()


def report() -> None:
    """Print time and memory of engines, of one long sequence, and of a study that is stored."""
    engines()
    long_sequence()
    stored_study()
