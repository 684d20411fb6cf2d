"""A measured finger pad in the numbers and files that robot simulators take."""

from fingerpad.simulator.export import export_finger
from fingerpad.simulator.law import SimulatorLaw, elements_or_reason, simulator_law
from fingerpad.simulator.mesh import TetrahedralMesh
from fingerpad.simulator.targets import (
    DrakeModulus,
    FiniteElements,
    MujocoContact,
    NewtonStiffness,
    PressureByDepth,
)

__all__ = [
    "DrakeModulus",
    "FiniteElements",
    "MujocoContact",
    "NewtonStiffness",
    "PressureByDepth",
    "SimulatorLaw",
    "TetrahedralMesh",
    "elements_or_reason",
    "export_finger",
    "simulator_law",
]
