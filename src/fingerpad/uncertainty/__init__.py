"""Uncertainty: the pad as a model of arrays, propagation through it, and pooling of estimates."""

from fingerpad.uncertainty.pad import PAD_INPUTS, PAD_OUTPUTS, SHARED_INPUTS, pad_model
from fingerpad.uncertainty.pool import Pooled, pool
from fingerpad.uncertainty.propagate import Propagated, propagate

__all__ = [
    "PAD_INPUTS",
    "PAD_OUTPUTS",
    "SHARED_INPUTS",
    "Pooled",
    "Propagated",
    "pad_model",
    "pool",
    "propagate",
]
