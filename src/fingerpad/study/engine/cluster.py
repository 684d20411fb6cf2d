"""Measuring on many machines: the workers of a Dask scheduler.

Workers that see the study folder under the path that it has here read it themselves; the files of each task
are sent to others. A worker must run the very code that this process runs. It performs each task in a child
process, within the same limits as on one machine.
"""

import logging
import math
import re
from collections import OrderedDict
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Future
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Thread
from time import monotonic
from typing import Any, Final

import fingerpad
from fingerpad.exceptions import ClusterError
from fingerpad.study.engine.limits import Limits
from fingerpad.study.engine.task import Task, TaskResult, working_code
from fingerpad.study.engine.worker import IsolatedRunner

_ADDRESS: Final = re.compile(r"((tcp|tls|ws|wss|ucx)://)?([\w.-]+|\[[0-9a-fA-F:.]+\]):\d{1,5}")
_WAIT_S: Final = 30
_COUNT_AGAIN_S: Final = 5
# Files of so many tasks stay with the workers: the pieces of a sequence follow one another.
_KEPT: Final = 4
_GONE: Final = "the scheduler is gone: what was measured is kept; start it again and run again to go on"


class ClusterExecutor:
    """The workers of a Dask scheduler."""

    def __init__(self, client: Any, folder: Path, limits: Limits, *, sends: bool) -> None:
        self.limits = limits
        self._client, self._folder, self._sends = client, folder, sends
        self._sent: OrderedDict[tuple[str, ...], Any] = OrderedDict()
        self._counted, self._threads = -math.inf, 1
        self._last_seen = monotonic()

    @property
    def capacity(self) -> int:
        """Twice the number of threads that the workers have at present."""
        self._count_threads()
        return 2 * max(1, self._threads)

    def require_workers(self) -> None:
        """Raise `ClusterError` if there has been no worker for a while."""
        self._count_threads()
        if monotonic() > self._last_seen + _WAIT_S:
            raise ClusterError(
                f"the scheduler has had no worker for {_WAIT_S} s: what was measured is kept; start some "
                "with `dask worker`, and run again to go on"
            )

    def _count_threads(self) -> None:
        if monotonic() > self._counted + _COUNT_AGAIN_S:
            self._counted = monotonic()
            with suppress(ClusterError), _connected(self._client):  # tasks report a scheduler that is gone
                self._threads = sum(self._client.nthreads().values())
        if self._threads:
            self._last_seen = monotonic()

    def submit(self, task: Task) -> Future[TaskResult]:
        """Hand a task to the scheduler."""
        files = self._files(task) if self._sends else None
        with _connected(self._client):
            remote = self._client.submit(
                _perform_there, task, str(self._folder), self.limits, working_code(), files, pure=False
            )
        future: Future[TaskResult] = Future()
        future.set_running_or_notify_cancel()  # an interrupt waits for what is at work
        when_done(remote, lambda done: _pass_on(done, future, task.file, self.limits))
        return future

    def _files(self, task: Task) -> Any:
        """Return the files of a task, sent to the workers once for all tasks that share them."""
        if not task.inputs:
            return {}
        if task.inputs not in self._sent:
            content = {name: _read(self._folder / name) for name in task.inputs}
            with _connected(self._client):
                self._sent[task.inputs] = self._client.scatter(content, hash=False)
            while len(self._sent) > _KEPT:
                self._sent.popitem(last=False)
        self._sent.move_to_end(task.inputs)
        return self._sent[task.inputs]


@contextmanager
def _connected(client: Any) -> Iterator[None]:
    """Raise `ClusterError` where the connection breaks, or was given up after a while without an answer."""
    try:
        yield
    except Exception as error:
        # What a client raises once it is closed depends on the call.
        if isinstance(error, OSError) or client.status in {"closing", "closed"}:
            raise ClusterError(_GONE) from error
        raise


# A terminal interrupts workers that are started here too: their tasks in progress would be lost.
_LEAVE_INTERRUPTS: Final = "import signal\nsignal.signal(signal.SIGINT, signal.SIG_IGN)\n"


@contextmanager
def cluster_executor(
    manifest: Path, workers: int, scheduler: str, limits: Limits
) -> Iterator[ClusterExecutor]:
    """Provide the workers of a scheduler as an executor.

    Parameters
    ----------
    manifest : Path
        The study's manifest; workers that can read it here are taken to see the whole study folder.
    workers : int
        Number of worker processes of a scheduler that is started here.
    scheduler : str
        Its address, as ``tcp://host:8786`` or ``tls://host:8786``, or ``local`` to start one here.
    limits : Limits
        What measuring a picture may take.

    Raises
    ------
    ClusterError
        If Dask is not installed, the address is none, the scheduler does not answer, it has no worker, or a
        worker lacks this version of fingerpad.
    """
    if scheduler != "local" and not _ADDRESS.fullmatch(scheduler):
        raise ClusterError(
            f"--scheduler takes an address, as in tcp://host:8786, or local; found {scheduler!r}"
        )
    try:
        import distributed
    except ModuleNotFoundError:
        raise ClusterError("--scheduler needs Dask: pip install 'fingerpad[cluster]'") from None
    with ExitStack() as stack:
        stack.enter_context(_quiet())
        if scheduler == "local":
            start: Any = distributed.LocalCluster
            started = start(
                n_workers=workers,
                threads_per_worker=1,
                dashboard_address="127.0.0.1:0",  # any free port, for this machine alone
                protocol="tcp://",
                preload=[_LEAVE_INTERRUPTS],
            )
            scheduler = stack.enter_context(started).scheduler_address
        security: Any = distributed.Security
        if scheduler.startswith("tls://") and security().tls_ca_file is None:
            raise ClusterError(
                f"{scheduler}: no certificate is configured: name yours in "
                "DASK_DISTRIBUTED__COMM__TLS__CA_FILE, …__CLIENT__CERT and …__CLIENT__KEY"
            )
        try:
            connect: Any = distributed.Client
            client = stack.enter_context(connect(scheduler, timeout=_WAIT_S, set_as_default=False))
        except (OSError, ValueError, TypeError) as error:
            raise ClusterError(
                f"{scheduler}: no scheduler answers ({error}): start one with `dask scheduler`, or check the "
                "address, as in tcp://host:8786"
            ) from error
        try:
            client.wait_for_workers(1, timeout=_WAIT_S)
        except TimeoutError as error:
            raise ClusterError(
                f"{scheduler}: has no worker: start some with `dask worker {scheduler} --nthreads 1`"
            ) from error
        folder = manifest.absolute().parent
        yield ClusterExecutor(client, folder, limits, sends=not _all_see(client, manifest.absolute()))


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep Dask from printing tracebacks of what is said here in words."""
    logger = logging.getLogger("distributed")
    before = logger.level
    logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        logger.setLevel(before)


def when_done(remote: Any, act: Callable[[Any], None]) -> None:
    """Call `act` with a future of Dask once it is done, in a thread of its own.

    Dask calls back in one thread for all clients of a process. To ask for a result never ends where the
    connection is closed meanwhile: in that thread it would keep all later runs from theirs, and the process
    from its end.
    """
    remote.add_done_callback(lambda done: Thread(target=act, args=(done,), daemon=True).start())


def _pass_on(remote: Any, future: Future[TaskResult], file: str, limits: Limits) -> None:
    """Pass on what became of a task on the cluster."""
    try:
        future.set_result(remote.result())
    except (OSError, CancelledError):  # of the connection, and of all that depended on it
        future.set_exception(ClusterError(_GONE))
    except Exception as error:  # whatever went wrong with the task goes to the caller
        if type(error).__name__ == "KilledWorker":
            reason = f"{file}: several workers died while they measured it, perhaps for want of memory"
            future.set_result(TaskResult({"reason": reason}, {}, 0.0, limits))
        else:
            future.set_exception(error)


def _all_see(client: Any, manifest: Path) -> bool:
    """Tell whether all workers see the study folder, once all are known to run this code."""
    ours = fingerpad.__version__

    # Defined here so that it travels as it stands, to workers that may not have fingerpad at all.
    def look(path: str) -> tuple[str | None, bool]:
        from importlib import metadata
        from pathlib import Path

        try:
            version = metadata.version("fingerpad")
        except metadata.PackageNotFoundError:
            return None, False
        return version, Path(path).is_file()

    found = client.run(look, str(manifest))
    wrong = {address: version for address, (version, _) in found.items() if version != ours}
    if wrong:
        address, version = next(iter(wrong.items()))
        what = "no fingerpad" if version is None else f"fingerpad {version}"
        raise ClusterError(f"worker {address} has {what}, this is {ours}: install {ours} there")
    return all(sees for _, sees in found.values())


def _perform_there(
    task: Task, folder: str, limits: Limits, code: str, files: dict[str, Any] | None
) -> TaskResult:
    """Perform a task on a worker."""
    from distributed import get_worker

    worker = get_worker()
    if working_code() != code:
        raise ClusterError(
            f"worker {worker.address} has another fingerpad than this ({fingerpad.__version__} there, with "
            "other code): install the same there"
        )
    if files is None:
        if not Path(folder).is_dir():
            raise ClusterError(f"worker {worker.address} does not see {folder}: share it, or stop the worker")
        return IsolatedRunner(Path(folder), limits).perform(task)
    with TemporaryDirectory(prefix="study-", dir=worker.local_directory) as here:
        for name, content in files.items():
            _write(Path(here) / name, content)
        return IsolatedRunner(Path(here), limits).perform(task)


def _read(path: Path) -> Any:
    """Return the bytes of a file, or those of a folder's files by their names."""
    if path.is_dir():
        return {item.name: item.read_bytes() for item in path.iterdir() if item.is_file()}
    return path.read_bytes()


def _write(path: Path, content: Any) -> None:
    if isinstance(content, dict):
        path.mkdir(parents=True, exist_ok=True)
        for name, inner in content.items():
            (path / name).write_bytes(inner)
    else:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
