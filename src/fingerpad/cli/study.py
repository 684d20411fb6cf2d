"""Commands that make and run studies."""

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fingerpad.cli.shared import AsJson, Exit, plain_errors, print_json
from fingerpad.units import value_with_uncertainty

if TYPE_CHECKING:
    from fingerpad.study.results.study_result import StudyResult


def init(
    folder: Annotated[Path, typer.Argument(help="Folder to make, or an empty one.", show_default=False)],
) -> None:
    """Write a commented study manifest to start from."""
    from fingerpad.study.editing.template import write_template

    with plain_errors():
        manifest = write_template(folder)
    typer.echo(f"Wrote {manifest}. Put your pictures beside it, fill it in, then: fingerpad run {manifest}")


def run(
    study: Annotated[Path, typer.Argument(help="The study's manifest.", show_default=False)],
    out: Annotated[Path, typer.Option(help="Folder for tables, figures and report.")] = Path("results"),
    workers: Annotated[int, typer.Option(min=1, help="Number of processes that measure.")] = 1,
    scheduler: Annotated[
        str | None,
        typer.Option(
            help="Dask scheduler whose workers measure, as tcp://host:8786; local starts --workers here.",
            show_default=False,
        ),
    ] = None,
    log: Annotated[
        Path | None,
        typer.Option(help="File to which progress is added, one JSON object a line.", show_default=False),
    ] = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Measure everything anew.")] = False,
) -> None:
    """Run a study: measure, model, pool, and write tables, figures and a report.

    What was measured before is kept in the output folder and measured again only where its picture, its
    parameters or the program have changed. Interrupted, a run finishes what it has in hand; run again, it
    goes on where it stopped.
    """
    from fingerpad.cli.progress import shown_progress
    from fingerpad.report import write_report
    from fingerpad.study.pipeline import run_study
    from fingerpad.study.results.output import write_tables

    with plain_errors(), shown_progress(log) as told:
        result = run_study(
            study, out, workers=workers, scheduler=scheduler, fresh=fresh, on_progress=told.tell
        )
        told.say("Writing tables and report")
        write_tables(result, out)
        report = write_report(result, out, workers=workers, on_drawn=told.tell_drawn)
    _print_outcome(result, report)
    if result.failures:
        raise typer.Exit(Exit.SOME_FAILED)


def status(
    study: Annotated[Path, typer.Argument(help="The study's manifest.", show_default=False)],
    out: Annotated[Path, typer.Option(help="Folder that it was run into.")] = Path("results"),
    as_json: AsJson = False,
) -> None:
    """Tell how much of a study is measured, failed, stale or left."""
    from fingerpad.study.status import study_status

    with plain_errors():
        found = study_status(study, out)
    record = {**asdict(found), "total": found.total, "seconds_left": found.seconds_left}
    if as_json:
        print_json(record)
        return
    for name in ("done", "failed", "stale", "left"):
        cost = found.seconds[name]
        typer.echo(f"{name:<7} {record[name]:>6}" + (f"  {cost:8.0f} s" if cost else ""))
    typer.echo(f"{'total':<7} {record['total']:>6}")


def _print_outcome(result: "StudyResult", report: Path) -> None:
    from fingerpad.report.text import FLAG_WORDS, doubtful_frames, face_differences, in_words

    for summary in result.summaries:
        pooled = summary.corrected_radius
        if pooled is None:
            continue
        label = "  (synthetic)" if summary.synthetic else ""
        typer.echo(
            f"{summary.finger}, wedge {summary.wedge_angle_deg:g}°: corrected radius "
            f"{value_with_uncertainty(pooled.value, pooled.std)} mm from {summary.pooled_from}{label}"
        )
    for finger in result.fingers.values():
        if finger.outlines is not None and finger.outlines.disagree:
            typer.echo(
                f"doubtful: {finger.name}: its faces disagree (p = {finger.outlines.p_value:.2g}): "
                f"{face_differences(finger.outlines)}"
            )
    for row in result.rows.at(~result.rows.known("frame")):
        if row["flags"]:
            typer.echo(f"doubtful: {row['observation']}: {', '.join(in_words(row['flags'], FLAG_WORDS))}")
    for name, count, words in doubtful_frames(result):
        typer.echo(f"doubtful: {name}: {words} in {count} of its frames")
    for note in result.notes:
        typer.echo(f"note: {note}", err=True)
    for failure in result.failures:
        typer.echo(f"failed: {failure}", err=True)
    typer.echo(f"Report: {report}")
