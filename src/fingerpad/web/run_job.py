"""The run of a study on its own thread, with progress events and cancellation."""

import time
from collections.abc import Callable
from contextlib import suppress
from threading import Event, Lock, Thread
from typing import Any, Final

from fingerpad.exceptions import FingerpadError
from fingerpad.report import write_report
from fingerpad.study.engine.runner import Progress
from fingerpad.study.results.study_result import StudyResult
from fingerpad.web.answers import RequestError
from fingerpad.web.events import Events, RunStatus

_INTERVAL_S: Final = 0.2
_ACTIVE: Final = frozenset(("running", "cancelling"))


class RunJob:
    """Runs of a study, one at a time."""

    def __init__(self, events: Events) -> None:
        self._events = events
        self._now = RunStatus()
        self._started = self._sent_at = 0.0
        self._before = 0
        self._stop, self._lock = Event(), Lock()
        self._thread: Thread | None = None

    def describe(self) -> RunStatus:
        """Return the status of the run."""
        with self._lock:
            active = {"seconds": time.monotonic() - self._started} if self._now.state in _ACTIVE else {}
            return RunStatus.of(self._now, **active)

    def start(self, run: Callable[..., StudyResult], when_done: Callable[[], None]) -> RunStatus:
        """Start a run: `run_study` with the study and the options."""
        with self._lock:
            if self._now.state in _ACTIVE:
                raise RequestError.conflict("a run is in progress: wait for it to end, or cancel it")
            self._now = RunStatus(state="running", phase="measuring", version=self._now.version + 1)
            self._started, self._sent_at = time.monotonic(), 0.0
            self._stop.clear()
            self._thread = Thread(target=self._work, args=(run, when_done), name="run", daemon=True)
            self._thread.start()
        self._events.send(self.describe())
        return self.describe()

    def cancel(self) -> RunStatus:
        """Cancel the run; finished measurements are kept."""
        with self._lock:
            if self._now.state == "running":
                self._change(state="cancelling")
                self._stop.set()
        return self.describe()

    def wait(self, timeout_s: float | None = None) -> None:
        """Wait for the run to end."""
        if self._thread is not None:
            self._thread.join(timeout_s)

    def _work(self, run: Callable[..., StudyResult], when_done: Callable[[], None]) -> None:
        end: dict[str, Any] = {"state": "failed"}
        try:
            result = run(write_report=write_report, on_progress=self._progress)
            end = {"state": "done", "failures": result.failures}
        except KeyboardInterrupt:
            end = {"state": "cancelled"}
        except (FingerpadError, OSError) as error:
            end["error"] = str(error)
        except Exception as error:  # a bug: the terminal shows the traceback
            end["error"] = f"the run ended with a fault ({type(error).__name__}: {error})"
            raise
        finally:
            with suppress(Exception):
                when_done()
            end |= {"phase": None, "current": "", "file": "", "seconds": time.monotonic() - self._started}
            self._set(**end, due=True)

    def _progress(self, now: Progress) -> None:
        """Record the progress of the run, and stop it if it was cancelled."""
        if now.status == "written":
            phase = {"phase": now.item} if now.item in {"tables", "report"} else {}
            self._set(current=now.item, file="", **phase, due=bool(phase))
        else:
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
        if self._stop.is_set():
            raise KeyboardInterrupt

    def _set(self, *, due: bool = False, **changes: Any) -> None:
        """Change the status, and send it where that is due, or none was sent for a while."""
        with self._lock:
            self._change(**changes)
            now = time.monotonic()
            due = due or now - self._sent_at > _INTERVAL_S
            self._sent_at = now if due else self._sent_at
        if due:
            self._events.send(self.describe())

    def _change(self, **changes: Any) -> None:
        self._now = self._now.model_copy(update={**changes, "version": self._now.version + 1})
