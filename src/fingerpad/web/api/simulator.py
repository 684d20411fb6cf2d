"""A finger of the last run for robot simulators: the numbers that they take, and the files."""

import io
import zipfile
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Final, TypeAlias

from fastapi import Response
from pydantic import Field

from fingerpad._files import file_stem
from fingerpad._words import capitalized
from fingerpad.simulator import FiniteElements, SimulatorLaw, elements_or_reason, export_finger, simulator_law
from fingerpad.study.results.load import MeasuredPad, measured_pad
from fingerpad.study.results.result_set import result_set_stamp
from fingerpad.web.answers import Answer
from fingerpad.web.api.base import Opened, Params, Query, router, saved_as
from fingerpad.web.pictures import Cache
from fingerpad.web.study_session import StudySession

# The finger, its law, and the finite elements of its tissue or why there are none.
_Simulated: TypeAlias = tuple[MeasuredPad, SimulatorLaw, FiniteElements | None, str]
_SIMULATED: Final[Cache[_Simulated]] = Cache(50)

Positive = Annotated[float, Field(gt=0, le=1e6)]


class SimulatorParams(Params):
    """A finger at an angle, the loads that matter, and MuJoCo's effective mass of the contact."""

    finger: Annotated[str, Field(min_length=1, max_length=300)]
    wedge_angle_deg: float
    lowest_load_N: Positive = 0.2  # noqa: N815
    highest_load_N: Positive = 3.0  # noqa: N815
    thickness_mm: Positive | None = None
    mass_kg: Positive = 0.1


class SimulatorTarget(Answer):
    """What one simulator takes, the largest relative error of its load, and the factor of its area."""

    name: str
    value: str
    worst_relative_error: float
    area_factor: float | None
    assumes: str


class SimulatorNumbers(Answer):
    """All that simulators take for a finger; `notes` say what to mind."""

    source: str
    model: str
    targets: list[SimulatorTarget]
    notes: list[str]


@router.get("/results/simulator")
def numbers(opened: Opened, params: Query[SimulatorParams]) -> SimulatorNumbers:
    """Return what simulators take for a finger of the last run."""
    pad, law, elements, reason = _simulated(opened, params)
    table, newton, drake = law.pressure_by_depth(), law.newton_kh(), law.drake_modulus()
    mujoco = law.mujoco(params.mass_kg)
    target = SimulatorTarget.of
    targets = [
        target(table, name="Table of pressure by depth", value=f"{len(table.depth)} depths"),
        target(newton, name="Newton kh", value=newton.words),
        target(drake, name="Drake hydroelastic modulus", value=drake.words),
        target(mujoco, name="MuJoCo solref", value=" ".join(f"{one:.6g}" for one in mujoco.solref)),
        target(mujoco, name="MuJoCo solimp", value=" ".join(f"{one:.6g}" for one in mujoco.solimp)),
    ]
    notes = [f"MuJoCo is stable with time steps up to {1000 * mujoco.largest_time_step:.3g} ms."]
    if elements is not None:
        low, high = elements.load_ratio[[0, -1]]
        value = f"{low:.2f} to {high:.2f} of the law's load"
        targets.append(target(elements, name="Finite elements on the exported tissue", value=value))
        reason = "Finite elements: the exported tissue is bent and has free sides, the law's layer has none."
    if reason:
        notes.append(f"{capitalized(reason.rstrip('.'))}.")
    return SimulatorNumbers(source=pad.source, model=law.model, targets=targets, notes=notes)


@router.get("/results/simulator/file", response_class=Response)
def export(opened: Opened, params: Query[SimulatorParams]) -> Response:
    """Return the files of `fingerpad simulator --export` as a ZIP."""
    pad, law, *_ = _simulated(opened, params)
    packed = io.BytesIO()
    with TemporaryDirectory() as folder, zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in export_finger(law, Path(folder), effective_mass=params.mass_kg, source=f"{pad.source}."):
            archive.write(file, file.name)
    name = file_stem(f"{params.finger}_{params.wedge_angle_deg:g}deg_simulator")
    return Response(packed.getvalue(), media_type="application/zip", headers=saved_as(f"{name}.zip"))


def _simulated(opened: StudySession, params: SimulatorParams) -> _Simulated:
    """Return what no mass changes."""
    opened.require_results()
    asked = params.model_copy(update={"mass_kg": 0.0})

    def simulated() -> _Simulated:
        pad = measured_pad(
            opened.out,
            finger=params.finger,
            wedge_deg=params.wedge_angle_deg,
            thickness_mm=params.thickness_mm,
        )
        loads = params.lowest_load_N, params.highest_load_N
        law = simulator_law(pad.placement, pad.tissue, loads, stds=pad.stds)
        return pad, law, *elements_or_reason(law)

    return _SIMULATED.get((opened.out, result_set_stamp(opened.out), asked), simulated)
