"""Photographs of fingertips of known curvature: semi-axes, and the radius at the place of contact."""

from benchmarks.claims.finger_shapes import print_accuracy


def report(count: int = 8, seed: int = 75) -> None:
    """Print errors, stated uncertainty and coverage by shape."""
    print_accuracy("known curvature", count, seed)
