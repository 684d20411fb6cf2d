"""The pad in three dimensions: point of contact, curvature, wedge and platen."""

from typing import Annotated, Any, Final, Self

import numpy as np
from pydantic import Field, model_validator

from fingerpad._arrays import FloatArray
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.image import SEMI_AXES
from fingerpad.study.manifest.models import Length, RollAngle, WedgeAngle
from fingerpad.uncertainty import Inputs, placement_model, propagate
from fingerpad.web.answers import Answer, Axis, Point3D, Quantity, RequestError, semi_axes
from fingerpad.web.api.base import Body, Opened, Params, router
from fingerpad.web.api.photographs import measured_finger
from fingerpad.web.study_session import StudySession

# Parametric angles u of the midline that are marked.
_MARKED_DEG: Final = (0, 30, 45, 60, 90)


class PadGeometry(Answer):
    """A pad on its wedge: semi-axes, place of contact, curvature, and what to draw.

    `points_mm` are those of the midline at parametric angles u in degrees. Each edge of the wedge is that of
    two faces, which go along it in opposite directions.
    """

    semi_axes_mm: dict[Axis, Quantity]
    u_deg: Quantity
    v_deg: Quantity
    in_plane_radius_mm: Quantity
    transverse_radius_mm: Quantity
    mean_curvature_radius_mm: Quantity
    geometric_mean_radius_mm: Quantity
    contact_point_mm: Point3D
    normal: Point3D
    principal_directions: tuple[Point3D, Point3D]
    mesh_mm: list[list[Point3D]]
    lines_mm: dict[str, list[Point3D]]
    platen_mm: list[Point3D]
    wedge_mm: list[Point3D]
    wedge_faces: list[list[int]]
    points_mm: dict[str, Point3D]


class GeometryParams(Params):
    """A pad on a wedge, by its finger or its semi-axes, and the resolution of the drawing."""

    finger: str | None = None
    semi_axes_mm: tuple[Length, Length, Length] | None = None
    wedge_angle_deg: WedgeAngle = 30.0
    roll_angle_deg: RollAngle = 0.0
    detail: Annotated[int, Field(ge=4, le=120)] = 32

    @model_validator(mode="after")
    def _one_pad(self) -> Self:
        if (self.finger is None) == (self.semi_axes_mm is None):
            raise ValueError("give finger, or semi_axes_mm: palmar, distal and radial-ulnar")
        return self


@router.post("/geometry")
def geometry(opened: Opened, params: Body[GeometryParams]) -> PadGeometry:
    """Return the point of contact, the curvature there, and the drawing."""
    axes, covariance, angle_stds = _pad(opened, params)
    pad, angles = Ellipsoid(*axes), np.radians([params.wedge_angle_deg, params.roll_angle_deg])
    placement = Placement(pad, wedge_angle=angles[0], roll_angle=angles[1])
    turn = np.linspace(0, 2 * np.pi, 2 * params.detail + 1)
    height = np.linspace(0, np.pi, params.detail + 1)
    return PadGeometry.of(
        semi_axes_mm=semi_axes(axes, None if covariance is None else np.sqrt(covariance.diagonal())),
        **_placed(axes, covariance, angles, angle_stds),
        v_deg=np.degrees(placement.v),
        contact_point_mm=placement.point,
        normal=placement.normal,
        principal_directions=placement.curvature.principal_directions,
        mesh_mm=pad.point(turn[:, None], height),
        **_drawn(pad, placement),
        points_mm={str(u): pad.point(np.radians(u), np.pi / 2) for u in _MARKED_DEG},
    )


def _pad(opened: StudySession, params: GeometryParams) -> tuple[FloatArray, FloatArray | None, FloatArray]:
    """Return semi-axes (mm), their covariance if known, and standard uncertainties of the angles."""
    if params.finger is None:
        return np.array(params.semi_axes_mm, dtype=float), None, np.zeros(2)
    finger, of = measured_finger(opened, params.finger), opened.study().uncertainty
    if finger is None:
        raise RequestError.impossible(f"{params.finger}: no complete finger of the study has this name")
    return finger.semi_axes, finger.covariance, np.radians([of.wedge_deg_std, of.roll_angle_deg_std])


def _placed(
    axes: FloatArray, covariance: FloatArray | None, angles: FloatArray, angle_stds: FloatArray
) -> dict[str, float | None]:
    """Return u and the radii at the point of contact, with standard uncertainties if known."""
    inputs = Inputs.of(
        **dict(zip(SEMI_AXES, axes.tolist(), strict=True)),
        wedge_angle=(angles[0], angle_stds[0]),
        roll_angle=(angles[1], angle_stds[1]),
    )
    if covariance is not None:
        inputs = inputs.with_covariance(SEMI_AXES, covariance)
    found = propagate(placement_model, inputs)
    placed: dict[str, float | None] = {}
    for name in found.names:
        key, factor = (f"{name}_deg", np.degrees(1.0)) if name == "u" else (f"{name}_mm", 1.0)
        placed[key] = float(factor * found[name].value)
        placed[f"{key}_std"] = None if covariance is None else float(factor * found[name].std)
    return placed


def _drawn(pad: Ellipsoid, placement: Placement) -> dict[str, Any]:
    """Return lines by name, the corners of the platen in the tangent plane, and the wedge.

    The incline of the wedge touches the back of the pad, and its base is horizontal.
    """
    point, normal = placement.point, placement.normal
    along, across = placement.curvature.principal_directions
    a, b, c = pad.semi_axes
    size = float(max(pad.semi_axes))
    reach = 0.6 * size
    low, high = np.array([-a, -1.15 * b, 0.0]), np.array([-a, b, 0.0])
    level = np.array([normal[0], normal[1], 0.0])
    level /= np.linalg.norm(level) or 1.0
    foot = high - ((high - low) @ level) * level
    width = np.array([0.0, 0.0, 0.8 * c])
    sides = [side for corner in (low, high, foot) for side in (corner - width, corner + width)]
    return {
        "lines_mm": {
            "principal direction along": np.stack([point - reach * along, point + reach * along]),
            "principal direction across": np.stack([point - reach * across, point + reach * across]),
            "normal": np.stack([point, point + reach * normal]),
            "finger axis": np.array([[0, -1.2, 0], [0, 1.2, 0]]) * pad.semi_axes,
            "midline": pad.point(np.linspace(-np.pi / 2, np.pi / 2, 61), np.pi / 2),
        },
        "platen_mm": point
        + size * np.stack([-along - across, along - across, along + across, across - along]),
        "wedge_mm": np.stack(sides),
        "wedge_faces": [[2, 0, 1, 3], [4, 2, 3, 5], [0, 4, 5, 1], [0, 2, 4], [1, 5, 3]],
    }
