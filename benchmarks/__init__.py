"""Measurements of accuracy and speed, run with ``make bench``."""
