"""Compare finished studies."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fingerpad._rounding import positive_with_uncertainty
from fingerpad.cli.shared import AsJson, print_json, print_rows

if TYPE_CHECKING:
    from fingerpad.study.compare import Comparison, Mean, ValidityVerdict, Value


def compare(
    studies: Annotated[
        list[Path],
        typer.Argument(
            metavar="STUDY...", help="Output folders of finished runs, or a file in each.", show_default=False
        ),
    ],
    out: Annotated[Path | None, typer.Option(help="Folder for tables, figures and a page.")] = None,
    as_json: AsJson = False,
) -> None:
    """Compare fingers and people: semi-axes, radii, moduli and exponents, with means over people.

    Means are over people at each placement: several fingers of one person (the manifest's key person) count
    as one person. Synthetic and real fingers are never in one mean.
    """
    from fingerpad.study.compare import compare_studies, write_comparison

    found = compare_studies(studies)
    page = None
    if out is not None:
        from fingerpad.report.compare import write_comparison_page

        write_comparison(found, out)
        page = write_comparison_page(found, out)
    if as_json:
        print_json(found.as_record())
        return
    _print_tables(found)
    if page is not None:
        typer.echo(f"Page: {page}")


def _print_tables(found: "Comparison") -> None:
    from fingerpad.study.compare import QUANTITIES

    for name, kind in QUANTITIES.items():
        values, means = found.of(name)
        if not values:
            continue
        typer.echo(f"{name}: {kind.words}")
        rows = [(_who(value), _place(value), _value_text(value)) for value in values]
        rows += [(_mean_of(mean), _place(mean), _mean_text(mean)) for mean in means if len(mean.people) > 1]
        print_rows(rows, "  ")
    if found.verdicts:
        typer.echo("validity: whether the model holds, and which checks say so")
        verdicts = ((one, ", ".join(one.checks)) for one in found.verdicts)
        print_rows(
            ((_who(one), _place(one), one.model, one.verdict, checks) for one, checks in verdicts), "  "
        )
    for note in found.notes:
        typer.echo(f"note: {note}")


def _who(value: "Value | ValidityVerdict") -> str:
    return f"{value.person.name}, {value.finger}{'  (synthetic)' if value.synthetic else ''}"


def _place(item: "Value | Mean | ValidityVerdict") -> str:
    if item.wedge_angle_deg is None:
        return ""
    return f"{item.wedge_angle_deg:g}°" + (f", roll {item.roll_angle_deg:g}°" if item.roll_angle_deg else "")


def _mean_of(mean: "Mean") -> str:
    return f"mean of {len(mean.people)} people{'  (synthetic)' if mean.synthetic else ''}"


def _value_text(value: "Value") -> str:
    text = positive_with_uncertainty(value.value, value.std)
    return f"{text} ({value.verdict})" if value.verdict else text


def _mean_text(mean: "Mean") -> str:
    low, high = mean.interval or (float("nan"), float("nan"))
    return (
        f"{positive_with_uncertainty(mean.value, mean.std)}  95 %: {low:.4g} to {high:.4g}, "
        f"between people {mean.between_people_std:.2g}"
    )
