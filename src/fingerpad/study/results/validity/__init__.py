"""Whether Hertz theory holds for a finger at an angle, and what the model adds to the uncertainty."""

from fingerpad.study.results.validity.place import INDENTATION, MODULUS, RADIUS
from fingerpad.study.results.validity.verdict import Validity, fill_columns, validity_of

__all__ = [
    "INDENTATION",
    "MODULUS",
    "RADIUS",
    "Validity",
    "fill_columns",
    "validity_of",
]
