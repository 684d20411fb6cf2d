"""Uncertainty: propagation through a model, and pooling of estimates."""

from fingerpad.uncertainty.pool import Pooled, pool
from fingerpad.uncertainty.propagate import FirstOrder, first_order

__all__ = ["FirstOrder", "Pooled", "first_order", "pool"]
