"""What all endpoints of the API share: parameters, the study that a request names, and errors."""

import json
import os
import re
from collections.abc import Mapping
from http import HTTPStatus
from pathlib import PurePath
from typing import Annotated, Any, Final, TypeAlias, TypeVar, cast

import cv2
import fastapi
from fastapi import APIRouter, Depends, FastAPI, Request, Response
from fastapi.dependencies.utils import get_flat_params
from fastapi.exceptions import RequestValidationError
from fastapi.routing import APIRoute
from pydantic import BaseModel, ConfigDict, Field, GetCoreSchemaHandler, ValidationError
from pydantic_core import core_schema
from starlette.datastructures import QueryParams
from starlette.exceptions import HTTPException
from starlette.types import Message, Receive, Scope, Send

from fingerpad._json import dumps
from fingerpad.exceptions import CorrectionConflict, EditConflict, FingerpadError, ManifestError
from fingerpad.study.manifest.models import Pixel
from fingerpad.web.answers import Refusal, RequestError
from fingerpad.web.study_session import StudySession
from fingerpad.web.workspace import Workspace

BODY_LIMIT: Final = 8_000_000
# Headers of what has another address once it changes, and of what keeps its own.
IMMUTABLE: Final = {"cache-control": "private, max-age=31536000, immutable"}
ASK_AGAIN: Final = {"cache-control": "private, no-cache"}


class Params(BaseModel):
    """Parameters of a request: no unknown key, and finite numbers only."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


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
Item: TypeAlias = Annotated[str, Field(min_length=1, max_length=1000)]
PointParam: TypeAlias = tuple[Pixel, Pixel]


class _Route(APIRoute):
    """A route that refuses unknown parameters, and limits a body that it reads at once."""

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, and read no more of a body that is too large."""
        known = {one.alias for one in get_flat_params(self.dependant)}
        if unknown := sorted(QueryParams(scope["query_string"]).keys() - known):
            words = "Extra inputs are not permitted"
            raise RequestValidationError([{"loc": ("query", name), "msg": words} for name in unknown])
        size = 0

        async def limited() -> Message:
            nonlocal size
            message = await receive()
            size += len(message.get("body", b""))
            if size > BODY_LIMIT:
                words = f"more than {BODY_LIMIT} bytes: send less at once"
                raise RequestError(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, words)
            return message

        await super().handle(scope, limited if self.body_field else receive, send)


def _router(prefix: str) -> APIRouter:
    refused: dict[int | str, Any] = {"4XX": {"model": Refusal, "description": "why the request failed"}}
    return APIRouter(prefix=prefix, route_class=_Route, responses=refused)


# Of endpoints about the workspace, and about the study that their path names.
here: Final = _router("/api")
router: Final = _router("/api/studies/{study}")


async def _workspace(request: Request) -> Workspace:
    return cast(Workspace, request.app.state.workspace)


Here: TypeAlias = Annotated[Workspace, Depends(_workspace)]


def _opened(study: str, workspace: Here) -> StudySession:
    return workspace.session(study)


Opened: TypeAlias = Annotated[StudySession, Depends(_opened)]


def saved_as(name: str) -> dict[str, str]:
    """Return the header of a download under a name, of which ASCII is kept."""
    plain = re.sub(r"[^A-Za-z0-9._+-]", "_", name)
    return {"content-disposition": f'attachment; filename="{plain}"'}


def answer_errors(app: FastAPI) -> None:
    """Make errors of requests and of the library answers with the same words."""
    odd = (FingerpadError, OSError, ArithmeticError, MemoryError, ValueError, cv2.error)
    for kind in (*odd, HTTPException, RequestValidationError):
        app.add_exception_handler(kind, _answer)


async def _answer(request: Request, error: Exception) -> Response:
    """Answer what is wrong with a request, or that odd pictures and numbers are too much for the library.

    An answer that does not fit its model is a fault of the program, and raised.
    """
    if isinstance(error, ValidationError) or (isinstance(error, OSError) and not error.strerror):
        raise error
    status, words, headers = HTTPStatus.UNPROCESSABLE_ENTITY.value, str(error), None
    more: Mapping[str, Any] = {}
    if isinstance(error, RequestValidationError):
        faults = [
            {"place": ".".join(map(str, fault["loc"][1:])), "words": fault["msg"]} for fault in error.errors()
        ]
        words = "; ".join(": ".join(filter(None, fault.values())) for fault in faults)
        status, more = HTTPStatus.BAD_REQUEST, {"faults": faults}
    elif isinstance(error, RequestError):
        status, words, more = error.status_code, error.detail, error.more
    elif isinstance(error, HTTPException):
        status, headers = error.status_code, error.headers
        words = f"{request.method} {request.url.path}: {error.detail}"
    elif isinstance(error, CorrectionConflict | EditConflict):
        status = HTTPStatus.CONFLICT
    elif isinstance(error, ManifestError):
        more = {"faults": [_fault(line) for line in words.splitlines()]}
    elif isinstance(error, OSError):
        name = error.filename
        file = f"{PurePath(os.fsdecode(name)).name}: " if isinstance(name, str | bytes) else ""
        words = f"{file}{error.strerror}"
    elif not isinstance(error, FingerpadError):
        words = f"this cannot be done ({type(error).__name__}: {error})"
    # Where the studies lie on this machine is nothing to show.
    words = words.replace(f"{request.app.state.workspace.workspace}{os.sep}", "")
    # A file's name may hold bytes that are not text.
    text = dumps({"error": words, **more}).encode(errors="replace")
    return Response(text, status_code=status, headers=headers, media_type="application/json")


def _fault(line: str) -> dict[str, str]:
    """Return an error of a manifest, as ``FILE: PLACE: WORDS``, with its place."""
    where, _, rest = line.partition(": ")
    place, colon, words = rest.partition(": ")
    return {"place": place, "words": words} if colon else {"place": "", "words": rest or where}
