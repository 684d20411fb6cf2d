"""Number of threads of linear algebra: one, as the matrices are small."""

from typing import Final

ONE_THREAD: Final = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS"), "1"
)
"""Settings of the environment for one thread; they are read when NumPy is loaded."""
