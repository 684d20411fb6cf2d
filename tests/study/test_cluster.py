"""Measuring by the workers of a Dask scheduler: a real one, and worker processes that it reaches over TCP."""

import os
import shutil
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path

import pytest
from distributed import Client
from tests.study.small_study import FRAMES, PICTURES, copy
from tests.waiting import wait_until
from typer.testing import CliRunner

import fingerpad
from fingerpad.cli import app
from fingerpad.exceptions import ClusterError
from fingerpad.study.engine import cluster
from fingerpad.study.engine.limits import Limits
from fingerpad.study.engine.progress import Progress
from fingerpad.study.engine.task import Task
from fingerpad.study.measuring import sequences
from fingerpad.study.pipeline import run_study

TOTAL = PICTURES + 2 + FRAMES
_BLIND = 'mount -t tmpfs none "$0" && exec "$@"'


@pytest.fixture(autouse=True)
def small_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sequences, "_LEAST_PIECE", 5)
    monkeypatch.setattr(cluster, "_WAIT_S", 15)


@pytest.fixture(scope="module")
def made(small_study_of_tiff: Path) -> Path:
    return small_study_of_tiff


@pytest.fixture(scope="module")
def undisturbed(made: Path, tmp_path_factory: pytest.TempPathFactory) -> list[dict]:
    return list(run_study(made, tmp_path_factory.mktemp("undisturbed")).rows)


class Processes:
    """A scheduler and its workers, started by the lines of the README."""

    def __init__(self, folder: Path) -> None:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        self.address, self._folder = f"tcp://127.0.0.1:{port}", folder
        self._environment = os.environ | {"DASK_LOGGING__DISTRIBUTED": "critical", "PYTHONWARNINGS": "ignore"}
        self.started: list[subprocess.Popen] = []
        self.scheduler = self._start("scheduler", "--host", "127.0.0.1", "--port", str(port))

    def worker(self, *, path: str | None = None, blind_to: Path | None = None) -> None:
        """Start a worker, with its own path of packages, or in a world in which a folder is empty."""
        words = ["worker", self.address, "--nthreads", "1", "--local-directory", str(self._folder)]
        hidden = [] if blind_to is None else ["unshare", "-m", "sh", "-c", _BLIND, str(blind_to)]
        self._start(*words, before=hidden, **({} if path is None else {"PYTHONPATH": path}))

    def _start(self, *words: str, before: Sequence[str] = (), **environment: str) -> subprocess.Popen:
        process = subprocess.Popen(
            [*before, sys.executable, "-m", "dask", *words, "--no-dashboard"],
            env=self._environment | environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        self.started.append(process)
        return process

    def end(self) -> None:
        for process in self.started:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()


@pytest.fixture
def processes(tmp_path: Path) -> Iterator[Processes]:
    started = Processes(tmp_path / "dask")
    yield started
    started.end()


def run(
    manifest: Path, out: Path, scheduler: str, reported: Callable[[Progress], None] = lambda _: None
) -> list:
    return list(run_study(manifest, out, scheduler=scheduler, on_progress=reported).rows)


def test_two_workers_give_the_rows_of_one_process_though_one_is_killed(
    made: Path, undisturbed: list[dict], tmp_path: Path, processes: Processes
) -> None:
    processes.worker()
    processes.worker()
    reported: list[Progress] = []

    def kill_one(progress: Progress) -> None:
        reported.append(progress)
        if len(reported) == 4:
            with Client(processes.address, set_as_default=False) as client:
                workers = client.run(os.getpid)
                assert len(workers) == 2
                os.kill(next(iter(workers.values())), signal.SIGKILL)

    assert run(made, tmp_path / "out", processes.address, kill_one) == undisturbed
    assert reported[-1].pictures == reported[-1].total == TOTAL


def test_a_killed_scheduler_costs_only_what_was_in_hand(
    made: Path, undisturbed: list[dict], tmp_path: Path, processes: Processes
) -> None:
    processes.worker()
    reported: list[Progress] = []

    def kill_it(progress: Progress) -> None:
        reported.append(progress)
        if progress.pictures:
            processes.scheduler.kill()

    with pytest.raises(ClusterError, match="the scheduler is gone.*run again"):
        run(made, tmp_path / "out", processes.address, kill_it)
    again: list[Progress] = []
    assert list(run_study(made, tmp_path / "out", on_progress=again.append).rows) == undisturbed
    assert again[0].pictures >= reported[-1].pictures > 0


def test_workers_that_do_not_see_the_study_are_sent_its_bytes(
    made: Path, undisturbed: list[dict], tmp_path: Path, processes: Processes
) -> None:
    manifest = copy(made, tmp_path / "study")
    processes.worker(blind_to=manifest.parent)
    assert run(manifest, tmp_path / "out", processes.address) == undisturbed


def test_a_worker_of_another_version_is_refused_by_its_name(
    made: Path, tmp_path: Path, processes: Processes
) -> None:
    other = tmp_path / "other" / "fingerpad-0.0.7.dist-info"
    other.mkdir(parents=True)
    (other / "METADATA").write_text("Metadata-Version: 2.1\nName: fingerpad\nVersion: 0.0.7\n")
    processes.worker(path=str(other.parent))
    with pytest.raises(ClusterError, match=r"worker tcp://\S+ has fingerpad 0\.0\.7, this is .*: install"):
        run(made, tmp_path / "out", processes.address)


def test_a_worker_of_other_code_is_refused_by_its_name(
    made: Path, tmp_path: Path, processes: Processes
) -> None:
    package = Path(shutil.copytree(Path(fingerpad.__file__).parent, tmp_path / "src" / "fingerpad"))
    with (package / "image" / "scale.py").open("a") as file:
        file.write("\n# changed\n")
    processes.worker(path=str(package.parent))
    with pytest.raises(ClusterError, match=r"worker tcp://\S+ has another fingerpad than this"):
        run(made, tmp_path / "out", processes.address)


def test_workers_that_are_all_dead_end_the_run_in_words(
    made: Path, undisturbed: list[dict], tmp_path: Path, processes: Processes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "_COUNT_AGAIN_S", 0.5)
    processes.worker()

    def kill_all(progress: Progress) -> None:
        if progress.pictures:
            monkeypatch.setattr(cluster, "_WAIT_S", 3)
            for process in processes.started[1:]:
                with suppress(ProcessLookupError):
                    os.killpg(process.pid, signal.SIGKILL)

    with pytest.raises(ClusterError, match="has had no worker for 3 s: what was measured is kept"):
        run(made, tmp_path / "out", processes.address, kill_all)
    assert list(run_study(made, tmp_path / "out").rows) == undisturbed


def crashing(_folder: Path, _out: Path) -> dict:
    os.kill(os.getpid(), signal.SIGSEGV)
    raise AssertionError


def test_a_task_that_crashes_is_named_and_costs_no_worker(
    made: Path, tmp_path: Path, processes: Processes
) -> None:
    processes.worker(path=str(Path(__file__).parents[2]))
    task = Task(name="a", item="a", file="a.png", key="k", work=crashing, inputs=())
    with cluster.cluster_executor(made, 1, processes.address, Limits()) as executor:
        result = executor.submit(task).result(60)
        with Client(processes.address, set_as_default=False) as client:
            assert len(client.nthreads()) == 1
    assert result.record["reason"].startswith("a.png: the process that measured it crashed twice")


@pytest.mark.parametrize(
    ("address", "words"),
    [
        ("tcp://127.0.0.1:9", "no scheduler answers"),
        ("nonsense", "--scheduler takes an address, as in tcp://host:8786, or local; found 'nonsense'"),
        ("tls://127.0.0.1:9", "no certificate is configured"),
    ],
)
def test_wrong_address(
    made: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, address: str, words: str
) -> None:
    monkeypatch.setattr(cluster, "_WAIT_S", 3)
    assert words in refusal(made, tmp_path / "out", address)


def test_scheduler_without_workers(
    made: Path, tmp_path: Path, processes: Processes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "_WAIT_S", 3)
    words = f"has no worker: start some with `dask worker {processes.address}"
    assert words in refusal(made, tmp_path / "out", processes.address)


def refusal(manifest: Path, out: Path, scheduler: str) -> str:
    """Return what the command says when it refuses to run."""
    result = CliRunner().invoke(app, ["run", str(manifest), "--out", str(out), "--scheduler", scheduler])
    assert (result.exit_code, result.exception.__class__) == (2, SystemExit)
    return " ".join(result.stderr.split())


def test_waiting_for_one_result_delays_no_other(processes: Processes) -> None:
    processes.worker()
    lost, seen = threading.Event(), threading.Event()
    with Client(processes.address, timeout=60, set_as_default=False) as client:
        cluster.when_done(client.submit(sum, [1]), lambda _: lost.wait())
        cluster.when_done(client.submit(sum, [2]), lambda _: seen.set())
        came = seen.wait(60)
        lost.set()
    assert came


def test_a_scheduler_of_ones_own(made: Path, undisturbed: list[dict], tmp_path: Path) -> None:
    assert list(run_study(made, tmp_path / "out", workers=2, scheduler="local").rows) == undisturbed


def test_an_interrupt_of_the_whole_terminal_ends_a_run_on_workers_of_its_own(
    made: Path, tmp_path: Path
) -> None:
    log = tmp_path / "log.jsonl"
    words = ["--out", str(tmp_path / "out"), "--scheduler", "local", "--workers", "2", "--log", str(log)]
    run = subprocess.Popen(
        [sys.executable, "-m", "fingerpad", "run", str(made), *words],
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
