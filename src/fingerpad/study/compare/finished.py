"""Studies that were run, as their summary.json tells them."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from fingerpad.exceptions import FingerpadError
from fingerpad.study.results.result_set import require_result_set
from fingerpad.study.results.summary_file import SummaryFile


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FinishedStudy:
    """The results of one run.

    Attributes
    ----------
    folder : Path
        Its output folder.
    summary : SummaryFile
        The content of ``summary.json``.
    """

    folder: Path
    summary: SummaryFile

    @property
    def title(self) -> str:
        """The study's title."""
        return self.summary.title

    def __repr__(self) -> str:
        made = self.summary.provenance.made
        return f"FinishedStudy(folder={str(self.folder)!r}, title={self.title!r}, made={made!r})"


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
                (inputs := study.summary.provenance.inputs_sha256)
                and inputs == other.summary.provenance.inputs_sha256
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
    return FinishedStudy(folder=folder, summary=SummaryFile.read(folder))
