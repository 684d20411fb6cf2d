"""Measuring by the workers of a Dask scheduler: a real one, and worker processes that it reaches over TCP."""

import os
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import suppress
from importlib import metadata
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING

import pytest
from tests import command
from tests.study.small_study import FRAMES, PICTURES
from tests.study.works import crashing
from tests.waiting import wait_until

from fingerpad.exceptions import ClusterError
from fingerpad.study.engine import cluster
from fingerpad.study.engine.runner import Progress
from fingerpad.study.engine.task import Limits, Task, working_code
from fingerpad.study.pipeline import run_study
from fingerpad.study.results.table import Row, records

if TYPE_CHECKING:
    from distributed import Client

TOTAL = PICTURES + 2 + FRAMES
CRASHING = Task(name="a", item="a", file="a.png", key="k", work=crashing, inputs=())


@pytest.fixture(autouse=True)
def patience(small_pieces, monkeypatch) -> None:
    monkeypatch.setattr(cluster, "_WAIT_S", 120)


def client(address: str) -> "Client":
    """Return a client of a scheduler; to import what it is of takes as long as all else of this module."""
    from distributed import Client  # noqa: PLC0415

    return Client(address, timeout=60, set_as_default=False)


class Scheduler:
    """A scheduler, started by the line of the README."""

    def __init__(self) -> None:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        self.address = f"tcp://127.0.0.1:{port}"
        self.process = start("scheduler", "--host", "127.0.0.1", "--port", str(port))

    def workers(self) -> int:
        with client(self.address) as there:
            return len(there.nthreads())


def start(*words: str) -> subprocess.Popen:
    """Start a process of Dask, in a group of its own, which finds here what crashes."""
    path = os.pathsep.join([str(Path(__file__).parents[2]), os.environ.get("PYTHONPATH", "")])
    quiet = {"DASK_LOGGING__DISTRIBUTED": "critical", "PYTHONWARNINGS": "ignore", "PYTHONPATH": path}
    return subprocess.Popen(
        [sys.executable, "-m", "dask", *words, "--no-dashboard"],
        env=os.environ | quiet,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )


def end(process: subprocess.Popen) -> None:
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


class Workers:
    """Workers of a scheduler."""

    def __init__(self, scheduler: Scheduler, folder: Path) -> None:
        self.address, self._folder = scheduler.address, folder
        self.started: list[subprocess.Popen] = []

    def start(self, *words: str) -> None:
        """Start a worker; with `--no-nanny` without a second process that starts it again when it ends."""
        home = ("worker", self.address, "--nthreads", "1", "--local-directory", str(self._folder))
        self.started.append(start(*home, *words))

    def end(self) -> None:
        for process in self.started:
            end(process)


@pytest.fixture(scope="module")
def scheduler() -> Iterator[Scheduler]:
    started = Scheduler()
    yield started
    end(started.process)


@pytest.fixture
def workers(scheduler, tmp_path) -> Iterator[Workers]:
    """Return the workers of one test, of which the scheduler forgets before the next."""
    started = Workers(scheduler, tmp_path / "dask")
    yield started
    started.end()
    assert wait_until(lambda: not scheduler.workers())


def rows(manifest: Path, **options: object) -> list[Row]:
    return list(records(run_study(manifest, manifest.parent / "out", **options).rows))


def test_two_workers_give_the_rows_of_one_process_though_one_is_killed(unfinished, undisturbed, workers):
    workers.start()
    workers.start()
    reported: list[Progress] = []

    def kill_one(progress: Progress) -> None:
        reported.append(progress)
        if len(reported) == 4:
            with client(workers.address) as there:
                pids = there.run(os.getpid)
                assert len(pids) == 2
                os.kill(next(iter(pids.values())), signal.SIGKILL)

    assert rows(unfinished, scheduler=workers.address, on_progress=kill_one) == undisturbed
    assert reported[-1].pictures == reported[-1].total == TOTAL


@pytest.mark.nightly
def test_a_killed_scheduler_costs_only_what_was_in_hand(unfinished, undisturbed, tmp_path):
    scheduler = Scheduler()
    workers = Workers(scheduler, tmp_path / "dask")
    workers.start("--no-nanny")
    reported: list[Progress] = []

    def kill_it(progress: Progress) -> None:
        reported.append(progress)
        if progress.pictures > reported[0].pictures:
            scheduler.process.kill()

    try:
        with pytest.raises(ClusterError, match="the scheduler is gone.*run again"):
            rows(unfinished, scheduler=scheduler.address, on_progress=kill_it)
    finally:
        end(scheduler.process)
        workers.end()
    again: list[Progress] = []
    assert rows(unfinished, on_progress=again.append) == undisturbed
    assert again[0].pictures >= reported[-1].pictures > reported[0].pictures


def test_a_worker_of_another_version_or_that_does_not_see_the_study_is_refused(small_study, monkeypatch):
    here = SimpleNamespace(run=lambda look, path: {"tcp://w:1": look(path)})
    cluster._require_fit(here, small_study)
    lost = small_study.with_name("lost.toml")
    with pytest.raises(
        ClusterError, match=rf"tcp://w:1 on {socket.gethostname()} does not see {lost}: put .*"
    ):
        cluster._require_fit(here, lost)
    monkeypatch.setattr(metadata, "version", lambda _: "0.0.7")
    with pytest.raises(ClusterError, match=r"worker tcp://w:1 has fingerpad 0\.0\.7, this is .*: install"):
        cluster._require_fit(here, small_study)


def test_a_worker_that_comes_later_is_refused_with_its_task(small_study, monkeypatch):
    monkeypatch.setattr("distributed.get_worker", lambda: SimpleNamespace(address="tcp://w:2"))
    for manifest, code, words in (
        (small_study, "other", r"worker tcp://w:2 has another fingerpad than this"),
        (small_study.with_name("lost.toml"), working_code(), r"worker tcp://w:2 on \S+ does not see"),
    ):
        with pytest.raises(ClusterError, match=words):
            cluster._perform_there(CRASHING, str(manifest), Limits(), code)


@pytest.mark.nightly
def test_workers_that_are_all_dead_end_the_run_in_words(unfinished, undisturbed, workers, monkeypatch):
    monkeypatch.setattr(cluster, "_COUNT_AGAIN_S", 0.5)
    workers.start()
    reported: list[Progress] = []

    def kill_all(progress: Progress) -> None:
        reported.append(progress)
        if progress.pictures > reported[0].pictures:
            monkeypatch.setattr(cluster, "_WAIT_S", 3)
            workers.end()

    with pytest.raises(ClusterError, match="has had no worker for 3 s: what was measured is kept"):
        rows(unfinished, scheduler=workers.address, on_progress=kill_all)
    assert rows(unfinished) == undisturbed


def test_a_task_that_crashes_is_named_and_costs_no_worker(small_study, tmp_path, workers):
    workers.start("--no-nanny")
    with cluster.cluster_executor(small_study, 1, workers.address, Limits()) as executor:
        result = executor.submit(CRASHING).result(60)
        with client(workers.address) as there:
            assert len(there.nthreads()) == 1
    assert result.record["reason"].startswith("a.png: the process that measured it crashed twice")


@pytest.mark.parametrize(
    ("address", "words"),
    [
        ("tcp://127.0.0.1:9", "no scheduler answers"),
        ("nonsense", "--scheduler takes an address, as in tcp://host:8786, or local; found 'nonsense'"),
        ("tls://127.0.0.1:9", "no certificate is configured"),
        ("", "has no worker: start some with `dask worker tcp://"),
    ],
)
def test_a_scheduler_that_is_none_or_has_no_workers(
    small_study, tmp_path, scheduler, monkeypatch, address, words
):
    monkeypatch.setattr(cluster, "_WAIT_S", 1)
    where = ("--out", tmp_path / "out", "--scheduler", address or scheduler.address)
    assert words in command.refusal("run", small_study, *where)


@pytest.mark.nightly
def test_waiting_for_one_result_delays_no_other(workers):
    workers.start("--no-nanny")
    lost, seen = threading.Event(), threading.Event()
    with client(workers.address) as there:
        cluster.when_done(there.submit(sum, [1]), lambda _: lost.wait())
        cluster.when_done(there.submit(sum, [2]), lambda _: seen.set())
        came = seen.wait(60)
        lost.set()
    assert came


@pytest.mark.nightly
def test_a_scheduler_of_ones_own(unfinished, undisturbed):
    assert rows(unfinished, workers=2, scheduler="local") == undisturbed


@pytest.mark.nightly
def test_an_interrupt_of_the_whole_terminal_ends_a_run_on_workers_of_its_own(small_study, tmp_path):
    log = tmp_path / "log.jsonl"
    words = ["--out", str(tmp_path / "out"), "--scheduler", "local", "--workers", "1", "--log", str(log)]
    run = subprocess.Popen(
        [sys.executable, "-m", "fingerpad", "run", str(small_study), *words],
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    try:
        assert wait_until(lambda: log.is_file() and log.read_text().count("\n") > 1)
        os.killpg(run.pid, signal.SIGINT)
        said = run.communicate(timeout=45)[1]
    finally:
        with suppress(ProcessLookupError):
            os.killpg(run.pid, signal.SIGKILL)
        run.wait()
    assert run.returncode == 130
    assert "Traceback" not in said
