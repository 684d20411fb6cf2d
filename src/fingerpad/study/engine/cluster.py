"""Measuring on many machines: the workers of a Dask scheduler.

Workers read the study folder themselves, under the path that it has here, and run the very code that this
process runs. Each performs a task in a child process, within the same limits as on one machine.
"""

import logging
import math
import re
import socket
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Future
from contextlib import ExitStack, contextmanager, suppress
from importlib import import_module
from pathlib import Path
from threading import Thread
from time import monotonic
from typing import Any, Final

import fingerpad
from fingerpad.exceptions import ClusterError
from fingerpad.study.engine.task import Limits, Task, TaskResult, working_code
from fingerpad.study.engine.worker import IsolatedRunner

_ADDRESS: Final = re.compile(r"((tcp|tls|ws|wss|ucx)://)?([\w.-]+|\[[0-9a-fA-F:.]+\]):\d{1,5}")
_WAIT_S: Final = 30
_COUNT_AGAIN_S: Final = 5
_GONE: Final = "the scheduler is gone: what was measured is kept; start it again and run again to go on"


class ClusterExecutor:
    """The workers of a Dask scheduler."""

    def __init__(self, client: Any, manifest: Path, limits: Limits) -> None:
        self.limits = limits
        self._client, self._manifest = client, manifest
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
        with _connected(self._client):
            remote = self._client.submit(
                _perform_there, task, str(self._manifest), self.limits, working_code(), pure=False
            )
        future: Future[TaskResult] = Future()
        future.set_running_or_notify_cancel()  # an interrupt waits for what is at work
        when_done(remote, lambda done: _pass_on(done, future, task.file, self.limits))
        return future


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
    """Provide the workers of a scheduler as an executor; ``local`` starts one here with so many."""
    if scheduler != "local" and not _ADDRESS.fullmatch(scheduler):
        raise ClusterError(
            f"--scheduler takes an address, as in tcp://host:8786, or local; found {scheduler!r}"
        )
    try:
        distributed: Any = import_module("distributed")
    except ModuleNotFoundError:
        raise ClusterError("--scheduler needs Dask: pip install 'fingerpad[cluster]'") from None
    with ExitStack() as stack:
        # Dask would print tracebacks of what is said here in words.
        logger = logging.getLogger("distributed")
        stack.callback(logger.setLevel, logger.level)
        logger.setLevel(logging.CRITICAL + 1)
        if scheduler == "local":
            started = distributed.LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                dashboard_address="127.0.0.1:0",  # any free port, for this machine alone
                protocol="tcp://",
                preload=[_LEAVE_INTERRUPTS],
            )
            scheduler = stack.enter_context(started).scheduler_address
        if scheduler.startswith("tls://") and distributed.Security().tls_ca_file is None:
            raise ClusterError(
                f"{scheduler}: no certificate is configured: name yours in "
                "DASK_DISTRIBUTED__COMM__TLS__CA_FILE, …__CLIENT__CERT and …__CLIENT__KEY"
            )
        try:
            connected = distributed.Client(scheduler, timeout=_WAIT_S, set_as_default=False)
            client = stack.enter_context(connected)
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
        manifest = manifest.absolute()
        _require_fit(client, manifest)
        yield ClusterExecutor(client, manifest, limits)


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


def _require_fit(client: Any, manifest: Path) -> None:
    """Raise `ClusterError` if a worker has another fingerpad, or does not see the study folder."""
    ours = fingerpad.__version__

    # Defined here so that it travels as it stands, to workers that may not have fingerpad at all.
    def look(path: str) -> tuple[str | None, str, bool]:
        import socket
        from importlib import metadata
        from pathlib import Path

        try:
            version = metadata.version("fingerpad")
        except metadata.PackageNotFoundError:
            version = None
        return version, socket.gethostname(), Path(path).is_file()

    for address, (version, host, sees) in client.run(look, str(manifest)).items():
        if version != ours:
            what = "no fingerpad" if version is None else f"fingerpad {version}"
            raise ClusterError(f"worker {address} has {what}, this is {ours}: install {ours} there")
        if not sees:
            raise ClusterError(_not_seen(address, host, manifest))


def _not_seen(address: str, host: str, manifest: Path) -> str:
    return (
        f"worker {address} on {host} does not see {manifest}: put the study on a drive that {host} has under "
        "the same path, or stop that worker"
    )


def _perform_there(task: Task, manifest: str, limits: Limits, code: str) -> TaskResult:
    """Perform a task on a worker, which may have come after the run began."""
    from distributed import get_worker

    address = get_worker().address
    if working_code() != code:
        raise ClusterError(
            f"worker {address} has another fingerpad than this ({fingerpad.__version__} there, with "
            "other code): install the same there"
        )
    path = Path(manifest)
    if not path.is_file():
        raise ClusterError(_not_seen(address, socket.gethostname(), path))
    return IsolatedRunner(path.parent, limits).perform(task)
