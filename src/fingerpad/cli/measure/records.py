"""One record for each picture: measured or failed, with a progress bar and an overlay."""

import itertools
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, TypeVar

import typer

from fingerpad._files import make_folder
from fingerpad._json import dumps
from fingerpad.exceptions import reason_of
from fingerpad.flags import Flagged, flags_in

Item = TypeVar("Item")


def record_of(path: Path, measured: Callable[[Path], dict[str, Any]]) -> dict[str, Any]:
    """Measure one picture; one that cannot be measured costs itself only."""
    try:
        return {"file": str(path), **measured(path)}
    except Exception as error:  # a picture can be damaged in unforeseen ways
        return {"file": str(path), "error": reason_of(error, f"{path}: cannot be measured")}


def printed(
    results: Iterable[Item],
    as_json: bool,
    record_of_result: Callable[[Item], Mapping[str, Any]],
    print_result: Callable[[Item], None],
) -> Iterator[Item]:
    """Print each result at once, and yield it: a later error loses none."""
    opening = "["
    try:
        for result in results:
            if as_json:
                typer.echo(f"{opening}{dumps(record_of_result(result))}", nl=False)
                opening = ",\n"
            else:
                print_result(result)
            yield result
    except (Exception, KeyboardInterrupt):
        if opening != "[":
            typer.echo("]")
        raise
    if as_json:
        typer.echo("[]" if opening == "[" else "]")


def tracked(items: Iterable[Item], count: int) -> Iterator[Item]:
    """Yield items, with a progress bar on stderr if that is a terminal and there are several.

    Where results are printed to a person as they come, a bar would only stand in between.
    """
    if count < 2 or sys.stdout.isatty() or not sys.stderr.isatty():
        yield from items
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True, redirect_stdout=False) as bar:
        yield from bar.track(items, total=count, description="Measuring")


def overlay_files(images: list[Path], folder: Path | None) -> dict[Path, Path]:
    """Return a file for each picture's overlay: no two the same, and none of them a picture to measure."""
    if folder is None:
        return {}
    make_folder(folder)
    files: dict[Path, Path] = {}
    taken = {path.resolve() for path in images}
    for path in images:
        names = (f"{path.stem}_overlay{number}.png" for number in itertools.chain([""], itertools.count(2)))
        files[path] = next(folder / name for name in names if (folder / name).resolve() not in taken)
        taken.add(files[path].resolve())
    return files


def print_if_exact(mm_per_px_std: float | None) -> None:
    """Say of a scale without uncertainty that it is taken as exact."""
    if mm_per_px_std == 0:
        typer.echo("scale taken as exact")


def print_flags(record: Mapping[str, Any], *kinds: Flagged) -> None:
    """Print what each flag of a record means, and what to do about it."""
    for flag in flags_in(record.get("flags", ()), *kinds):
        typer.echo(f"{flag.code}: {flag.words}. To do: {flag.to_do}.")
