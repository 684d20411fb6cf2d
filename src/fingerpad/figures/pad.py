"""The pad in three dimensions, seen along a direction without perspective, shaded as matt skin would be."""

import base64
import io
from dataclasses import dataclass
from typing import Any, Final, Self

import numpy as np
import numpy.typing as npt
from matplotlib.colors import to_rgb
from PIL import Image

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array, check_radians
from fingerpad.figures.marks import Axis, Dash, Line, Panel, Picture, Points, Side, Text, arrow, synthetic_tag
from fingerpad.figures.mpl import on_axes
from fingerpad.figures.style import BLACK, BLUE, GREEN, GREY, ORANGE, PNG_LEVEL, VERMILLION, YELLOW
from fingerpad.geometry import Ellipse, Ellipsoid, Placement, PrincipalRadii

# The caption of Fig. 4 of Dzidek et al. (2017).
POINT_COLOURS: Final = {0: YELLOW, 30: GREEN, 45: BLUE, 60: ORANGE, 90: VERMILLION}
_SKIN: Final = to_rgb("#f3d9c6")
_BACK: Final = to_rgb("#dfe3e8")
_PIXELS: Final = 160


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Camera:
    """Orthonormal axes of a picture: to the right, upwards, and towards the eye."""

    right: FloatArray
    up: FloatArray
    towards: FloatArray

    @classmethod
    def of(cls, towards: ArrayLike, up: ArrayLike) -> Self:
        """Look from `towards`, with `up` upwards as far as it can be."""
        eye = as_float_array(towards) / np.linalg.norm(towards)
        right = np.cross(as_float_array(up), eye)
        right /= np.linalg.norm(right)
        return cls(right=right, up=np.cross(eye, right), towards=eye)

    def project(self, points: FloatArray) -> FloatArray:
        """Return the picture's coordinates of points, shape (..., 2)."""
        return np.stack([points @ self.right, points @ self.up], axis=-1)


@on_axes
def plot_pad(
    axes: Panel, pad: Ellipsoid, *, u_deg: ArrayLike = tuple(POINT_COLOURS), synthetic: bool = False
) -> None:
    """Draw the ellipsoid, its palmar cap, axes and points of given u (Figs 1 and 4 of Dzidek et al. 2017)."""
    view = Camera.of(towards=(0.55, 0.5, 0.95), up=(1, 0, 0))
    outline = _draw_surface(axes, pad, view)
    _frame(axes, np.concatenate([outline, _draw_coordinate_axes(axes, pad, view)]))
    for angle in np.atleast_1d(as_float_array(u_deg)):
        spot = view.project(pad.point(np.radians(angle), np.pi / 2))
        outward = view.project(pad.normal(np.radians(angle), np.pi / 2))
        colour = POINT_COLOURS.get(round(float(angle)), BLACK)
        right, up = -12 * outward / np.linalg.norm(outward)
        axes.add(
            Points(*spot, colour=colour, size=7, edge=BLACK, edge_width=0.7),
            Text(f"{angle:g}°", *spot, right=right, up=up, horizontal="center", vertical="center", size=7),
        )
    _draw_scale_bar(axes)
    axes.add(*synthetic_tag(synthetic))


@on_axes
def plot_pad_with_contact(
    axes: Panel,
    pad: Ellipsoid,
    *,
    wedge_angle: float,
    roll_angle: float = 0.0,
    predicted: Ellipse | None = None,
    measured: Ellipse | None = None,
    measured_long_axis_angle: float = 0.0,
    synthetic: bool = False,
) -> None:
    """Draw the pad as seen through the platen: place of contact, principal directions, contact ellipses.

    Angles are in radians; that of the measured long axis is from the finger's axis, which points upwards,
    counter-clockwise. The predicted one lies along the larger principal radius.
    """
    placement = Placement(pad, wedge_angle=wedge_angle, roll_angle=roll_angle)
    # The finger's axis as it lies on the platen, ∂n/∂θ: regular even where the finger stands on its tip.
    rise: FloatArray = np.array([-np.sin(wedge_angle) * np.cos(roll_angle), np.cos(wedge_angle)])
    view = Camera.of(placement.normal, up=(*rise, -np.sin(wedge_angle) * np.sin(roll_angle)))
    centre = view.project(placement.point)
    directions = view.project(placement.curvature.principal_directions)
    radii = placement.curvature.principal_radii
    outline = _draw_surface(axes, pad, view)
    drawn = [outline]
    if measured is not None:
        angle = float(check_radians("measured_long_axis_angle", measured_long_axis_angle))
        label = "contact measured"
        drawn.append(_draw_contact(axes, centre, measured, angle, colour=BLUE, dash="-", label=label))
    if predicted is not None:
        long_axis = directions[np.argmax(radii)]
        turn = float(np.arctan2(-long_axis[0], long_axis[1]))
        label = "Hertz shape of the measured area"
        drawn.append(_draw_contact(axes, centre, predicted, turn, colour=ORANGE, dash="--", label=label))
    drawn += _draw_directions(axes, centre, np.concatenate(drawn), directions, radii)
    _frame(axes, np.concatenate(drawn))
    axes.add(Points(*centre, size=3.5, label="place of contact"))
    roll = f", roll φ = {np.degrees(roll_angle):g}°" if roll_angle else ""
    axes.title = f"θ = {np.degrees(wedge_angle):g}°{roll}, u = {np.degrees(placement.u):.1f}°"
    axes.legend = "below"
    _draw_scale_bar(axes)
    axes.add(*synthetic_tag(synthetic))


def _draw_surface(axes: Panel, pad: Ellipsoid, view: Camera) -> FloatArray:
    """Draw the shaded ellipsoid with its parametric lines and outline; return the outline."""
    turn = np.linspace(0, 2 * np.pi, 361)
    rim = np.cos(turn)[:, None] * view.right + np.sin(turn)[:, None] * view.up
    outline = view.project(pad.contact_point(rim))
    reach = np.abs(outline).max(axis=0)  # the outline is symmetric about the centre
    axes.add(Picture(_png(_shaded(pad, view, reach)), -reach[0], reach[0], -reach[1], reach[1]))
    across, along = np.linspace(0, np.pi, 91), np.linspace(-np.pi / 2, np.pi / 2, 181)
    u, v = np.radians(np.arange(-90, 91, 15))[:, None], np.radians(np.arange(15, 166, 15))[:, None]
    lines = np.concatenate([_parametric(pad, view, u, across), _parametric(pad, view, along, v)])
    axes.add(
        Line(*lines.T, colour=GREY, width=0.35, alpha=0.6),
        Line(*_parametric(pad, view, along, np.pi / 2).T, width=0.9, alpha=0.9),
        Line(*outline.T, colour=GREY, width=0.9),
    )
    axes.equal, axes.framed = True, False
    return outline


def _frame(axes: Panel, points: FloatArray) -> None:
    """Set the limits to hold `points` with a margin."""
    low, high = points.min(axis=0), points.max(axis=0)
    margin = 0.05 * (high - low)
    ends = np.stack([low - margin, high + margin]).tolist()
    axes.x, axes.y = (Axis(low=ends[0][k], high=ends[1][k]) for k in range(2))


def _shaded(pad: Ellipsoid, view: Camera, reach: FloatArray) -> npt.NDArray[np.uint8]:
    """Return a picture, RGBA: where each line of sight meets the ellipsoid, how far it faces the light."""
    s, t = np.meshgrid(*(np.linspace(-r, r, _PIXELS) for r in reach))
    base = s[..., None] * view.right + t[..., None] * view.up
    weight = 1 / pad.semi_axes**2
    a = (weight * view.towards**2).sum()
    b = (weight * base * view.towards).sum(axis=-1)
    discriminant = b * b - a * ((weight * base**2).sum(axis=-1) - 1)
    depth = (np.sqrt(np.maximum(discriminant, 0)) - b) / a
    point = base + depth[..., None] * view.towards
    normal = weight * point
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    light = view.towards + 0.5 * view.up - 0.4 * view.right
    shade = 0.62 + 0.38 * np.clip(normal @ (light / np.linalg.norm(light)), 0, 1)
    colour = np.where(point[..., :1] >= 0, _SKIN, _BACK)
    inside = discriminant / np.hypot(*np.gradient(discriminant))  # pixels within the outline
    opacity = np.clip(1 + inside, 0, 1)
    picture = np.concatenate([colour * shade[..., None], opacity[..., None]], axis=-1)
    return (255 * picture).round().astype(np.uint8)  # of floats Matplotlib keeps copies at full size


def _parametric(pad: Ellipsoid, view: Camera, u: ArrayLike, v: ArrayLike) -> FloatArray:
    """Return the parts of parametric lines that face the eye, each followed by a gap."""
    u, v = np.broadcast_arrays(np.atleast_2d(u), np.atleast_2d(v))
    seen = pad.normal(u, v) @ view.towards > 0
    lines = np.where(seen[..., None], view.project(pad.point(u, v)), np.nan)
    return np.pad(lines, ((0, 0), (0, 1), (0, 0)), constant_values=np.nan).reshape(-1, 2)


def _png(pixels: npt.NDArray[np.uint8]) -> str:
    """Return pixels, the lowest row first, as a PNG file in base64."""
    buffer = io.BytesIO()
    Image.fromarray(pixels[::-1]).save(buffer, "PNG", compress_level=PNG_LEVEL)
    return base64.b64encode(buffer.getvalue()).decode()


def _draw_coordinate_axes(axes: Panel, pad: Ellipsoid, view: Camera) -> FloatArray:
    """Draw the directions of the three semi-axes as arrows that leave the surface; return their ends."""
    length = 0.3 * float(pad.semi_axes.max())
    starts, ends = (view.project(np.diag(reach)) for reach in (pad.semi_axes, pad.semi_axes + length))
    for start, end, name in zip(starts, ends, ("x, palmar", "y, distal", "z, across"), strict=True):
        axes.add(*arrow(start, end))
        steep = abs(end[1] - start[1]) > 2 * abs(end[0] - start[0])
        right, up = 4 * (end - start) / np.linalg.norm(end - start)
        side: Side = "center" if steep else "left" if end[0] > start[0] else "right"
        text = Text(
            name, *end, right=right, up=up, horizontal=side, vertical="bottom" if steep else "center", size=7
        )
        axes.add(text)
    return ends


def _draw_directions(
    axes: Panel, centre: FloatArray, within: FloatArray, directions: FloatArray, radii: PrincipalRadii
) -> list[FloatArray]:
    """Draw the principal directions through the place of contact, named beyond points; return their lines."""
    lines: list[FloatArray] = []
    for direction, radius, word in zip(directions, radii, ("along", "across"), strict=True):
        upwards = word == "along"
        side = direction * np.sign(direction[1] if upwards else direction[0])
        reach = (within - centre) @ side
        line = centre + np.outer([1.06 * reach.min(), 1.08 * reach.max()], side)
        name = f"R {word}{' ' if upwards else chr(10)}{radius:.1f} mm"
        place: dict[str, Any] = {"right": 0 if upwards else 3, "up": 2 if upwards else 0, "size": 6.8}
        place |= {
            "horizontal": "center" if upwards else "left",
            "vertical": "bottom" if upwards else "center",
        }
        axes.add(Line(*line.T, width=0.8), Text(name, *line[1], **place))
        lines.append(line)
    return lines


def _draw_contact(
    axes: Panel, centre: FloatArray, ellipse: Ellipse, angle: float, *, colour: str, dash: Dash, label: str
) -> FloatArray:
    """Draw a contact ellipse, its long axis `angle` from upwards, counter-clockwise; return its points."""
    turn = np.linspace(0, 2 * np.pi, 181)
    major, minor = ellipse.semi_major * np.cos(turn), ellipse.semi_minor * np.sin(turn)
    x = centre[0] - major * np.sin(angle) - minor * np.cos(angle)
    y = centre[1] + major * np.cos(angle) - minor * np.sin(angle)
    size = f"semi-axes {ellipse.semi_major:.1f} × {ellipse.semi_minor:.1f} mm"
    axes.add(Line(x, y, dash=dash, colour=colour, width=1.5, label=f"{label}, {size}"))
    return np.stack([x, y], axis=-1)


def _draw_scale_bar(axes: Panel, length: float = 5.0) -> None:
    """Draw a bar of `length` mm in the lower left corner, the axes having no ticks."""
    left, bottom = axes.limits("x")[0], axes.limits("y")[0]
    axes.add(
        Line([left, left + length], bottom, width=1.8, clipped=False),
        Text(f"{length:g} mm", left + length / 2, bottom, up=3, horizontal="center", size=7),
    )
