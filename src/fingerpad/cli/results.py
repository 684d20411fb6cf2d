"""Commands on the results of finished runs: compare them, draw their figures, write their tables."""

from pathlib import Path
from typing import Annotated, Literal

import typer
from typer import Argument, Option

from fingerpad.cli import options, show
from fingerpad.cli.commands import Exit
from fingerpad.exceptions import FigureError, reason_of


def compare(
    studies: Annotated[
        list[Path],
        Argument(
            metavar="STUDY...", help="Output folders of finished runs, or a file in each.", show_default=False
        ),
    ],
    out: Annotated[Path | None, Option(help="Folder for tables, figures and a page.")] = None,
    as_json: options.AsJson = False,
) -> None:
    """Compare fingers and people: semi-axes, radii, moduli and exponents, with means over people.

    Means are over people at each placement: several fingers of one person (the manifest's key person) count
    as one person. Synthetic and real fingers are never in one mean.
    """
    from fingerpad.report.terminal import comparison_lines
    from fingerpad.study.compare import compare_studies, write_comparison

    found = compare_studies(studies)
    page = None
    if out is not None:
        from fingerpad.report.compare import write_comparison_page

        write_comparison(found, out)
        page = write_comparison_page(found, out)
    show.result(found.as_record(), as_json, lambda _: typer.echo("\n".join(comparison_lines(found))))
    show.folder("Page", page, as_json)


def figure(
    file: Annotated[
        Path, Argument(help="A figure of a report as data, results/figures/NAME.json.", show_default=False)
    ],
    out: Annotated[
        Path, Option(help="File to write: .svg, .pdf, .png, or .csv for its data.", show_default=False)
    ],
    width_mm: Annotated[float | None, Option(help="Width, mm: a journal's column.")] = None,
    height_mm: Annotated[float | None, Option(help="Height, mm.")] = None,
    font_pt: Annotated[float | None, Option(help="Size of labels, points.")] = None,
    x_range: Annotated[str, Option(help="Ends of the x axis, as 0:2 or 0: or :2.", show_default=False)] = ":",
    y_range: Annotated[str, Option(help="Ends of the y axis.", show_default=False)] = ":",
    x_scale: Annotated[Literal["linear", "log"] | None, Option(help="Scale of the x axis.")] = None,
    y_scale: Annotated[Literal["linear", "log"] | None, Option(help="Scale of the y axis.")] = None,
    colours: Annotated[
        str, Option(help="Colours of the data in their order, as black,#D55E00.", show_default=False)
    ] = "",
    dpi: Annotated[float, Option(help="Resolution of a PNG, dots per inch.")] = 300.0,
) -> None:
    """Draw a figure of a report for publication, or write the data behind it."""
    from fingerpad.figures.marks import Figure
    from fingerpad.figures.publish import FigureSettings, save_figure

    ranges = _range("x", x_range) | _range("y", y_range)
    try:
        settings = FigureSettings(
            width_mm=width_mm,
            height_mm=height_mm,
            font_pt=font_pt,
            **ranges,
            x_scale=x_scale,
            y_scale=y_scale,
            colours=colours,
            dpi=dpi,
        )
    except FigureError as error:
        name, _, words = str(error).partition(":")
        raise FigureError(f"--{name.replace('_', '-')}:{words}") from None
    try:
        drawn = Figure.of_json(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise FigureError(
            f"{file}: not a figure of a report: name a file of results/figures that ends in .json"
        ) from error
    save_figure(drawn, out, settings=settings)
    typer.echo(f"Wrote {out}")


def _range(axis: str, text: str) -> dict[str, float | None]:
    try:
        low, high = (float(end) if end else None for end in text.split(":"))
    except ValueError:
        raise FigureError(f"--{axis}-range: takes two numbers separated by a colon, found {text!r}") from None
    return {f"{axis}_low": low, f"{axis}_high": high}


def export(
    results: Annotated[Path, Argument(help="Output folder of a finished run.", show_default=False)],
    files: Annotated[
        list[Path],
        Argument(metavar="FILE...", help="Files to write: .xlsx, .mat or .parquet.", show_default=False),
    ],
) -> None:
    """Write the table of a finished run for Excel or MATLAB or as Parquet, by the suffix of each file.

    Every column keeps its type, unit and meaning. Parquet needs the package pyarrow.
    """
    from fingerpad.study.results.load import export_results

    failed = 0
    for file in files:
        try:
            export_results(results, file)
        except Exception as error:  # one format may hold what another cannot
            show.error(reason_of(error, f"{file}: cannot be written"))
            failed += 1
        else:
            typer.echo(f"Wrote {file}")
    if failed:
        raise typer.Exit(Exit.SOME_FAILED if failed < len(files) else Exit.REFUSED)
