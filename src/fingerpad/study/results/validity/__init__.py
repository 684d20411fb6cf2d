"""Whether Hertz theory holds for a finger at an angle, and what the model adds to the uncertainty."""

from fingerpad.study.results.validity.model_checks import HEADLINES, INDENTATION, MODULUS, RADIUS
from fingerpad.study.results.validity.verdict import Headline, Validity, validity_of, with_verdicts

__all__ = [
    "HEADLINES",
    "INDENTATION",
    "MODULUS",
    "RADIUS",
    "Headline",
    "Validity",
    "validity_of",
    "with_verdicts",
]
