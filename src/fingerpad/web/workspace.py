"""The workspace: its studies, and those that are open."""

import os
import re
import shutil
import tomllib
import unicodedata
from http import HTTPStatus
from importlib.metadata import version
from itertools import chain, count
from pathlib import Path
from threading import RLock
from typing import Final

from fingerpad.exceptions import ManifestError
from fingerpad.image import MEMORY_LIMIT
from fingerpad.study.journal import read_text_or_none
from fingerpad.study.manifest.load import STUDY_NAME
from fingerpad.study.results.result_set import RESULTS_NAME
from fingerpad.web.answers import RequestError
from fingerpad.web.pictures import Pictures
from fingerpad.web.study_session import StudySession

_FIRST_TABLE: Final = re.compile(r"^\s*\[", re.MULTILINE)
UPLOAD_LIMIT: Final = 4 * 2**30
# A folder's name holds letters, digits and . _ + - only, as all names of a study.
NAME: Final = r"^\w[\w.+-]{0,59}$"
# The version changes the address, so that browsers may keep the script.
PLOTLY_ADDRESS: Final = f"/static/vendor/plotly-{version('plotly')}.min.js"


def folder_of(study: Path) -> Path:
    """Return the folder of a study, named by its manifest or itself, that the page can change."""
    if study.is_dir():
        return study.absolute()
    if not study.is_file():
        raise ManifestError(
            f"{study}: no such file or folder; `fingerpad init {study.parent if study.suffix else study}` "
            "writes a study to start from, and `fingerpad app` alone begins one here"
        )
    if study.name != STUDY_NAME:
        raise ManifestError(f"{study}: the page changes manifests named {STUDY_NAME} only; rename it")
    return study.absolute().parent


def title_of(folder: Path) -> str | None:
    """Return a study's title at a glance, without reading its tables; None where that does not tell it."""
    try:
        text = read_text_or_none(folder / STUDY_NAME) or ""
        title = tomllib.loads(_FIRST_TABLE.split(text, maxsplit=1)[0]).get("title")
    except (ManifestError, tomllib.TOMLDecodeError):
        return None
    return title if isinstance(title, str) else None


class Workspace:
    """A folder of studies, any of which can be open: each window of the page has its own.

    Limits are in bytes, of an uploaded file, of an imported study (None for the free space of the disk), and
    of what reading and measuring one picture may take, as for `read_image`.
    """

    def __init__(
        self,
        workspace: Path,
        *,
        upload_limit: int = UPLOAD_LIMIT,
        import_limit: int | None = None,
        memory_limit: int = MEMORY_LIMIT,
    ) -> None:
        self.workspace = workspace.absolute()
        self.upload_limit, self.import_limit = upload_limit, import_limit
        self.pictures = Pictures(memory_limit)
        self._open: dict[Path, StudySession] = {}
        self.last: StudySession | None = None  # that was opened last
        self._lock = RLock()

    def session(self, name: str) -> StudySession:
        """Return a study by its name, opened if it is not."""
        with self._lock:
            found = next((one for one in self._open.values() if one.name == name), None)
            return found or self._session(self.folder_of(name))

    def studies(self) -> list[str]:
        """Return the names of the workspace's studies."""
        try:
            with os.scandir(self.workspace) as entries:
                folders = [Path(entry.path) for entry in entries if entry.is_dir(follow_symlinks=False)]
        except OSError:
            return []
        return sorted(f.name for f in folders if (f / STUDY_NAME).is_file())

    def folder_of(self, name: str) -> Path:
        """Return the folder of one of the workspace's studies."""
        if name not in self.studies():
            raise RequestError.not_there(f"the workspace holds no study {name!r}")
        return self.workspace / name

    def open_folder(self, folder: Path, out: Path | None = None) -> StudySession:
        """Open the study in a folder; others stay open."""
        with self._lock:
            self.last = self._session(folder, out)
            return self.last

    def _session(self, folder: Path, out: Path | None = None) -> StudySession:
        folder = folder.absolute()
        if folder not in self._open:
            out = (out or folder / RESULTS_NAME).absolute()
            self._open[folder] = StudySession(folder, out=out, pictures=self.pictures)
        return self._open[folder]

    def close(self) -> None:
        """Close all studies; runs are stopped, and their finished measurements are kept."""
        with self._lock:
            closed, self._open, self.last = list(self._open.values()), {}, None
        for study in closed:
            study.close()

    def end_events(self) -> None:
        """Disconnect all listeners, so that the server can stop."""
        for study in list(self._open.values()):
            study.events.end()

    @property
    def room(self) -> int:
        """The most bytes of a study that can be imported now."""
        free = shutil.disk_usage(self.workspace).free
        return free if self.import_limit is None else min(free, self.import_limit)

    def free_name(self, name: str) -> str:
        """Return a name, with a number if the workspace holds it already."""
        numbered = (f"{name}-{number}" for number in count(2))
        return next(one for one in chain([name], numbered) if not os.path.lexists(self.workspace / one))

    def new_folder(self, name: str) -> Path:
        """Return the path of a new sub-folder of the workspace."""
        if not re.fullmatch(NAME, name):
            raise RequestError(
                HTTPStatus.BAD_REQUEST, f"{name!r}: write the name with letters, digits and . _ + - only"
            )
        folder = self.workspace / name
        if os.path.lexists(folder):
            raise RequestError.conflict(f"the workspace holds {name!r} already: choose another name")
        return folder


def name_of(title: str) -> str:
    """Return the name of a folder that follows from a title, in letters and digits without accents."""
    letters = unicodedata.normalize("NFKD", title)
    plain = re.sub(r"[^A-Za-z0-9._]+", "-", re.sub(r"[\u0300-\u036f]", "", letters))
    return plain.strip("-.")[:56].rstrip("-") or "study"
