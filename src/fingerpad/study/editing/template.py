"""A commented manifest to start from."""

from importlib.resources import files
from pathlib import Path

from fingerpad.exceptions import ManifestError


def write_template(folder: Path) -> Path:
    """Write ``study.toml`` into a new or empty folder and return its path.

    Raises
    ------
    ManifestError
        If the folder holds anything already, or cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if any(folder.iterdir()):
            raise ManifestError(f"{folder}: the folder is not empty; name a new one, so that nothing is lost")
        manifest = folder / "study.toml"
        template = files("fingerpad.study.editing").joinpath("template.toml").read_text(encoding="utf-8")
        manifest.write_text(template, encoding="utf-8")
    except OSError as error:
        raise ManifestError(f"{folder}: cannot write a study there ({error.strerror})") from error
    return manifest
