"""The task that opens a sequence, and counts its frames."""

from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Final

from fingerpad.image import open_frames
from fingerpad.study.engine.store import DamagedResultError
from fingerpad.study.engine.task import Record, Task
from fingerpad.study.manifest import ContactSequence
from fingerpad.study.measuring.context import RunContext, cache_key

# What says when a frame was taken and under which load, but nothing of what is seen in it.
TIMING: Final = frozenset(
    ("force", "force_columns", "times", "frames_per_second", "start_s", "contact_load_N")
)


def header_task(sequence: ContactSequence, context: RunContext) -> Task:
    """Return the task that opens a sequence: it counts the frames."""
    return Task(
        name=f"{sequence.name} header",  # no name of the manifest holds a blank
        item=sequence.name,
        file=sequence.file,
        key=cache_key(context.key(sequence, leave_out=TIMING), "header"),
        work=partial(_header, sequence.file),
        inputs=(sequence.file,),
        pictures=0,
    )


def _header(path: str, folder: Path, _out: Path) -> Record:
    header = asdict(open_frames(folder / path))
    del header["path"]
    return {"header": header}


def frame_count(sequence: ContactSequence, context: RunContext) -> int:
    """Return the number of frames of a sequence; 1 if it has not been opened, or cannot be."""
    header = header_task(sequence, context)
    try:
        record = context.record(header.name, header.key)
    except DamagedResultError:
        record = None
    return 1 if record is None or "header" not in record else int(record["header"]["count"])
