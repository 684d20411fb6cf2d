"""The endpoints of the API, by what they are about: each module adds its own to the routers."""

from fingerpad.web.api import (  # noqa: F401
    contacts,
    corrections,
    downloads,
    files,
    geometry,
    images,
    new_files,
    photographs,
    results,
    scales,
    sequences,
    simulator,
    state,
    studies,
)
from fingerpad.web.api.base import here, router

__all__ = ["here", "router"]
