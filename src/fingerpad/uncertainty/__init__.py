"""Uncertainty: models of named quantities, propagation through them, budgets, and pooling."""

from fingerpad.uncertainty.agreement import Agreement, agreement
from fingerpad.uncertainty.correlated import correlated_values, inputs_from_ufloats
from fingerpad.uncertainty.covariance import covariance_of, covariance_root
from fingerpad.uncertainty.inputs import Inputs, Model
from fingerpad.uncertainty.layer import (
    LAYER_OUTPUTS,
    LAYER_SOURCES,
    indentation_model,
    layer_flag,
    layer_model,
    with_thickness,
)
from fingerpad.uncertainty.monte_carlo import (
    MonteCarloResult,
    Validation,
    run_monte_carlo,
    validate_linear_approximation,
)
from fingerpad.uncertainty.outputs import Outputs
from fingerpad.uncertainty.pad import PAD_OUTPUTS, PAD_SOURCES, pad_inputs, pad_model, pad_uncertainty
from fingerpad.uncertainty.pad_shape import ELLIPSOID_STD, HIDDEN_STD, radius_deviation
from fingerpad.uncertainty.placement import placement_model
from fingerpad.uncertainty.pool import (
    Pooled,
    RandomEffects,
    SharedErrors,
    pool,
    pool_random_effects,
    proportional_stds,
)
from fingerpad.uncertainty.propagate import Propagated, propagate
from fingerpad.uncertainty.repeatability import (
    NestedScatter,
    ScatterComponent,
    nested_scatter,
    within_covariance,
)
from fingerpad.uncertainty.sobol import SobolIndices, sobol_indices
from fingerpad.uncertainty.variance_components import VarianceComponents, variance_components

__all__ = [
    "ELLIPSOID_STD",
    "HIDDEN_STD",
    "LAYER_OUTPUTS",
    "LAYER_SOURCES",
    "PAD_OUTPUTS",
    "PAD_SOURCES",
    "Agreement",
    "Inputs",
    "Model",
    "MonteCarloResult",
    "NestedScatter",
    "Outputs",
    "Pooled",
    "Propagated",
    "RandomEffects",
    "ScatterComponent",
    "SharedErrors",
    "SobolIndices",
    "Validation",
    "VarianceComponents",
    "agreement",
    "correlated_values",
    "covariance_of",
    "covariance_root",
    "indentation_model",
    "inputs_from_ufloats",
    "layer_flag",
    "layer_model",
    "nested_scatter",
    "pad_inputs",
    "pad_model",
    "pad_uncertainty",
    "placement_model",
    "pool",
    "pool_random_effects",
    "propagate",
    "proportional_stds",
    "radius_deviation",
    "run_monte_carlo",
    "sobol_indices",
    "validate_linear_approximation",
    "variance_components",
    "with_thickness",
    "within_covariance",
]
