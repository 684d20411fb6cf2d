r"""How load and area depart from those of a paraboloid on a half-space: an exact sphere, a layer over bone.

Both are factors at the same indentation ξ: on :math:`\tfrac43 R^{1/2}\xi^{3/2}` and on :math:`\pi R \xi`.
A pad that is not a sphere has R = 1/H, and its form is four numbers without dimension, `PAD_FORM`.
"""

from collections.abc import Mapping
from functools import cache, lru_cache
from typing import Final

import numpy as np
from scipy.interpolate import CubicSpline

from fingerpad._arrays import FloatArray
from fingerpad.contact.laws import press
from fingerpad.geometry.gap import Gap, paraboloid_gap

# The exact sphere is tabulated to this a/R, a layer to this a/t (its laws hold to 3).
_WIDEST, _THINNEST = 0.98, 2.95
_WIDEST_PAD, _KNOTS = 1.2, 48  # a/R to which a pad is tabulated, where its laws hold
_LEAST = 0.2
_INCOMPRESSIBLE = 0.5
# Of the gap of a pad: R1/R2, then skewness and flatness times R (see `Gap`).
PAD_FORM: Final = ("radius_ratio", "first_skewness", "second_skewness", "flatness")


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
        return _within(_sphere(), xi / radius)
    if PAD_FORM[0] in values:
        curved = values.get("pad_form", 1.0)
        form = (values[PAD_FORM[0]], *(curved * values[name] for name in PAD_FORM[1:]))
        inverse = radius * values.get("inverse_thickness", 0.0)
        return _on_layer(form, inverse, poisson_ratio, np.sqrt(np.maximum(xi, 0.0) / radius))
    if values.get("inverse_thickness", 0.0) != 0:
        size = np.sqrt(radius * np.maximum(xi, 0.0)) * values["inverse_thickness"]
        return _within(_layer(poisson_ratio), size)
    return one, one


def _within(factors: CubicSpline, size: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the factors on load and area, the spline's columns; beyond its ends they go on straight."""
    known = np.clip(size, 0.0, factors.x[-1])
    both = factors(known)
    beyond = size - known
    if beyond.any():
        both += factors(known, 1) * beyond[..., None]
    both = np.maximum(both, _LEAST)
    return both[..., 0], both[..., 1]


def _on_layer(
    form: tuple[float, ...], inverse: float, poisson_ratio: float, size: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the factors of a pad at sizes √(ξ/R); a negative R/t continues them as an odd function of it."""
    if poisson_ratio > _INCOMPRESSIBLE:
        most = _on_layer(form, inverse, _INCOMPRESSIBLE, size)
        less = _on_layer(form, inverse, 2 * _INCOMPRESSIBLE - poisson_ratio, size)
        return 2 * most[0] - less[0], 2 * most[1] - less[1]
    load, area = _within(_pad(form, abs(inverse), poisson_ratio), size)
    if inverse >= 0:
        return load, area
    deep = _within(_pad(form, 0.0, poisson_ratio), size)
    return np.maximum(2 * deep[0] - load, _LEAST), np.maximum(2 * deep[1] - area, _LEAST)


@lru_cache(maxsize=1024)
def _pad(form: tuple[float, ...], inverse: float, poisson_ratio: float) -> CubicSpline:
    """Return the factors of a pad of R = 1 on a layer of thickness 1/inverse, against √ξ."""
    first = (1 + form[0]) / 2
    radii = np.array([first, first / form[0]])
    a = np.linspace(0.01, _WIDEST_PAD, _KNOTS) * min(1.0, _THINNEST / (inverse * _WIDEST_PAD + 1e-12))
    skew = dict(zip(PAD_FORM[1:], map(np.asarray, form[1:]), strict=True))
    contact = press(
        Gap(first_radius=radii[0], second_radius=radii[1], **skew, angle=np.zeros(())),
        area=np.pi * a**2,
        reduced_modulus=1.0,
        thickness=1 / inverse if inverse else None,
        poisson_ratio=max(poisson_ratio, 0.3),
    )
    known = contact.flag_code == 0
    load, depth, area = (
        np.append(at_first, getattr(contact, name)[known])
        for at_first, name in zip(_first_touch(*radii.tolist()), ("load", "indentation", "area"), strict=True)
    )
    size = np.append(0.0, np.sqrt(depth[1:]))
    return CubicSpline(size, np.stack([0.75 * load / depth**1.5, area / (np.pi * depth)], axis=-1))


@lru_cache(maxsize=1024)
def _first_touch(first: float, second: float) -> tuple[float, float, float]:
    """Return load, indentation and area of a paraboloid of these radii on a half-space."""
    point = press(paraboloid_gap(np.array(first), np.array(second)), area=np.pi, reduced_modulus=1.0)
    return float(point.load), float(point.indentation), float(point.area)


@cache
def _sphere() -> CubicSpline:
    """Return the factors against ξ/R (Sneddon 1965: ξ = a artanh(a/R), frictionless)."""
    a = np.linspace(0.01, _WIDEST, 300)
    depth = a * np.arctanh(a)
    load = (1 + a**2) * np.arctanh(a) - a
    size = np.append(0.0, depth)
    return CubicSpline(size, np.insert([0.75 * load / depth**1.5, a**2 / depth], 0, 1.0, axis=1).T)


@cache
def _layer(poisson_ratio: float) -> CubicSpline:
    """Return the factors against √(Rξ)/t on a layer bonded to bone (`fast_contact`)."""
    a = np.linspace(0.02, _THINNEST, 150)
    contact = press(
        paraboloid_gap(np.ones(()), np.ones(())),
        area=np.pi * a**2,
        reduced_modulus=1.0,
        thickness=1.0,
        poisson_ratio=max(poisson_ratio, 0.3),
    )
    size = np.append(0.0, np.sqrt(contact.indentation))
    factors = [0.75 * contact.load / contact.indentation**1.5, contact.area_over_pi_indentation]
    return CubicSpline(size, np.insert(factors, 0, 1.0, axis=1).T)
