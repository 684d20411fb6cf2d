"""Words of a study: its files by the names that its manifest gives them, and counts of things."""

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


def counted(count: int, noun: str) -> str:
    """Return a count with its noun, in the plural where that is due.

    Examples
    --------
    >>> counted(1, "press"), counted(2, "press"), counted(3, "frame")
    ('1 press', '2 presses', '3 frames')
    """
    plural = f"{noun}es" if noun.endswith("s") else f"{noun}s"
    return f"{count} {noun if count == 1 else plural}"
