"""One record for each picture: measured or failed, with a progress bar and an overlay."""

import itertools
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any, TypeVar

from fingerpad._files import make_folder
from fingerpad.exceptions import FingerpadError

Item = TypeVar("Item")


def record_of(path: Path, measured: Callable[[Path], dict[str, Any]]) -> dict[str, Any]:
    """Measure one picture; one that cannot be measured costs itself only."""
    try:
        return {"file": str(path), **measured(path)}
    except FingerpadError as error:
        return {"file": str(path), "error": str(error)}


def tracked(items: Iterable[Item], count: int) -> Iterator[Item]:
    """Hand items on, with a bar on stderr where someone may be watching more than one."""
    if count < 2 or not sys.stderr.isatty():
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
