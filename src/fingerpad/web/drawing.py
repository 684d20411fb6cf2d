"""Matplotlib's settings are the process's: one drawing at a time."""

from threading import Lock
from typing import Final

DRAWING: Final = Lock()
