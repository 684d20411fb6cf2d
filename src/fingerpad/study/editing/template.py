"""A commented manifest to start from."""

import json
from importlib.resources import files
from pathlib import Path

from fingerpad.exceptions import ManifestError
from fingerpad.study.manifest import Study
from fingerpad.study.manifest.load import STUDY_NAME

SCHEMA_NAME = "study.schema.json"


def write_template(folder: Path) -> Path:
    """Write ``study.toml`` and its JSON schema into a new or empty folder and return the manifest's path.

    Editors that know TOML schemas complete keys and mark errors by the ``#:schema`` line.

    Raises
    ------
    ManifestError
        If the folder holds anything already, or cannot be written.
    """
    template = files("fingerpad.study.editing").joinpath("template.toml").read_text(encoding="utf-8")
    return write_manifest(folder, template)


def write_manifest(folder: Path, text: str) -> Path:
    """Write a manifest and its schema into a new or empty folder; errors as for `write_template`."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if any(folder.iterdir()):
            raise ManifestError(f"{folder}: the folder is not empty; name a new one, so that nothing is lost")
        for name, content in manifest_files(text).items():
            (folder / name).write_text(content, encoding="utf-8")
    except OSError as error:
        raise ManifestError(f"{folder}: cannot write a study there ({error.strerror})") from error
    return folder / STUDY_NAME


def manifest_files(text: str) -> dict[str, str]:
    """Return a manifest that begins with the line of its JSON schema, and the schema, by file name."""
    return {SCHEMA_NAME: manifest_schema(), STUDY_NAME: f"#:schema ./{SCHEMA_NAME}\n{text}"}


def manifest_schema() -> str:
    """Return the JSON schema of a manifest.

    Examples
    --------
    >>> sorted(json.loads(manifest_schema())["properties"])[:3]
    ['apparatus', 'curves', 'description']
    """
    return json.dumps(Study.model_json_schema(), indent=1, ensure_ascii=False) + "\n"
