"""The section under a contact: pressure above, shear stress in the tissue, receptors and bone."""

from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Final

import matplotlib as mpl
import numpy as np
from contourpy import FillType, contour_generator
from matplotlib.colors import to_hex
from matplotlib.ticker import MaxNLocator

from fingerpad._arrays import FloatArray
from fingerpad.contact import ContactField, ContactSection
from fingerpad.figures.marks import Axis, Band, Figure, Line, Panel, Points, Rule, Text, new_panels
from fingerpad.figures.mpl import on_axes
from fingerpad.figures.style import BLUE, GREY, VERMILLION
from fingerpad.units import KPA_PER_MPA

_LEVELS: Final = MaxNLocator(16, steps=(1, 2, 2.5, 5, 10))
_COLOURS: Final = "YlOrBr"
_BONE: Final = "#ece7dc"
_BONE_SHOWN: Final = 0.09  # of the section's width
_HATCH: Final = 36  # lines over the section's width
_LABEL_GAP: Final = 2.8  # mm on paper between the labels of receptors
# Room beside, above and between the axes, and height of the colour bar and of its label, mm on paper.
_LEFT, _RIGHT, _TOP, _GAP, _FOOT, _BAR, _BAR_LABEL = 11.0, 17.5, 5.0, 2.5, 9.5, 2.6, 10.0


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


@on_axes
def plot_section(
    axes: Panel, section: ContactSection, *, highest_shear: tuple[float, float] | None = None
) -> None:
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
    >>> axes = plot_section(plt.figure().subplots(), field.section())
    >>> axes.get_ylabel()
    'depth (mm)'
    """
    shear = KPA_PER_MPA * section.maximum_shear
    contours = contour_generator(section.along, section.depth, shear, fill_type=FillType.OuterOffset)
    for low, _, colour in _steps(section):
        # All that is above a level, with the next level upon it: between two areas side by side is a gap.
        outlines = [
            part
            for points, offsets in zip(*contours.filled(low, np.inf), strict=True)
            for part in np.split(points, offsets[1:-1])
        ]
        label = f"_above {low:g} kPa"
        axes.add(Line(*_joined(outlines), face=colour, width=0.25, alpha=0.5, label=label))
    left, right, bottom = float(section.along[0]), float(section.along[-1]), float(section.depth[-1])
    if bottom == section.thickness:
        bottom += _BONE_SHOWN * (right - left)
        axes.add(*_bone(left, right, section.thickness, bottom))
    touching = section.along[section.pressure > 0]
    if touching.size:
        axes.add(Line(touching[[0, -1]], 0.0, colour=BLUE, width=3, clipped=False))
    axes.add(Line([0, 0], [0, section.depth[-1]], width=0.6, dash="-."))
    if highest_shear is not None:
        value, depth = highest_shear
        text = f"{KPA_PER_MPA * value:.3g} kPa at {depth:.1f} mm"
        axes.add(
            Points(0.0, depth, colour=VERMILLION, edge="white", edge_width=0.7),
            Text(text, 0, depth, right=5, vertical="center", halo="white"),
        )
    axes.x = Axis("along the finger (mm), fingertip →", low=left, high=right)
    axes.y = Axis("depth (mm)", low=bottom, high=0.0)
    axes.equal = True


def _steps(section: ContactSection) -> list[tuple[float, float, str]]:
    """Return levels of shear stress, kPa, from one to the next, with their colours."""
    levels = [*_LEVELS.tick_values(0, KPA_PER_MPA * float(np.nanmax(section.maximum_shear)))]
    middles = (np.arange(len(levels) - 1) + 0.5) / (len(levels) - 1)
    colours = map(to_hex, mpl.colormaps[_COLOURS](middles))
    return [(low, high, colour) for (low, high), colour in zip(pairwise(levels), colours, strict=True)]


def _joined(lines: list[FloatArray]) -> FloatArray:
    """Return the coordinates of lines as those of one, with gaps."""
    gap = np.full((1, 2), np.nan)
    return np.concatenate([part for line in lines for part in (line, gap)]).T


def _bone(left: float, right: float, top: float, bottom: float) -> list[Line | Rule | Text]:
    """Return the bone, hatched and named, under its upper edge."""
    starts = np.arange(left - (bottom - top), right, (right - left) / _HATCH)
    hatch = [np.array([(start, bottom), (start + bottom - top, top)]) for start in starts]
    middle = (left + right) / 2, (top + bottom) / 2
    return [
        Rule("y", top, bottom, colour=_BONE),
        Line(*_joined(hatch), colour=GREY, width=0.5),
        Line([left, right], top, width=1.0),
        Text("bone", *middle, horizontal="center", vertical="center", halo=_BONE),
    ]


@on_axes
def mark_receptors(axes: Panel, receptors: Mapping[str, tuple[float, float]], *, spacing: float) -> None:
    """Draw the middle depths of receptors as thin lines, their ranges as bars to the right of a section."""
    right, bottom = axes.limits("x")[1], axes.limits("y")[0]
    place = -np.inf
    for index, (name, (low, high)) in enumerate(sorted(receptors.items(), key=lambda item: item[1])):
        middle = (low + high) / 2
        if high > bottom:
            continue
        place = max(middle, place + spacing)
        beside, words = right + (0.3 + 0.3 * (index % 2)) * spacing, right + 1.3 * spacing
        axes.add(
            Rule("y", middle, width=0.45, dash="--"),
            Line([beside, beside], [low, high], width=1.6, clipped=False),
            Line([beside, words], [middle, place], width=0.4, clipped=False),
            Text(name, words, place, right=2, vertical="center", size=6.5),
        )


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
        As data, which `save_figure` writes.

    Examples
    --------
    >>> from fingerpad.contact import Tissue
    >>> from fingerpad.geometry import Ellipsoid, Placement
    >>> pad = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
    >>> place = Placement(pad, wedge_angle=np.radians(30))
    >>> field = ContactField.of_hertz(place, Tissue(youngs_modulus=0.1024), load=2.0)
    >>> figure = section_figure(field, receptors={"Merkel": (0.7, 1.0)})
    >>> [panel.y.label for panel in figure.panels]
    ['pressure (kPa)', 'depth (mm)', '']
    """
    section = field.section(points=points, levels=levels)
    extent, deepest = float(np.ptp(section.along)), float(section.depth[-1])
    if deepest == section.thickness:
        deepest += _BONE_SHOWN * extent
    inner = width_mm - _LEFT - _RIGHT
    pressure, depth = 0.3 * inner, inner * deepest / extent
    low = _FOOT + _BAR + _BAR_LABEL
    total = low + depth + _GAP + pressure + _TOP
    figure, (upper, lower, bar) = new_panels(width_mm=width_mm, height_mm=total, rows=3)
    for panel, bottom, height in (
        (upper, low + depth + _GAP, pressure),
        (lower, low, depth),
        (bar, _FOOT, _BAR),
    ):
        panel.place = _LEFT / width_mm, bottom / total, inner / width_mm, height / total
    plot_contact_pressure(upper, section, hertz=None if hertz is None else hertz.section())
    plot_section(lower, section, highest_shear=field.highest_shear_on_axis())
    upper.x = replace(lower.x, label="", names=())
    mark_receptors(lower, receptors or {}, spacing=_LABEL_GAP * extent / inner)
    steps = _steps(section)
    bar.add(*(Rule("x", low, high, colour=colour) for low, high, colour in steps))
    highest = steps[-1][1]
    bar.add(Line([0, highest, highest, 0, 0], [0, 0, 1, 1, 0], width=0.6, clipped=False))
    bar.x = Axis("maximum shear stress (kPa)", low=0.0, high=highest)
    bar.y = Axis(low=0.0, high=1.0, ticks=())
    return figure
