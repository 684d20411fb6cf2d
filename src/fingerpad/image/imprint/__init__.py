"""Measure contact images."""
