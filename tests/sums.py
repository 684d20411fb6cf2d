"""The list of a result set's files, written by other means than a run."""

import hashlib
from pathlib import Path

TABLES = ("results.csv", "results.json", "results_columns.csv", "summary.json")


def write_sums(folder: Path) -> Path:
    """List the files of a folder as those of a finished run; tables that are missing are made, empty."""
    for name in TABLES:
        (folder / name).touch()
    files = sorted(path for path in folder.rglob("*") if path.is_file() and path.name != "SHA256SUMS")
    lines = [
        f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.relative_to(folder).as_posix()}\n"
        for path in files
    ]
    (folder / "SHA256SUMS").write_text("".join(lines), encoding="utf-8")
    return folder
