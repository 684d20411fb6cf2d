"""The finger on its wedge, and the figures of Dzidek et al. (2017) that follow from its printed numbers."""

from collections.abc import Iterator
from typing import Any, Final

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray
from fingerpad.contact import equivalent_radius_from_indentation
from fingerpad.figures.marks import (
    Axis,
    Figure,
    Line,
    Panel,
    Points,
    Rule,
    Text,
    arrow,
    new_panels,
    synthetic_tag,
)
from fingerpad.figures.mpl import on_axes
from fingerpad.figures.pad import POINT_COLOURS, plot_pad
from fingerpad.figures.results import plot_corrected_radius
from fingerpad.figures.style import BLACK, BLUE, GREY, ORANGE, VERMILLION
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.published.dzidek2017 import dzidek2017

_SKIN: Final = "#f3d9c6"
_STEEL: Final = "#c9ced4"
_TURN: Final = np.linspace(0, 2 * np.pi, 361)
_CENTRED: Final[dict[str, Any]] = {"horizontal": "center", "vertical": "center", "size": 7}


@on_axes
def plot_wedge(axes: Panel, pad: Ellipsoid, *, wedge_angle: float, synthetic: bool = False) -> None:
    """Draw the finger on its wedge under a level platen (upper part of Fig. 5 of Dzidek et al. 2017)."""
    sine, cosine = np.sin(wedge_angle), np.cos(wedge_angle)
    # From the pad's axes to the page, on which the platen's normal points upwards.
    level = np.array([[-sine, cosine], [cosine, sine]])
    a, b = float(pad.palmar), float(pad.distal)
    contact = level @ Placement(pad, wedge_angle=wedge_angle).point[:2]
    low, high = level @ [-a, -1.15 * b], level @ [-a, b]
    left, right, top = contact[0] - 0.75 * b, contact[0] + 0.75 * b, contact[1] + 0.12 * b
    platen = [(left, contact[1]), (right, contact[1]), (right, top), (left, top), (left, contact[1])]
    axes.add(
        Line(*level @ [a * np.cos(_TURN), b * np.sin(_TURN)], face=_SKIN, width=0.9),
        Line(*level @ [[0, 0], [-b, b]], colour=GREY, width=0.7, dash="-."),
        Line(*np.transpose([low, high, (high[0], low[1]), low]), face=_STEEL, width=0.7),
        *_angle(low, 0.375 * b, wedge_angle, "θ"),
        Line(*np.transpose(platen), face=_STEEL, width=0.7),
        Text("platen", (left + contact[0]) / 2, (contact[1] + top) / 2, **_CENTRED),
        _place(contact),
        Text("place of\ncontact", *contact, up=-7, **{**_CENTRED, "vertical": "top"}, halo=_SKIN),
        *synthetic_tag(synthetic),
    )
    axes.x, axes.y, axes.equal = Axis("horizontal (mm)"), Axis("vertical (mm)"), True
    axes.title = f"on the wedge, θ = {np.degrees(wedge_angle):g}°"


@on_axes
def plot_wedge_in_pad_axes(
    axes: Panel, pad: Ellipsoid, *, wedge_angle: float, synthetic: bool = False
) -> None:
    """Draw the same section in the pad's own axes (lower part of Fig. 5 of Dzidek et al. 2017).

    The platen is the tangent of gradient −cot θ. The radius of the dotted circle of radius ℓa at the angle u
    ends below or above the place of contact: u is parametric, not polar.
    """
    placement = Placement(pad, wedge_angle=wedge_angle)
    a, b, u = float(pad.palmar), float(pad.distal), float(placement.u)
    contact, normal = placement.point[:2], placement.normal[:2]
    reach = 0.75 * b * np.array([-normal[1], normal[0]])
    gradient = f"{-normal[0] / normal[1]:z.2f}".replace("-", "−") if normal[1] > 1e-12 else "−∞"
    platen = f"platen\ndy/dx = −cot θ = {gradient}"
    on_circle = a * np.array([np.cos(u), np.sin(u)])
    length = 0.5 * b
    axes.add(
        Line(a * np.cos(_TURN), b * np.sin(_TURN), face=_SKIN, width=0.9),
        Line(a * np.cos(_TURN), a * np.sin(_TURN), dash=":", colour=BLUE, width=0.9),
        Rule("x", 0, width=0.6),
        Rule("y", 0, width=0.6),
        Line(*np.transpose([contact - reach, contact + reach]), width=1.4),
        # u at the centre, to the point of the circle from which the place of contact has its x.
        Line(*np.transpose([(0, 0), on_circle]), colour=BLUE, width=0.9),
        Line(*np.transpose([on_circle, contact]), dash=":", colour=BLUE, width=0.9),
        *_angle((0, 0), 0.45 * a, u, "u", colour=BLUE),
        *arrow(contact, contact + length * normal, colour=ORANGE),
        Line(contact[0] + np.array([0, length]), contact[1], dash="--", colour=GREY, width=0.8),
        *_angle(contact, length / 2, float(np.arctan2(normal[1], normal[0])), "θ", colour=ORANGE),
        _place(contact),
        Text(platen, *(contact - reach), right=6, up=2, vertical="bottom", size=7),
        *synthetic_tag(synthetic),
    )
    axes.x = Axis("x, palmar (mm)", low=-1.15 * a, high=float(contact[0] + 1.9 * b))
    axes.y = Axis("y, distal (mm)", low=-1.1 * b, high=float(max(1.1 * b, contact[1] + 0.8 * b)))
    axes.title, axes.equal = f"u = {np.degrees(u):.1f}°", True


def _place(contact: FloatArray) -> Points:
    return Points(*contact, colour=VERMILLION, size=5, edge=BLACK, edge_width=0.6)


def _angle(
    centre: ArrayLike, radius: float, angle: float, name: str, *, colour: str = BLACK
) -> Iterator[Line | Text]:
    """Yield an angle from the horizontal as an arc, with its name beyond."""
    turn = np.linspace(0, angle, 61)
    x, y = np.reshape(centre, (2, 1)) + radius * np.array([np.cos(turn), np.sin(turn)])
    yield Line(x, y, colour=colour, width=0.9)
    x, y = np.asarray(centre) + 1.4 * radius * np.array([np.cos(angle / 2), np.sin(angle / 2)])
    yield Text(name, x, y, colour=colour, **{**_CENTRED, "size": 8})


def dzidek2017_figures() -> Iterator[tuple[str, Figure, str]]:
    """Yield the supplement's Figs 1, 4, 5 and 6, as far as they follow from printed numbers.

    Fig. 6 shows 2 N, the one load of which numbers are printed: R_g^corr from the printed R_0g and contact
    ellipse, R_0g F₂⁻³, beside the printed value.
    """
    article = dzidek2017()
    pad = article.semi_axes["ellipse"].ellipsoid
    for number, u_deg, caption in (
        (1, (), "The ellipsoid of Table 1 (ellipse approach) and its axes."),
        (4, tuple(POINT_COLOURS), "The places u = 0°, 30°, 45°, 60° and 90° on the pad."),
    ):
        figure, (axes,) = new_panels(height_mm=80)
        plot_pad(axes, pad, u_deg=u_deg)
        yield f"dzidek2017_figure_{number}", figure, caption
    for angle, wedge in article.wedges.items():
        theta, radius = np.radians(angle), wedge.mean_curvature_radius_mm.value
        k = wedge.semi_minor_mm.value / wedge.semi_major_mm.value
        figure, (left, right) = new_panels(width_mm=170, height_mm=95, columns=2)
        plot_wedge(left, pad, wedge_angle=theta)
        plot_wedge_in_pad_axes(right, pad, wedge_angle=theta)
        caption = f"The finger on its wedge of {angle}°, and in its own axes."
        yield f"dzidek2017_figure_5_{angle}deg", figure, caption
        figure, (axes,) = new_panels()
        plot_corrected_radius(
            axes,
            wedge.load_N,
            equivalent_radius_from_indentation(radius, k),
            measured_radius=wedge.measured_radius_mm.value,
            mean_curvature_radius=radius,
            printed=wedge,
        )
        caption = f"Corrected radius at {angle}° and 2 N, from printed numbers."
        yield f"dzidek2017_figure_6_{angle}deg", figure, caption
