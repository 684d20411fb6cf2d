r"""How load and area depart from those of a paraboloid on a half-space: an exact sphere, a layer over bone.

Both are factors at the same indentation ξ: on :math:`\tfrac43 R^{1/2}\xi^{3/2}` and on :math:`\pi R \xi`.
"""

from collections.abc import Mapping
from functools import cache

import numpy as np
from scipy.interpolate import CubicSpline

from fingerpad._arrays import FloatArray
from fingerpad.contact import PadGap, fast_contact

# The exact sphere is tabulated to this a/R, a layer to this a/t (its laws hold to 3).
_WIDEST, _THINNEST = 0.98, 2.95
_LEAST = 0.2


def shape_factors(
    law: str, values: Mapping[str, float], xi: FloatArray, poisson_ratio: float
) -> tuple[FloatArray, FloatArray]:
    """Return the factors on load and area at indentations ξ (mm), both one for a paraboloid on a half-space.

    The law ``exact_sphere``, or a value ``inverse_thickness`` (1/mm), says otherwise. A negative one, to
    which a search may go, continues the factors in a straight line.
    """
    one = np.ones_like(xi)
    radius = max(values["loading_radius"], 1e-9)
    if law == "exact_sphere":
        return _within(*_sphere(), xi / radius)
    if values.get("inverse_thickness", 0.0) != 0:
        size = np.sqrt(radius * np.maximum(xi, 0.0)) * values["inverse_thickness"]
        return _within(*_layer(poisson_ratio), size)
    return one, one


def _within(load: CubicSpline, area: CubicSpline, size: FloatArray) -> tuple[FloatArray, FloatArray]:
    known = np.clip(size, 0.0, load.x[-1])
    of_load, of_area = (
        np.maximum(law(known) + law(known, 1) * (size - known), _LEAST) for law in (load, area)
    )
    return of_load, of_area


@cache
def _sphere() -> tuple[CubicSpline, CubicSpline]:
    """Return the factors against ξ/R (Sneddon 1965: ξ = a artanh(a/R), frictionless)."""
    a = np.linspace(0.01, _WIDEST, 300)
    depth = a * np.arctanh(a)
    load = (1 + a**2) * np.arctanh(a) - a
    size = np.append(0.0, depth)
    return (
        CubicSpline(size, np.append(1.0, 0.75 * load / depth**1.5)),
        CubicSpline(size, np.append(1.0, a**2 / depth)),
    )


@cache
def _layer(poisson_ratio: float) -> tuple[CubicSpline, CubicSpline]:
    """Return the factors against √(Rξ)/t on a layer bonded to bone (`fast_contact`)."""
    a = np.linspace(0.02, _THINNEST, 150)
    contact = fast_contact(
        PadGap.paraboloid(1.0, 1.0),
        area=np.pi * a**2,
        reduced_modulus=1.0,
        thickness=1.0,
        poisson_ratio=max(poisson_ratio, 0.3),
    )
    size = np.append(0.0, np.sqrt(contact.indentation))
    return (
        CubicSpline(size, np.append(1.0, 0.75 * contact.load / contact.indentation**1.5)),
        CubicSpline(size, np.append(1.0, contact.area_over_pi_indentation)),
    )
