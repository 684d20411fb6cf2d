"""Telling every open page what has changed, as server-sent events."""

import asyncio
from collections.abc import AsyncIterator
from threading import Lock
from typing import Any, Final

from fingerpad._json import dumps

_STILL_HERE_S: Final = 15.0
_MOST_WAITING: Final = 200


class Events:
    """What has happened, sent to every listener; any thread may tell."""

    def __init__(self) -> None:
        self._listeners: dict[asyncio.Queue[str | None], asyncio.AbstractEventLoop] = {}
        self._lock = Lock()

    def tell(self, event: str, data: Any) -> None:
        """Send an event to all who listen."""
        self._send(f"event: {event}\ndata: {dumps(data)}\n\n")

    def end(self) -> None:
        """Let every listener go, lest it hold the server up."""
        self._send(None)

    def _send(self, message: str | None) -> None:
        with self._lock:
            listeners = list(self._listeners.items())
        for queue, loop in listeners:
            if not loop.is_closed():
                loop.call_soon_threadsafe(_put, queue, message)

    async def listen(self) -> AsyncIterator[str]:
        """Yield events as they come, and a remark where nothing comes for long."""
        queue: asyncio.Queue[str | None] = asyncio.Queue(_MOST_WAITING)
        with self._lock:
            self._listeners[queue] = asyncio.get_running_loop()
        try:
            yield ": here\n\n"
            while True:
                try:
                    message = await asyncio.wait_for(queue.get(), _STILL_HERE_S)
                except TimeoutError:
                    message = ": still here\n\n"
                if message is None:
                    return
                yield message
        finally:
            with self._lock:
                del self._listeners[queue]


def _put(queue: asyncio.Queue[str | None], message: str | None) -> None:
    """Add a message; a listener that hangs loses the oldest ones."""
    if queue.full():
        queue.get_nowait()
    queue.put_nowait(message)
