"""Progress of a run, for people and for logs."""

import json
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, TextIO

from fingerpad._files import explain_write_errors
from fingerpad.exceptions import FingerpadError

if TYPE_CHECKING:
    from rich.progress import Progress as Bar

    from fingerpad.study.engine.runner import Progress

_BEGINNING = '{"time": '


class ProgressDisplay:
    """A bar on the screen, and lines of JSON in a file."""

    def __init__(self, bar: "Bar", log: TextIO | None) -> None:
        self._bar, self._log = bar, log
        self._task = bar.add_task("Looking for what is to be measured", total=None, rate="", failed="")
        self._start, self._before = monotonic(), 0

    def update(self, progress: "Progress") -> None:
        """Show how far a run is."""
        if progress.status == "started":
            self._start, self._before = monotonic(), progress.pictures
        if self._log is not None:
            time = datetime.now(UTC).isoformat(timespec="milliseconds")
            way_out = "what was measured is kept; choose another --log and run again to go on"
            with explain_write_errors(Path(self._log.name), way_out):
                print(json.dumps({"time": time, **asdict(progress)}), file=self._log, flush=True)
        seconds = monotonic() - self._start
        rate = (progress.pictures - self._before) / seconds if seconds > 0 else 0.0
        self._bar.update(
            self._task,
            total=progress.total,
            completed=progress.pictures,
            description=_words(progress),
            rate=f"{rate:.1f} pictures/s" if rate > 0 and progress.status != "written" else "",
            failed=f"{progress.failed} failed" if progress.failed else "",
        )

    def finish(self) -> None:
        """Say that the run has ended."""
        self._bar.update(self._task, description="Done", rate="")


def _words(progress: "Progress") -> str:
    if progress.status == "checked":
        return f"Checked the uncertainty of {progress.item}"
    if progress.status == "written":
        return f"Writing results: {progress.item}"
    if progress.item:
        return f"Measured {progress.file or progress.item}"
    return "Measuring" if progress.pictures < progress.total else "Evaluating"


@contextmanager
def progress_display(log: Path | None) -> Iterator[ProgressDisplay]:
    """Show progress on stderr, and add it to a file if one is given."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    file, console = None if log is None else _opened(log), Console(stderr=True)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}"),
        TimeRemainingColumn(elapsed_when_finished=True),
        TextColumn("[red]{task.fields[failed]}"),
    )
    try:
        # A file in place of a terminal would get the last line of the bar, and an empty one.
        with Progress(*columns, console=console, disable=not console.is_terminal) as bar:
            display = ProgressDisplay(bar, file)
            try:
                yield display
                display.finish()
            except FingerpadError:
                bar.live.transient = True  # the error is printed in place of the bar
                raise
    finally:
        if file is not None:
            with suppress(OSError):  # the error was reported when it occurred
                file.close()


def _opened(log: Path) -> TextIO:
    """Open a log to add to, a new one or that of an earlier run: never a file of the study."""
    with explain_write_errors(log, "choose another --log"):
        file = log.open("a+", encoding="utf-8", errors="replace")
        file.seek(0)
        beginning = file.read(len(_BEGINNING))
    if beginning not in {"", _BEGINNING}:
        file.close()
        raise FingerpadError(f"{log}: is no log of fingerpad's: choose another --log")
    return file
