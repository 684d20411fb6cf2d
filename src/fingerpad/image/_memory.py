"""The memory that a picture takes, by its header, before anything is decoded."""

from os import PathLike
from typing import Final

from fingerpad.exceptions import ImageError

MEMORY_LIMIT: Final = 2_000_000_000
# Six copies in single precision are more than measuring holds at a time.
_MEASURING_BYTES: Final = 24


def check_memory(
    path: str | PathLike[str],
    size: tuple[int, int],
    memory_limit: int,
    *,
    channels: int,
    sample_bytes: int,
) -> None:
    """Refuse a picture of (columns, rows) that is too large by its header.

    Raises
    ------
    ImageError
        If it has no pixels, or needs more than `memory_limit` bytes.
    """
    columns, rows = size
    if not (columns > 0 and rows > 0):
        raise ImageError(f"{path}: has {columns} × {rows} pixels, the file is damaged: copy it again")
    # Two copies as decoded, and those for measuring.
    needed = columns * rows * (2 * channels * sample_bytes + _MEASURING_BYTES)
    if needed > memory_limit:
        raise ImageError(
            f"{path}: {columns} × {rows} pixels of {channels} × {8 * sample_bytes} bits take "
            f"{needed / 1e9:.2g} GB to read and measure, more than the limit of {memory_limit / 1e9:.2g} GB: "
            "crop or shrink the picture, or raise memory_limit (bytes)"
        )
