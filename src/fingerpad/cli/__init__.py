"""The command line."""

from typing import Annotated

import typer

import fingerpad
from fingerpad.cli import imports, measure, model, study
from fingerpad.cli.app import app as page
from fingerpad.cli.compare import compare
from fingerpad.cli.export import export
from fingerpad.cli.fields import fields
from fingerpad.cli.figure import figure
from fingerpad.cli.fit import fit
from fingerpad.cli.modulus import modulus
from fingerpad.cli.shared import Command, Commands
from fingerpad.cli.solve import solve

__all__ = ["app"]

app = typer.Typer(
    name="fingerpad",
    cls=Commands,
    help="Contact mechanics of the human finger pad.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
app.command()(model.geometry)
app.command()(model.hertz)
app.command()(modulus)
app.command()(solve)
app.command()(fields)
app.command()(model.correct)
app.command()(model.reproduce)
app.add_typer(measure.app, name="measure")
app.command()(fit)
app.command()(study.init)
app.command()(study.run)
app.command()(study.status)
app.command()(study.verify)
app.command()(compare)
app.command()(figure)
app.command()(export)
app.add_typer(imports.app, name="import")
app.command("app")(page)
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
