"""Contact mechanics of the human finger pad.

The names that most people need are offered here, and imported when they are first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from fingerpad.contact import (
        Contact,
        Tissue,
        fast_contact,
        hertz_contact,
        solve_contact,
        youngs_modulus,
    )
    from fingerpad.exceptions import FingerpadError
    from fingerpad.figures.show import show
    from fingerpad.geometry import Ellipse, Ellipsoid, Paraboloid, Placement
    from fingerpad.image import (
        ForceSignal,
        FrameRate,
        Scale,
        combine_faces,
        measure_coin,
        measure_contact_image,
        measure_photograph,
        measure_sequence,
        open_frames,
        read_force_signal,
        read_image,
    )
    from fingerpad.loading import LoadingCurve, fit_loading_curve, read_loading_curve
    from fingerpad.study.pipeline import run_study
    from fingerpad.study.results.load import load_results
    from fingerpad.uncertainty import Inputs, pad_model, pad_uncertainty, pool, propagate, run_monte_carlo

_MODULES = {
    "fingerpad.contact": (
        "Contact",
        "Tissue",
        "fast_contact",
        "hertz_contact",
        "solve_contact",
        "youngs_modulus",
    ),
    "fingerpad.exceptions": ("FingerpadError",),
    "fingerpad.figures.show": ("show",),
    "fingerpad.geometry": ("Ellipse", "Ellipsoid", "Paraboloid", "Placement"),
    "fingerpad.image": (
        "ForceSignal",
        "FrameRate",
        "Scale",
        "combine_faces",
        "measure_coin",
        "measure_contact_image",
        "measure_photograph",
        "measure_sequence",
        "open_frames",
        "read_force_signal",
        "read_image",
    ),
    "fingerpad.loading": ("LoadingCurve", "fit_loading_curve", "read_loading_curve"),
    "fingerpad.study.pipeline": ("run_study",),
    "fingerpad.study.results.load": ("load_results",),
    "fingerpad.uncertainty": (
        "Inputs",
        "pad_model",
        "pad_uncertainty",
        "pool",
        "propagate",
        "run_monte_carlo",
    ),
}
_MODULE_OF = {name: module for module, names in _MODULES.items() for name in names}

__all__ = [
    "Contact",
    "Ellipse",
    "Ellipsoid",
    "FingerpadError",
    "ForceSignal",
    "FrameRate",
    "Inputs",
    "LoadingCurve",
    "Paraboloid",
    "Placement",
    "Scale",
    "Tissue",
    "__version__",
    "combine_faces",
    "fast_contact",
    "fit_loading_curve",
    "hertz_contact",
    "load_results",
    "measure_coin",
    "measure_contact_image",
    "measure_photograph",
    "measure_sequence",
    "open_frames",
    "pad_model",
    "pad_uncertainty",
    "pool",
    "propagate",
    "read_force_signal",
    "read_image",
    "read_loading_curve",
    "run_monte_carlo",
    "run_study",
    "show",
    "solve_contact",
    "youngs_modulus",
]


if not TYPE_CHECKING:  # a type checker would take any name for one that is there

    def __getattr__(name: str) -> Any:
        """Import a name of `__all__` when it is first used."""
        if name not in _MODULE_OF:
            raise AttributeError(f"module 'fingerpad' has no attribute {name!r}")
        value = globals()[name] = getattr(import_module(_MODULE_OF[name]), name)
        return value


def __dir__() -> list[str]:
    return list(__all__)
