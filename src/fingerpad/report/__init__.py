"""The report of a study: one self-contained HTML file, and its figures as files."""

from fingerpad.report.write import write_report

__all__ = ["write_report"]
