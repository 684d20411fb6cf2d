"""The finger pad against a platen: Hertz contact, equivalent spheres, and the whole pad on a layer."""

from fingerpad.contact.contact_stress import contact_displacement, contact_stress
from fingerpad.contact.ellipsoid_contact import EllipsoidContact
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
from fingerpad.contact.fast_laws import FastContact, FastEllipse, fast_contact, fast_ellipse
from fingerpad.contact.field import ContactField, ContactSection
from fingerpad.contact.gap import Counterface, ellipsoid_gap
from fingerpad.contact.hertz import (
    HertzContact,
    HertzGeometry,
    hertz_contact,
    reduced_modulus,
    youngs_modulus,
)
from fingerpad.contact.hertz_pressure import HertzPressure, hertz_displacement
from fingerpad.contact.influence import ElasticBody, layer_compliance_ratio
from fingerpad.contact.layered import LayeredContact, layered_contact
from fingerpad.contact.pad import PadContact, pad_contact
from fingerpad.contact.pad_gap import PadGap
from fingerpad.contact.solver import ContactSolution, solve_contact
from fingerpad.contact.stress import StressField, hertz_stress

__all__ = [
    "ContactField",
    "ContactSection",
    "ContactSolution",
    "Counterface",
    "ElasticBody",
    "EllipsoidContact",
    "FastContact",
    "FastEllipse",
    "HertzContact",
    "HertzGeometry",
    "HertzPressure",
    "LayeredContact",
    "PadContact",
    "PadGap",
    "StressField",
    "complete_integrals",
    "contact_displacement",
    "contact_stress",
    "curvature_ratio",
    "ellipsoid_gap",
    "equivalent_radius_from_area",
    "equivalent_radius_from_compliance",
    "equivalent_radius_from_indentation",
    "equivalent_radius_ratios",
    "fast_contact",
    "fast_ellipse",
    "hertz_contact",
    "hertz_displacement",
    "hertz_stress",
    "indentation_factor",
    "layer_compliance_ratio",
    "layered_contact",
    "pad_contact",
    "reduced_modulus",
    "size_factor",
    "solve_contact",
    "solve_contact_ellipse",
    "youngs_modulus",
]
