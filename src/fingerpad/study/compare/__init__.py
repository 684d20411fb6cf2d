"""Finished studies side by side: each finger's values, and means with the scatter between people."""

from fingerpad.study.compare.comparison import Comparison, Mean, compare_studies, write_comparison
from fingerpad.study.compare.values import QUANTITIES, FinishedStudy, Person, ValidityVerdict, Value

__all__ = [
    "QUANTITIES",
    "Comparison",
    "FinishedStudy",
    "Mean",
    "Person",
    "ValidityVerdict",
    "Value",
    "compare_studies",
    "write_comparison",
]
