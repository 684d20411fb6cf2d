"""Names of types that annotations use."""

from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

Array: TypeAlias = npt.NDArray[Any]
Pixels: TypeAlias = npt.NDArray[np.uint8]
Pair: TypeAlias = tuple[float, float]
Range: TypeAlias = tuple[float, float]
Rng: TypeAlias = np.random.Generator
