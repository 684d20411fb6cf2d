"""What pressing a pad on one layer of tissue over bone shows: R_g, read in three ways, and exponents."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array, check_all
from fingerpad._display import Displayed
from fingerpad.contact.laws import find_modulus, plate_gap, press
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Ellipsoid, Placement

READINGS: Final = ("ratio", "slope", "slope_through_origin")
_LOADS: Final = 64


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ExpectedLoading(Displayed):
    """What pressing a pad on a layer of tissue shows; NaN beyond the range of the laws.

    Attributes
    ----------
    reduced_modulus : ndarray
        E* with which the highest load gives the contact area.
    ratio : ndarray
        A/(πξ) at the highest load.
    slope : ndarray
        Slope of A against πξ, with an intercept.
    slope_through_origin : ndarray
        The same without an intercept.
    contact_shift : ndarray
        Indentation at which the line with an intercept reaches A = 0; zero in Hertz theory.
    area_exponent : ndarray
        n of A ∝ W^n; 2/3 in Hertz theory.
    load_exponent : ndarray
        m of W ∝ ξ^m; 3/2 in Hertz theory.
    along_over_across : ndarray
        Axis of the contact nearer to the finger's over the other, at the highest load, by second moments.

    Examples
    --------
    >>> pad = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
    >>> loading = expected_loading(pad, wedge_angle=np.radians(30), area=116.3, thickness=8.0)
    >>> loading.ratio.round(1), loading.along_over_across.round(2)
    (np.float64(20.4), np.float64(0.95))
    """

    reduced_modulus: FloatArray
    ratio: FloatArray
    slope: FloatArray
    slope_through_origin: FloatArray
    contact_shift: FloatArray
    area_exponent: FloatArray
    load_exponent: FloatArray
    along_over_across: FloatArray

    def loading_radius(self, reading: str) -> FloatArray:
        """Return R_g, read from area and indentation in one of three ways.

        Parameters
        ----------
        reading : str
            "ratio", "slope" or "slope_through_origin".

        Returns
        -------
        ndarray
            In the unit of the semi-axes.

        Raises
        ------
        GeometryError
            For any other reading.
        """
        check_choice("reading", reading, READINGS)
        radius: FloatArray = getattr(self, reading)
        return radius


def expected_loading(
    pad: Ellipsoid,
    *,
    wedge_angle: ArrayLike,
    area: ArrayLike,
    thickness: ArrayLike,
    poisson_ratio: ArrayLike = 0.5,
    load: float = 2.0,
    min_load: float = 0.0,
) -> ExpectedLoading:
    """Return R_g and the exponents that a pad on a layer of tissue over bone should show.

    The whole ellipsoid is pressed against a plate without friction (`fast_contact`). E* follows from the
    contact area at the highest load. Lines and exponents are least-squares fits to 64 evenly spaced loads.
    Arrays broadcast.

    Parameters
    ----------
    pad : Ellipsoid
        One pad, or many.
    wedge_angle : array_like
        Wedge angle θ, radians.
    area : array_like
        Contact area at the highest load.
    thickness : array_like
        Of the layer, bonded to rigid bone; infinity for a half-space.
    poisson_ratio : array_like
        ν of the tissue, 0.3 to 0.5.
    load, min_load : float
        Highest and lowest load; the lowest itself is left out.

    Returns
    -------
    ExpectedLoading
        R_g by its three readings, E* and exponents.

    Raises
    ------
    GeometryError
        If a thickness is not positive, or the loads are not 0 ≤ min_load < load.

    Examples
    --------
    The pad of Dzidek et al. (2017) at 30°, where R_g = 20.5 mm, on deep tissue and on 8 mm over bone:

    >>> pad = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
    >>> loading = expected_loading(pad, wedge_angle=np.radians(30), area=116.3, thickness=[np.inf, 8.0])
    >>> loading.loading_radius("ratio").round(1), loading.slope.round(1)
    (array([12.4, 20.4]), array([12.2, 21.4]))
    >>> loading.area_exponent.round(2), loading.load_exponent.round(2)
    (array([0.65, 0.61]), array([1.49, 1.83]))
    """
    thickness = as_float_array(thickness)
    check_all(thickness > 0, "thickness", thickness, "positive", GeometryError)
    if not 0 <= min_load < load < np.inf:
        raise GeometryError(f"loads must rise from zero or above, found {min_load:g} to {load:g}")
    gap = plate_gap(Placement(pad, wedge_angle=wedge_angle))
    tissue = {"thickness": thickness, "poisson_ratio": poisson_ratio}
    modulus, highest = find_modulus(gap, load=load, area=area, **tissue)
    loads = np.linspace(min_load, load, _LOADS + 1)[1:]
    contact = press(
        gap[..., None],
        load=loads,
        reduced_modulus=modulus[..., None],
        thickness=thickness[..., None],
        poisson_ratio=as_float_array(poisson_ratio)[..., None],
    )
    x, y = np.pi * contact.indentation, contact.area
    slope = _slope(x, y)
    return ExpectedLoading(
        reduced_modulus=modulus,
        ratio=y[..., -1] / x[..., -1],
        slope=slope,
        slope_through_origin=np.sum(x * y, axis=-1) / np.sum(x * x, axis=-1),
        contact_shift=(x.mean(axis=-1) - y.mean(axis=-1) / slope) / np.pi,
        area_exponent=_slope(np.log(loads), np.log(y)),
        load_exponent=_slope(np.log(x), np.log(loads)),
        along_over_across=np.where(highest.along, highest.aspect_ratio, 1 / highest.aspect_ratio),
    )


def _slope(x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the slope of y on x over the last axis, by least squares."""
    deviation = x - x.mean(axis=-1, keepdims=True)
    slope: FloatArray = np.sum(deviation * y, axis=-1) / np.sum(deviation**2, axis=-1)
    return slope


def check_choice(name: str, value: str, choices: tuple[str, ...]) -> None:
    """Raise GeometryError unless `value` is one of `choices`."""
    if value not in choices:
        raise GeometryError(f"{name} must be one of {', '.join(choices)}; found {value!r}")
