"""The finger pad in contact: Hertz theory, fast laws of the whole pad on a layer, and a solver."""

from fingerpad.contact.contact import Contact, Tissue
from fingerpad.contact.elliptic import (
    complete_integrals,
    indentation_factor,
    size_factor,
    solve_contact_ellipse,
)
from fingerpad.contact.fast_laws import fast_contact, youngs_modulus
from fingerpad.contact.field import ContactField, ContactSection
from fingerpad.contact.hertz import (
    equivalent_radius_from_area,
    equivalent_radius_from_compliance,
    equivalent_radius_from_indentation,
    hertz_contact,
)
from fingerpad.contact.solved_stress import SolvedStress
from fingerpad.contact.solver import SolvedContact, solve_contact, solve_gap
from fingerpad.contact.stress import StressField, hertz_stress

__all__ = [
    "Contact",
    "ContactField",
    "ContactSection",
    "SolvedContact",
    "SolvedStress",
    "StressField",
    "Tissue",
    "complete_integrals",
    "equivalent_radius_from_area",
    "equivalent_radius_from_compliance",
    "equivalent_radius_from_indentation",
    "fast_contact",
    "hertz_contact",
    "hertz_stress",
    "indentation_factor",
    "size_factor",
    "solve_contact",
    "solve_contact_ellipse",
    "solve_gap",
    "youngs_modulus",
]
