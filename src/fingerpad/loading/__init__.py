"""Loading curves: force, displacement and contact area, fitted for radius and moduli of the pad."""

from fingerpad.loading.adhesion import tabor_parameter
from fingerpad.loading.areas import fit_contact_compliance, sphere_ratio
from fingerpad.loading.curve import LoadingCurve, read_loading_curve
from fingerpad.loading.cycles import Cycle, Hysteresis, Segment, find_cycles, hysteresis
from fingerpad.loading.fit import fit_loading_curve
from fingerpad.loading.law_fit import LawFit
from fingerpad.loading.laws import (
    ContactLaw,
    FittedForceModel,
    area_from_load,
    contact_law,
    indentation_from_load,
    load_from_indentation,
    local_area_exponent,
    secant_modulus,
)
from fingerpad.loading.layer import LayerThicknessFit, fit_layer_thickness
from fingerpad.loading.relaxation import PronyTerm, Relaxation, fit_relaxation
from fingerpad.loading.result import LawUncertainty, LoadingFit, Secant

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
    "area_from_load",
    "contact_law",
    "find_cycles",
    "fit_contact_compliance",
    "fit_layer_thickness",
    "fit_loading_curve",
    "fit_relaxation",
    "hysteresis",
    "indentation_from_load",
    "load_from_indentation",
    "local_area_exponent",
    "read_loading_curve",
    "secant_modulus",
    "sphere_ratio",
    "tabor_parameter",
]
