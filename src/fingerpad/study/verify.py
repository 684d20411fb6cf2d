"""Whether everything that is kept of a study is what was written."""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from fingerpad._files import digest_of
from fingerpad.exceptions import FingerpadError
from fingerpad.study.corrections.items import CORRECTIONS_NAME, SECOND_OPERATOR_NAME
from fingerpad.study.corrections.log import CorrectionLog
from fingerpad.study.engine.store import STORE_NAME, Store
from fingerpad.study.error_text import counted
from fingerpad.study.manifest import manifest_in, read_study
from fingerpad.study.results.result_set import result_files, result_set_faults
from fingerpad.study.results.summary_file import SummaryFile


@dataclass(frozen=True, slots=True, kw_only=True)
class Verification:
    """What a look at all files of a study found.

    Attributes
    ----------
    intact : dict of str to str
        What is as it was written: a file or group of files, with what it holds.
    faults : tuple of str
        What is not, each naming its file.
    changed_inputs : tuple of str
        Inputs that are not those of the last run: the next one measures them again.
    """

    intact: dict[str, str]
    faults: tuple[str, ...]
    changed_inputs: tuple[str, ...]


def verify_study(manifest: Path, out: Path) -> Verification:
    """Read all that is kept of a study, and compare it with its checksums; nothing is written.

    Parameters
    ----------
    manifest : Path
        The study's TOML file, or its folder.
    out : Path
        Folder of its results.
    """
    manifest = manifest_in(manifest)
    folder = manifest.absolute().parent
    intact: dict[str, str] = {}
    faults: list[str] = []
    try:
        study = read_study(manifest)
        count = len(study.observations) + len(study.sequences)
        intact[manifest.name] = f"{counted(len(study.fingers), 'finger')}, {counted(count, 'contact')}"
    except FingerpadError as error:
        faults += str(error).splitlines()
    for name in (CORRECTIONS_NAME, SECOND_OPERATOR_NAME):
        if not (folder / name).is_file():
            continue
        try:
            log = CorrectionLog(folder, name)
            intact[name] = counted(log.count, "record")
            faults += log.notes
        except FingerpadError as error:
            faults.append(str(error))
    if (out / STORE_NAME).is_file():
        found = list(_store_faults(out / STORE_NAME))
        if not found:
            with Store.reading(out / STORE_NAME) as store:
                intact[STORE_NAME] = counted(len(store.statuses()), "result")
        faults += found
    listed = result_files(out)
    found = result_set_faults(out, digest_of)
    if listed and not found:
        intact["results"] = counted(len(listed), "file")
    faults += found
    return Verification(
        intact=intact, faults=tuple(faults), changed_inputs=tuple(_changed_inputs(folder, out))
    )


def _store_faults(path: Path) -> Iterator[str]:
    try:
        with Store.reading(path) as store:
            for task in store.damaged():
                yield f"{STORE_NAME}: the stored result of {task} is damaged"
            for task, status in store.statuses().items():
                for name, digest in status.drawn.items():
                    drawn = store.drawn_file(name, digest)
                    if drawn is None or digest_of(drawn) != digest:
                        yield f"{name}: is missing or was changed; {task} will be measured again"
    except FingerpadError as error:
        yield str(error)


def _changed_inputs(folder: Path, out: Path) -> Iterator[str]:
    """Yield the inputs of the last run that are not what they were, as far as it tells."""
    with suppress(OSError, FingerpadError):
        for name, digest in SummaryFile.read(out).provenance.inputs_sha256.items():
            path = folder / name
            if path.is_file() and digest_of(path) != digest:
                yield name
