"""Uncertainty: the pad as a model of arrays, three ways of propagation through it, budgets, and pooling."""

from fingerpad.uncertainty.budget import SobolIndices, sobol_indices, variance_shares
from fingerpad.uncertainty.correlated import correlated_values, mean_and_covariance
from fingerpad.uncertainty.covariance import covariance_of, covariance_root
from fingerpad.uncertainty.monte_carlo import (
    MonteCarloResult,
    Validation,
    run_monte_carlo,
    validate_linear_approximation,
)
from fingerpad.uncertainty.pad import PAD_INPUTS, PAD_OUTPUTS, PAD_SOURCES, pad_model
from fingerpad.uncertainty.placement import PLACEMENT_INPUTS, PLACEMENT_OUTPUTS, placement_model
from fingerpad.uncertainty.pool import (
    Pooled,
    RandomEffects,
    SharedErrors,
    VarianceComponents,
    pool,
    pool_random_effects,
    variance_components,
)
from fingerpad.uncertainty.propagate import Model, Propagated, propagate

__all__ = [
    "PAD_INPUTS",
    "PAD_OUTPUTS",
    "PAD_SOURCES",
    "PLACEMENT_INPUTS",
    "PLACEMENT_OUTPUTS",
    "Model",
    "MonteCarloResult",
    "Pooled",
    "Propagated",
    "RandomEffects",
    "SharedErrors",
    "SobolIndices",
    "Validation",
    "VarianceComponents",
    "correlated_values",
    "covariance_of",
    "covariance_root",
    "mean_and_covariance",
    "pad_model",
    "placement_model",
    "pool",
    "pool_random_effects",
    "propagate",
    "run_monte_carlo",
    "sobol_indices",
    "validate_linear_approximation",
    "variance_components",
    "variance_shares",
]
