"""Uncertainty: the pad as a model of arrays, three ways of propagation through it, budgets, and pooling."""

from fingerpad.uncertainty.budget import SobolIndices, sobol_indices, variance_shares
from fingerpad.uncertainty.correlated import correlated_values, mean_and_covariance
from fingerpad.uncertainty.covariance import covariance_of, factor_of
from fingerpad.uncertainty.monte_carlo import Simulated, Validation, simulate, validate_first_order
from fingerpad.uncertainty.pad import PAD_INPUTS, PAD_OUTPUTS, PAD_SOURCES, pad_model
from fingerpad.uncertainty.placement import PLACEMENT_INPUTS, PLACEMENT_OUTPUTS, placement_model
from fingerpad.uncertainty.pool import (
    Pooled,
    RandomEffects,
    Scatter,
    SharedParts,
    pool,
    pool_random_effects,
    scatter_of,
)
from fingerpad.uncertainty.propagate import Model, Propagated, propagate

__all__ = [
    "PAD_INPUTS",
    "PAD_OUTPUTS",
    "PAD_SOURCES",
    "PLACEMENT_INPUTS",
    "PLACEMENT_OUTPUTS",
    "Model",
    "Pooled",
    "Propagated",
    "RandomEffects",
    "Scatter",
    "SharedParts",
    "Simulated",
    "SobolIndices",
    "Validation",
    "correlated_values",
    "covariance_of",
    "factor_of",
    "mean_and_covariance",
    "pad_model",
    "placement_model",
    "pool",
    "pool_random_effects",
    "propagate",
    "scatter_of",
    "simulate",
    "sobol_indices",
    "validate_first_order",
    "variance_shares",
]
