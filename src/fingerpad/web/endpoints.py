"""The endpoints of the API: parameters, answers, and the OpenAPI document that describes them."""

import json
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from http import HTTPStatus
from inspect import iscoroutinefunction, signature
from pathlib import PurePath
from typing import Annotated, Any, Final, Literal, TypeAlias

import cv2
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from pydantic.json_schema import models_json_schema
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from fingerpad._json import dumps
from fingerpad.exceptions import FingerpadError, ManifestError
from fingerpad.study.manifest.models import Pixel
from fingerpad.web.answers.base import Answer, Refusal
from fingerpad.web.answers.study import EVENTS
from fingerpad.web.errors import RequestError
from fingerpad.web.workspace import REQUESTED, Workspace

BODY_LIMIT: Final = 8_000_000
# Headers of what has another address once it changes.
IMMUTABLE: Final = {"cache-control": "private, max-age=31536000, immutable"}
# Odd pictures and numbers may raise these: the request fails, and the page goes on.
_RECOVERABLE_ERRORS: Final = (ArithmeticError, MemoryError, ValueError, cv2.error)


class Params(BaseModel):
    """Parameters of a request: no unknown key, and finite numbers only."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


Point: TypeAlias = tuple[Pixel, Pixel]
Item: TypeAlias = Annotated[str, Field(min_length=1, max_length=1000)]
Person: TypeAlias = Annotated[str, Field(max_length=60)]


class NoParams(Params):
    """No parameters."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Endpoint:
    """An endpoint of the API.

    Attributes
    ----------
    method, path : str
        Method and path of its requests.
    answer : callable
        Takes the workspace, the validated query and body, and returns the content of `model` or a
        `Response`. It runs on a thread of its own, so that it may take long.
    summary : str
        One line of the OpenAPI document.
    model : type of Answer or None
        Model of the answer, None where it is not JSON.
    query, body : type of Params
        Models of the query and of the body.
    status : int
        Status of an answer in JSON.
    media : str
        Media type of an answer that is not JSON.
    streamed : bool
        Whether body or answer are streamed: `answer` is then a coroutine, and takes the request in place of
        a body.
    """

    method: Literal["GET", "POST", "PUT", "DELETE"]
    path: str
    answer: Callable[[Workspace, Any, Any], Any]
    summary: str
    model: type[Answer] | None
    query: type[Params]
    body: type[Params]
    status: HTTPStatus
    media: str
    streamed: bool

    @property
    def plain_path(self) -> str:
        """The path without Starlette's converters."""
        return self.path.replace(":path}", "}")

    def route(self, workspace: Workspace) -> Route:
        """Return the route of this endpoint for a workspace."""

        async def respond(request: Request) -> Response:
            try:
                place = dict(request.path_params)
                REQUESTED.set(place.pop("study", None))
                params = validated_query(self.query, {**request.query_params, **place})
                if self.streamed:
                    with plain_errors():
                        return self._response(await self.answer(workspace, params, request))
                body = NoParams() if self.body is NoParams else await _body(self.body, request)
                return await run_in_threadpool(self._answer, workspace, params, body)
            except RequestError as error:
                return error_response(error)

        return Route(self.path, respond, methods=[self.method])

    def _answer(self, workspace: Workspace, query: Params, body: Params) -> Response:
        """Call the library; its errors become answers with the same text."""
        with plain_errors():
            found = self.answer(workspace, query, body)
        return self._response(found)

    def _response(self, found: Any) -> Response:
        """Validate an answer by its model and return it; one that does not fit is a fault of the program."""
        if isinstance(found, Response):
            return found
        assert self.model is not None
        content, status = found if isinstance(found, tuple) else (found, self.status)
        text = _encoded(content)
        self.model.model_validate_json(text)
        return Response(text, status_code=status, media_type="application/json")


def endpoint(
    method: Literal["GET", "POST", "PUT", "DELETE"],
    path: str,
    summary: str,
    model: type[Answer] | None = None,
    *,
    status: HTTPStatus = HTTPStatus.OK,
    media: str = "application/octet-stream",
) -> Callable[[Callable[[Workspace, Any, Any], Any]], Endpoint]:
    """Make an `Endpoint` of the function that answers it, whose annotations are query and body."""

    def of(answer: Callable[[Workspace, Any, Any], Any]) -> Endpoint:
        _, query, body = (one.annotation for one in signature(answer).parameters.values())
        return Endpoint(
            method=method,
            path=path,
            answer=answer,
            summary=summary,
            model=model,
            query=NoParams if query is Any else query,
            body=NoParams if body in (Any, Request) else body,
            status=status,
            media=media,
            streamed=iscoroutinefunction(answer),
        )

    return of


class plain_errors:  # noqa: N801 (used as a statement)
    """Turn the library's errors into those of a request."""

    def __enter__(self) -> None:
        """Do nothing."""

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        """Raise a `RequestError` with the same text."""
        if isinstance(error, ManifestError):
            raise RequestError.impossible(str(error), faults=manifest_errors(error)) from error
        if isinstance(error, FingerpadError):
            raise RequestError.impossible(str(error)) from error
        if isinstance(error, OSError) and error.strerror:
            raise RequestError.impossible(f"{_name_of(error)}{error.strerror}") from error
        if isinstance(error, _RECOVERABLE_ERRORS):
            raise RequestError.impossible(f"this cannot be done ({type(error).__name__}: {error})") from error


def _name_of(error: OSError) -> str:
    """Return the name of an error's file, as the start of a sentence."""
    name = error.filename
    return f"{PurePath(os.fsdecode(name)).name}: " if isinstance(name, str | bytes) else ""


def manifest_errors(error: ManifestError) -> list[dict[str, str]]:
    """Return the errors of a manifest, each with its place."""
    found = []
    for line in str(error).splitlines():
        where, _, rest = line.partition(": ")
        place, colon, words = rest.partition(": ")
        found.append({"place": place, "words": words} if colon else {"place": "", "words": rest or where})
    return found


def _encoded(content: Any) -> bytes:
    """Return JSON in UTF-8; NaN and infinity become null."""
    return dumps(content).encode(errors="replace")  # a file's name may hold bytes that are not text


def error_response(error: RequestError) -> Response:
    """Return the response to a request that failed."""
    text = _encoded({"error": error.words, **error.more})
    return Response(text, status_code=error.status, media_type="application/json")


def validated_query(model: type[Params], content: Any) -> Params:
    """Validate a query, whose values are text."""
    try:
        return model.model_validate(content, strict=False)
    except ValidationError as error:
        raise _malformed(error) from error


async def _body(model: type[Params], request: Request) -> Params:
    text = await limited_body(request, BODY_LIMIT)
    try:
        return model.model_validate_json(text or b"{}", strict=True)
    except ValidationError as error:
        raise _malformed(error) from error


def _malformed(error: ValidationError) -> RequestError:
    faults = [
        {"place": ".".join(map(str, fault["loc"])), "words": fault["msg"]}
        for fault in error.errors(include_url=False, include_input=False, include_context=False)
    ]
    words = "; ".join(
        f"{fault['place']}: {fault['words']}" if fault["place"] else fault["words"] for fault in faults
    )
    return RequestError(HTTPStatus.BAD_REQUEST, words, faults=faults)


async def limited_body(request: Request, limit: int) -> bytes:
    """Read a body of at most `limit` bytes, and no more of a larger one."""
    parts, size = [], 0
    async for part in request.stream():
        size += len(part)
        if size > limit:
            raise RequestError(
                HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"more than {limit} bytes: send less at once"
            )
        parts.append(part)
    return b"".join(parts)


def openapi(operations: Sequence[Endpoint], version: str) -> dict[str, Any]:
    """Return the OpenAPI 3.1 document of the endpoints."""
    models: set[type[Answer]] = {Refusal, *EVENTS.values()}
    models.update(one.model for one in operations if one.model is not None)
    ordered = sorted(models, key=lambda model: model.__name__)
    _, schemas = models_json_schema(
        [(model, "serialization") for model in ordered], ref_template="#/components/schemas/{model}"
    )
    paths: dict[str, dict[str, Any]] = {}
    for operation in operations:
        paths.setdefault(operation.plain_path, {})[operation.method.lower()] = _described(operation)
    return {
        "openapi": "3.1.0",
        "info": {
            "title": "fingerpad",
            "version": version,
            "description": "The API under the page of fingerpad app.",
        },
        "components": {
            "securitySchemes": {"token": {"type": "http", "scheme": "bearer"}},
            "schemas": schemas["$defs"],
        },
        "security": [{"token": []}],
        "paths": paths,
    }


def _described(operation: Endpoint) -> dict[str, Any]:
    schema = operation.query.model_json_schema()
    in_path = [part.strip("{}") for part in operation.plain_path.split("/") if part.startswith("{")]
    parameters = [
        {
            "name": name,
            "in": "path" if name in in_path else "query",
            "required": name in in_path or name in schema.get("required", ()),
            "schema": what,
        }
        for name, what in schema.get("properties", {}).items()
    ]
    if "study" in in_path:
        parameters.append({"name": "study", "in": "path", "required": True, "schema": {"type": "string"}})
    content: dict[str, Any] = (
        {operation.media: {"schema": {"type": "string"}}}
        if operation.model is None
        else {"application/json": {"schema": _reference(operation.model)}}
    )
    described: dict[str, Any] = {
        "summary": operation.summary,
        "operationId": f"{operation.method.lower()}{operation.plain_path.replace('/', '_')}",
        "parameters": parameters,
        "responses": {
            str(int(operation.status)): {"description": "the answer", "content": content},
            "4XX": {
                "description": "why the request failed",
                "content": {"application/json": {"schema": _reference(Refusal)}},
            },
        },
    }
    if operation.streamed and operation.method == "POST":
        content = {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}}
        described["requestBody"] = {"required": True, "content": content}
    if operation.body is not NoParams:
        body = json.loads(json.dumps(operation.body.model_json_schema(ref_template="#/$defs/{model}")))
        described["requestBody"] = {
            "required": True,
            "content": {"application/json": {"schema": _flat(body)}},
        }
    return described


def _reference(model: type[Answer]) -> dict[str, str]:
    return {"$ref": f"#/components/schemas/{model.__name__}"}


def _flat(schema: dict[str, Any]) -> dict[str, Any]:
    """Replace the references of a schema by what they refer to."""
    known = schema.pop("$defs", {})

    def put(value: Any) -> Any:
        if isinstance(value, dict):
            if "$ref" in value:
                return put(known[value["$ref"].rpartition("/")[2]])
            return {key: put(item) for key, item in value.items() if key != "discriminator"}
        return [put(item) for item in value] if isinstance(value, list) else value

    flat: dict[str, Any] = put(schema)
    return flat
