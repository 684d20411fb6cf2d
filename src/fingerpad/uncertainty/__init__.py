"""Uncertainty: models of named quantities, propagation through them, budgets, and pooling."""

from fingerpad.uncertainty.models import (
    LAYER_OUTPUTS,
    LAYER_SOURCES,
    PAD_SOURCES,
    layer_flag,
    layer_model,
    pad_model,
    pad_uncertainty,
    placement_model,
)
from fingerpad.uncertainty.monte_carlo import (
    MonteCarloResult,
    SobolIndices,
    Validation,
    run_monte_carlo,
    sobol_indices,
    validate_linear_approximation,
)
from fingerpad.uncertainty.pool import (
    Pooled,
    RandomEffects,
    SharedErrors,
    pool,
    pool_random_effects,
    proportional_stds,
)
from fingerpad.uncertainty.propagate import Propagated, propagate
from fingerpad.uncertainty.quantities import (
    Inputs,
    Model,
    Outputs,
    correlated_values,
    covariance_of,
    covariance_root,
    inputs_from_ufloats,
)
from fingerpad.uncertainty.scatter import (
    Agreement,
    NestedScatter,
    ScatterComponent,
    agreement,
    nested_scatter,
)

__all__ = [
    "LAYER_OUTPUTS",
    "LAYER_SOURCES",
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
    "agreement",
    "correlated_values",
    "covariance_of",
    "covariance_root",
    "inputs_from_ufloats",
    "layer_flag",
    "layer_model",
    "nested_scatter",
    "pad_model",
    "pad_uncertainty",
    "placement_model",
    "pool",
    "pool_random_effects",
    "propagate",
    "proportional_stds",
    "run_monte_carlo",
    "sobol_indices",
    "validate_linear_approximation",
]
