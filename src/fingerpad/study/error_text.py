"""Reasons in the words of a study: its files by the names that its manifest gives them."""

import os
from pathlib import Path


def in_study(words: object, folder: Path) -> str:
    """Return a message without the place of the study's folder on this machine.

    Examples
    --------
    >>> in_study("/home/me/study/prints/a.png: no such file", Path("/home/me/study"))
    'prints/a.png: no such file'
    """
    return str(words).replace(f"{folder}{os.sep}", "")
