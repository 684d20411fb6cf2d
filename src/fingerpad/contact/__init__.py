"""The finger pad against a platen: elliptic integrals, Hertz contact, equivalent spheres."""

from fingerpad.contact.elliptic import (
    complete_integrals,
    curvature_ratio,
    indentation_factor,
    size_factor,
    solve_contact_ellipse,
)
from fingerpad.contact.equivalent import (
    equivalent_radius_from_area,
    equivalent_radius_from_compliance,
    equivalent_radius_from_indentation,
    equivalent_radius_ratios,
)
from fingerpad.contact.halfspace import HalfSpaceContact, ellipsoid_gap
from fingerpad.contact.hertz import (
    HertzContact,
    HertzGeometry,
    hertz_contact,
    reduced_modulus,
    youngs_modulus,
)
from fingerpad.contact.pad import PadContact, pad_contact

__all__ = [
    "HalfSpaceContact",
    "HertzContact",
    "HertzGeometry",
    "PadContact",
    "complete_integrals",
    "curvature_ratio",
    "ellipsoid_gap",
    "equivalent_radius_from_area",
    "equivalent_radius_from_compliance",
    "equivalent_radius_from_indentation",
    "equivalent_radius_ratios",
    "hertz_contact",
    "indentation_factor",
    "pad_contact",
    "reduced_modulus",
    "size_factor",
    "solve_contact_ellipse",
    "youngs_modulus",
]
