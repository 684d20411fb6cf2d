"""The log of corrections, asked by one thread at a time."""

from collections.abc import Mapping
from pathlib import Path
from threading import Lock
from typing import Any

from fingerpad.study.corrections.history import ActiveCorrection, History, Record
from fingerpad.study.corrections.log import CorrectionLog
from fingerpad.study.manifest import Study


class Corrections:
    """The corrections of the open study; the library's log, which keeps its place in the file, behind a lock.

    Parameters
    ----------
    folder : Path
        The study folder.
    """

    def __init__(self, folder: Path) -> None:
        self._log = CorrectionLog(folder)
        self._lock = Lock()

    def history(self, item: str) -> History:
        """Return all decisions about an item."""
        with self._lock:
            return self._log.history(item)

    def active_correction(self, item: str) -> ActiveCorrection | None:
        """Return what rules for an item."""
        return self.history(item).active_correction

    def active_corrections(self) -> dict[str, ActiveCorrection]:
        """Return what rules, by item."""
        with self._lock:
            return self._log.active_corrections()

    def append(
        self,
        item: str,
        change: Mapping[str, Any],
        *,
        who: str,
        expected: int,
        study: Study,
        shape: tuple[int, int] | None,
        picture: str,
    ) -> Record:
        """Keep a change; once this returns, it is on the disk."""
        with self._lock:
            return self._log.append(
                item, change, who=who, expected=expected, study=study, shape=shape, picture=picture
            )

    def undo(self, item: str, *, who: str, expected: int) -> Record:
        """Take the newest change back."""
        with self._lock:
            return self._log.undo(item, who=who, expected=expected)

    def redo(self, item: str, *, who: str, expected: int) -> Record:
        """Put the change back that was taken back last."""
        with self._lock:
            return self._log.redo(item, who=who, expected=expected)
