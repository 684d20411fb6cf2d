"""Drawings of the axes: of the pad, on its wedge over bone, and of the directions in the contact."""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

import fingerpad as fp
from fingerpad.figures import plot_wedge, plot_wedge_in_pad_axes
from fingerpad.figures.style import BLACK, BLUE, GREY, VERMILLION, in_style

PAD = fp.Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
WEDGE = np.radians(30)
TISSUE = fp.Tissue(youngs_modulus=0.05, thickness=8.0)
SKIN, STEEL, BONE = "#f3d9c6", "#c9ced4", "#ece7dc"


@in_style()
def draw(path: Path) -> None:
    """Write the drawing as SVG."""
    figure, axes = plt.subplot_mosaic(
        [["pad", "wedge"], ["layer", "layer"]],
        figsize=(6.8, 5.6),
        layout="constrained",
        height_ratios=(1.35, 1),
    )
    pad, wedge, layer = (axes[name] for name in ("pad", "wedge", "layer"))
    plot_wedge_in_pad_axes(pad, PAD, wedge_angle=WEDGE)
    pad.set_title("1  the pad's own axes (z across, towards you)")
    plot_wedge(wedge, PAD, wedge_angle=WEDGE)
    wedge.set_title("2  on a wedge of angle θ")
    draw_layer(layer)
    layer.set_title("3  pressed: contact, indentation ξ, layer t")
    figure.savefig(path)
    plt.close(figure)


@in_style()
def draw_axes(path: Path) -> None:
    """Write the pad's axes and its wedge as SVG."""
    figure, (pad, wedge) = plt.subplots(1, 2, figsize=(6.8, 3.3), layout="constrained")
    plot_wedge_in_pad_axes(pad, PAD, wedge_angle=WEDGE)
    pad.set_title("the pad's own axes (z across, towards you)")
    plot_wedge(wedge, PAD, wedge_angle=WEDGE)
    wedge.set_title("on a wedge of angle θ")
    figure.savefig(path)
    plt.close(figure)


@in_style()
def draw_directions(path: Path) -> None:
    """Write the directions in the contact as SVG."""
    figure, axes = plt.subplots(figsize=(4.6, 2.3), layout="constrained")
    draw_layer(axes)
    arrow = {"arrowstyle": "->", "color": VERMILLION, "lw": 1.5, "shrinkA": 0, "shrinkB": 0}
    for end, (x, y), name in (
        ((14.5, -7), (14.8, -7.3), "x along, to the tip"),
        ((11, -10.5), (11.3, -10.8), "z depth"),
    ):
        axes.annotate("", end, (11, -7), arrowprops=arrow)
        axes.text(x, y, name, color=VERMILLION, fontsize=8)
    axes.text(11, -6.6, "y across", color=VERMILLION, fontsize=8, ha="center")
    axes.set(xlim=(-11.5, 24), ylim=(-12, 4))
    figure.savefig(path)
    plt.close(figure)


def draw_layer(axes: Axes) -> None:
    """Draw the section along the finger at the place of contact, with the platen above and the bone below."""
    place = fp.Placement(PAD, wedge_angle=WEDGE)
    contact = fp.fast_contact(place, TISSUE, load=2.0)
    depth, bone = float(contact.indentation), -float(TISSUE.thickness)
    half = float(contact.semi_major if contact.along else contact.semi_minor)
    along = np.linspace(-11.0, 6.8, 400)
    surface = -place.gap.height(along, 0.0)
    axes.fill_between(along, np.minimum(surface, -depth), bone, color=SKIN, linewidth=0)
    axes.plot(along, surface, "--", color=GREY, linewidth=0.9)
    left, width = -11.0, 20.0
    axes.add_patch(Rectangle((left, -depth), width, 3.6, facecolor=STEEL, edgecolor=BLACK, lw=0.7, alpha=0.6))
    axes.add_patch(Rectangle((left, bone - 1.8), width, 1.8, facecolor=BONE, edgecolor=BLACK, lw=0.7))
    axes.plot([-half, half], [-depth, -depth], color=BLUE, linewidth=2.5, solid_capstyle="butt")
    axes.plot([-8.5, 3.6], [0, 0], ":", color=BLACK, linewidth=0.7)
    axes.plot(0, 0, "o", color=VERMILLION, markersize=5, markeredgecolor=BLACK, markeredgewidth=0.6)
    arrow = {"arrowstyle": "<->", "color": BLACK, "lw": 0.8, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (3.0, -depth), (3.0, 0), arrowprops=arrow)
    axes.annotate("", (-7.5, bone), (-7.5, 0), arrowprops=arrow)
    for x, y, words, colour in (
        (0, 0.8, "platen", BLACK),
        (0, bone - 0.9, "bone", BLACK),
        (3.4, -depth / 2, "ξ", BLACK),
        (-7.0, bone / 2 - 1, "t", BLACK),
        (0, -depth - 0.7, "contact ellipse, along the finger", BLUE),
        (0, bone / 2 - 1.2, "tissue", BLACK),
    ):
        axes.text(x, y, words, ha="center", va="center", fontsize=8, color=colour)
    axes.text(7.0, -4.0, "pad before\nit is pressed", fontsize=7, color=GREY)
    axes.set_aspect("equal")
    axes.axis("off")
