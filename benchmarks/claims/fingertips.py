"""Photographs of fingertips of known curvature: bias, stated uncertainty and coverage of the semi-axes."""

from benchmarks.claims.finger_shapes import measured, print_semi_axes


def report(count: int = 8, seed: int = 75) -> None:
    """Print errors, stated uncertainty and coverage by shape."""
    print_semi_axes(measured("known curvature", count, seed))
