"""How many threads linear algebra takes: matrices of a finger are small, and threads would only wait."""

from typing import Final

SETTINGS: Final = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
"""Settings of the environment that are read when NumPy is loaded."""
