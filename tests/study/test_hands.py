"""Those who do the tasks of a run: each process its share of the machine, and nothing else changed by it."""

import os
from pathlib import Path

import pytest

from fingerpad.study.engine.hands import local_hands
from fingerpad.study.engine.runner import records_of
from fingerpad.study.engine.store import STORE_NAME, Store
from fingerpad.study.engine.task import Record, Task


def threads(_folder: Path, _out: Path) -> Record:
    return {"process": os.getpid(), "threads": os.environ.get("OMP_NUM_THREADS")}


def failing(_folder: Path, _out: Path) -> Record:
    raise ValueError("nothing to see")


def task(number: int, work=threads) -> Task:
    return Task(name=str(number), item="", file=f"file {number}", key="", work=work, inputs=())


@pytest.mark.parametrize("before", [None, "4"])
def test_linear_algebra_of_a_worker_has_one_thread(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, before: str | None
) -> None:
    if before is None:
        monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    else:
        monkeypatch.setenv("OMP_NUM_THREADS", before)
    with Store.open(tmp_path / STORE_NAME) as store, local_hands(tmp_path, 2) as hands:
        records = records_of([task(number) for number in range(6)], hands, store)
    assert {record["threads"] for record in records} == {"1"}
    assert os.getpid() not in {record["process"] for record in records}
    assert os.environ.get("OMP_NUM_THREADS") == before


@pytest.mark.parametrize("workers", [1, 2])
def test_records_come_in_the_order_of_their_tasks(tmp_path: Path, workers: int) -> None:
    with Store.open(tmp_path / STORE_NAME) as store, local_hands(tmp_path, workers) as hands:
        records = records_of([task(0), task(1, failing), task(2)], hands, store)
    assert ["reason" in record for record in records] == [False, True, False]
    assert records[1]["reason"] == "file 1: cannot be measured (ValueError: nothing to see)"
