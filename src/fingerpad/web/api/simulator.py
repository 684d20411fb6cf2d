"""A finger of the last run for robot simulators: the numbers that they take, and the files."""

import io
import zipfile
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any, Final, TypeAlias

from fastapi import Query, Response
from pydantic import Field

from fingerpad._files import file_stem
from fingerpad.simulator import FiniteElements, SimulatorLaw, export_finger, simulator_law
from fingerpad.study.results.load import MeasuredPad, measured_pad
from fingerpad.study.results.result_set import result_set_stamp
from fingerpad.web.answers import Answer
from fingerpad.web.api.base import Opened, Params, saved_as, study_router
from fingerpad.web.api.results import require_results
from fingerpad.web.pictures import Cache
from fingerpad.web.study_session import StudySession

router = study_router()

_Simulated: TypeAlias = tuple[MeasuredPad, SimulatorLaw, FiniteElements | None]
_SIMULATED: Final[Cache[_Simulated]] = Cache(50, lambda _: 1)

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
def numbers(opened: Opened, params: Annotated[SimulatorParams, Query()]) -> SimulatorNumbers:
    """Return what simulators take for a finger of the last run."""
    pad, law, elements = _simulated(opened, params)
    table, newton, drake, mujoco = (
        law.pressure_by_depth(),
        law.newton_kh(),
        law.drake_modulus(),
        law.mujoco(params.mass_kg),
    )
    rows: list[tuple[str, str, Any]] = [
        ("Table of pressure by depth", f"{len(table.depth)} depths", table),
        ("Newton kh", f"{newton.kh:.4g} ± {newton.kh_std:.2g} N/m³", newton),
        ("Drake hydroelastic modulus", f"{drake.modulus:.4g} ± {drake.modulus_std:.2g} Pa", drake),
        ("MuJoCo solref", " ".join(f"{one:.6g}" for one in mujoco.solref), mujoco),
        ("MuJoCo solimp", " ".join(f"{one:.6g}" for one in mujoco.solimp), mujoco),
    ]
    notes = [f"MuJoCo is stable with time steps up to {1000 * mujoco.largest_time_step:.3g} ms."]
    if elements is not None:
        low, high = elements.load_ratio[[0, -1]]
        value = f"{low:.2f} to {high:.2f} of the law's load"
        rows.append(("Finite elements on the exported tissue", value, elements))
        notes.append(
            "Finite elements: the exported tissue is bent and has free sides, the law's layer has none."
        )
    return SimulatorNumbers.of(
        {
            "source": pad.source,
            "model": law.model,
            "targets": [
                {
                    "name": name,
                    "value": value,
                    "worst_relative_error": of.worst_relative_error,
                    "area_factor": of.area_factor,
                    "assumes": of.assumes,
                }
                for name, value, of in rows
            ],
            "notes": notes,
        }
    )


@router.get("/results/simulator/file", response_class=Response)
def export(opened: Opened, params: Annotated[SimulatorParams, Query()]) -> Response:
    """Return the files of `fingerpad simulator --export` as a ZIP."""
    pad, law, _ = _simulated(opened, params)
    packed = io.BytesIO()
    with TemporaryDirectory() as folder, zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in export_finger(law, Path(folder), effective_mass=params.mass_kg, source=f"{pad.source}."):
            archive.write(file, file.name)
    name = file_stem(f"{params.finger}_{params.wedge_angle_deg:g}deg_simulator")
    return Response(
        packed.getvalue(),
        media_type="application/zip",
        headers=saved_as(f"{name}.zip"),
    )


def _simulated(opened: StudySession, params: SimulatorParams) -> _Simulated:
    """Return what no mass changes: the finger, its law, and finite elements where there is bone."""
    require_results(opened)
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
        return pad, law, None if law.pad.tissue.is_deep else law.finite_elements()

    return _SIMULATED.get((opened.out, result_set_stamp(opened.out), asked), simulated)
