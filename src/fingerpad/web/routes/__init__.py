"""The endpoints of the API, by what they are about."""

from typing import Final

from fingerpad.web.endpoints import Endpoint
from fingerpad.web.routes import (
    contacts,
    corrections,
    figures,
    files,
    geometry,
    images,
    new_files,
    photographs,
    results,
    scales,
    sequences,
    state,
    studies,
)

_MODULES: Final = (
    studies,
    state,
    images,
    scales,
    photographs,
    contacts,
    sequences,
    corrections,
    results,
    figures,
    geometry,
    files,
    new_files,
)
ENDPOINTS: Final = tuple(
    one for module in _MODULES for one in vars(module).values() if isinstance(one, Endpoint)
)
