"""The workspace: its studies, and those that are open."""

import getpass
import os
import re
import shutil
import unicodedata
from http import HTTPStatus
from importlib.metadata import version
from itertools import chain, count
from pathlib import Path
from threading import RLock
from typing import Any, Final

import fingerpad
from fingerpad.image import MEMORY_LIMIT
from fingerpad.report.text import VERDICT_SYMBOLS
from fingerpad.study.editing.edit import title_of
from fingerpad.study.editing.propose import TAKES, USES
from fingerpad.study.editing.scales import CARD, COINS, SCALE_WAYS
from fingerpad.study.imports.names import AMBIGUOUS, FACES, NUMBER
from fingerpad.study.manifest.load import STUDY_NAME
from fingerpad.study.results.result_set import RESULTS_NAME
from fingerpad.study.results.table import GLOSSARY
from fingerpad.web.errors import RequestError
from fingerpad.web.events import Events
from fingerpad.web.pictures import Pictures
from fingerpad.web.study_session import StudySession

UPLOAD_LIMIT: Final = 4 * 2**30
# A folder's name holds letters, digits and . _ + - only, as all names of a study.
NAME: Final = r"^\w[\w.+-]{0,59}$"
# The version changes the address, so that browsers may keep the script.
PLOTLY_ADDRESS: Final = f"/static/vendor/plotly-{version('plotly')}.min.js"

_RULES: Final = {
    # As NAME, in the regular expressions of browsers.
    "name": r"[\p{L}\p{N}_][\p{L}\p{N}_.+\-]*",
    "number": NUMBER,
    "ambiguous": AMBIGUOUS,
    "faces": FACES,
    "uses": USES,
    "takes": TAKES,
    "scale_ways": SCALE_WAYS,
    "coins": COINS,
    "card": CARD,
    "verdicts": VERDICT_SYMBOLS,
}


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
        self.upload_limit, self.import_limit, self.memory_limit = upload_limit, import_limit, memory_limit
        self.pictures = Pictures(memory_limit)
        self._open: dict[Path, StudySession] = {}
        self._last: StudySession | None = None
        self._lock = RLock()

    def session(self, name: str) -> StudySession:
        """Return a study by its name, opened if it is not."""
        with self._lock:
            found = next((one for one in self._open.values() if one.name == name), None)
            return found or self._session(self._folder_of(name))

    def describe(self) -> dict[str, Any]:
        """Return the studies of the workspace and the one that was opened last."""
        study = self._last
        return {
            "version": fingerpad.__version__,
            "study": None if study is None else {"name": study.name, "title": study.study().title},
            "workspace": self.workspace.name,
            "studies": [{"name": name, "title": title_of(self.workspace / name)} for name in self.studies()],
            "who": _login(),
            "plotly": PLOTLY_ADDRESS,
            "glossary": GLOSSARY,
            "rules": _RULES,
        }

    def studies(self) -> list[str]:
        """Return the names of the workspace's studies."""
        try:
            with os.scandir(self.workspace) as entries:
                folders = [Path(entry.path) for entry in entries if entry.is_dir(follow_symlinks=False)]
        except OSError:
            return []
        return sorted(f.name for f in folders if (f / STUDY_NAME).is_file())

    def open(self, name: str) -> StudySession:
        """Open one of the workspace's studies, with its results beside its manifest."""
        return self.open_folder(self._folder_of(name))

    def _folder_of(self, name: str) -> Path:
        if name not in self.studies():
            raise RequestError.not_there(f"the workspace holds no study {name!r}")
        return self.workspace / name

    def open_folder(self, folder: Path, out: Path | None = None) -> StudySession:
        """Open the study in a folder; others stay open."""
        with self._lock:
            self._last = self._session(folder, out)
            return self._last

    def _session(self, folder: Path, out: Path | None = None) -> StudySession:
        folder = folder.absolute()
        if folder not in self._open:
            self._open[folder] = StudySession(
                folder,
                out=(out or folder / RESULTS_NAME).absolute(),
                events=Events(),
                pictures=self.pictures,
                memory_limit=self.memory_limit,
            )
        return self._open[folder]

    def close(self) -> None:
        """Close all studies; runs are stopped, and their finished measurements are kept."""
        with self._lock:
            closed, self._open, self._last = list(self._open.values()), {}, None
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


def _login() -> str:
    """Return the user's login name, empty on systems without one."""
    try:
        return getpass.getuser()
    except (OSError, KeyError):
        return ""
