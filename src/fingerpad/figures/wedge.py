"""The finger on its wedge, and the figures of Dzidek et al. (2017) that follow from its printed numbers."""

from collections.abc import Iterator
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Polygon, Rectangle

from fingerpad._arrays import FloatArray
from fingerpad.contact import equivalent_radius_from_indentation
from fingerpad.figures.marks import Panel, synthetic_tag
from fingerpad.figures.mpl import draw
from fingerpad.figures.pad import plot_pad
from fingerpad.figures.results import plot_corrected_radius
from fingerpad.figures.style import (
    BLACK,
    BLUE,
    GREY,
    ORANGE,
    VERMILLION,
    in_style,
    new_figure,
    pair,
)
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.published.dzidek2017 import dzidek2017

_SKIN: Final = "#f3d9c6"
_STEEL: Final = "#c9ced4"
_TURN: Final = np.linspace(0, 2 * np.pi, 361)


@in_style
def plot_wedge(axes: Axes, pad: Ellipsoid, *, wedge_angle: float, synthetic: bool = False) -> Axes:
    """Draw the finger on its wedge under a level platen (upper part of Fig. 5 of Dzidek et al. 2017)."""
    placement = Placement(pad, wedge_angle=wedge_angle)
    sine, cosine = np.sin(wedge_angle), np.cos(wedge_angle)

    def level(x: FloatArray | float, y: FloatArray | float) -> FloatArray:
        """Turn the pad's axes so that the platen's normal points upwards."""
        return np.stack([y * cosine - x * sine, x * cosine + y * sine], axis=-1)

    a, b = float(pad.palmar), float(pad.distal)
    _draw_section(axes, level(a * np.cos(_TURN), b * np.sin(_TURN)))
    axes.plot(*level(np.zeros(2), np.array([-b, b])).T, color=GREY, linewidth=0.7, linestyle="-.")
    _draw_support(axes, level(-a, -1.15 * b), level(-a, b), wedge_angle, size=b)
    contact = level(placement.point[0], placement.point[1])
    corner, width, height = contact - [0.75 * b, 0], 1.5 * b, 0.12 * b
    axes.add_patch(Rectangle(pair(corner), width, height, facecolor=_STEEL, edgecolor=BLACK, lw=0.7))
    axes.text(contact[0], contact[1] + height / 2, "platen", ha="center", va="center", fontsize=7)
    _draw_place(axes, contact)
    axes.annotate(
        "place of contact",
        pair(contact),
        xytext=(0, -9),
        textcoords="offset points",
        ha="center",
        va="top",
        fontsize=7,
    )
    axes.margins(0.05)
    axes.set_aspect("equal")
    axes.set_xlabel("horizontal (mm)")
    axes.set_ylabel("vertical (mm)")
    axes.set_title(f"on the wedge, θ = {np.degrees(wedge_angle):g}°")
    draw(Panel(marks=[*synthetic_tag(synthetic)]), axes)
    return axes


def _draw_section(axes: Axes, outline: FloatArray) -> None:
    axes.add_patch(Polygon(outline, facecolor=_SKIN, edgecolor=BLACK, lw=0.9))


def _draw_place(axes: Axes, contact: FloatArray) -> None:
    axes.plot(
        *contact, "o", color=VERMILLION, markersize=5, markeredgecolor=BLACK, markeredgewidth=0.6, zorder=5
    )


def _draw_support(axes: Axes, low: FloatArray, high: FloatArray, angle: float, *, size: float) -> None:
    """Draw the wedge whose incline runs from `low` to `high`, and name its angle."""
    foot = np.array([high[0], low[1]])
    axes.add_patch(Polygon([low, high, foot], facecolor=_STEEL, edgecolor=BLACK, lw=0.7, joinstyle="round"))
    radius = 0.75 * size
    axes.add_patch(Arc((low[0], low[1]), radius, radius, theta1=0, theta2=np.degrees(angle), lw=0.9))
    place = low + 0.53 * size * np.array([np.cos(angle / 2), np.sin(angle / 2)])
    axes.text(place[0], place[1], "θ", ha="center", va="center", fontsize=8)


@in_style
def plot_wedge_in_pad_axes(
    axes: Axes, pad: Ellipsoid, *, wedge_angle: float, synthetic: bool = False
) -> Axes:
    """Draw the same section in the pad's own axes (lower part of Fig. 5 of Dzidek et al. 2017).

    The platen is the tangent of gradient −cot θ. The radius of the dotted circle of radius ℓa at the angle u
    ends below or above the place of contact: u is parametric, not polar.
    """
    placement = Placement(pad, wedge_angle=wedge_angle)
    a, b, u = float(pad.palmar), float(pad.distal), float(placement.u)
    _draw_section(axes, np.column_stack([a * np.cos(_TURN), b * np.sin(_TURN)]))
    axes.plot(a * np.cos(_TURN), a * np.sin(_TURN), ":", color=BLUE, linewidth=0.9)
    axes.axhline(0, color=BLACK, linewidth=0.6)
    axes.axvline(0, color=BLACK, linewidth=0.6)
    contact, normal = placement.point[:2], placement.normal[:2]
    tangent = np.array([-normal[1], normal[0]])
    axes.plot(
        *(contact + np.outer([-0.75 * b, 0.75 * b], tangent)).T, color=BLACK, linewidth=1.4, label="platen"
    )
    _draw_parametric_angle(axes, contact, radius=a, u=u)
    _draw_normal(axes, contact, normal, length=0.5 * b)
    _draw_place(axes, contact)
    _name_platen(axes, contact - 0.75 * b * tangent, normal)
    axes.set_aspect("equal")
    axes.set_xlim(-1.15 * a, contact[0] + 1.7 * b)
    axes.set_ylim(-1.1 * b, max(1.1 * b, contact[1] + 0.8 * b))
    axes.set_xlabel("x, palmar (mm)")
    axes.set_ylabel("y, distal (mm)")
    axes.set_title(f"u = {np.degrees(u):.1f}°")
    draw(Panel(marks=[*synthetic_tag(synthetic)]), axes)
    return axes


def _name_platen(axes: Axes, end: FloatArray, normal: FloatArray) -> None:
    """Write the platen's gradient beside its lower end."""
    gradient = f"{-normal[0] / normal[1]:.2f}".replace("-", "−") if normal[1] > 1e-12 else "−∞"
    axes.annotate(
        f"platen\ndy/dx = −cot θ = {gradient}",
        pair(end),
        xytext=(6, 2),
        textcoords="offset points",
        ha="left",
        va="bottom",
        fontsize=7,
    )


def _draw_parametric_angle(axes: Axes, contact: FloatArray, *, radius: float, u: float) -> None:
    """Draw u at the centre, to the point of the circle from which the place of contact has its x."""
    on_circle = radius * np.array([np.cos(u), np.sin(u)])
    axes.plot([0, on_circle[0]], [0, on_circle[1]], color=BLUE, linewidth=0.9)
    axes.plot(*np.array([on_circle, contact]).T, ":", color=BLUE, linewidth=0.9)
    axes.add_patch(
        Arc((0, 0), 0.9 * radius, 0.9 * radius, theta1=0, theta2=np.degrees(u), color=BLUE, lw=0.9)
    )
    place = 0.62 * radius * np.array([np.cos(u / 2), np.sin(u / 2)])
    axes.text(place[0], place[1], "u", color=BLUE, ha="center", va="center", fontsize=8)


def _draw_normal(axes: Axes, contact: FloatArray, normal: FloatArray, *, length: float) -> None:
    """Draw the outward normal at the place of contact, and its angle θ to the palmar axis."""
    angle = np.arctan2(normal[1], normal[0])
    axes.annotate(
        "",
        pair(contact + length * normal),
        pair(contact),
        arrowprops={"arrowstyle": "-|>", "color": ORANGE, "lw": 1.1, "shrinkA": 0, "shrinkB": 0},
    )
    axes.plot([contact[0], contact[0] + length], [contact[1]] * 2, "--", color=GREY, linewidth=0.8)
    axes.add_patch(
        Arc((contact[0], contact[1]), length, length, theta1=0, theta2=np.degrees(angle), color=ORANGE)
    )
    place = contact + 0.68 * length * np.array([np.cos(angle / 2), np.sin(angle / 2)])
    axes.text(place[0], place[1], "θ", color=BLACK, ha="center", va="center", fontsize=8)


def dzidek2017_figures() -> Iterator[tuple[str, Figure, str]]:
    """Yield the supplement's Figs 1, 4, 5 and 6, as far as they follow from printed numbers.

    Fig. 6 shows 2 N, the one load of which numbers are printed: R_g^corr from the printed R_0g and contact
    ellipse, R_0g F₂⁻³, beside the printed value.
    """
    article = dzidek2017()
    pad = article.semi_axes["ellipse"].ellipsoid
    figure, (axes,) = new_figure(height_mm=80)
    plot_pad(axes, pad, u_deg=())
    yield "dzidek2017_figure_1", figure, "The ellipsoid of Table 1 (ellipse approach) and its axes."
    figure, (axes,) = new_figure(height_mm=80)
    plot_pad(axes, pad)
    yield "dzidek2017_figure_4", figure, "The places u = 0°, 30°, 45°, 60° and 90° on the pad."
    for angle, wedge in article.wedges.items():
        theta = np.radians(angle)
        k = wedge.semi_minor_mm.value / wedge.semi_major_mm.value
        figure, (left, right) = new_figure(width_mm=170, height_mm=95, columns=2)
        plot_wedge(left, pad, wedge_angle=theta)
        plot_wedge_in_pad_axes(right, pad, wedge_angle=theta)
        yield (
            f"dzidek2017_figure_5_{angle}deg",
            figure,
            f"The finger on its wedge of {angle}°, and in its own axes.",
        )
        figure, (axes,) = new_figure()
        plot_corrected_radius(
            axes,
            wedge.load_N,
            equivalent_radius_from_indentation(wedge.mean_curvature_radius_mm.value, k),
            measured_radius=wedge.measured_radius_mm.value,
            mean_curvature_radius=wedge.mean_curvature_radius_mm.value,
            printed=wedge,
        )
        yield (
            f"dzidek2017_figure_6_{angle}deg",
            figure,
            f"Corrected radius at {angle}° and 2 N, from printed numbers.",
        )
