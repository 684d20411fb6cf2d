"""The application and its server: access control, the API, the page's files, on this machine only."""

import hashlib
import logging
import os
import signal
import socket
from collections.abc import Callable
from contextlib import suppress
from importlib.metadata import distribution
from pathlib import Path
from tempfile import TemporaryDirectory
from types import FrameType
from typing import Final, NamedTuple

import uvicorn
from fastapi import FastAPI, Security
from fastapi.security import HTTPBearer
from fastapi.telemetry import TelemetryConfig
from starlette.requests import Request
from starlette.responses import FileResponse, HTMLResponse, RedirectResponse, Response
from starlette.routing import Mount, Route
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp, Scope

import fingerpad
from fingerpad.exceptions import FingerpadError
from fingerpad.web.api import here, router
from fingerpad.web.api.base import IMMUTABLE, answer_errors
from fingerpad.web.security import START, Access, Guard, closed_page, cookie_name
from fingerpad.web.workspace import PLOTLY_ADDRESS, Workspace

STATIC: Final = Path(__file__).parent / "static"
# Nothing is sent anywhere, whatever the environment says.
_NO_TELEMETRY: Final[TelemetryConfig] = {
    "tracing": False,
    "metrics": False,
    "logs": False,
    "operation_spans": False,
    "auto_configure": False,
}


def make_api() -> FastAPI:
    """Return the API, of which `openapi` tells the document; a launch gives it a workspace."""
    app = FastAPI(
        title="fingerpad",
        version=fingerpad.__version__,
        description="The API under the page of fingerpad app.",
        openapi_url="/api/openapi.json",
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
        telemetry=_NO_TELEMETRY,
        dependencies=[Security(HTTPBearer(auto_error=False, description="the token of the launch"))],
    )
    answer_errors(app)
    app.include_router(here)
    app.include_router(router)
    return app


def make_app(workspace: Workspace, access: Access) -> ASGIApp:
    """Return the application of one launch."""

    def start(request: Request) -> Response:
        """Exchange the token or the code of the start address for a cookie, and redirect to the page."""
        params = request.query_params
        answer = RedirectResponse("/", status_code=303)
        if access.has_token(request.headers):
            return answer
        if request.method != "GET" or not access.accepts(
            token=params.get("token", ""), code=params.get("code", "")
        ):
            return closed_page("It has been used, belongs to another launch, or is incomplete.")
        name = cookie_name(request.headers.get("host", ""))
        answer.set_cookie(name, access.token, httponly=True, samesite="strict", path="/")
        return answer

    app = make_api()
    app.state.workspace = workspace
    app.router.routes += [
        Route(START, start),
        Route("/", _page),
        Route(PLOTLY_ADDRESS, _plotly),
        Mount("/static/{version}", _Static(directory=STATIC)),
    ]
    return Guard(app, access)


class _Static(StaticFiles):
    """The page's files, under an address that changes with them, so that a browser need not ask again."""

    async def get_response(self, path: str, scope: Scope) -> Response:
        answer = await super().get_response(path, scope)
        answer.headers.update(IMMUTABLE)
        return answer


def _page(_: Request) -> Response:
    content = hashlib.sha256()
    for path in sorted(STATIC.rglob("*.*")):
        content.update(path.read_bytes())
    page = (STATIC / "index.html").read_text(encoding="utf-8")
    page = page.replace("/static/", f"/static/{content.hexdigest()[:16]}/")
    return HTMLResponse(page, headers={"cache-control": "no-cache"})


def _plotly(_: Request) -> Response:
    """Return Plotly's script from the installed package: nothing is loaded from the network."""
    package = distribution("plotly")
    script = str(package.locate_file("plotly/package_data/plotly.min.js"))
    return FileResponse(script, media_type="text/javascript", headers=IMMUTABLE)


LOOPBACK: Final = "127.0.0.1"
# Time for the browser to start.
_TO_OPEN_S: Final = 120.0


class Launch(NamedTuple):
    """Addresses of the page of one launch; that for the user and the file for scripts hold the token.

    The address that is opened in the browser is valid once, for a short time: other users of the machine may
    see it in the list of processes.
    """

    address: str
    browser_address: str
    token_file: Path


def serve(workspace: Workspace, *, port: int, on_ready: Callable[[Launch], None]) -> None:
    """Serve the page until it is interrupted, or ended by SIGTERM or SIGHUP; port 0 is any free one."""
    listener, access = listening(port), Access()
    page = f"http://{LOOPBACK}:{listener.getsockname()[1]}{START}"
    runtime = os.environ.get("XDG_RUNTIME_DIR", "")
    # Only this user can enter it.
    private = TemporaryDirectory(
        prefix="fingerpad-", dir=runtime if os.access(runtime, os.W_OK) else None, ignore_cleanup_errors=True
    )
    token_file = Path(private.name) / "token"
    token_file.touch(0o600, exist_ok=False)
    token_file.write_text(f"{access.token}\n", encoding="ascii")

    class Server(uvicorn.Server):
        async def startup(self, sockets: list[socket.socket] | None = None) -> None:
            await super().startup(sockets)
            browser_address = f"{page}?code={access.new_code(_TO_OPEN_S)}"
            on_ready(Launch(f"{page}?token={access.token}", browser_address, token_file))

        async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
            workspace.end_events()
            # Responses cut off by the shutdown are not errors to print.
            logging.getLogger("uvicorn.error").setLevel(logging.CRITICAL + 1)
            await super().shutdown(sockets)

    config = uvicorn.Config(
        make_app(workspace, access),
        log_level="warning",
        access_log=False,
        server_header=False,
        timeout_graceful_shutdown=1,
    )
    _leave_on_signals()
    try:
        # The token goes first, as the end of a run may be interrupted too.
        with listener, private, suppress(KeyboardInterrupt):  # the way to end it
            Server(config).run(sockets=[listener])
    finally:
        workspace.close()


def _leave_on_signals() -> None:
    """Raise SystemExit on SIGTERM and SIGHUP, which would end the program without cleaning up.

    While Uvicorn serves, it handles SIGTERM itself, shuts down, and raises the signal again.
    """

    def leave(number: int, _: FrameType | None) -> None:
        raise SystemExit(128 + number)

    def hang_up(_: int, __: FrameType | None) -> None:
        signal.raise_signal(signal.SIGTERM)

    signal.signal(signal.SIGTERM, leave)
    # Windows has no SIGHUP; nohup has it ignored.
    if hasattr(signal, "SIGHUP") and signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:
        signal.signal(signal.SIGHUP, hang_up)


def listening(port: int) -> socket.socket:
    """Return a socket that listens on this machine only."""
    # With the protocol stated, asyncio sets TCP_NODELAY; otherwise each response waits for 40 ms.
    listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    try:
        if os.name == "posix":
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind((LOOPBACK, port))
        listener.listen()
    except OSError as error:
        listener.close()
        raise FingerpadError(
            f"port {port} of {LOOPBACK} is not available ({error.strerror}): choose another with --port"
        ) from error
    return listener
