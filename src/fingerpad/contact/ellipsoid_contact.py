"""The whole ellipsoid against a plate, sphere or cylinder, on deep tissue or on a layer over bone.

Hertz theory replaces the gap by its paraboloid and the pad by an elastic half-space. Neither holds on a
finger at a few newtons: the contact is a third to a half of the radii of curvature, and the tissue is 4 to
12 mm deep.
"""

import math
from dataclasses import dataclass
from functools import partial
from typing import Self

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad._display import Displayed
from fingerpad.contact.gap import Counterface, ellipsoid_gap, relative_curvature_tensor
from fingerpad.contact.hertz import HertzContact, HertzGeometry
from fingerpad.contact.influence import ElasticBody
from fingerpad.contact.solver import ContactSolution, solve_contact
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Ellipsoid, Placement, principal_curvatures


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class EllipsoidContact(Displayed):
    """The contact of a whole ellipsoid, and that of Hertz theory at the same load.

    Attributes
    ----------
    solution : ContactSolution
        The solved contact. Its plane's first coordinate points along the finger, its second across.
    hertz : HertzContact
        Hertz theory for the same pad, placement, counterface, load and modulus, on a half-space.

    Examples
    --------
    On 8 mm of tissue, Hertz theory reads a higher modulus from the indentation than from the area:

    >>> import numpy as np
    >>> pad = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
    >>> contact = EllipsoidContact.of(
    ...     pad, wedge_angle=np.radians(30), thickness=8.0, load=2.0, reduced_modulus=0.1, points=64
    ... )
    >>> print(f"{contact.solution.area:.1f} mm², Hertz {contact.hertz.area:.1f} mm²")
    92.5 mm², Hertz 109.0 mm²
    >>> print(f"{contact.modulus_disagreement:.2f}")
    0.56
    """

    solution: ContactSolution
    hertz: HertzContact

    @property
    def modulus_disagreement(self) -> float:
        r"""E* that Hertz theory would read from the area, over that from the indentation.

        :math:`(A_H/A)^{3/2} / (\xi_H/\xi)^{3/2}`, A_H and ξ_H being Hertz theory's: one where it holds.
        """
        area = self.solution.area / float(self.hertz.area)
        indentation = self.solution.indentation / float(self.hertz.indentation)
        return float((indentation / area) ** 1.5)

    @classmethod
    def of(
        cls,
        pad: Ellipsoid,
        *,
        wedge_angle: float,
        roll_angle: float = 0.0,
        counterface: Counterface | None = None,
        reduced_modulus: float,
        thickness: float | None = None,
        poisson_ratio: float = 0.5,
        load: float | None = None,
        indentation: float | None = None,
        area: float | None = None,
        points: int = 256,
    ) -> Self:
        """Press a pad against a rigid body.

        Parameters
        ----------
        pad : Ellipsoid
            One pad.
        wedge_angle, roll_angle : float
            Placement, radians.
        counterface : Counterface, optional
            The rigid body; a plate where none is given.
        reduced_modulus : float
            E* of the tissue.
        thickness : float, optional
            Of a layer of tissue bonded to a rigid base; a half-space where none is given.
        poisson_ratio : float
            ν of the tissue, which matters to a layer alone.
        load, indentation, area : float
            Exactly one of normal force W, mutual approach ξ and contact area.
        points : int
            Grid cells along each side.

        Returns
        -------
        EllipsoidContact
            The solved contact beside Hertz theory.

        Raises
        ------
        GeometryError
            As `solve_contact`: impossible values, or a contact beyond the pad's silhouette or the layer.
        ConvergenceError
            If the pressure is not found.

        Examples
        --------
        The pad of Dzidek et al. (2017) at 2 N. Curved away from the plate, it touches less than its
        paraboloid; on 8 mm of tissue over bone it is pressed in less, too.

        >>> import numpy as np
        >>> pad = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
        >>> for thickness in (None, 8.0):
        ...     contact = EllipsoidContact.of(
        ...         pad,
        ...         wedge_angle=np.radians(30),
        ...         thickness=thickness,
        ...         load=2.0,
        ...         reduced_modulus=0.1365,
        ...         points=64,
        ...     )
        ...     area = contact.solution.area / float(contact.hertz.area)
        ...     indentation = contact.solution.indentation / float(contact.hertz.indentation)
        ...     print(f"area {area - 1:+.0%}, indentation {indentation - 1:+.0%}")
        area -5%, indentation +1%
        area -13%, indentation -40%
        """
        rigid = Counterface.plate() if counterface is None else counterface
        depth = math.inf if thickness is None else thickness
        body = ElasticBody(reduced_modulus=reduced_modulus, thickness=depth, poisson_ratio=poisson_ratio)
        normal = normal_of_one_pad(pad, wedge_angle, roll_angle)
        geometry, angle = hertz_geometry_of_pad(pad, normal, rigid)
        guess = hertz_contact_at(geometry, reduced_modulus, load, indentation, area)
        semi_axes = float(guess.semi_major), float(guess.semi_minor)
        solution = solve_contact(
            partial(ellipsoid_gap, pad, normal, counterface=rigid),
            body,
            half_widths=semi_axes[::-1] if geometry.long_axis == 1 else semi_axes,
            angle=angle,
            load=load,
            indentation=indentation,
            area=area,
            points=points,
        )
        return cls(
            solution=solution,
            hertz=geometry.under_load(solution.load, reduced_modulus=reduced_modulus),
        )


def normal_of_one_pad(pad: Ellipsoid, wedge_angle: float, roll_angle: float) -> FloatArray:
    """Return the outward normal where one pad touches, shape (3,).

    Raises
    ------
    GeometryError
        If the angles are those of no placement, or of several, or there are several pads.
    """
    placement = Placement(pad, wedge_angle=wedge_angle, roll_angle=roll_angle)
    if placement.point.shape != (3,):
        raise GeometryError(
            f"one pad in one placement is solved at a time, found shape {placement.point.shape[:-1]}: "
            "loop over them, or take layered_contact, which broadcasts"
        )
    return placement.normal


def hertz_geometry_of_pad(
    pad: Ellipsoid, normal: FloatArray, counterface: Counterface
) -> tuple[HertzGeometry, float]:
    """Return the paraboloid of the gap, and the angle from the finger to its first principal direction."""
    tensor = relative_curvature_tensor(pad, normal, counterface)
    curvatures, angle = principal_curvatures(tensor[0, 0], tensor[1, 1], tensor[0, 1])
    return HertzGeometry(*(1 / curvatures)), float(angle)


def hertz_contact_at(
    geometry: HertzGeometry,
    reduced_modulus: float,
    load: float | None,
    indentation: float | None,
    area: float | None,
) -> HertzContact:
    """Return the contact under a load, at an indentation or of an area, whichever is given."""
    if load is not None:
        return geometry.under_load(load, reduced_modulus=reduced_modulus)
    if indentation is not None:
        return geometry.at_indentation(indentation, reduced_modulus=reduced_modulus)
    return geometry.at_area(np.nan if area is None else area, reduced_modulus=reduced_modulus)
