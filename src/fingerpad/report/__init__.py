"""The report of a study: one HTML file that needs nothing else, and its figures as files."""

from fingerpad.report.write import write_report

__all__ = ["write_report"]
