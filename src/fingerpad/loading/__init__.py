"""Loading curves: force, displacement and contact area, and what they say of the pad."""

from fingerpad.loading.curve import LoadingCurve, read_loading_curve
from fingerpad.loading.fit import ContactCompliance, fit_contact_compliance

__all__ = ["ContactCompliance", "LoadingCurve", "fit_contact_compliance", "read_loading_curve"]
