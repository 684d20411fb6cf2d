"""Write a run's table in other formats."""

from pathlib import Path
from typing import Annotated

import typer

from fingerpad.cli.shared import Exit, print_error
from fingerpad.exceptions import reason_of


def export(
    results: Annotated[Path, typer.Argument(help="Output folder of a finished run.", show_default=False)],
    files: Annotated[
        list[Path],
        typer.Argument(metavar="FILE...", help="Files to write: .parquet or .mat.", show_default=False),
    ],
) -> None:
    """Write the table of a finished run as Parquet or for MATLAB, by the suffix of each file.

    Every column keeps its type, unit and meaning. Parquet needs the package pyarrow.
    """
    from fingerpad.study.results.load import export_results

    failed = 0
    for file in files:
        try:
            export_results(results, file)
        except Exception as error:  # one format may hold what another cannot
            print_error(reason_of(error, f"{file}: cannot be written"))
            failed += 1
        else:
            typer.echo(f"Wrote {file}")
    if failed:
        raise typer.Exit(Exit.SOME_FAILED if failed < len(files) else Exit.REFUSED)
