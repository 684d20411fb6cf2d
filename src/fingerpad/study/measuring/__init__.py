"""Measuring what a study shows: photographs, contact images, sequences."""
