"""A child process that performs tasks one at a time, within limits of time and memory.

A damaged picture can crash a decoder, take all memory or never end. In a process of its own it costs its own
row, and names itself. The process is started as a plain Python program, so that neither a script without a
``__main__`` guard nor a daemonic worker of a scheduler stands in its way.
"""

import atexit
import ctypes
import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path
from typing import IO, Final

import cv2

from fingerpad._threads import ONE_THREAD
from fingerpad.study.engine.task import DEFAULT_LIMITS, Limits, Task, TaskResult, perform

if sys.platform != "win32":
    import resource

_BOOTSTRAP: Final = (
    "import sys; sys.path[:] = {path!r}; from fingerpad.study.engine.worker import serve; serve()"
)
# Of glibc's malloc.h.
_M_TRIM_THRESHOLD, _M_MMAP_THRESHOLD = -1, -3


class WorkerDied(Exception):  # noqa: N818 (it reports what happened to a process)
    """The process ended while it performed a task, with this exit code."""


class Worker:
    """A child process that performs tasks."""

    def __init__(self) -> None:
        process = subprocess.Popen(  # noqa: S603 (this very Python)
            [sys.executable, "-c", _BOOTSTRAP.format(path=sys.path)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=os.environ | ONE_THREAD,
            start_new_session=True,  # an interrupt from the terminal is for the parent alone
        )
        assert process.stdin is not None
        assert process.stdout is not None
        self._process, self._questions, self._answers = process, process.stdin, process.stdout
        self._is_ready = self._late = False

    @property
    def is_alive(self) -> bool:
        """Whether it has not ended."""
        return self._process.poll() is None

    def perform(self, task: Task, folder: Path, limits: Limits) -> TaskResult:
        """Perform a task and wait for its result; `TimeoutError` or `WorkerDied` where the process ended."""
        timer = threading.Timer(limits.seconds * max(1, task.reads), self._end_late)
        timer.daemon = True
        try:
            if not self._is_ready:
                pickle.load(self._answers)  # noqa: S301 (of our own child)
                self._is_ready = True
            timer.start()
            try:
                answer = self._ask((task.work, task.file, folder, limits))
            finally:
                timer.cancel()
                timer.join()  # it may have run out just now: from here on it does nothing more
        except (EOFError, OSError, pickle.UnpicklingError):  # it ended, perhaps amid an answer
            self.kill()
            if self._late:
                raise TimeoutError from None
            raise WorkerDied(self._process.wait()) from None
        if self._late:  # the answer came first, and holds; no further task may get this process
            self.kill()
        if isinstance(answer, Exception):
            raise answer
        assert isinstance(answer, TaskResult)
        return answer

    def _ask(self, question: object) -> object:
        _send(self._questions, pickle.dumps(question))
        return pickle.loads(pickle.load(self._answers))  # noqa: S301 (of our own child)

    def _end_late(self) -> None:
        self._late = True
        self._process.kill()

    def kill(self) -> None:
        """End the process at once."""
        self._process.kill()
        self._process.wait()
        for pipe in (self._questions, self._answers):
            with suppress(OSError):  # what it was asked last may still be in the buffer
                pipe.close()


class WorkerPool:
    """Idle workers of this process, kept from one run to the next: to start one takes a second."""

    def __init__(self) -> None:
        self._idle: list[Worker] = []
        self._lock = threading.Lock()

    def take(self) -> Worker:
        """Return an idle worker, or start one."""
        with self._lock:
            return self._idle.pop() if self._idle else Worker()

    def give_back(self, worker: Worker) -> None:
        """Keep a worker for the next task, unless it has ended."""
        if worker.is_alive:
            with self._lock:
                self._idle.append(worker)

    def keep(self, most: int) -> None:
        """End idle workers beyond so many."""
        with self._lock:
            extra, self._idle = self._idle[most:], self._idle[:most]
        for worker in extra:
            worker.kill()

    def forget(self) -> None:
        """Leave the workers to the process of which this one is a copy."""
        self._idle, self._lock = [], threading.Lock()


POOL: Final = WorkerPool()
atexit.register(POOL.keep, 0)
if sys.platform != "win32":
    os.register_at_fork(after_in_child=POOL.forget)


class IsolatedRunner:
    """Performs tasks in child processes; one that kills its process twice, or takes too long, fails."""

    def __init__(self, folder: Path, limits: Limits) -> None:
        self._folder, self.limits = folder, limits
        self._busy: set[Worker] = set()
        self._abandoned = False

    def perform(self, task: Task) -> TaskResult:
        """Perform a task; any number of threads may ask. `CancelledError` if it was abandoned."""
        reason, seconds = "", self.limits.seconds
        for _ in range(2):  # perhaps it died for want of memory beside others: a second time tells
            worker = POOL.take()
            self._busy.add(worker)
            try:
                if self._abandoned:
                    raise CancelledError
                return worker.perform(task, self._folder, self.limits)
            except TimeoutError:
                reason = (
                    f"{task.file}: measuring it takes longer than {seconds:g} s: crop or shrink it, or raise "
                    "the limit (fingerpad run --time-limit-s)"
                )
                return TaskResult({"reason": reason}, {}, seconds * max(1, task.reads), self.limits)
            except WorkerDied as death:
                if self._abandoned:
                    raise CancelledError from None
                reason = _reason_of_death(task.file, *death.args)
            finally:
                self._busy.discard(worker)
                POOL.give_back(worker)
        return TaskResult({"reason": reason}, {}, 0.0, self.limits)

    def abandon(self) -> None:
        """End what is at work."""
        self._abandoned = True
        for worker in tuple(self._busy):
            worker.kill()


def _reason_of_death(file: str, code: int) -> str:
    if code == -signal.SIGKILL:
        return (
            f"{file}: the process that measured it was killed twice, as happens where memory runs out: "
            "crop or shrink it, or use fewer --workers"
        )
    how = f"signal {signal.Signals(-code).name}" if code < 0 else f"exit code {code}"
    return (
        f"{file}: the process that measured it crashed twice ({how}): the file may be damaged, save it again"
    )


def serve() -> None:
    """Perform the tasks that come on standard input, one after another, until it closes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    settle_worker()
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what libraries print must not mix with the answers
    questions: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    threading.Thread(target=_receive, args=(sys.stdin.buffer, questions), daemon=True).start()
    idle_bytes = _virtual_bytes()
    with suppress(BrokenPipeError):  # the parent has ended just now
        _send(answers, b"ready")
        while True:
            _send(answers, _answer(questions.get(), idle_bytes))
    os._exit(1)


def _answer(question: bytes, idle_bytes: int) -> bytes:
    try:
        work, file, folder, limits = pickle.loads(question)  # noqa: S301 (of our own parent)
        if sys.platform != "win32" and idle_bytes:
            _, hard = resource.getrlimit(resource.RLIMIT_AS)
            wanted = idle_bytes + round(limits.memory_gb * 1e9)
            resource.setrlimit(resource.RLIMIT_AS, (wanted if hard < 0 else min(wanted, hard), hard))
        return pickle.dumps(perform(work, file, folder, limits))
    except Exception as error:  # raised again by the caller
        return pickle.dumps(error)


def _send(pipe: IO[bytes], message: bytes) -> None:
    """Write a message, pickled once more: a pickle tells where it ends, though what it holds be broken."""
    pickle.dump(message, pipe)
    pipe.flush()


def _receive(pipe: IO[bytes], questions: "queue.SimpleQueue[bytes]") -> None:
    """Take questions as they come, and end the process with the parent, even in the middle of a task."""
    try:
        while True:
            questions.put(pickle.load(pipe))  # noqa: S301 (of our own parent)
    finally:
        os._exit(1)


def settle_worker() -> None:
    """Use one core, and let the memory of one frame serve the next.

    By default glibc returns freed memory and asks for it again, page by page, a thousand times a frame.
    """
    cv2.setNumThreads(1)
    with suppress(OSError, AttributeError):  # another C library has no such settings
        settings = ctypes.CDLL("libc.so.6").mallopt
        settings(_M_TRIM_THRESHOLD, 256 << 20)
        settings(_M_MMAP_THRESHOLD, 32 << 20)


def _virtual_bytes() -> int:
    """Return the address space in use, 0 where the system does not tell."""
    try:
        pages = int(Path("/proc/self/statm").read_text().split()[0])
    except (OSError, ValueError):
        return 0
    return pages * os.sysconf("SC_PAGE_SIZE")


class LocalExecutor(IsolatedRunner):
    """So many processes of this machine, for tasks whose inputs are in `folder`."""

    def __init__(self, folder: Path, workers: int, limits: Limits = DEFAULT_LIMITS) -> None:
        super().__init__(folder, limits)
        self.capacity = 2 * workers
        self._threads = ThreadPoolExecutor(workers)

    def submit(self, task: Task) -> Future[TaskResult]:
        """Begin a task as soon as a process is free."""
        return self._threads.submit(self.perform, task)

    def require_workers(self) -> None:
        """Do nothing: a process that dies is replaced."""

    def close(self) -> None:
        """End what is at work."""
        self._threads.shutdown(wait=False, cancel_futures=True)
        self.abandon()
        self._threads.shutdown()
        POOL.keep(1)  # with which the next run begins at once
