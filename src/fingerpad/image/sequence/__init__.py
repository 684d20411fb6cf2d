"""Measure sequences of contact images against time and force."""
