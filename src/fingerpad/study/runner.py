"""Measuring all contacts of a study, on one or several processes."""

import signal
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from time import perf_counter

import cv2

from fingerpad.study.manifest import Contact, ContactSequence, Observation
from fingerpad.study.measure import Measurement, measure_observation
from fingerpad.study.scales import FoundScale
from fingerpad.study.sequences import SequenceResult, measure_contact_sequence


@dataclass(frozen=True, slots=True, kw_only=True)
class Measured:
    """What one contact of the manifest gave.

    Attributes
    ----------
    contact : str
        Name of the observation or sequence.
    measurements : list of Measurement
        One for an observation, one for each frame in contact of a sequence.
    sequence : SequenceResult or None
        What the film comes to, if it is one.
    seconds : float
        What measuring it took.
    """

    contact: str
    measurements: list[Measurement]
    sequence: SequenceResult | None = None
    seconds: float = 0.0

    @property
    def failed(self) -> bool:
        """Whether nothing of it could be measured."""
        return all(each.reason is not None for each in self.measurements) and bool(self.measurements)


def measure_all(
    contacts: Sequence[Contact],
    scales: Mapping[str, FoundScale | str],
    folder: Path,
    out: Path,
    *,
    workers: int = 1,
    on_frame: Callable[[], None] = lambda: None,
) -> Iterator[Measured]:
    """Yield the measurement of each contact as it is done, in any order.

    Parameters
    ----------
    contacts : sequence of Contact
        What to measure.
    scales : mapping
        The study's named scales.
    folder, out : Path
        The study folder, and the folder of results.
    workers : int
        Number of processes; one measures in this process.
    on_frame : callable
        Called after each frame of a sequence that is measured in this process.
    """
    workers = min(workers, len(contacts))
    if workers <= 1:
        for contact in contacts:
            yield _measure(contact, scales, folder, out, on_frame)
        return
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn"), initializer=_start_worker) as pool:
        # The longest first, so that no process is left alone with a film.
        ordered = sorted(contacts, key=lambda contact: isinstance(contact, Observation))
        waiting = {pool.submit(_measure, contact, scales, folder, out) for contact in ordered}
        try:
            for future in as_completed(tuple(waiting)):
                waiting.discard(future)
                yield future.result()
        except KeyboardInterrupt:
            # What is in hand is finished and kept.
            pool.shutdown(cancel_futures=True)
            yield from (future.result() for future in waiting if not future.cancelled())
            raise


def _measure(
    contact: Contact,
    scales: Mapping[str, FoundScale | str],
    folder: Path,
    out: Path,
    on_frame: Callable[[], None] = lambda: None,
) -> Measured:
    start, film = perf_counter(), None
    if isinstance(contact, ContactSequence):
        film, measurements = measure_contact_sequence(contact, scales, folder, out, on_frame)
    else:
        measurements = [measure_observation(contact, scales, folder, out)]
    return Measured(
        contact=contact.name, measurements=measurements, sequence=film, seconds=perf_counter() - start
    )


def _start_worker() -> None:
    """Leave interrupts to the parent, and the other cores to the other workers."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    cv2.setNumThreads(1)
