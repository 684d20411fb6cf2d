"""The command line."""

from typing import Annotated

import typer

import fingerpad
from fingerpad.cli import imports, measure, model, results, study
from fingerpad.cli.commands import Command, Commands
from fingerpad.cli.fit import fit
from fingerpad.cli.simulator import simulator

__all__ = ["app"]

_HELP = """Contact mechanics of the human finger pad.

To begin: fingerpad init --example example, then fingerpad run example/study.toml; or fingerpad app.
"""

app = typer.Typer(
    name="fingerpad",
    cls=Commands,
    help=_HELP,
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,  # whole names of options and paragraphs that fit the screen
    pretty_exceptions_enable=False,
)
for title, functions in (
    ("Studies", (study.init, study.run, study.app, study.status, study.verify)),
    ("Studies", (results.compare, results.figure, results.export)),
    ("Single questions", (model.geometry, model.hertz, model.modulus, model.solve, model.fields)),
    ("Single questions", (model.correct, fit, simulator)),
    ("Dzidek et al. (2017)", (model.reproduce,)),
):
    for function in functions:
        app.command(rich_help_panel=title)(function)
app.add_typer(measure.app, name="measure", rich_help_panel="Single questions")
app.add_typer(imports.app, name="import", rich_help_panel="Studies")
for group in (app, measure.app, imports.app):
    for command in group.registered_commands:
        command.cls = Command


def _show_version(value: bool) -> None:
    if value:
        typer.echo(f"fingerpad {fingerpad.__version__}")
        raise typer.Exit


@app.callback()
def _main(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Contact mechanics of the human finger pad."""
