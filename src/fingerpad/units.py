"""Conversion of units."""

from typing import Final

KPA_PER_MPA: Final = 1000.0
MM_PER_INCH: Final = 25.4

_LENGTHS: Final = {"mm": 1.0, "um": 1e-3, "µm": 1e-3, "cm": 10.0, "m": 1e3}
_GRAM_FORCE_N: Final = 9.80665e-3
# Factor that turns a value in the unit into the library's; grams of a force are grams-force.
FACTORS: Final = {
    "force": {"N": 1.0, "mN": 1e-3, "kN": 1e3, "gf": _GRAM_FORCE_N, "g": _GRAM_FORCE_N, "kgf": 9.80665},
    "displacement": _LENGTHS,
    "area": {"mm2": 1.0, "cm2": 100.0, "m2": 1e6},
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0},
    "trigger": {"V": 1.0, "mV": 1e-3},
    "x": _LENGTHS,
    "y": _LENGTHS,
    "row": {"px": 1.0},
    "column": {"px": 1.0},
}
