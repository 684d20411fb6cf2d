"""Reading a manifest, and everything that can be checked before any work."""

import os
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from unicodedata import normalize

from fingerpad.exceptions import ManifestError
from fingerpad.study.journal import recover
from fingerpad.study.manifest.spreadsheet import read_rows
from fingerpad.study.manifest.study import Study
from fingerpad.study.manifest.validation import validated


def manifest_in(path: Path) -> Path:
    """Return the manifest that a path means: itself, or ``study.toml`` in the folder that it is."""
    return path / "study.toml" if path.is_dir() else path


def read_study(path: Path, on_read: Callable[[str, bytes], None] = lambda _name, _content: None) -> Study:
    """Read and check a manifest; rows of ``observations_csv`` are appended to its observations.

    Everything is checked before any work: keys, values, references between tables, and that every file named
    exists inside the study folder.

    Parameters
    ----------
    path : Path
        The TOML file. File names in it are relative to its folder.
    on_read : callable
        Called with the name and the content of each file that is read.

    Raises
    ------
    ManifestError
        Naming the file, and for each fault its key, what was found and what was expected.
    """
    recover(path.parent)
    if path.is_char_device():
        raise ManifestError(f"{path}: is a device, not a file")  # which may have no end
    try:
        text = path.read_bytes()
        on_read(path.name, text)
        content = tomllib.loads(text.decode("utf-8-sig"))
    except FileNotFoundError:
        raise ManifestError(
            f"{path}: no such file; `fingerpad init DIR` writes a manifest to start from"
        ) from None
    except (OSError, UnicodeDecodeError) as error:
        raise ManifestError(f"{path}: cannot be read ({error})") from error
    except (ValueError, RecursionError) as error:
        raise ManifestError(f"{path}: not valid TOML: {error}") from error
    study = validated(Study, content, path.name, strict=True)
    if study.observations_csv is not None:
        table = file_inside(path.parent, study.observations_csv, path.name, "observations_csv")
        rows = read_rows(table, lambda text: on_read(str(study.observations_csv), text))
        study = study.model_copy(update={"observations": [*study.observations, *rows]})
    faults = [*_reference_faults(study), *_file_faults(study, path.parent)]
    if faults:
        raise ManifestError("\n".join(f"{path.name}: {fault}" for fault in faults))
    return study


def _reference_faults(study: Study) -> Iterator[str]:
    fingers = [finger.name for finger in study.fingers]
    contacts = [contact.name for contact in (*study.observations, *study.sequences)]
    kinds = "observations and sequences" if study.sequences else "observations"
    for kind, names in (("scales", list(study.scales)), ("fingers", fingers), (kinds, contacts)):
        # Two files must differ by more than case, and by more than how an accent is written.
        folded = [normalize("NFC", name).casefold() for name in names]
        for name, key in sorted(set(zip(names, folded, strict=True))):
            count = folded.count(key)
            if count == 1:
                continue
            yield f"{kind}: the name {name!r} is given {count} times; names must differ by more than case"
    used = [(f"observation {row.name!r}", row.finger) for row in study.observations]
    used += [(f"sequence {sequence.name!r}", sequence.finger) for sequence in study.sequences]
    used += [(f"curves[{index}]", curve.finger) for index, curve in enumerate(study.curves)]
    for place, name in used:
        if name not in fingers:
            yield f"{place}: no finger is named {name!r}; there is {', '.join(fingers)}"
    for place, name in study.named_scales():
        if name not in study.scales:
            known = (
                f"there is {', '.join(study.scales)}" if study.scales else f"write a table [scales.{name}]"
            )
            yield f"{place}: no scale is named {name!r}; {known}"


def _file_faults(study: Study, folder: Path) -> Iterator[str]:
    for place, name in study.named_files():
        try:
            is_sequence = place.startswith("sequences[") and place.endswith(".file")
            file_inside(folder, name, "", place, may_be_folder=is_sequence)
        except ManifestError as error:
            yield str(error).removeprefix(": ")


def file_inside(folder: Path, name: str, where: str, place: str, *, may_be_folder: bool = False) -> Path:
    """Return the path of a file of the study, which must exist inside its folder."""
    path, home = folder / name, folder.resolve()
    try:
        known = path.exists() if may_be_folder else path.is_file()
        inside = path.resolve().is_relative_to(home)
        outside = _link_out(path, home) if inside and path.is_dir() else None
    except (OSError, ValueError, RuntimeError) as error:  # a name too long, a NUL in it, a loop of links
        raise ManifestError(f"{where}: {place}: {name[:60]!r} is no file name ({error})") from error
    if not inside:
        raise ManifestError(f"{where}: {place}: {name!r} leaves the study folder; copy the file into it")
    if not known:
        raise ManifestError(f"{where}: {place}: no file {name!r} in the study folder")
    if outside is not None:
        raise ManifestError(
            f"{where}: {place}: {f'{name}/{outside}'!r} is a link that leaves the study folder; "
            "copy the file into it"
        )
    return path


def _link_out(frames: Path, home: Path) -> str | None:
    """Return the name of a frame in a folder that is a link to a file outside the study, None without one."""
    with os.scandir(frames) as entries:
        links = sorted(entry.name for entry in entries if entry.is_symlink())
    return next((name for name in links if not (frames / name).resolve().is_relative_to(home)), None)
