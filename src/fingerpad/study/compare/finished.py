"""Studies that were run, as their summary.json tells them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fingerpad.exceptions import FingerpadError
from fingerpad.study.results.result_set import require_result_set
from fingerpad.study.results.results_reader import read_summary


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FinishedStudy:
    """The results of one run.

    Attributes
    ----------
    folder : Path
        Its output folder.
    title : str
        The study's title.
    version, made : str
        The fingerpad that made it, and when.
    failures : int
        What could not be measured.
    inputs : mapping
        SHA-256 by input file.
    summary : mapping
        The content of ``summary.json``.
    """

    folder: Path
    title: str
    version: str
    made: str
    failures: int
    inputs: Mapping[str, str]
    summary: Mapping[str, Any]

    def __repr__(self) -> str:
        return f"FinishedStudy(folder={str(self.folder)!r}, title={self.title!r}, made={self.made!r})"


def read_finished(paths: Sequence[Path]) -> list[FinishedStudy]:
    """Read finished runs, each named by its output folder or a file in it.

    Raises
    ------
    FingerpadError
        If one is no finished run, two are the same study, or two have one title.
    """
    studies: list[FinishedStudy] = []
    for path in paths:
        study = _read(path.parent if path.is_file() else path)
        for other in studies:
            if study.folder.resolve() == other.folder.resolve() or (
                study.inputs and study.inputs == other.inputs
            ):
                raise FingerpadError(
                    f"{study.folder}: is the same study as {other.folder}: its fingers would count twice; "
                    "name it once"
                )
            if study.title.casefold() == other.title.casefold():
                raise FingerpadError(
                    f"{study.folder} and {other.folder} are both titled {study.title!r}; give one another "
                    "title in its study.toml and run it again: nothing is measured again"
                )
        studies.append(study)
    if not studies:
        raise FingerpadError("no study is named; name output folders of `fingerpad run`")
    return studies


def _read(folder: Path) -> FinishedStudy:
    require_result_set(folder)
    summary = read_summary(folder)
    try:
        of = summary["provenance"]
        return FinishedStudy(
            folder=folder,
            title=str(summary["title"]),
            version=str(of["fingerpad"]),
            made=str(of["made"]),
            failures=len(summary["failures"]),
            inputs=dict(of["inputs_sha256"]),
            summary=summary,
        )
    except (KeyError, TypeError, ValueError) as error:
        raise not_understood(folder, error) from error


def not_understood(folder: Path, error: Exception) -> FingerpadError:
    """Return the error for a summary that lacks what it should have."""
    return FingerpadError(
        f"{folder / 'summary.json'}: is not understood ({type(error).__name__}: {error}); run the study "
        "again with this version: nothing that was measured is measured again"
    )
