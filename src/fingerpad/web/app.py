"""The application: the guard, the API, the page's files."""

from pathlib import Path
from typing import Final

from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import FileResponse, HTMLResponse, JSONResponse, RedirectResponse, Response
from starlette.routing import Mount, Route
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp, Scope

import fingerpad
from fingerpad.web import (
    contacts,
    corrections,
    files,
    geometry,
    image_routes,
    photographs,
    results,
    scale_routes,
    state,
    studies,
)
from fingerpad.web.endpoints import Endpoint, openapi
from fingerpad.web.security import START, Access, Guard, cookie_name
from fingerpad.web.workspace import Workspace

STATIC: Final = Path(__file__).parent / "static"
_YEAR_S: Final = 31_536_000
_ROUTES: Final = (
    studies,
    state,
    image_routes,
    scale_routes,
    photographs,
    contacts,
    corrections,
    results,
    geometry,
    files,
)
ENDPOINTS: Final[tuple[Endpoint, ...]] = tuple(one for room in _ROUTES for one in room.ENDPOINTS)


def make_app(workspace: Workspace, access: Access) -> ASGIApp:
    """Return the application of one launch.

    Parameters
    ----------
    bench : Workspace
        What it works on.
    access : Access
        What opens it.
    """

    def start(request: Request) -> Response:
        """Exchange the token or the code of the start address for a cookie, and lead to the page."""
        params = request.query_params
        answer = RedirectResponse("/", status_code=303)
        if access.knows(request.headers):
            return answer
        if request.method != "GET" or not access.opens(
            token=params.get("token", ""), code=params.get("code", "")
        ):
            return HTMLResponse(_CLOSED, status_code=403)
        name = cookie_name(request.headers.get("host", ""))
        answer.set_cookie(name, access.token, httponly=True, samesite="strict", path="/")
        return answer

    def document(_: Request) -> Response:
        return JSONResponse(openapi(ENDPOINTS, fingerpad.__version__))

    starlette = Starlette(
        routes=[
            Route(START, start),
            Route("/", _page),
            Route("/favicon.ico", _icon),
            Route("/static/vendor/plotly.min.js", _plotly),
            Route("/api/openapi.json", document),
            *(operation.route(workspace) for operation in ENDPOINTS),
            Mount("/static", _Static(directory=STATIC)),
        ],
        exception_handlers={HTTPException: _not_there},
    )
    return Guard(starlette, access)


_CLOSED: Final = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>This address opens nothing</title>
<meta name="color-scheme" content="light dark">
<style>body { font: 1rem/1.6 sans-serif; margin: 12vh auto; max-width: 40rem; padding: 1rem }</style></head>
<body><h1>This address opens nothing</h1>
<p>It has been used, is of another launch, or is not whole. Open the address that
<code>fingerpad app</code> printed in the terminal.</p></body></html>
"""


class _Static(StaticFiles):
    """The page's own files, asked for anew each time, so that an upgrade is seen at once."""

    async def get_response(self, path: str, scope: Scope) -> Response:
        answer = await super().get_response(path, scope)
        answer.headers["cache-control"] = "no-cache"
        return answer


def _page(_: Request) -> Response:
    return FileResponse(STATIC / "index.html", headers={"cache-control": "no-cache"})


def _icon(_: Request) -> Response:
    icon = STATIC / "icon.svg"
    return FileResponse(icon) if icon.is_file() else Response(status_code=404)


def _plotly(_: Request) -> Response:
    """Return Plotly's script from the installed package: nothing comes from elsewhere."""
    import plotly  # noqa: PLC0415 (large, and needed for this file only)

    script = Path(plotly.__file__).parent / "package_data" / "plotly.min.js"
    headers = {"cache-control": f"private, max-age={_YEAR_S}"}
    return FileResponse(script, media_type="text/javascript", headers=headers)


def _not_there(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    words = f"{request.method} {request.url.path}: {error.detail}"
    return JSONResponse({"error": words}, status_code=error.status_code, headers=error.headers)
