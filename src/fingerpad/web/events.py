"""Server-sent events: every open page hears what has changed."""

import asyncio
from collections.abc import AsyncIterator
from threading import Lock
from typing import Any, Final, Literal

from fingerpad._json import dumps
from fingerpad.web.answers import Answer

_KEEP_ALIVE_S: Final = 15.0
_MAX_WAITING: Final = 200


class RunStatus(Answer):
    """Progress of a run; `version` rises with each change."""

    state: Literal["idle", "running", "cancelling", "done", "cancelled", "failed"]
    phase: Literal["measuring", "tables", "report"] | None
    total: int
    done: int
    failed: int
    current: str
    file: str
    seconds: float
    seconds_left: float | None
    error: str | None
    failures: list[str]
    version: int


class StudyEvent(Answer):
    """Event ``study``: the manifest has changed."""

    digest: str


class CorrectionsEvent(Answer):
    """Event ``corrections``: an item was corrected."""

    item: str
    last_id: int


# Server-sent events by their names.
EVENTS: Final[dict[str, type[Answer]]] = {
    "study": StudyEvent,
    "corrections": CorrectionsEvent,
    "run": RunStatus,
}


class Events:
    """Events for all listeners, sent from any thread."""

    def __init__(self) -> None:
        self._listeners: dict[asyncio.Queue[str | None], asyncio.AbstractEventLoop] = {}
        self._lock = Lock()

    def send(self, event: str, data: Any) -> None:
        """Send an event to all listeners."""
        text = dumps(data)
        EVENTS[event].model_validate_json(text.encode(errors="replace"))
        self._put_all(f"event: {event}\ndata: {text}\n\n")

    def end(self) -> None:
        """Disconnect all listeners, so that the server can stop."""
        self._put_all(None)

    def _put_all(self, message: str | None) -> None:
        with self._lock:
            listeners = list(self._listeners.items())
        for queue, loop in listeners:
            if not loop.is_closed():
                loop.call_soon_threadsafe(_put, queue, message)

    async def listen(self) -> AsyncIterator[str]:
        """Yield events as they come, and comments in between to keep the connection open."""
        queue: asyncio.Queue[str | None] = asyncio.Queue(_MAX_WAITING)
        with self._lock:
            self._listeners[queue] = asyncio.get_running_loop()
        try:
            yield ": here\n\n"
            while True:
                try:
                    message = await asyncio.wait_for(queue.get(), _KEEP_ALIVE_S)
                except TimeoutError:
                    message = ": still here\n\n"
                if message is None:
                    return
                yield message
        finally:
            with self._lock:
                del self._listeners[queue]


def _put(queue: asyncio.Queue[str | None], message: str | None) -> None:
    """Add a message; a listener that does not keep up loses the oldest ones."""
    if queue.full():
        queue.get_nowait()
    queue.put_nowait(message)
