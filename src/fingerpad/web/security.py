"""Access control: only the local page, and scripts that know the token of this launch.

A page on the internet can make a browser send requests to this machine. It cannot read the token,
set a foreign Host to the loopback's name, or hide the Origin from which it asks. Other people on this machine
can read the arguments of its processes: addresses hold codes that are good for one use, never the token.
"""

import math
import secrets
import time
from collections.abc import Callable, Mapping
from http import HTTPStatus
from http.cookies import CookieError, SimpleCookie
from threading import Lock
from typing import Final
from urllib.parse import urlsplit

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import HTMLResponse, JSONResponse, PlainTextResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from fingerpad.web.answers import RequestError

START: Final = "/start"
_LOOPBACK: Final = frozenset(("127.0.0.1", "localhost", "::1"))
_HEADERS: Final = {
    # Plotly writes styles into the page; scripts come from files only.
    "content-security-policy": "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data: blob:; font-src 'self'; connect-src 'self'; frame-src 'self'; form-action 'self'; "
    "base-uri 'none'; frame-ancestors 'none'",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "referrer-policy": "no-referrer",
    "x-content-type-options": "nosniff",
    "x-frame-options": "DENY",
}
# The report is one file with its own styles and no script; only this page may show it inside itself.
FRAMED_HEADERS: Final = {
    "content-security-policy": "default-src 'none'; style-src 'unsafe-inline'; img-src data:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'self'; sandbox allow-popups allow-same-origin",
    "x-frame-options": "SAMEORIGIN",
}


class Access:
    """The token of one launch, and single-use codes that are exchanged for it."""

    def __init__(self, token: str | None = None, *, clock: Callable[[], float] = time.monotonic) -> None:
        self.token = token or secrets.token_urlsafe(32)
        self._clock = clock
        self._ends: dict[str, float] = {}
        self._lock = Lock()

    def new_code(self, seconds: float) -> str:
        """Return a code that is valid once, within some time."""
        code = secrets.token_urlsafe(32)
        with self._lock:
            self._ends[code] = self._clock() + seconds
        return code

    def accepts(self, *, token: str, code: str) -> bool:
        """Tell whether the token or the code is valid; a code is valid once."""
        with self._lock:
            end = self._ends.pop(code, -math.inf)
        return _same(token, self.token) or self._clock() <= end

    def has_token(self, headers: Mapping[str, str]) -> bool:
        """Tell whether a request has the token, as bearer token or as cookie."""
        kind, _, given = headers.get("authorization", "").partition(" ")
        if kind.lower() == "bearer" and _same(given.strip(), self.token):
            return True
        try:
            cookie = SimpleCookie(headers.get("cookie", "")).get(cookie_name(headers.get("host", "")))
        except CookieError:
            return False
        return cookie is not None and _same(cookie.value, self.token)


class Guard:
    """ASGI middleware that passes requests of the local page and of scripts only."""

    def __init__(self, app: ASGIApp, access: Access) -> None:
        self._app, self._access = app, access

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Refuse a request, or pass it on and add headers to its response."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return

        async def send_guarded(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in _HEADERS.items():
                    headers.setdefault(name, value)
                headers.setdefault("cache-control", "no-store")
            await send(message)

        try:
            self._require(Headers(scope=scope), scope["path"])
        except RequestError as refusal:
            await _answer(refusal, scope["path"])(scope, receive, send_guarded)
        else:
            await self._app(scope, receive, send_guarded)

    def _require(self, headers: Mapping[str, str], path: str) -> None:
        host = headers.get("host", "")
        if _host_name(host) not in _LOOPBACK:
            raise RequestError(
                HTTPStatus.MISDIRECTED_REQUEST, "this page answers to 127.0.0.1 and localhost only"
            )
        origin, site = headers.get("origin"), headers.get("sec-fetch-site", "none")
        is_start = path == START
        if origin not in {None, f"http://{host}"} or not (is_start or site in {"same-origin", "none"}):
            raise RequestError(HTTPStatus.FORBIDDEN, "requests from other pages are refused")
        if not (is_start or self._access.has_token(headers)):
            raise RequestError(
                HTTPStatus.FORBIDDEN,
                "this launch's token is missing: open the address that fingerpad app printed when it started",
            )


_CLOSED: Final = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>This address is not valid</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<style>body { font: 1rem/1.6 sans-serif; margin: 12vh auto; max-width: 40rem; padding: 1rem }</style></head>
<body><h1>This address is not valid</h1>
<p>WHY Open the address that <code>fingerpad app</code> printed in the terminal when it started.</p>
<p>Confirmed changes are saved.</p></body></html>
"""


def closed_page(why: str) -> Response:
    """Return the page of an address that is not valid, which says why and what to do."""
    return HTMLResponse(_CLOSED.replace("WHY", why), status_code=HTTPStatus.FORBIDDEN)


def _same(given: str, token: str) -> bool:
    """Compare two tokens in constant time."""
    return secrets.compare_digest(given.encode(), token.encode())


def cookie_name(host: str) -> str:
    """Return the cookie's name, with the port: browsers share cookies between the ports of a host."""
    return f"fingerpad-{host.rpartition(':')[2] if ':' in host else 80}"


def _host_name(host: str) -> str | None:
    try:
        parts = urlsplit(f"//{host}")
        _ = parts.port
    except ValueError:
        return None
    return None if parts.path or parts.query or parts.username is not None else parts.hostname


def _answer(refusal: RequestError, path: str) -> Response:
    if path.startswith("/api/"):
        return JSONResponse({"error": refusal.detail}, status_code=refusal.status_code)
    if path == "/" and refusal.status_code == HTTPStatus.FORBIDDEN:
        return closed_page(
            "It lacks the token of this launch: fingerpad was started again, or this is another browser."
        )
    return PlainTextResponse(refusal.detail, status_code=refusal.status_code)
