"""Performing tasks: in processes of their own, within limits, and nothing else of the machine changed."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest
from tests.study import works
from tests.waiting import wait_until

from fingerpad.exceptions import StoreError
from fingerpad.study.engine.runner import records_of, run_plans
from fingerpad.study.engine.store import STORE_NAME, Store
from fingerpad.study.engine.task import DEFAULT_LIMITS, Limits, Record, Task
from fingerpad.study.engine.worker import LocalExecutor, Worker


def task(number: int, work=works.process) -> Task:
    return Task(name=str(number), item="", file=f"file {number}", key="k", work=work, inputs=())


def records(folder: Path, *works, workers: int = 1, limits: Limits = DEFAULT_LIMITS) -> list[Record]:
    tasks = [task(number, work) for number, work in enumerate(works)]
    folder.mkdir(exist_ok=True)
    with (
        Store.writing(folder / STORE_NAME) as store,
        closing(LocalExecutor(folder, workers, limits)) as executor,
    ):
        return list(records_of(tasks, executor, store, folder).values())


def test_linear_algebra_of_a_worker_has_one_thread(tmp_path, monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "4")
    found = records(tmp_path, *[works.process] * 6, workers=2)
    assert {record["threads"] for record in found} == {"1"}
    assert os.getpid() not in {record["process"] for record in found}
    assert os.environ.get("OMP_NUM_THREADS") == "4"


def test_tasks_are_asked_for_as_they_can_be_performed(tmp_path):
    asked: list[int] = []
    before_each: list[int] = []

    def tasks() -> Iterator[Task]:
        for number in range(5):
            asked.append(number)
            yield task(number)

    with Store.writing(tmp_path / STORE_NAME) as store, closing(LocalExecutor(tmp_path, 1)) as executor:
        found = records_of(tasks(), executor, store, tmp_path, lambda _: before_each.append(len(asked)))
    assert len(found) == 5
    assert before_each[0] == executor.capacity == 2


@pytest.mark.parametrize("workers", [1, 2])
def test_records_come_in_the_order_of_their_tasks(tmp_path, workers):
    found = records(tmp_path, works.process, works.failing, works.odd, works.process, workers=workers)
    assert ["reason" in record for record in found] == [False, True, True, False]
    assert found[1]["reason"] == "file 1: cannot be measured (ValueError: nothing to see)"
    assert found[2]["reason"] == "file 2: cannot be measured (KeyError: 'of a damaged file')"


@pytest.mark.parametrize(
    ("workers", "work", "words"),
    [
        (2, works.crashing, "file 1: the process that measured it crashed twice (signal SIGSEGV)"),
        (1, works.killed, "file 1: the process that measured it was killed twice, as happens where memory"),
    ],
)
def test_a_task_that_kills_its_process_is_named_and_the_others_go_on(tmp_path, workers, work, words):
    found = records(tmp_path, works.process, work, works.process, works.crashing_once, workers=workers)
    assert found[1]["reason"].startswith(words)
    assert ["reason" in record for record in found] == [False, True, False, False]


def test_a_task_that_never_ends_is_ended_and_tried_again_only_with_more_time(tmp_path):
    # On a busy machine a new process takes seconds to import the work itself.
    found = records(tmp_path, works.endless, works.process, limits=Limits(seconds=6))
    assert found[0]["reason"].startswith("file 0: measuring it takes longer than 6 s")
    assert "reason" not in found[1]
    # Whether a task is performed again shows in what another work makes of it.
    assert records(tmp_path, works.process, works.process, limits=Limits(seconds=5)) == found
    assert "reason" not in records(tmp_path, works.process, works.process, limits=Limits(seconds=60))[0]


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="memory is limited on Linux only")
def test_a_task_that_takes_too_much_memory_fails_by_name(tmp_path):
    found = records(tmp_path, works.greedy, works.process, limits=Limits(memory_gb=0.5))
    assert found[0]["reason"].startswith("file 0: measuring it takes more than 0.5 GB of memory")
    assert "reason" not in found[1]


def test_a_time_limit_that_runs_out_just_after_the_answer_costs_no_later_task(tmp_path, monkeypatch):
    ran_out = threading.Event()
    ask, end_late = Worker._ask, Worker._end_late

    def answered_in_time(worker: Worker, question: object) -> object:
        answer = ask(worker, question)
        assert ran_out.wait(60)
        return answer

    def end_after_a_moment(worker: Worker) -> None:
        ran_out.set()
        time.sleep(0.3)
        end_late(worker)

    monkeypatch.setattr(Worker, "_ask", answered_in_time)
    monkeypatch.setattr(Worker, "_end_late", end_after_a_moment)
    (first,) = records(tmp_path / "first", works.process, limits=Limits(seconds=0.1))
    monkeypatch.undo()
    (second,) = records(tmp_path / "second", works.lasting)
    assert "reason" not in first
    assert "reason" not in second
    assert second["process"] != first["process"]


def test_a_full_disk_ends_the_run(tmp_path):
    with pytest.raises(StoreError, match="the disk is full"):
        records(tmp_path, works.full)


def test_what_is_drawn_is_kept_and_what_is_printed_does_no_harm(tmp_path):
    records(tmp_path, works.drawing)
    with Store.reading(tmp_path / STORE_NAME) as store:
        ((name, digest),) = store.statuses()["0"].drawn.items()
        assert name == "figures/a.svg"
        assert store.drawn_file(name, digest).read_text() == "<svg/>"


def test_workers_end_with_their_parent(tmp_path):
    pid = os.fork()
    if not pid:
        try:
            (record,) = records(tmp_path, works.process)
            (tmp_path / "worker").write_text(str(record["process"]))
            time.sleep(60)
        finally:
            os._exit(1)
    assert wait_until(lambda: (tmp_path / "worker").is_file() and (tmp_path / "worker").read_text())
    worker = int((tmp_path / "worker").read_text())
    os.kill(pid, signal.SIGKILL)
    os.waitpid(pid, 0)
    assert wait_until(lambda: not _is_running(worker))


def test_a_worker_whose_answer_nobody_takes_ends_without_a_word():
    serve = "from fingerpad.study.engine.worker import serve; serve()"
    with subprocess.Popen([sys.executable, "-c", serve], stdin=-1, stdout=-1, stderr=-1) as worker:
        worker.stdout.close()
        assert (worker.stderr.read(), worker.wait()) == (b"", 1)


def _is_running(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_a_second_interrupt_does_not_wait(tmp_path):
    stored = []

    def interrupt() -> None:
        for _ in range(2):
            time.sleep(0.3)
            os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=interrupt)

    def plans() -> Iterator[list[Task]]:
        thread.start()
        yield [task(0, works.endless)]

    with closing(LocalExecutor(tmp_path, 1)) as executor, pytest.raises(KeyboardInterrupt):
        run_plans([plans()], executor, lambda *one: stored.append(one), lambda _: False)
    thread.join()
    assert stored == []
