"""The run of a study on a thread of its own: its progress for all who listen, and its end by request."""

import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from threading import Event, Lock, Thread
from typing import Any, Final

from fingerpad.exceptions import FingerpadError
from fingerpad.report import write_report
from fingerpad.study.engine.progress import Progress
from fingerpad.study.pipeline import Draw, run_study
from fingerpad.study.results.study_result import StudyResult
from fingerpad.web.errors import RequestError
from fingerpad.web.events import Events

_EVERY_S: Final = 0.2
# Matplotlib's settings belong to the process: one report at a time, also while a closed study ends its run.
_DRAWING: Final = Lock()
_AT_WORK: Final = frozenset(("running", "cancelling"))
_NOTHING: Final[dict[str, Any]] = {
    "state": "idle",
    "phase": None,
    "total": 0,
    "done": 0,
    "failed": 0,
    "current": "",
    "file": "",
    "seconds": 0.0,
    "seconds_left": None,
    "error": None,
    "failures": [],
    "version": 0,  # counts the changes, so that a page knows an older answer from a newer one
}


def _write_report(result: StudyResult, folder: Path, draw: Draw, on_drawn: Callable[[str], None]) -> None:
    with _DRAWING:
        write_report(result, folder, draw, on_drawn)


class RunJob:
    """One run at a time."""

    def __init__(self, events: Events) -> None:
        self._events = events
        self._now = dict(_NOTHING)
        self._started = self._told = 0.0
        self._before = 0
        self._stop = Event()
        self._lock = Lock()
        self._thread: Thread | None = None

    def describe(self) -> dict[str, Any]:
        """Return how far the run is."""
        with self._lock:
            now = dict(self._now)
        if now["state"] in _AT_WORK:
            now["seconds"] = time.monotonic() - self._started
        return now

    def start(
        self, manifest: Path, out: Path, *, workers: int, fresh: bool, when_done: Callable[[], None]
    ) -> dict[str, Any]:
        """Begin a run."""
        with self._lock:
            if self._now["state"] in _AT_WORK:
                raise RequestError.conflict("a run is at work: wait for it to end, or cancel it")
            begun = {"state": "running", "phase": "measuring", "version": self._now["version"] + 1}
            self._now = {**_NOTHING, **begun}
            self._started, self._told = time.monotonic(), 0.0
            self._stop.clear()
            self._thread = Thread(
                target=self._work, args=(manifest, out, workers, fresh, when_done), name="run", daemon=True
            )
            self._thread.start()
        self._tell()
        return self.describe()

    def cancel(self) -> dict[str, Any]:
        """Ask the run to stop; what it has measured is kept."""
        with self._lock:
            if self._now["state"] == "running":
                self._now |= {"state": "cancelling", "version": self._now["version"] + 1}
                self._stop.set()
        return self.describe()

    def wait(self, timeout_s: float | None = None) -> None:
        """Wait for the run to end."""
        if self._thread is not None:
            self._thread.join(timeout_s)

    def _work(
        self, manifest: Path, out: Path, workers: int, fresh: bool, when_done: Callable[[], None]
    ) -> None:
        end: dict[str, Any] = {"state": "failed"}
        try:
            result = run_study(
                manifest,
                out,
                workers=workers,
                fresh=fresh,
                write_report=_write_report,
                on_progress=self._progress,
            )
            end = {"state": "done", "failures": result.failures}
        except KeyboardInterrupt:
            end = {"state": "cancelled"}
        except (FingerpadError, OSError) as error:
            end = {"state": "failed", "error": str(error)}
        except Exception as error:  # a fault of the program: the terminal shows where
            end = {
                "state": "failed",
                "error": f"the run ended with a fault ({type(error).__name__}: {error})",
            }
            raise
        finally:
            with suppress(Exception):
                when_done()
            self._set(
                **end, phase=None, current="", file="", seconds=time.monotonic() - self._started, told=True
            )

    def _go_on(self) -> None:
        if self._stop.is_set():
            raise KeyboardInterrupt

    def _progress(self, now: Progress) -> None:
        """Take note of how far the run is, and stop it where that was asked for."""
        if now.status == "written":
            if now.item in {"tables", "report"}:
                self._set(phase=now.item)
            self._set(current=now.item, file="")
            self._go_on()
            return
        if now.status == "started":
            self._before = now.pictures
        gone, new = time.monotonic() - self._started, now.pictures - self._before
        self._set(
            total=now.total,
            done=now.pictures,
            failed=now.failed,
            current=now.item,
            file=now.file,
            seconds_left=gone / new * (now.total - now.pictures) if new else None,
        )
        self._go_on()

    def _set(self, *, told: bool = False, **changes: Any) -> None:
        with self._lock:
            self._now |= {**changes, "version": self._now["version"] + 1}
            now = time.monotonic()
            due = told or "phase" in changes or now - self._told > _EVERY_S
            self._told = now if due else self._told
        if due:
            self._tell()

    def _tell(self) -> None:
        self._events.send("run", self.describe())
