"""Loading curves: force, displacement and contact area, fitted for radius and moduli of the pad."""

from fingerpad.loading.compliance import ContactCompliance, fit_contact_compliance
from fingerpad.loading.consistency import ShapeCheck, shape_check
from fingerpad.loading.contact_point import ESTIMATORS
from fingerpad.loading.curve import LoadingCurve, read_loading_curve
from fingerpad.loading.fit import LoadingFit, contact_points, fit_loading_curve
from fingerpad.loading.laws import (
    FittedForceModel,
    area_from_load,
    indentation_from_load,
    load_from_indentation,
    local_area_exponent,
    secant_modulus,
)
from fingerpad.loading.layer_result import LayerThicknessFit
from fingerpad.loading.layer_thickness import fit_layer_thickness
from fingerpad.loading.least_squares import LeastSquaresFit, effective_count, fit_least_squares
from fingerpad.loading.modulus_range import Secant
from fingerpad.loading.relaxation import (
    PronyTerm,
    Relaxation,
    fit_relaxation,
)
from fingerpad.loading.segments import Cycle, Hysteresis, Segment, find_cycles, hysteresis

__all__ = [
    "ESTIMATORS",
    "ContactCompliance",
    "Cycle",
    "FittedForceModel",
    "Hysteresis",
    "LayerThicknessFit",
    "LeastSquaresFit",
    "LoadingCurve",
    "LoadingFit",
    "PronyTerm",
    "Relaxation",
    "Secant",
    "Segment",
    "ShapeCheck",
    "area_from_load",
    "contact_points",
    "effective_count",
    "find_cycles",
    "fit_contact_compliance",
    "fit_layer_thickness",
    "fit_least_squares",
    "fit_loading_curve",
    "fit_relaxation",
    "hysteresis",
    "indentation_from_load",
    "load_from_indentation",
    "local_area_exponent",
    "read_loading_curve",
    "secant_modulus",
    "shape_check",
]
