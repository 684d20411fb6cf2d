"""A whole pad on a layer of tissue over bone, from its load and its contact area or indentation."""

from dataclasses import dataclass

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array
from fingerpad.contact.fast_laws import FLAGS, FastContact, fast_contact
from fingerpad.contact.hertz import youngs_modulus
from fingerpad.contact.pad_gap import PadGap
from fingerpad.geometry import Ellipsoid


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class LayeredContact(FastContact):
    """A pad on a layer of tissue over bone, with the moduli that explain it; NaN where it is flagged.

    A/(πξ) is what loading data should show as R_g at its load.

    Attributes
    ----------
    load, area, indentation : ndarray
        Normal force W, contact area A and mutual approach ξ.
    flag_code : ndarray
        Place in `FLAGS` of what takes a contact out of the laws' range; 0 within.
    reduced_modulus : ndarray
        E* with which the load gives that area and indentation.
    youngs_modulus : ndarray
        E = E*(1 − ν²).

    Examples
    --------
    >>> pad = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
    >>> contact = layered_contact(pad, wedge_angle=np.radians(30), thickness=[8.0, 1.5], load=2, area=116)
    >>> contact.area_over_pi_indentation.round(1), contact.flag.tolist()
    (array([20.4,  nan]), ['', 'layer_too_thin'])
    """

    reduced_modulus: FloatArray
    youngs_modulus: FloatArray


def layered_contact(
    pad: Ellipsoid,
    *,
    wedge_angle: ArrayLike,
    roll_angle: ArrayLike = 0.0,
    thickness: ArrayLike,
    poisson_ratio: ArrayLike = 0.5,
    load: ArrayLike,
    area: ArrayLike | None = None,
    indentation: ArrayLike | None = None,
) -> LayeredContact:
    """Find the modulus of a pad on a layer of tissue over bone, by the fast laws.

    The whole ellipsoid is pressed against a plate without friction; the layer is bonded to flat, rigid bone
    (see `fast_contact`, which also states the range). Of area and indentation, the one that was measured is
    given; the other and E* follow. Arrays broadcast.

    Parameters
    ----------
    pad : Ellipsoid
        The undeformed pad.
    wedge_angle, roll_angle : array_like
        Placement, radians.
    thickness : array_like
        Effective thickness of the tissue; infinity for a half-space.
    poisson_ratio : array_like
        ν of the tissue, 0.3 to 0.5.
    load : array_like
        Normal force W.
    area, indentation : array_like
        Exactly one of contact area and mutual approach ξ.

    Returns
    -------
    LayeredContact
        Shapes broadcast.

    Raises
    ------
    GeometryError
        If the angles are those of no placement, or not exactly one of area and indentation is given.

    Examples
    --------
    The pad of Dzidek et al. (2017) at 30° and 2 N, on deep tissue and on 8 mm of it over bone (mm, N, MPa):

    >>> pad = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
    >>> press = {"wedge_angle": np.radians(30), "thickness": [np.inf, 8.0], "load": 2.0}
    >>> seen = layered_contact(pad, **press, area=116.3)
    >>> (1000 * seen.youngs_modulus).round(), seen.indentation.round(2)
    (array([61., 49.]), array([2.99, 1.81]))

    With the indentation of the layer, deep tissue would have to be twice as stiff:

    >>> (1000 * layered_contact(pad, **press, indentation=1.81).youngs_modulus).round()
    array([127.,  50.])
    """
    gap = PadGap.of(pad, wedge_angle=wedge_angle, roll_angle=roll_angle)
    return layered_contact_kernel(
        gap, thickness=thickness, poisson_ratio=poisson_ratio, load=load, area=area, indentation=indentation
    )


@np.errstate(all="ignore")
def layered_contact_kernel(
    gap: PadGap,
    *,
    thickness: ArrayLike | None,
    poisson_ratio: ArrayLike,
    load: ArrayLike,
    area: ArrayLike | None = None,
    indentation: ArrayLike | None = None,
) -> LayeredContact:
    """Return `layered_contact` from gaps; on a half-space where no thickness is given."""
    load = as_float_array(load)
    contact = fast_contact(
        gap,
        reduced_modulus=1.0,
        thickness=thickness,
        poisson_ratio=poisson_ratio,
        area=area,
        indentation=indentation,
    )
    pressed = load.real > 0
    no_contact = np.int8(FLAGS.index("no_contact"))
    modulus = np.where(pressed, load, np.nan) / contact.load
    return LayeredContact(
        load=np.where(np.isnan(modulus), np.nan, load)[()],
        area=np.where(pressed, contact.area, np.nan)[()],
        indentation=np.where(pressed, contact.indentation, np.nan)[()],
        reduced_modulus=modulus,
        youngs_modulus=youngs_modulus(modulus, poisson_ratio),
        flag_code=np.where(pressed, contact.flag_code, no_contact)[()],
    )
