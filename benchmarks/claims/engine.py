"""Measuring on several processes, resuming, and long sequences."""

import json
import multiprocessing
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from itertools import chain
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import tifffile
import tomlkit

from benchmarks.cost import peak_mb, peak_of_children_mb
from benchmarks.tables import table
from fingerpad.simulate import render_sequence
from fingerpad.study.engine.runner import Progress
from fingerpad.study.engine.store import STORE_NAME, Store
from fingerpad.study.engine.task import DEFAULT_LIMITS, TaskResult, perform
from fingerpad.study.manifest.load import read_study
from fingerpad.study.measuring.context import RunContext, scale_from, scale_record, scale_tables
from fingerpad.study.measuring.sequences import SequenceItem, header_task
from fingerpad.study.pipeline import run_study
from fingerpad.study.status import study_status

FPS = 500
AXES = {"palmar": 7.9, "distal": 13.8, "radial_ulnar": 11.8}
Row: TypeAlias = tuple[str, str, str]  # what, measured, asked for


def make_study(folder: Path, *, sequences: int, frames: int, ppi: float, size: float = 1.0) -> Path:
    """Write a study of synthetic sequences, each of a rendered press, and return its manifest."""
    rendered = min(frames, 40)
    loads = np.interp(np.arange(rendered), [0, rendered // 2, rendered - 1], [0.05, 2 * size, 0.05])
    press = render_sequence(loads, radii=(14.3 * size, 13.0 * size), reduced_modulus=0.09, ppi=ppi, seed=1)
    pages = [press.pixels(k) for k in range(rendered)]
    stretched = np.arange(frames) * rendered // frames
    same, tables = {"scale": {"ppi": ppi}, "frames_per_second": FPS, "synthetic": True}, []
    for number in range(sequences):
        name = f"sequence_{number}"
        files = {"name": name, "file": f"{name}.tif", "force": f"force_{number}.csv"}
        with tifffile.TiffWriter(folder / files["file"]) as writer:
            for page in stretched:
                # Files that are the same would count as one press.
                writer.write(pages[page], contiguous=False, description=f"press {number}")
        rows = "\n".join(f"{k / FPS},{loads[page]}" for k, page in enumerate(stretched))
        (folder / files["force"]).write_text(f"time_s,force_N\n{rows}\n", encoding="ascii")
        of = {"finger": f"finger_{number % 5}", "wedge_angle_deg": (15, 45)[number // 5 % 2]}
        tables.append(same | files | of)
    given = {"semi_axes_mm": AXES, "semi_axes_mm_std": dict.fromkeys(AXES, 0.1), "synthetic": True}
    fingers = [{"name": f"finger_{number}", **given} for number in range(5)]
    study = {"title": "Synthetic sequences", "fingers": fingers, "sequences": tables}
    manifest = folder / "study.toml"
    manifest.write_text(tomlkit.dumps(study), encoding="utf-8")
    return manifest


def engines(sequences: int = 4, frames: int = 1500) -> Iterator[Row]:
    """Yield how one process, two, and two workers of Dask compare, and what keeping costs."""
    with tempfile.TemporaryDirectory() as folder:
        manifest = make_study(Path(folder), sequences=sequences, frames=frames, ppi=1000)
        one, spent = _timed(manifest, Path(folder) / "one")
        two, _ = _timed(manifest, Path(folder) / "two", workers=2)
        dask, _ = _timed(manifest, Path(folder) / "dask", workers=2, scheduler="local")
    yield "frames of 614 × 582 px a second, two processes", f"{sequences * frames / two:.0f}", "–"
    yield "two processes over one", f"{one / two:.2f}", "1.85"
    yield "Dask with two workers, over two processes", f"{two / dask:.2f}", "0.85"
    yield "keys, store and overlays, over measuring", f"{100 * (one / spent - 1):.1f} %", "5 %"


def _timed(manifest: Path, out: Path, **options: Any) -> tuple[float, float]:
    """Return the seconds of a run's measuring, and those that its tasks took."""
    reported: list[tuple[float, Progress]] = []

    def report(now: Progress) -> None:
        if now.status not in {"checked", "written"}:
            reported.append((time.perf_counter(), now))

    run_study(manifest, out, on_progress=report, **options)
    return reported[-1][0] - reported[0][0], sum(one.seconds for _, one in reported)


def long_sequence(short: int = 200, long: int = 20_000) -> Iterator[Row]:
    """Yield what a long TIFF of small frames takes beyond a short one, parent and workers."""
    more = np.subtract(_in_child(_sequence_memory, long), _in_child(_sequence_memory, short))
    what = f"memory of {long:,} frames of a TIFF beyond that of {short}: parent, worker"
    yield what, f"{more[0]:.0f}, {more[1]:.0f} MB", "100 MB"


def _sequence_memory(frames: int) -> tuple[float, float]:
    with tempfile.TemporaryDirectory() as folder:
        manifest = make_study(Path(folder), sequences=1, frames=frames, ppi=240, size=0.4)
        run_study(manifest, Path(folder) / "out", workers=2)
        return peak_mb(), peak_of_children_mb()


def stored_study(sequences: int = 50, frames: int = 2000) -> Iterator[Row]:
    """Yield what a finished study of many frames costs: its status, and a run that measures nothing."""
    what = f"of a finished study of {sequences * frames:,} frames"
    with tempfile.TemporaryDirectory() as folder:
        manifest = make_study(Path(folder), sequences=sequences, frames=frames, ppi=240, size=0.4)
        out = Path(folder) / "out"
        _fill(manifest, out)
        start = time.perf_counter()
        study_status(manifest, out)
        yield f"`status` {what}", f"{time.perf_counter() - start:.2f} s", "1 s"
        start = time.perf_counter()
        command = [sys.executable, "-c", _RUN, "run", str(manifest), "--out", str(out)]
        peak = float(subprocess.run(command, check=True, capture_output=True).stdout.split()[-1])
        seconds = time.perf_counter() - start
        yield f"another run {what}: tables and report", f"{seconds:.0f} s, {peak:.0f} MB", "–, 300 MB"


# The command line, and its memory below what it prints.
_RUN = "from benchmarks.cost import peak_mb; from fingerpad.__main__ import _run; _run(); print(peak_mb())"


def _fill(manifest: Path, out: Path) -> None:
    """Measure the first sequence, and store its results for the others, which show the same."""
    out.mkdir()
    study, folder = read_study(manifest), manifest.parent
    first = study.sequences[0].name
    with Store.writing(out / STORE_NAME) as store:
        scales = {
            key: scale_from(scale_record(name, table, folder, folder))
            for key, (name, table) in scale_tables(study).items()
        }
        context = RunContext(study=study, folder=folder, store=store, scales=scales)
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
    table(("", "measured", "target"), chain(engines(), long_sequence(), stored_study()))
