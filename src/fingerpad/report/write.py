"""Writing the report: one page, or where there is too much for one a page over those of the fingers."""

import json
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Final

from fingerpad.exceptions import FingerpadError
from fingerpad.report.page import write_page
from fingerpad.study.durable import keep_files, remove_others
from fingerpad.study.engine.hands import local_hands
from fingerpad.study.engine.runner import run_plans
from fingerpad.study.engine.task import Done, Record, Task, code_digest
from fingerpad.study.results.digest import digest_of_values
from fingerpad.study.results.study_result import StudyResult

REPORT_NAME: Final = "report.html"

# Fingers at angles on one page: more make a page that opens slowly and takes long to draw.
_MOST_GROUPS: Final = 20
_PAGES: Final = "report"
_INDEX: Final = f"{_PAGES}/pages.json"


def write_report(
    result: StudyResult,
    out: Path,
    *,
    workers: int = 1,
    on_drawn: Callable[[str], None] = lambda _: None,
) -> Path:
    """Write ``report.html`` and ``figures/*.svg, *.png`` into `out`, and return the report's path.

    A study of more than 20 fingers at angles has a page for each finger, ``report/FINGER.html``, which is
    drawn again only if what it shows has changed; ``report.html`` tables all and leads to them.

    Parameters
    ----------
    result : StudyResult
        What a run found.
    out : Path
        The run's output folder.
    workers : int
        Number of processes that draw the pages of fingers.
    on_drawn : callable
        Told what has just been drawn: a figure, or how many of the fingers' pages. It may raise
        KeyboardInterrupt: finished pages of fingers are kept.

    Raises
    ------
    FingerpadError
        If a file cannot be written.
    """
    many = len(result.summaries) > _MOST_GROUPS and len(result.fingers) > 1
    tasks = [_task(result.of_finger(name)) for name in result.fingers] if many else []
    known = _known(out)
    index = {task.name: known[task.name] for task in tasks if _is_drawn(task, known, out)}
    _remove_other_files(out, index)

    def keep(task: Task, done: Done) -> None:
        if (reason := done.record.get("reason")) is not None:
            raise FingerpadError(reason)
        index[task.name] = {"key": task.key, "files": sorted(done.pictures)}
        keep_files(out, done.pictures)
        keep_files(out, {_INDEX: json.dumps(index, indent=1).encode()})
        on_drawn(f"{len(index)} of {len(tasks)} fingers")

    with local_hands(out, workers) as hands:
        run_plans((iter([[task]]) for task in tasks), hands, keep, lambda task: task.name in index)
    pages = {task.name: task.file for task in tasks}
    write_page(result, out, REPORT_NAME, overlays=out, pages=pages, on_drawn=on_drawn)
    return out / REPORT_NAME


def _task(part: StudyResult) -> Task:
    """Return the drawing of a finger's page, keyed by all that it shows and by the code that draws."""
    (name,) = part.fingers
    file = f"{_PAGES}/{name}.html"
    shown = replace(part, provenance={**part.provenance, "made": None})
    return Task(
        name=name,
        item=name,
        file=file,
        key=digest_of_values(shown, code_digest("report", "figures", "image", "units.py")),
        work=partial(_draw, part, file),
        inputs=(),
    )


def _draw(part: StudyResult, file: str, results: Path, out: Path) -> Record:
    write_page(part, out, file, overlays=results, home=f"../{REPORT_NAME}")
    return {}


def _known(out: Path) -> dict[str, Any]:
    """Return what was drawn before, as far as it can be told."""
    with suppress(OSError, ValueError):
        known = json.loads((out / _INDEX).read_bytes())
        if isinstance(known, dict):
            return known
    return {}


def _is_drawn(task: Task, known: Mapping[str, Any], out: Path) -> bool:
    """Tell whether a finger's page and all its figures are there as they should be."""
    match known.get(task.name):
        case {"key": task.key, "files": [*files]}:
            return all(isinstance(file, str) and (out / file).is_file() for file in files)
    return False


def _remove_other_files(out: Path, index: Mapping[str, Any]) -> None:
    """Leave the pages and figures that are as they should be, and nothing of earlier runs beside them.

    The report goes too: one that is cut short shall not look finished.
    """
    kept = {file for entry in index.values() for file in entry["files"]} | ({_INDEX} if index else set())
    remove_others(out, (REPORT_NAME, f"{_PAGES}/*.html", _INDEX, "figures/*.png", "figures/*.svg"), kept)
    with suppress(OSError):  # pages are in it, or files that someone keeps there
        (out / _PAGES).rmdir()
