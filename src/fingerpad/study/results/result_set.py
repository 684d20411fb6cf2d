"""The files of a run, put in place as one: all of a new result set, or all of the old one.

They are written into a folder beside the old ones and listed with their digests in ``SHA256SUMS``, in the
format of ``sha256sum``. Then the folder is renamed, from which moment the new set counts, and its files are
moved into place. Readers of results check them against the list.
"""

import os
import re
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

from fingerpad._files import content_stamp, digest_of, explain_write_errors, leads_out, sha256_of
from fingerpad.exceptions import FingerpadError, StoreError
from fingerpad.study.engine.store import STORE_NAME, Store
from fingerpad.study.journal import sync_folder, write_synced
from fingerpad.study.manifest.load import manifest_in

RESULTS_NAME: Final = "results"
SUMS_NAME: Final = "SHA256SUMS"
# What a run writes into its output folder.
OUTPUT_NAMES: Final = frozenset(
    (
        *(SUMS_NAME, "results.csv", "results.json", "results_columns.csv", "summary.json", "by_load.csv"),
        *("repeatability.csv", "second_operator.csv", "figures", "overlays", "report", "report.html"),
        "report.json",
    )
)
_TABLES: Final = frozenset(("results.csv", "results.json", "results_columns.csv", "summary.json"))
_FOLDERS: Final = ("overlays/photographs", "overlays/sequences", "overlays", "figures", "report")
_NEW: Final = ".results-new"
_COMPLETE: Final = ".results-complete"
_LINE: Final = re.compile(r"([0-9a-f]{64})  ([^\s/][^\n]*)")
_DAMAGED: Final = f"{SUMS_NAME}: is damaged"
RERUN: Final = "run the study again: nothing that was measured is measured again"


def results_folder(manifest: Path) -> Path:
    """Return the output folder of a study for which none is named: beside its manifest."""
    return manifest_in(manifest).parent / RESULTS_NAME


class NewResultSet:
    """A result set that is being written into `folder`."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._digests: dict[str, str] = {}

    def add(self, name: str, source: Path, digest: str) -> None:
        """Add a file that was drawn before, with its SHA-256: by a link where the file system has them."""
        target = self.folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        try:
            os.link(source, target)
        except OSError:
            # Never onto what is there: that may be a link to a file of the old result set.
            with source.open("rb") as drawn, target.open("xb") as copy:
                shutil.copyfileobj(drawn, copy)
        self._digests[name] = digest

    def write_sums(self) -> None:
        """Write the list of all files with their digests."""
        files = (path for path in self.folder.rglob("*") if path.is_file())
        names = sorted(path.relative_to(self.folder).as_posix() for path in files)
        sums = "".join(
            f"{self._digests.get(name) or sha256_of(self.folder / name)}  {name}\n" for name in names
        )
        write_synced(self.folder / SUMS_NAME, sums)


@contextmanager
def new_result_set(store: Store) -> Iterator[NewResultSet]:
    """Provide a folder for a run's files, which are put in place in the end unless anything is raised."""
    out = store.folder
    new = out / _NEW
    way_out = "the results before it are kept; make room, or choose another --out, and run again to go on"
    try:
        with explain_write_errors(out, way_out):
            shutil.rmtree(new, ignore_errors=True)
            new.mkdir()
            result_set = NewResultSet(new)
            yield result_set
            result_set.write_sums()
            new.rename(out / _COMPLETE)
            sync_folder(out)
    finally:
        shutil.rmtree(new, ignore_errors=True)
    put_in_place(store)


def put_in_place(store: Store) -> None:
    """Put a complete result set in place, as one that was interrupted in the middle, if there is one."""
    out = store.folder
    complete = out / _COMPLETE
    if not complete.is_dir():
        return
    try:
        old, new = (_listed(folder)[0] for folder in (out, complete))
        for name in old.keys() - new.keys() if new else ():
            (out / name).unlink(missing_ok=True)
        for name in (*new, SUMS_NAME):  # the list last: until then it is known that something is missing
            if (complete / name).exists():
                (out / name).parent.mkdir(parents=True, exist_ok=True)
                (complete / name).replace(out / name)
        shutil.rmtree(complete)
        listed = _listed(out)[0]
        for name, digest in listed.items():
            store.remember(out / name, digest)
        for folder in _FOLDERS:
            with suppress(OSError):  # not empty
                (out / folder).rmdir()
    except OSError as error:
        raise FingerpadError(
            f"{error.filename}: cannot be put in place ({error.strerror}): run again to go on"
        ) from error
    store.keep_drawn(listed)


def result_files(out: Path) -> list[str]:
    """Return the names of the files of a result set, relative to its folder; empty where there is none."""
    return list(_listed(out)[0])


def result_set_stamp(out: Path) -> tuple[object, ...]:
    """Return what changes with the result set in a folder, and with its tables, without reading a file."""
    return tuple(content_stamp(out / name) for name in (_COMPLETE, *sorted(OUTPUT_NAMES)))


def result_set_faults(
    out: Path, digest: Callable[[Path], str] = digest_of, is_checked: Callable[[str], bool] = lambda _: True
) -> list[str]:
    """Return what is wrong with a result set, each fault naming its file; empty where nothing is."""
    if (out / _COMPLETE).is_dir():
        return ["the last run was stopped while it put its results in place, or is doing so now"]
    listed, faults = _listed(out)
    if not listed and not faults:
        loose = sorted(name for name in OUTPUT_NAMES if (out / name).is_file())
        return [f"{name}: is there without {SUMS_NAME}, so not of a finished run" for name in loose]
    for name, expected in listed.items():
        if not is_checked(name):
            continue
        found = digest(out / name)
        if not found:
            faults.append(f"{name}: is missing or cannot be read")
        elif found != expected:
            faults.append(f"{name}: is not the file that the last run wrote")
    return faults


def quick_faults(out: Path, is_checked: Callable[[str], bool] = lambda _: True) -> list[str]:
    """Return the same, but read only files that have changed since the run, where the store tells."""
    with suppress(StoreError):  # reported where it is needed
        if (out / STORE_NAME).is_file():
            with Store.reading(out / STORE_NAME) as store:
                return result_set_faults(out, store.digest, is_checked)
    return result_set_faults(out, is_checked=is_checked)


def require_result_set(out: Path) -> None:
    """Refuse results that are missing or do not belong together."""
    if out.is_file():
        raise FingerpadError(f"{out}: is a file; name the output folder of a finished run")
    faults = quick_faults(out)
    if faults:
        more = f" (and {len(faults) - 3} more)" if len(faults) > 3 else ""
        raise FingerpadError(f"{out}: {'; '.join(faults[:3])}{more}: {RERUN}")
    if (out / SUMS_NAME).is_file():
        return
    inner = out / RESULTS_NAME
    if (inner / SUMS_NAME).is_file():
        raise FingerpadError(f"{out}: no finished run there, but in {inner}: name that folder")
    raise FingerpadError(f"{out}: no finished run there; `fingerpad run STUDY --out FOLDER` makes one")


def _listed(folder: Path) -> tuple[dict[str, str], list[str]]:
    """Return the digests of a result set by file, and what is wrong with the list; both empty without one."""
    try:
        text = (folder / SUMS_NAME).read_text(encoding="utf-8")
    except FileNotFoundError:
        return {}, []
    except (OSError, UnicodeDecodeError):
        return {}, [_DAMAGED]
    # No other line break counts: sha256sum knows none.
    lines = [_LINE.fullmatch(line) for line in text.removesuffix("\n").split("\n")]
    # Files that the next result set lacks are removed: a list from elsewhere must name none outside.
    listed = {line[2]: line[1] for line in lines if line is not None and not leads_out(line[2])}
    is_whole = text.endswith("\n") and len(listed) == len(lines) and listed.keys() >= _TABLES
    return listed, [] if is_whole else [_DAMAGED]
