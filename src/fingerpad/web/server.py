"""Serving the page on this machine."""

import logging
import os
import shutil
import socket
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from tempfile import mkdtemp
from typing import Final, NamedTuple

import uvicorn

from fingerpad.exceptions import FingerpadError
from fingerpad.web.app import make_app
from fingerpad.web.security import START, Access
from fingerpad.web.workspace import Workspace

LOOPBACK: Final = "127.0.0.1"
# In which the browser has to come up.
_TO_OPEN_S: Final = 120.0


class Launch(NamedTuple):
    """How the page of one launch is reached.

    Attributes
    ----------
    address : str
        For the user to open; it holds the token.
    browser_address : str
        For this program to open in the browser: good once, within a short time. Other users of the machine
        may see it in the list of processes.
    token_file : Path
        Holds the token for scripts; nobody else can read it.
    """

    address: str
    browser_address: str
    token_file: Path


def serve(workspace: Workspace, *, port: int, on_ready: Callable[[Launch], None]) -> None:
    """Serve the page until it is interrupted.

    Parameters
    ----------
    bench : Workspace
        What it works on.
    port : int
        Where to listen; 0 takes one that is free.
    on_ready : callable
        Told how the page is reached, when it can be.

    Raises
    ------
    FingerpadError
        If the port cannot be had.
    """
    listener = listening(port)
    page = f"http://{LOOPBACK}:{listener.getsockname()[1]}{START}"
    folder, access = _private_folder(), Access()
    token_file = folder / "token"
    _write_private(token_file, access.token)

    class Server(uvicorn.Server):
        async def startup(self, sockets: list[socket.socket] | None = None) -> None:
            await super().startup(sockets)
            browser_address = f"{page}?code={access.new_code(_TO_OPEN_S)}"
            on_ready(Launch(f"{page}?token={access.token}", browser_address, token_file))

        async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
            workspace.events.end()
            # An answer that is cut off is no fault to print.
            logging.getLogger("uvicorn.error").setLevel(logging.CRITICAL + 1)
            await super().shutdown(sockets)

    config = uvicorn.Config(
        make_app(workspace, access),
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
            workspace.close()
            shutil.rmtree(folder, ignore_errors=True)


def _private_folder() -> Path:
    """Return a new folder that this user alone can enter."""
    runtime = os.environ.get("XDG_RUNTIME_DIR", "")
    return Path(mkdtemp(prefix="fingerpad-", dir=runtime if os.access(runtime, os.W_OK) else None))


def _write_private(path: Path, text: str) -> None:
    """Write a new file that this user alone can read."""
    with open(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w", encoding="ascii") as file:
        file.write(f"{text}\n")


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
