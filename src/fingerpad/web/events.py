"""Server-sent events: every open page hears what has changed."""

import asyncio
from collections.abc import AsyncIterator
from threading import Lock
from typing import ClassVar, Final, Literal, TypeAlias

from fastapi.sse import ServerSentEvent

from fingerpad._json import dumps
from fingerpad.web.answers import Answer

_MAX_WAITING: Final = 200


class RunStatus(Answer):
    """Progress of a run; `version` rises with each change, so that a page can ignore older answers."""

    event: ClassVar = "run"

    state: Literal["idle", "running", "cancelling", "done", "cancelled", "failed"] = "idle"
    phase: Literal["measuring", "tables", "report"] | None = None
    total: int = 0
    done: int = 0
    failed: int = 0
    current: str = ""
    file: str = ""
    seconds: float = 0.0
    seconds_left: float | None = None
    error: str | None = None
    failures: tuple[str, ...] = ()
    version: int = 0


class StudyEvent(Answer):
    """The manifest has changed."""

    event: ClassVar = "study"

    digest: str


class CorrectionsEvent(Answer):
    """An item was corrected."""

    event: ClassVar = "corrections"

    item: str
    last_id: int


Event: TypeAlias = StudyEvent | CorrectionsEvent | RunStatus


class Events:
    """Events for all listeners, sent from any thread."""

    def __init__(self) -> None:
        self._listeners: dict[asyncio.Queue[ServerSentEvent | None], asyncio.AbstractEventLoop] = {}
        self._lock = Lock()

    def send(self, event: Event) -> None:
        """Send an event to all listeners."""
        self._put_all(ServerSentEvent(event=event.event, raw_data=dumps(event)))

    def end(self) -> None:
        """Disconnect all listeners, so that the server can stop."""
        self._put_all(None)

    def _put_all(self, message: ServerSentEvent | None) -> None:
        with self._lock:
            listeners = list(self._listeners.items())
        for queue, loop in listeners:
            if not loop.is_closed():
                loop.call_soon_threadsafe(_put, queue, message)

    async def listen(self) -> AsyncIterator[ServerSentEvent]:
        """Yield events as they come."""
        queue: asyncio.Queue[ServerSentEvent | None] = asyncio.Queue(_MAX_WAITING)
        with self._lock:
            self._listeners[queue] = asyncio.get_running_loop()
        try:
            yield ServerSentEvent(comment="here")
            while (message := await queue.get()) is not None:
                yield message
        finally:
            with self._lock:
                del self._listeners[queue]


def _put(queue: asyncio.Queue[ServerSentEvent | None], message: ServerSentEvent | None) -> None:
    """Add a message; a listener that does not keep up loses the oldest ones."""
    if queue.full():
        queue.get_nowait()
    queue.put_nowait(message)
