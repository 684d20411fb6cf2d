"""What the API can be asked: each operation with its question, its answer, and its OpenAPI description."""

import json
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from http import HTTPStatus
from pathlib import PurePath
from typing import Any, Final, Literal
from urllib.parse import unquote

import cv2
from pydantic import BaseModel, ConfigDict, ValidationError
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from fingerpad._json import dumps
from fingerpad.exceptions import FingerpadError, ManifestError
from fingerpad.web.errors import RequestError
from fingerpad.web.workspace import Workspace

BODY_LIMIT: Final = 8_000_000
# Says of which study a request is, percent-encoded.
STUDY_HEADER: Final = "fingerpad-study"
# A picture or a number can be odd in ways that nobody has thought of: it costs its answer, never the page.
_RECOVERABLE_ERRORS: Final = (ArithmeticError, MemoryError, ValueError, cv2.error)


class Params(BaseModel):
    """What a request says: no key that is not known, no number that is not finite."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class NoParams(Params):
    """A question without keys."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Endpoint:
    """One operation of the API.

    Attributes
    ----------
    method, path : str
        Where it is asked.
    answer : callable
        Takes the workspace, the checked query and body (`NoParams` where there is none), and returns what
        JSON can hold or a `Response`. It runs on a thread of its own, so that it may take its time.
    summary : str
        One line of the OpenAPI document.
    query, body : type of Params
        What is asked.
    status : int
        Of an answer in JSON.
    media : str
        Type of the answer.
    streamed : bool
        Whether body or answer come in parts: `answer` is then a coroutine, and takes the request as it comes
        in place of a body.
    """

    method: Literal["GET", "POST", "PUT", "DELETE"]
    path: str
    answer: Callable[[Workspace, Any, Any], Any]
    summary: str
    query: type[Params] = NoParams
    body: type[Params] = NoParams
    status: HTTPStatus = HTTPStatus.OK
    media: str = "application/json"
    streamed: bool = False

    @property
    def plain_path(self) -> str:
        """The path without Starlette's types of its parts."""
        return self.path.replace(":path}", "}")

    def route(self, workspace: Workspace) -> Route:
        """Return the route that answers for `workspace`."""

        async def respond(request: Request) -> Response:
            try:
                _same_study(workspace, request)
                query = validated_query(self.query, {**request.query_params, **request.path_params})
                if self.streamed:
                    return await self._answered_in_parts(workspace, query, request)
                body = NoParams() if self.body is NoParams else await _body(self.body, request)
                return await run_in_threadpool(self._answered, workspace, query, body)
            except RequestError as refusal:
                return error_response(refusal)

        return Route(self.path, respond, methods=[self.method])

    async def _answered_in_parts(self, workspace: Workspace, query: Params, request: Request) -> Response:
        with plain_errors():
            answer: Response = await self.answer(workspace, query, request)
        return answer

    def _answered(self, workspace: Workspace, query: Params, body: Params) -> Response:
        """Ask the library; what it refuses becomes the same words in the answer."""
        with plain_errors():
            found = self.answer(workspace, query, body)
        return found if isinstance(found, Response) else json_response(found, self.status)


def _same_study(workspace: Workspace, request: Request) -> None:
    """Refuse what is asked of another study than the one that is open: another window has opened that."""
    meant, name = request.headers.get(STUDY_HEADER), workspace.name
    if meant is not None and unquote(meant) != name:
        words = "closed the study" if name is None else f"opened the study {name!r}"
        raise RequestError.conflict(f"another window {words}: nothing was changed", study=name)


class plain_errors:  # noqa: N801 (used as a statement)
    """Turn the library's errors into refusals."""

    def __enter__(self) -> None:
        """Begin."""

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        """Say the library's words."""
        if isinstance(error, ManifestError):
            raise RequestError.impossible(str(error), faults=validation_errors(error)) from error
        if isinstance(error, FingerpadError):
            raise RequestError.impossible(str(error)) from error
        if isinstance(error, OSError) and error.strerror:
            raise RequestError.impossible(f"{_name_of(error)}{error.strerror}") from error
        if isinstance(error, _RECOVERABLE_ERRORS):
            raise RequestError.impossible(f"this cannot be done ({type(error).__name__}: {error})") from error


def _name_of(error: OSError) -> str:
    """Return the name of the file that an error is about, as the beginning of a sentence."""
    name = error.filename
    return f"{PurePath(os.fsdecode(name)).name}: " if isinstance(name, str | bytes) else ""


def validation_errors(error: ManifestError) -> list[dict[str, str]]:
    """Return the faults of a manifest, each with its place in it."""
    found = []
    for line in str(error).splitlines():
        where, _, rest = line.partition(": ")
        place, colon, words = rest.partition(": ")
        found.append({"place": place, "words": words} if colon else {"place": "", "words": rest or where})
    return found


def json_response(content: Any, status: int = HTTPStatus.OK) -> Response:
    """Return an answer in JSON, what is not a number as null."""
    # A file's name may hold bytes that are no text.
    text = dumps(content).encode(errors="replace")
    return Response(text, status_code=status, media_type="application/json")


def error_response(refusal: RequestError) -> Response:
    """Return the answer that something is not granted."""
    return json_response({"error": refusal.words, **refusal.more}, refusal.status)


def validated_query(model: type[Params], content: Any) -> Params:
    """Return what a query asks, if it is as it should be; its values are text."""
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
    """Return the OpenAPI 3.1 document of the operations."""
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
        "components": {"securitySchemes": {"token": {"type": "http", "scheme": "bearer"}}},
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
    content: dict[str, Any] = {operation.media: {"schema": {}}}
    described: dict[str, Any] = {
        "summary": operation.summary,
        "operationId": f"{operation.method.lower()}{operation.plain_path.replace('/', '_')}",
        "parameters": parameters,
        "responses": {
            str(int(operation.status)): {"description": "the answer", "content": content},
            "4XX": {
                "description": "refused, in words",
                "content": {
                    "application/json": {
                        "schema": {
                            "type": "object",
                            "required": ["error"],
                            "properties": {"error": {"type": "string"}},
                        }
                    }
                },
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


def _flat(schema: dict[str, Any]) -> dict[str, Any]:
    """Put what a schema refers to in its place, so that it stands alone."""
    known = schema.pop("$defs", {})

    def put(value: Any) -> Any:
        if isinstance(value, dict):
            if "$ref" in value:
                return put(known[value["$ref"].rpartition("/")[2]])
            return {key: put(item) for key, item in value.items() if key != "discriminator"}
        return [put(item) for item in value] if isinstance(value, list) else value

    flat: dict[str, Any] = put(schema)
    return flat
