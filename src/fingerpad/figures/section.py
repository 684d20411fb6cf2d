"""The section under a contact: pressure above, shear stress in the tissue, receptors and bone."""

from collections.abc import Mapping
from typing import Final

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator

from fingerpad.contact import ContactField, ContactSection
from fingerpad.figures.marks import Axis, Band, Line, Panel
from fingerpad.figures.mpl import on_axes
from fingerpad.figures.style import BLACK, BLUE, GREY, VERMILLION, in_style, new_figure
from fingerpad.units import KPA_PER_MPA

_LEVELS: Final = 16
_STEPS: Final = 1, 2, 2.5, 5, 10  # between levels and ticks
_COLOURS: Final = "YlOrBr"
_BONE: Final = "#ece7dc"
_BONE_SHOWN: Final = 0.09  # of the section's width
_LABEL_GAP: Final = 2.8  # mm on paper between the labels of receptors
# Room beside, above and between the axes, and height of the colour bar and of its label, mm on paper.
_LEFT, _RIGHT, _TOP, _GAP, _FOOT, _BAR, _BAR_LABEL = 11.0, 17.5, 5.0, 2.5, 9.5, 2.6, 10.0
_HALO: Final = [withStroke(linewidth=1.6, foreground="white")]


@on_axes
def plot_contact_pressure(
    axes: Panel, section: ContactSection, *, hertz: ContactSection | None = None
) -> None:
    """Draw the pressure along the finger.

    Parameters
    ----------
    axes : Axes
        Where to draw.
    section : ContactSection
        Section in mm and MPa.
    hertz : ContactSection, optional
        That of Hertz theory, to compare.

    Returns
    -------
    Axes
        `axes`.

    Examples
    --------
    >>> import matplotlib.pyplot as plt
    >>> from fingerpad.contact import Tissue
    >>> from fingerpad.geometry import Ellipsoid, Placement
    >>> pad = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
    >>> place = Placement(pad, wedge_angle=np.radians(30))
    >>> field = ContactField.of_hertz(place, Tissue(youngs_modulus=0.1024), load=2.0)
    >>> axes = plot_contact_pressure(plt.figure().subplots(), field.section())
    >>> axes.get_ylabel()
    'pressure (kPa)'
    """
    pressure = KPA_PER_MPA * section.pressure
    axes.add(
        Band(section.along, 0.0, pressure, colour=BLUE, alpha=0.18),
        Line(section.along, pressure, colour=BLUE, label="whole pad"),
    )
    if hertz is not None:
        axes.add(Line(hertz.along, KPA_PER_MPA * hertz.pressure, dash="--", colour=GREY, label="Hertz"))
        axes.legend, axes.columns = "above", 2
    axes.x = Axis(low=float(section.along[0]), high=float(section.along[-1]))
    axes.y = Axis("pressure (kPa)", low=0)


@in_style()
def plot_section(
    axes: Axes, section: ContactSection, *, highest_shear: tuple[float, float] | None = None
) -> ContourSet:
    """Draw the maximum shear stress in the section along the finger, and the bone below.

    Parameters
    ----------
    axes : Axes
        Where to draw; takes equal scales.
    section : ContactSection
        Section in mm and MPa.
    highest_shear : tuple of float, optional
        Highest shear stress on the axis and its depth, to mark.

    Returns
    -------
    ContourSet
        The filled contours, for a colour bar.

    Examples
    --------
    >>> import matplotlib.pyplot as plt
    >>> from fingerpad.contact import Tissue
    >>> from fingerpad.geometry import Ellipsoid, Placement
    >>> pad = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
    >>> place = Placement(pad, wedge_angle=np.radians(30))
    >>> field = ContactField.of_hertz(place, Tissue(youngs_modulus=0.1024), load=2.0)
    >>> filled = plot_section(plt.figure().subplots(), field.section())
    >>> filled.levels[-1] > 5  # kPa
    np.True_
    """
    shear = KPA_PER_MPA * section.maximum_shear
    levels = MaxNLocator(_LEVELS, steps=_STEPS).tick_values(0, float(np.nanmax(shear)))
    filled = axes.contourf(section.along, section.depth, shear, levels, cmap=_COLOURS)
    axes.contour(section.along, section.depth, shear, levels, colors=BLACK, linewidths=0.25, alpha=0.5)
    left, right, bottom = section.along[0], section.along[-1], section.depth[-1]
    if bottom == section.thickness:
        bottom += _BONE_SHOWN * (right - left)
        _draw_bone(axes, section, bottom)
    touching = section.along[section.pressure > 0]
    if touching.size:
        axes.plot(touching[[0, -1]], [0, 0], color=BLUE, linewidth=3, solid_capstyle="butt", clip_on=False)
    axes.plot([0, 0], [0, section.depth[-1]], color=BLACK, linewidth=0.6, linestyle="-.")
    if highest_shear is not None:
        value, depth = highest_shear
        axes.plot(0, depth, "o", color=VERMILLION, markeredgecolor="white", markeredgewidth=0.7, zorder=4)
        text = f"{KPA_PER_MPA * value:.3g} kPa at {depth:.1f} mm"
        axes.annotate(text, (0, depth), (5, 0), textcoords="offset points", va="center", path_effects=_HALO)
    axes.set_xlim(left, right)
    axes.set_ylim(bottom, 0)
    axes.set_aspect("equal")
    axes.yaxis.set_major_locator(MaxNLocator(5, steps=(1, 2, 5, 10)))
    axes.grid(visible=False)
    axes.set_xlabel("along the finger (mm), fingertip →")
    axes.set_ylabel("depth (mm)")
    return filled


def _draw_bone(axes: Axes, section: ContactSection, bottom: float) -> None:
    left, right = section.along[0], section.along[-1]
    size = right - left, bottom - section.thickness
    with mpl.rc_context({"hatch.linewidth": 0.5}):
        bone = Rectangle(
            (left, section.thickness), *size, facecolor=_BONE, edgecolor=GREY, hatch="////", lw=0
        )
        axes.add_patch(bone)
    axes.axhline(section.thickness, color=BLACK, linewidth=1.0)
    axes.text(
        (left + right) / 2,
        (section.thickness + bottom) / 2,
        "bone",
        ha="center",
        va="center",
        bbox={"facecolor": _BONE, "edgecolor": "none", "pad": 1.0},
    )


@in_style()
def mark_receptors(axes: Axes, receptors: Mapping[str, tuple[float, float]], *, spacing: float) -> None:
    """Draw the middle depths of receptors as thin lines, their ranges as bars to the right of a section."""
    right, bottom = axes.get_xlim()[1], axes.get_ylim()[0]
    place = -np.inf
    for index, (name, (low, high)) in enumerate(sorted(receptors.items(), key=lambda item: item[1])):
        middle = (low + high) / 2
        if high > bottom:
            continue
        place = max(middle, place + spacing)
        beside = right + (0.3 + 0.3 * (index % 2)) * spacing
        axes.axhline(middle, color=BLACK, linewidth=0.45, linestyle=(0, (5, 3)))
        axes.plot([beside, beside], [low, high], color=BLACK, linewidth=1.6, clip_on=False)
        axes.annotate(
            name,
            (beside, middle),
            (right + 1.3 * spacing, place),
            va="center",
            fontsize=6.5,
            annotation_clip=False,
            arrowprops={"arrowstyle": "-", "lw": 0.4, "color": BLACK, "shrinkA": 0.5, "shrinkB": 0},
        )


@in_style()
def section_figure(
    field: ContactField,
    *,
    hertz: ContactField | None = None,
    receptors: Mapping[str, tuple[float, float]] | None = None,
    width_mm: float = 85.0,
    points: int = 181,
    levels: int = 61,
) -> Figure:
    """Return the section under a contact, with its pressure, receptors and bone.

    Parameters
    ----------
    field : ContactField
        The contact, in mm, N and MPa.
    hertz : ContactField, optional
        That of Hertz theory; its pressure is drawn dashed.
    receptors : mapping, optional
        Least and greatest depth of receptors by name, mm.
    width_mm : float
        Width on paper; 85 mm is one column of a journal.
    points, levels : int
        Points of the section along the finger, and in depth.

    Returns
    -------
    Figure

    Examples
    --------
    >>> from fingerpad.contact import Tissue
    >>> from fingerpad.geometry import Ellipsoid, Placement
    >>> pad = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
    >>> place = Placement(pad, wedge_angle=np.radians(30))
    >>> field = ContactField.of_hertz(place, Tissue(youngs_modulus=0.1024), load=2.0)
    >>> figure = section_figure(field, receptors={"Merkel": (0.7, 1.0)})
    >>> [axes.get_ylabel() for axes in figure.axes]
    ['pressure (kPa)', 'depth (mm)', '']
    """
    section = field.section(points=points, levels=levels)
    extent = section.along[-1] - section.along[0]
    deepest = section.depth[-1]
    if deepest == section.thickness:
        deepest += _BONE_SHOWN * extent
    inner = width_mm - _LEFT - _RIGHT
    pressure, depth = 0.3 * inner, inner * deepest / extent
    low = _FOOT + _BAR + _BAR_LABEL
    total = low + depth + _GAP + pressure + _TOP
    figure, (empty,) = new_figure(width_mm=width_mm, height_mm=total)
    empty.remove()
    figure.set_layout_engine("none")

    def box(bottom: float, height: float) -> tuple[float, float, float, float]:
        return _LEFT / width_mm, bottom / total, inner / width_mm, height / total

    upper = figure.add_axes(box(low + depth + _GAP, pressure))
    lower = figure.add_axes(box(low, depth), sharex=upper)
    bar = figure.add_axes(box(_FOOT, _BAR))
    plot_contact_pressure(upper, section, hertz=None if hertz is None else hertz.section())
    upper.yaxis.set_major_locator(MaxNLocator(3, steps=_STEPS))
    upper.tick_params(labelbottom=False)
    filled = plot_section(lower, section, highest_shear=field.highest_shear_on_axis())
    mark_receptors(lower, receptors or {}, spacing=_LABEL_GAP * extent / inner)
    figure.colorbar(filled, cax=bar, orientation="horizontal", label="maximum shear stress (kPa)")
    bar.grid(visible=False)
    return figure
