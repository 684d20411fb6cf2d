"""The figures of a study's report, one set for each finger and placement."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from fingerpad._arrays import FloatArray
from fingerpad.contact import HertzGeometry
from fingerpad.figures import (
    new_figure,
    plot_area_against_load,
    plot_aspect_ratio,
    plot_contact_compliance,
    plot_corrected_radius,
    plot_load_indentation,
    plot_pad_with_contact,
)
from fingerpad.geometry import Ellipse, Ellipsoid, Placement
from fingerpad.study.pipeline import StudyResult
from fingerpad.study.summary import CurveResult, Summary, area_exponent, curve_of


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Plot:
    """A drawn figure.

    Attributes
    ----------
    name : str
        File name without suffix.
    figure : Figure
        The drawing.
    caption : str
        What is seen.
    """

    name: str
    figure: Figure
    caption: str


def group_name(finger: str, wedge_angle_deg: float, roll_angle_deg: float, *, synthetic: bool) -> str:
    """Return the file name of a group of rows, which no other group has."""
    roll = f"_roll{roll_angle_deg!r}" if roll_angle_deg else ""
    return f"{finger}_{wedge_angle_deg!r}deg{roll}".replace(".0deg", "deg") + (
        "_synthetic" if synthetic else ""
    )


def summary_plots(result: StudyResult, summary: Summary) -> Iterator[Plot]:
    """Draw one finger at one placement."""
    name = group_name(
        summary.finger, summary.wedge_angle_deg, summary.roll_angle_deg, synthetic=summary.synthetic
    )
    label = "; synthetic" if summary.synthetic else ""
    where = f"{summary.finger}, wedge {summary.wedge_angle_deg:g}°{label}"
    yield Plot(
        name=f"{name}_pad",
        figure=_pad(result, summary),
        caption=(
            f"The pad seen through the platen ({where}; grey: not pad), and the contact "
            f"{summary.rows[-1]['observation']} drawn flat. Hertz theory gives the shape only."
            + (
                ""
                if summary.rows[-1]["long_axis"]
                else " The measured ellipse has no direction and is not drawn."
            )
        ),
    )
    yield Plot(
        name=f"{name}_corrected_radius",
        figure=_corrected_radius(summary, curve_of(result.curves, summary)),
        caption=(
            f"Corrected radius against load ({where}); bars: one standard uncertainty with the pad's "
            "geometry held exact, as the source does. Dotted: undeformed pad. Dashed: loading data, if any."
        ),
    )
    if len({row["load_N"] for row in summary.rows}) > 1:
        yield Plot(
            name=f"{name}_area",
            figure=_area(summary),
            caption=f"Contact area against load, with the fitted exponent and that of Hertz ({where}).",
        )
    if any(row["long_axis"] for row in summary.rows):
        yield Plot(
            name=f"{name}_aspect_ratio",
            figure=_aspect_ratio(summary),
            caption=f"Aspect ratio and direction of the long axis, measured and predicted ({where}).",
        )


def curve_plots(curve: CurveResult, number: int) -> Iterator[Plot]:
    """Draw one loading curve."""
    if curve.curve is None or curve.fit is None or curve.curve.area is None:
        return
    data, area, fit = curve.curve, curve.curve.area, curve.fit
    synthetic = np.full(data.load.shape, curve.manifest.synthetic)
    of = curve.manifest
    name = f"curve{number}_{group_name(of.finger, of.wedge_angle_deg, 0.0, synthetic=of.synthetic)}"
    where = f"{curve.name}{'; synthetic' if curve.manifest.synthetic else ''}"
    figure, (axes,) = new_figure()
    plot_contact_compliance(
        axes,
        data.indentation,
        area,
        effective_radius=fit.effective_radius,
        effective_radius_std=fit.effective_radius_std,
        area_at_zero=fit.area_at_zero,
        synthetic=synthetic,
    )
    yield Plot(
        name=f"{name}_compliance",
        figure=figure,
        caption=f"Contact area against π × indentation; its slope is the effective radius ({where}).",
    )
    figure, (axes,) = new_figure()
    plot_load_indentation(axes, data.indentation, data.load, synthetic=synthetic)
    yield Plot(
        name=f"{name}_load_indentation",
        figure=figure,
        caption=f"Load against displacement, from the instrument's own zero ({where}).",
    )


def _column(summary: Summary, name: str) -> FloatArray:
    return np.array([np.nan if row[name] is None else row[name] for row in summary.rows], dtype=float)


def _pad(result: StudyResult, summary: Summary) -> Figure:
    row = summary.rows[-1]
    pad = Ellipsoid.of(*result.fingers[summary.finger].semi_axes)
    wedge, roll = np.radians([summary.wedge_angle_deg, summary.roll_angle_deg])
    radii = Placement.of(pad, wedge_angle=wedge, roll_angle=roll).curvature.principal_radii
    area = np.pi * row["semi_major_mm"] * row["semi_minor_mm"]
    predicted = HertzGeometry.of(radii[0], radii[1]).at_area(area, reduced_modulus=1.0).ellipse
    measured = Ellipse.of(row["semi_major_mm"], row["semi_minor_mm"]) if row["long_axis"] else None
    angle = (
        row["orientation_deg"]
        if row["orientation_deg"] is not None
        else 90.0 * (row["long_axis"] == "across")
    )
    figure, (axes,) = new_figure(height_mm=95)
    plot_pad_with_contact(
        axes,
        pad,
        wedge_angle=float(wedge),
        roll_angle=float(roll),
        predicted=predicted,
        measured=measured,
        measured_long_axis_angle=float(np.radians(angle)),
        synthetic=summary.synthetic,
    )
    return figure


def _corrected_radius(summary: Summary, curve: CurveResult | None) -> Figure:
    figure, (axes,) = new_figure()
    plot_corrected_radius(
        axes,
        _column(summary, "load_N"),
        _column(summary, "radius_from_indentation_mm"),
        corrected_radius_std=_column(summary, "radius_from_indentation_mm_std_given_geometry"),
        compliance_radius=_column(summary, "radius_from_compliance_mm"),
        measured_radius=None if curve is None else curve.effective_radius,
        mean_curvature_radius=summary.rows[0]["mean_curvature_radius_mm"],
        synthetic=np.full(len(summary.rows), summary.synthetic),
    )
    return figure


def _area(summary: Summary) -> Figure:
    figure, (axes,) = new_figure()
    major, minor = _column(summary, "semi_major_mm"), _column(summary, "semi_minor_mm")
    plot_area_against_load(
        axes,
        _column(summary, "load_N"),
        np.pi * major * minor,
        area_std=_column(summary, "gross_area_mm2_std"),
        exponent=area_exponent(summary),
        synthetic=np.full(len(summary.rows), summary.synthetic),
    )
    return figure


def _aspect_ratio(summary: Summary) -> Figure:
    figure, (axes,) = new_figure()
    ratio = _column(summary, "aspect_ratio")
    relative = [
        _column(summary, f"semi_{axis}_mm_std") / _column(summary, f"semi_{axis}_mm")
        for axis in ("major", "minor")
    ]
    across = np.array([90.0 if row["long_axis"] == "across" else 0.0 for row in summary.rows])
    orientation = _column(summary, "orientation_deg")
    first = summary.rows[0]
    plot_aspect_ratio(
        axes,
        _column(summary, "load_N"),
        ratio,
        aspect_ratio_std=ratio * np.hypot(*relative),
        long_axis_angle=np.radians(np.where(np.isfinite(orientation), orientation, across)),
        predicted_aspect_ratio=first["predicted_aspect_ratio"],
        predicted_long_axis_angle=np.pi / 2 if first["predicted_long_axis"] == "across" else 0.0,
        synthetic=np.full(len(summary.rows), summary.synthetic),
    )
    return figure
