"""Answers that are no: a status and words for people."""

from http import HTTPStatus
from typing import Any


class RequestError(Exception):
    """A request that is not granted.

    Attributes
    ----------
    status : HTTPStatus
        Of the answer.
    words : str
        What is wrong, and the way out.
    more : dict
        What else the answer holds, beside ``"error"``.
    """

    def __init__(self, status: HTTPStatus, words: str, **more: Any) -> None:
        super().__init__(words)
        self.status, self.words, self.more = status, words, more

    @classmethod
    def not_there(cls, words: str) -> "RequestError":
        """Return the answer that something is not there."""
        return cls(HTTPStatus.NOT_FOUND, words)

    @classmethod
    def conflict(cls, words: str, **more: Any) -> "RequestError":
        """Return the answer that something else came first."""
        return cls(HTTPStatus.CONFLICT, words, **more)

    @classmethod
    def impossible(cls, words: str, **more: Any) -> "RequestError":
        """Return the answer that a request is understood but cannot be done."""
        return cls(HTTPStatus.UNPROCESSABLE_ENTITY, words, **more)
