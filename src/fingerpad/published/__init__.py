"""The numbers printed by Dzidek et al. (2017), and an audit of them."""

from fingerpad.published.audit import AuditItem, audit
from fingerpad.published.dzidek2017 import dzidek2017
from fingerpad.published.tissue_thickness import TissueThickness, fit_tissue_thickness, layer_items

__all__ = ["AuditItem", "TissueThickness", "audit", "dzidek2017", "fit_tissue_thickness", "layer_items"]
