"""The endpoints of the API, by what they are about: each module adds its own to the routers."""

from importlib import import_module
from pkgutil import iter_modules

from fingerpad.web.api.base import here, router

for _module in iter_modules(__path__, f"{__name__}."):
    import_module(_module.name)

__all__ = ["here", "router"]
