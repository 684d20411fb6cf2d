"""Commands that create, run and open studies."""

import sys
import webbrowser
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import typer
from typer import Argument, Option

import fingerpad as fp
from fingerpad.cli import options, show
from fingerpad.cli.commands import Exit
from fingerpad.exceptions import FingerpadError, ManifestError
from fingerpad.study.engine.task import DEFAULT_LIMITS, Limits

if TYPE_CHECKING:
    from fingerpad.web.app import Launch

Manifest: TypeAlias = Annotated[Path, Argument(help="The study's manifest.", show_default=False)]
Out: TypeAlias = Annotated[
    Path | None, Option(help="Output folder.", show_default="results beside the manifest")
]


def init(
    folder: Annotated[Path, Argument(help="Folder of the study, made if missing.", show_default=False)],
    example: Annotated[
        bool, Option("--example", help="Write a small synthetic study that runs as it is.")
    ] = False,
    from_files: Annotated[
        bool, Option("--from-files", help="Write the manifest of the files that lie in the folder.")
    ] = False,
    finger: Annotated[
        str, Option(help="With --from-files, the finger of files that name none.", show_default=False)
    ] = "",
    scale: Annotated[
        str,
        Option(
            help="With --from-files, the scale of contact images, as '500 ppi' or '0.05 mm/px', where no "
            "spreadsheet states it.",
            show_default=False,
        ),
    ] = "",
    wedge_deg: Annotated[
        float | None,
        Option(min=0, max=90, help="With --from-files, the wedge angle of files that state none: 0 is flat."),
    ] = None,
) -> None:
    """Write a commented study manifest to start from, an example study, or the study of a folder's files."""
    from fingerpad.study.editing.template import write_example, write_template

    for flag, value in (("--finger", finger), ("--scale", scale), ("--wedge-deg", wedge_deg)):
        if value not in ("", None) and not from_files:
            raise ManifestError(f"{flag} is that of files: give --from-files with it")
    if from_files and example:
        raise ManifestError("--example and --from-files write different studies: give one of them")
    if from_files:
        _begin(folder, finger=finger, scale=scale, wedge_angle_deg=wedge_deg)
    elif example:
        typer.echo(f"Wrote a synthetic study. Run it: fingerpad run {write_example(folder)}")
    else:
        manifest = write_template(folder)
        typer.echo(
            f"Wrote {manifest}. Its finger and contact are examples: replace them, remove their lines "
            f"`synthetic = true`, put your pictures beside it, then: fingerpad run {manifest}"
        )


def _begin(folder: Path, **of_files: Any) -> None:
    """Write the manifest of the files in a folder, and say what is taken, guessed and not known."""
    from fingerpad.study.manifest.load import STUDY_NAME
    from fingerpad.study.new_files import start_study

    found, manifest = start_study(folder, **of_files), folder / STUDY_NAME
    lacking = [": ".join(filter(None, (f"{one.kind} {one.key}".strip(), one.words))) for one in found.missing]
    for title, lines in {
        "Taken": [f"{file}: {words}" for file, words in found.taken.items()],
        "Guessed, to be checked": found.guesses,
        "Not taken": [f"{file}: {words}" for file, words in found.left.items()],
        "Missing": lacking,
    }.items():
        if lines:
            typer.echo("\n  ".join([f"{title}:", *lines]))
    rest = "Enter what is missing, then: " if found.loaded.issues else "Run it: "
    typer.echo(f"Wrote {manifest}. {rest}fingerpad run {manifest}")


def run(
    study: Manifest,
    out: Out = None,
    workers: Annotated[int, Option(min=1, help="Number of processes that measure.")] = 1,
    scheduler: Annotated[
        str | None,
        Option(
            help="Dask scheduler whose workers measure, as tcp://host:8786; local starts --workers here.",
            show_default=False,
        ),
    ] = None,
    log: Annotated[
        Path | None,
        Option(help="File to which progress is added, one JSON object a line.", show_default=False),
    ] = None,
    force: Annotated[bool, Option("--force", help="Re-measure all.")] = False,
    incomplete: Annotated[
        bool, Option("--incomplete", help="Run what is complete, and name what is left out.")
    ] = False,
    all_columns: Annotated[
        bool, Option("--all-columns", help="Write also the columns that few ask for.")
    ] = False,
    time_limit_s: Annotated[
        float, options.positive("Time that measuring one picture may take, s.")
    ] = DEFAULT_LIMITS.seconds,
    memory_gb: Annotated[
        float, options.positive("Memory that measuring one picture may take, GB (enforced on Linux).")
    ] = DEFAULT_LIMITS.memory_gb,
) -> None:
    """Run a study: measure, model, pool, and write tables, figures and a report.

    What was measured before is kept in the output folder and measured again only where its picture, its
    parameters or the program have changed. Interrupted, a run finishes the tasks in progress; run again, it
    goes on where it stopped.
    """
    # pandas loads pyarrow wherever that is installed, 34 MB that no run uses.
    sys.modules.setdefault("pyarrow", None)  # type: ignore[arg-type]
    from fingerpad.cli.progress import progress_display
    from fingerpad.report import write_report
    from fingerpad.report.terminal import outcome_lines, outcome_notes
    from fingerpad.report.write import REPORT_NAME
    from fingerpad.study.results.result_set import results_folder

    with progress_display(log) as progress:
        try:
            result = fp.run_study(
                study,
                out,
                workers=workers,
                scheduler=scheduler,
                force=force,
                incomplete=incomplete,
                all_columns=all_columns,
                limits=Limits(seconds=time_limit_s, memory_gb=memory_gb),
                write_report=write_report,
                on_progress=progress.update,
            )
        except KeyboardInterrupt:
            show.error("interrupted; what was measured is kept: run it again to go on")
            raise typer.Exit(Exit.INTERRUPTED) from None
    for line in outcome_lines(result):
        typer.echo(line)
    for note in outcome_notes(result):
        show.note(note)
    for failure in result.failures:
        typer.echo(f"failed: {failure}", err=True)
    typer.echo(f"Report: {(out or results_folder(study)) / REPORT_NAME}")
    if result.failures:
        raise typer.Exit(Exit.SOME_FAILED)


def status(study: Manifest, out: Out = None, as_json: options.AsJson = False) -> None:
    """Show how much of a study is measured, failed, stale or left."""
    from fingerpad.study.status import study_status

    found = study_status(study, out)
    record = {**asdict(found), "total": found.total, "seconds_left": found.seconds_left}

    def print_text(_: object) -> None:
        for name in ("done", "failed", "stale", "left"):
            cost = found.seconds[name]
            typer.echo(f"{name:<7} {getattr(found, name):>6}" + (f"  {cost:8.0f} s" if cost else ""))
        typer.echo(f"{'total':<7} {found.total:>6}")
        for item in found.failed_items:
            typer.echo(f"failed: {item}")
        for fault in found.faults:
            typer.echo(f"fault: {fault}", err=True)

    show.result(record, as_json, print_text)
    if found.faults:
        raise typer.Exit(Exit.SOME_FAILED)


def verify(study: Manifest, out: Out = None, as_json: options.AsJson = False) -> None:
    """Check that all that is kept of a study is what was written: manifest, corrections, store, results.

    Nothing is written. The exit code is 3 where something is damaged.
    """
    from fingerpad.study.status import verify_study

    found = verify_study(study, out)

    def print_text(_: object) -> None:
        for name, holds in found.intact.items():
            typer.echo(f"intact   {name}: {holds}")
        for name in found.changed_inputs:
            typer.echo(f"changed  {name}: not what it was at the last run")
        for fault in found.faults:
            typer.echo(f"fault    {fault}")

    show.result(asdict(found), as_json, print_text)
    if found.faults:
        raise typer.Exit(Exit.SOME_FAILED)


def app(
    study: Annotated[
        Path | None, Argument(help="The study's manifest, its folder, or one of studies.", show_default=False)
    ] = None,
    out: Annotated[
        Path | None, Option(help="Folder of its results.", show_default="results beside the manifest")
    ] = None,
    port: Annotated[int, Option(min=0, max=65535, help="Port; 0 takes one that is free.")] = 0,
    browser: Annotated[bool, Option(help="Open the page in the browser.")] = True,
) -> None:
    """Open a page in the browser to measure, correct and read a study.

    It can be reached from this machine only, through the address that is printed. In a folder that is no
    study, by default the current one, the page begins a study or opens one of those there. Ctrl-C ends it.
    """
    from fingerpad.study.manifest.load import manifest_in
    from fingerpad.web.app import serve
    from fingerpad.web.workspace import Workspace, folder_of

    folder = folder_of(study or Path())
    is_study = manifest_in(folder).is_file()
    workspace = Workspace(folder.parent if is_study else folder)
    if is_study:
        workspace.open_folder(folder, out)
    elif out is not None:
        raise FingerpadError("--out needs a study: name its manifest")

    def tell(launch: "Launch") -> None:
        typer.echo(f"The page is at {launch.address}")
        typer.echo(f"Ctrl-C ends it. Scripts read the token from {launch.token_file}")
        if browser:
            webbrowser.open(launch.browser_address)

    serve(workspace, port=port, on_ready=tell)
