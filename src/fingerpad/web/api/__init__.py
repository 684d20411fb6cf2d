"""The endpoints of the API, by what they are about."""

from typing import Final

from fastapi import APIRouter

from fingerpad.web.api import (
    contacts,
    corrections,
    downloads,
    figures,
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

ROUTERS: Final[tuple[APIRouter, ...]] = (
    *(studies.here, studies.router, state.router, images.router, scales.router, photographs.router),
    *(contacts.router, sequences.router, corrections.router, results.here, results.router),
    simulator.router,
    *(figures.router, geometry.router, files.here, files.router, downloads.router, new_files.router),
)
