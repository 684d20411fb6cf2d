"""A commented manifest to start from."""

import json
from importlib.resources import files
from pathlib import Path

from fingerpad.exceptions import ManifestError
from fingerpad.study.manifest import Study
from fingerpad.study.manifest.load import STUDY_NAME

SCHEMA_NAME = "study.schema.json"


def write_template(folder: Path) -> Path:
    """Write ``study.toml`` and its JSON schema into a folder and return the manifest's path.

    Editors that know TOML schemas complete keys and mark errors by the ``#:schema`` line.

    Raises
    ------
    ManifestError
        If the folder holds one of the two already, or cannot be written.
    """
    template = files("fingerpad.study.editing").joinpath("template.toml").read_text(encoding="utf-8")
    return write_manifest(folder, template)


def write_manifest(folder: Path, text: str) -> Path:
    """Write a manifest and its schema into a folder, overwriting nothing; errors as for `write_template`."""
    content = manifest_files(text)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name in content:
            if (folder / name).exists():
                raise ManifestError(f"{folder / name}: is there already; name another folder")
        for name, lines in content.items():
            with (folder / name).open("x", encoding="utf-8") as file:
                file.write(lines)
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
