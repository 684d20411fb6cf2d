"""Serving the page on this machine."""

import os
import socket
from collections.abc import Callable
from contextlib import suppress
from typing import Final

import uvicorn

from fingerpad.exceptions import FingerpadError
from fingerpad.web.app import make_app
from fingerpad.web.bench import Bench
from fingerpad.web.security import START, new_token

LOOPBACK: Final = "127.0.0.1"


def serve(bench: Bench, *, port: int, on_ready: Callable[[str], None]) -> None:
    """Serve the page until it is interrupted.

    Parameters
    ----------
    bench : Bench
        What it works on.
    port : int
        Where to listen; 0 takes one that is free.
    on_ready : callable
        Told the address to open, when it can be opened.

    Raises
    ------
    FingerpadError
        If the port cannot be had.
    """
    token = new_token()
    listener = listening(port)
    address = f"http://{LOOPBACK}:{listener.getsockname()[1]}{START}?token={token}"

    class Server(uvicorn.Server):
        async def startup(self, sockets: list[socket.socket] | None = None) -> None:
            await super().startup(sockets)
            on_ready(address)

        async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
            bench.events.end()
            await super().shutdown(sockets)

    config = uvicorn.Config(
        make_app(bench, token),
        log_level="warning",
        access_log=False,
        server_header=False,
        timeout_graceful_shutdown=1,
    )
    with listener:
        try:
            with suppress(KeyboardInterrupt):  # the way to end it
                Server(config).run(sockets=[listener])
        finally:
            bench.close()


def listening(port: int) -> socket.socket:
    """Return a socket that listens on this machine only.

    Raises
    ------
    FingerpadError
        If the port cannot be had.
    """
    # Only of a socket that says TCP does asyncio send small parts at once; else each answer waits for 40 ms.
    listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    try:
        if os.name == "posix":
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind((LOOPBACK, port))
        listener.listen()
    except OSError as error:
        listener.close()
        raise FingerpadError(
            f"port {port} of {LOOPBACK} cannot be had ({error.strerror}): choose another with --port"
        ) from error
    return listener
