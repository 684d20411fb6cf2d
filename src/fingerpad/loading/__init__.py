"""Loading curves: force, displacement and contact area, fitted for radius and moduli of the pad."""

from fingerpad.loading.curve import (
    Cycle,
    Hysteresis,
    LoadingCurve,
    Segment,
    find_cycles,
    hysteresis,
    read_loading_curve,
)
from fingerpad.loading.fit import fit_contact_compliance, fit_loading_curve
from fingerpad.loading.law_fit import fit_adhesion
from fingerpad.loading.law_registry import ContactLaw, contact_law
from fingerpad.loading.laws import FittedForceModel, secant_modulus, sphere_ratio, tabor_parameter
from fingerpad.loading.layer import LayerThicknessFit, fit_layer_thickness
from fingerpad.loading.relaxation import PronyTerm, Relaxation, fit_relaxation
from fingerpad.loading.result import LawFit, LawUncertainty, LoadingFit, Secant

__all__ = [
    "ContactLaw",
    "Cycle",
    "FittedForceModel",
    "Hysteresis",
    "LawFit",
    "LawUncertainty",
    "LayerThicknessFit",
    "LoadingCurve",
    "LoadingFit",
    "PronyTerm",
    "Relaxation",
    "Secant",
    "Segment",
    "contact_law",
    "find_cycles",
    "fit_adhesion",
    "fit_contact_compliance",
    "fit_layer_thickness",
    "fit_loading_curve",
    "fit_relaxation",
    "hysteresis",
    "read_loading_curve",
    "secant_modulus",
    "sphere_ratio",
    "tabor_parameter",
]
