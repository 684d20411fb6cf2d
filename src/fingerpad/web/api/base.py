"""What all endpoints of the API share: parameters, the study that a request names, and errors."""

import json
import os
import re
from collections.abc import Callable, Coroutine
from http import HTTPStatus
from pathlib import PurePath
from typing import Annotated, Any, Final, TypeAlias, TypeVar, cast

import cv2
import fastapi
from fastapi import APIRouter, Depends, FastAPI, Request, Response
from fastapi.exceptions import RequestValidationError
from fastapi.routing import APIRoute
from pydantic import BaseModel, ConfigDict, Field, GetCoreSchemaHandler, ValidationError
from pydantic_core import core_schema
from starlette.exceptions import HTTPException

from fingerpad._json import dumps
from fingerpad.exceptions import FingerpadError, ManifestError
from fingerpad.study.manifest.models import Pixel
from fingerpad.web.answers import Refusal
from fingerpad.web.errors import RequestError
from fingerpad.web.study_session import StudySession
from fingerpad.web.workspace import Workspace

BODY_LIMIT: Final = 8_000_000
# Media types of the files of results; `mimetypes` would ask the system.
MEDIA_TYPES: Final = {
    ".html": "text/html; charset=utf-8",
    ".csv": "text/csv; charset=utf-8",
    ".json": "application/json",
    ".svg": "image/svg+xml",
    ".png": "image/png",
    ".pdf": "application/pdf",
}
# Headers of what has another address once it changes.
IMMUTABLE: Final = {"cache-control": "private, max-age=31536000, immutable"}


class Params(BaseModel):
    """Parameters of a request: no unknown key, and finite numbers only."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


Item: TypeAlias = Annotated[str, Field(min_length=1, max_length=1000)]


class FileParams(Params):
    """A file of the study, by its name."""

    file: Item


class _Strictly:
    """Validates a body as the JSON that it was: no number is given as text."""

    def __get_pydantic_core_schema__(
        self, source: type[Params], handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        # FastAPI has parsed it already; strict validation of that would refuse lists for tuples.
        def strictly(value: Any) -> Any:
            if isinstance(value, dict):
                return source.model_validate_json(json.dumps(value), strict=True)
            return value

        return core_schema.no_info_before_validator_function(strictly, handler(source))


_P = TypeVar("_P", bound=Params)
Body: TypeAlias = Annotated[_P, _Strictly()]
Query: TypeAlias = Annotated[_P, fastapi.Query()]

PointParam: TypeAlias = tuple[Pixel, Pixel]
Person: TypeAlias = Annotated[str, Field(max_length=60)]


class _LimitedRequest(Request):
    """A request that reads a body of at most `BODY_LIMIT` bytes, and no more of a larger one."""

    async def body(self) -> bytes:
        """Return the body."""
        if not hasattr(self, "_body"):
            parts, size = [], 0
            async for part in self.stream():
                size += len(part)
                if size > BODY_LIMIT:
                    raise RequestError(
                        HTTPStatus.REQUEST_ENTITY_TOO_LARGE,
                        f"more than {BODY_LIMIT} bytes: send less at once",
                    )
                parts.append(part)
            self._body = b"".join(parts)
        return self._body


class _Route(APIRoute):
    """A route with a limit for the bodies that are read at once; streams have their own."""

    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        """Return the handler."""
        handler = super().get_route_handler()

        async def limited(request: Request) -> Response:
            return await handler(_LimitedRequest(request.scope, request.receive))

        return limited


def api_router(prefix: str) -> APIRouter:
    """Return a router of the API."""
    refused: dict[int | str, dict[str, Any]] = {
        "4XX": {"model": Refusal, "description": "why the request failed"}
    }
    return APIRouter(prefix=prefix, route_class=_Route, responses=refused)


def study_router() -> APIRouter:
    """Return a router of endpoints about the study that their path names."""
    return api_router("/api/studies/{study}")


def _workspace(request: Request) -> Workspace:
    return cast(Workspace, request.app.state.workspace)


def _opened(study: str, request: Request) -> StudySession:
    return _workspace(request).session(study)


async def _here(request: Request) -> Workspace:
    return _workspace(request)


Here: TypeAlias = Annotated[Workspace, Depends(_here)]
Opened: TypeAlias = Annotated[StudySession, Depends(_opened)]


def saved_as(name: str) -> dict[str, str]:
    """Return the header of a download under a name, of which ASCII is kept."""
    plain = re.sub(r"[^A-Za-z0-9._+-]", "_", name)
    return {"content-disposition": f'attachment; filename="{plain}"'}


def answer_errors(app: FastAPI) -> None:
    """Make errors of requests and of the library answers with the same words."""
    for kind in (FingerpadError, OSError, ArithmeticError, MemoryError, ValueError, cv2.error):
        app.add_exception_handler(kind, _failed)
    app.add_exception_handler(HTTPException, _refused)
    app.add_exception_handler(RequestValidationError, _malformed)


def _words(status: int, words: str, headers: Any = None, **more: Any) -> Response:
    # A file's name may hold bytes that are not text.
    text = dumps({"error": words, **more}).encode(errors="replace")
    return Response(text, status_code=status, headers=headers, media_type="application/json")


async def _failed(_: Request, error: Exception) -> Response:
    """Answer that the library cannot do this, or that odd pictures and numbers are too much for it.

    An answer that does not fit its model is a fault of the program, and raised.
    """
    if isinstance(error, ValidationError) or (isinstance(error, OSError) and not error.strerror):
        raise error
    impossible = HTTPStatus.UNPROCESSABLE_ENTITY
    if isinstance(error, ManifestError):
        return _words(impossible, str(error), faults=manifest_errors(error))
    if isinstance(error, FingerpadError):
        return _words(impossible, str(error))
    if isinstance(error, OSError):
        name = error.filename
        file = f"{PurePath(os.fsdecode(name)).name}: " if isinstance(name, str | bytes) else ""
        return _words(impossible, f"{file}{error.strerror}")
    return _words(impossible, f"this cannot be done ({type(error).__name__}: {error})")


async def _refused(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    if isinstance(error, RequestError):
        return _words(error.status_code, error.words, **error.more)
    return _words(error.status_code, f"{request.method} {request.url.path}: {error.detail}", error.headers)


async def _malformed(_: Request, error: Exception) -> Response:
    assert isinstance(error, RequestValidationError)
    faults = [
        {"place": ".".join(map(str, fault["loc"][1:])), "words": fault["msg"]} for fault in error.errors()
    ]
    words = "; ".join(": ".join(filter(None, (fault["place"], fault["words"]))) for fault in faults)
    return _words(HTTPStatus.BAD_REQUEST, words, faults=faults)


def manifest_errors(error: ManifestError) -> list[dict[str, str]]:
    """Return the errors of a manifest, each with its place."""
    found = []
    for line in str(error).splitlines():
        where, _, rest = line.partition(": ")
        place, colon, words = rest.partition(": ")
        found.append({"place": place, "words": words} if colon else {"place": "", "words": rest or where})
    return found
