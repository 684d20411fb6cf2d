"""Write a run's table in other formats."""

from pathlib import Path
from typing import Annotated

import typer

from fingerpad.cli.shared import plain_errors


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
    from fingerpad.study.export import export_results

    with plain_errors():
        for file in files:
            export_results(results, file)
            typer.echo(f"Wrote {file}")
