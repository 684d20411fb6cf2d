"""Mutants of the code."""
