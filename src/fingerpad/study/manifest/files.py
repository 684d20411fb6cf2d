"""Files that a study names: each must lie in its folder."""

import os
from pathlib import Path

from fingerpad.exceptions import ManifestError


def file_inside(folder: Path, name: str, *, may_be_folder: bool = False) -> Path:
    """Return the path of a file of the study.

    Raises
    ------
    ManifestError
        If there is none of this name inside the study folder.
    """
    path, home = folder / name, os.path.realpath(folder)
    if Path(name).is_absolute() or ".." in Path(name).parts:
        raise ManifestError(
            f"{name!r} leaves the study folder, or is named from outside it; name the file from the study "
            "folder, without .."
        )
    try:
        # A study names thousands of files: each check is a few system calls.
        known = path.exists() if may_be_folder else path.is_file()
        real = os.path.realpath(path)
        inside = real == home or real.startswith(os.path.join(home, ""))
        outside = _link_out(path, Path(home)) if may_be_folder and inside and path.is_dir() else None
    except (OSError, ValueError, RuntimeError) as error:  # a name too long, a NUL in it, a loop of links
        raise ManifestError(f"{name[:60]!r} is no file name ({error})") from error
    if not inside:
        raise ManifestError(f"{name!r} leaves the study folder; copy the file into it")
    if not known:
        raise ManifestError(f"no file {name!r} in the study folder")
    if outside is not None:
        raise ManifestError(
            f"{f'{name}/{outside}'!r} is a link that leaves the study folder; copy the file into it"
        )
    return path


def _link_out(frames: Path, home: Path) -> str | None:
    """Return the name of a frame in a folder that is a link to a file outside the study, None without one."""
    with os.scandir(frames) as entries:
        links = sorted(entry.name for entry in entries if entry.is_symlink())
    return next((name for name in links if not (frames / name).resolve().is_relative_to(home)), None)
