"""Measuring all observations of a study, on one or several processes."""

import signal
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from pathlib import Path

import cv2

from fingerpad.study.manifest import Observation
from fingerpad.study.measure import Measurement, measure_observation


def measure_all(
    observations: list[Observation], folder: Path, out: Path, *, workers: int = 1
) -> Iterator[Measurement]:
    """Yield the measurement of each observation as it is done, in any order.

    Parameters
    ----------
    observations : list of Observation
        What to measure.
    folder, out : Path
        The study folder, and the folder of results.
    workers : int
        Number of processes; one measures in this process.
    """
    workers = min(workers, len(observations))
    if workers <= 1:
        for observation in observations:
            yield measure_observation(observation, folder, out)
        return
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn"), initializer=_start_worker) as pool:
        futures = [pool.submit(measure_observation, row, folder, out) for row in observations]
        for future in as_completed(futures):
            yield future.result()


def _start_worker() -> None:
    """Leave interrupts to the parent, and the other cores to the other workers."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    cv2.setNumThreads(1)
