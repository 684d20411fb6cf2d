"""Errors of requests: a status and a message."""

from http import HTTPStatus
from typing import Any

from starlette.exceptions import HTTPException


class RequestError(HTTPException):
    """A request that failed: words of what is wrong and what to do, and further keys of the answer."""

    def __init__(self, status: HTTPStatus, words: str, **more: Any) -> None:
        super().__init__(status, words)
        self.more = more

    @classmethod
    def not_there(cls, words: str) -> "RequestError":
        """Return the error that something does not exist."""
        return cls(HTTPStatus.NOT_FOUND, words)

    @classmethod
    def conflict(cls, words: str, **more: Any) -> "RequestError":
        """Return the error that another request came first."""
        return cls(HTTPStatus.CONFLICT, words, **more)

    @classmethod
    def impossible(cls, words: str, **more: Any) -> "RequestError":
        """Return the error that a valid request cannot be done."""
        return cls(HTTPStatus.UNPROCESSABLE_ENTITY, words, **more)
