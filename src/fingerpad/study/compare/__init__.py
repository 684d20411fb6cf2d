"""Finished studies side by side: each finger's values, and means with the scatter between people."""

from fingerpad.study.compare.comparison import Comparison, compare_studies, write_comparison
from fingerpad.study.compare.finished import FinishedStudy, read_finished
from fingerpad.study.compare.means import Mean, PersonMean
from fingerpad.study.compare.values import QUANTITIES, Kind, Person, Value, Verdict

__all__ = [
    "QUANTITIES",
    "Comparison",
    "FinishedStudy",
    "Kind",
    "Mean",
    "Person",
    "PersonMean",
    "Value",
    "Verdict",
    "compare_studies",
    "read_finished",
    "write_comparison",
]
