"""Laws of the force of a pressed pad, and where a press is on them: indentation, and the force's zero."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad._display import Displayed
from fingerpad.loading.models import clipped_load, hertz_stiffness
from fingerpad.loading.shapes import shape_factors

Values = Mapping[str, float]

# Steps in which the indentation is found that a yielding stage leaves.
_STEPS = 6


def _hertz(values: Values, xi: FloatArray, stiffness: FloatArray) -> FloatArray:
    return values["youngs_modulus"] * (stiffness * xi**1.5)


def _growing(values: Values, xi: FloatArray, stiffness: FloatArray) -> FloatArray:
    return clipped_load(stiffness * xi**1.5, values["initial_modulus"], values["load_coefficient"])


def _power(values: Values, xi: FloatArray, stiffness: FloatArray) -> FloatArray:
    exponent = min(max(values["load_exponent"], 0.05), 20.0)
    return values["youngs_modulus"] * stiffness * xi**exponent


# The load W as a function of values, ξ and 4/3 R^½/(1 − ν²).
FORCE_MODELS: Final[Mapping[str, Callable[[Values, FloatArray, FloatArray], FloatArray]]] = MappingProxyType(
    {
        "hertz": _hertz,
        "load_dependent": _growing,
        "exact_sphere": _growing,  # its shape is a factor on the stiffness
        "free_exponent": _power,
    }
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FittedForceModel(Displayed):
    """A force model with the values that fit a record.

    Attributes
    ----------
    law : str
        Key of `FORCE_MODELS`.
    values : dict of str to float
        All parameters: mm, N, s, MPa.
    poisson_ratio : float
        ν of the pad.
    aicc : float
        Corrected Akaike criterion χ² + 2k + 2k(k+1)/(n−k−1), to compare models under one noise.

    Examples
    --------
    >>> values = {"contact_offset": 1.0, "loading_radius": 20.5, "youngs_modulus": 0.1024}
    >>> model = FittedForceModel(law="hertz", values=values, poisson_ratio=0.5, aicc=0.0)
    >>> model.load(np.array([1.0, 2.806])).round(2)
    array([0., 2.])
    """

    law: str
    values: dict[str, float]
    poisson_ratio: float
    aicc: float

    def load(self, displacement: FloatArray) -> FloatArray:
        """Return the fitted load at readings of the displacement.

        Parameters
        ----------
        displacement : ndarray
            Readings, mm, from the instrument's zero.

        Returns
        -------
        ndarray
            W, N.
        """
        return _load(self.values, self.law, displacement, self.poisson_ratio)

    def corrected_load(self, clock: FloatArray, load: FloatArray) -> FloatArray:
        """Return measured forces with zero and tilt removed.

        Parameters
        ----------
        clock : ndarray
            Times of the readings, s, from the start of the record.
        load : ndarray
            Readings, N.

        Returns
        -------
        ndarray
            N.
        """
        return load - force_zero(self.values, clock)


def _load(values: Values, law: str, displacement: FloatArray, poisson_ratio: float) -> FloatArray:
    xi = indentation_of(values, law, displacement, poisson_ratio)
    return load_at(values, law, np.maximum(xi, 0.0), poisson_ratio)


def load_at(values: Values, law: str, xi: FloatArray, poisson_ratio: float) -> FloatArray:
    """Return the load W (N) at indentations ξ (mm), none of them negative."""
    stiffness = hertz_stiffness(max(values["loading_radius"], 1e-9), poisson_ratio)
    factor, _ = shape_factors(law, values, xi, poisson_ratio)
    return FORCE_MODELS[law](values, xi, stiffness * factor)


def indentation_of(values: Values, law: str, displacement: FloatArray, poisson_ratio: float) -> FloatArray:
    """Return ξ, negative before contact: the displacement from contact on, less what the stage yields."""
    whole = displacement - values["contact_offset"]
    compliance = values.get("stage_compliance", 0.0)
    if compliance == 0:
        return whole
    xi = np.maximum(whole, 0.0)
    for _ in range(_STEPS):
        load = load_at(values, law, xi, poisson_ratio)
        rise = 1.5 * load / np.maximum(xi, 1e-9)
        xi = np.maximum(xi - (xi + compliance * load - whole) / np.maximum(1 + compliance * rise, 0.2), 0.0)
    return np.where(whole > 0, xi, whole)


def force_zero(values: Values, clock: FloatArray) -> FloatArray:
    """Return what the sensor shows without contact, N."""
    line = values.get("force_zero", 0.0) + values.get("force_tilt", 0.0) * clock
    bend = values.get("force_bend", 0.0)
    return line + bend * (clock / clock[-1]) ** 2 if bend else line
