"""What tasks of the tests perform, in a module that a worker imports at once."""

import os
import signal
import time
from pathlib import Path

import numpy as np

from fingerpad.study.engine.task import Record


def process(*_: Path) -> Record:
    return {"process": os.getpid(), "threads": os.environ.get("OMP_NUM_THREADS")}


def failing(*_: Path) -> Record:
    raise ValueError("nothing to see")


def odd(*_: Path) -> Record:
    return {}["of a damaged file"]


def crashing(*_: Path) -> Record:
    os.kill(os.getpid(), signal.SIGSEGV)
    raise AssertionError


def killed(*_: Path) -> Record:
    os.kill(os.getpid(), signal.SIGKILL)
    raise AssertionError


def crashing_once(folder: Path, _out: Path) -> Record:
    if not (folder / "crashed").exists():
        (folder / "crashed").touch()
        os._exit(3)
    return {"process": os.getpid()}


def endless(*_: Path) -> Record:
    while True:
        time.sleep(1)


def lasting(*_: Path) -> Record:
    time.sleep(1)
    return {"process": os.getpid()}


def greedy(*_: Path) -> Record:
    return {"sum": float(np.ones((1 << 30,)).sum())}  # 8 GB


def full(*_: Path) -> Record:
    raise OSError(28, "No space left on device")


def drawing(_folder: Path, out: Path) -> Record:
    print("libraries print what they like")
    (out / "figures").mkdir()
    (out / "figures" / "a.svg").write_text("<svg/>")
    return {}
