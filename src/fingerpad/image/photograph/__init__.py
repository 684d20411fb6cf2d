"""Measure photographs of a finger's faces, and their outlines."""
