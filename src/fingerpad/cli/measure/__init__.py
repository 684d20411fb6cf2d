"""Commands that measure pictures."""

import typer

from fingerpad.cli.measure import photograph, prints, sequence
from fingerpad.cli.shared import Group

app = typer.Typer(cls=Group, rich_markup_mode=None, help="Measure pictures.", no_args_is_help=True)
app.command("print")(prints.measure_prints)
app.command("photo")(photograph.measure_photo)
app.command("sequence")(sequence.measure_frames)
