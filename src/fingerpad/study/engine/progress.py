"""Progress of a run."""

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, slots=True, kw_only=True)
class Progress:
    """Where a run stands. Loading curves count as pictures do.

    Attributes
    ----------
    item : str
        Observation, photograph, curve or sequence that has just been dealt with; empty at the start.
    file : str
        Its file, relative to the study folder; empty at the start.
    status : {"started", "done", "failed", "checked", "written"}
        What has happened. Once all is measured: ``checked``, the uncertainty of a contact was checked;
        ``written``, a file of the results is being written, which `item` names.
    pictures : int
        Pictures and frames dealt with so far, those of earlier runs included.
    failed : int
        Items that failed so far.
    total : int
        Pictures and frames in all.
    seconds : float
        What this one cost.
    """

    item: str = ""
    file: str = ""
    status: Literal["started", "done", "failed", "checked", "written"] = "started"
    pictures: int
    failed: int
    total: int
    seconds: float = 0.0
