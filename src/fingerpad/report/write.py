"""Writing the report: one page, or for many fingers an index and a page for each."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Final

from fingerpad._digest import digest_of_values
from fingerpad._files import file_stem
from fingerpad.study.engine.task import Record, Task, code_digest
from fingerpad.study.results.study_result import StudyResult

REPORT_NAME: Final = "report.html"

# Fingers at angles on one page: more make a page that opens slowly and takes long to draw.
_MOST_GROUPS: Final = 20
_PAGES: Final = "report"


def write_report(
    result: StudyResult,
    folder: Path,
    draw: Callable[[Iterable[Task], Callable[[Task], None]], None] | None = None,
    on_drawn: Callable[[str], None] = lambda _: None,
) -> Path:
    """Write ``report.html`` and ``figures/*.svg, *.json`` into the folder of the run's overlays.

    A study of more than 20 fingers at angles has a page for each finger, ``report/FINGER.html``, which `draw`
    performs as tasks and calls back; ``report.html`` tables all and links to them. `on_drawn` is called with
    the name of each figure and page, and may raise KeyboardInterrupt.
    """
    many = len(result.summaries) > _MOST_GROUPS and len(result.fingers) > 1
    pages = {name: f"{_PAGES}/{file_stem(name)}.html" for name in (result.fingers if many else ())}
    # One by one: what was found of all fingers is as large as what was found of the study.
    tasks = (_task(result.of_finger(name), page) for name, page in pages.items())
    (draw or partial(_draw_here, folder))(tasks, lambda task: on_drawn(f"page of {task.item}"))
    _write_page(result, folder, REPORT_NAME, overlays=folder, pages=pages, on_drawn=on_drawn)
    return folder / REPORT_NAME


def _draw_here(folder: Path, tasks: Iterable[Task], on_drawn: Callable[[Task], None]) -> None:
    for task in tasks:
        task.work(folder, folder)
        on_drawn(task)


def _task(part: StudyResult, file: str) -> Task:
    """Return the drawing of a finger's page, keyed by all that it shows and by the code that draws."""
    (name,) = part.fingers
    # The table of all summaries is that of the rows: it is digested once.
    summaries = [replace(one, table=part.rows[[]]) for one in part.summaries]
    shown = replace(part, summaries=summaries, provenance={**part.provenance, "made": None})
    return Task(
        name=f"/page {name}",  # no item's name begins like this
        item=name,
        file=file,
        key=digest_of_values(
            shown,
            code_digest("report", "figures", "image", "simulator", "units.py", "study/results/output.py"),
        ),
        work=partial(_draw, part, file),
        inputs=(),
    )


def _draw(part: StudyResult, file: str, results: Path, out: Path) -> Record:
    _write_page(part, out, file, overlays=results, home=f"../{REPORT_NAME}")
    return {}


def _write_page(result: StudyResult, out: Path, file: str, **options: Any) -> None:
    # What draws takes 15 MB, which a large study has no room for until its tables are written.
    from fingerpad.report.page import write_page

    write_page(result, out, file, **options)
