"""Tables and figures of docs/explanation/bone.md."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes

from fingerpad._arrays import FloatArray
from fingerpad.contact import Contact, Tissue, fast_contact, hertz_contact, solve_contact
from fingerpad.figures.style import BLACK, BLUE, GREY, VERMILLION, in_style, new_figure
from fingerpad.geometry import Placement
from fingerpad.published import dzidek2017, fit_tissue_thickness
from fingerpad.published.dzidek2017 import PublishedWedge

_IMAGES = Path(__file__).parents[2] / "docs" / "images"
_SOURCE = dzidek2017()
_WEDGES = _SOURCE.wedges
_COLOURS = {30: BLUE, 45: VERMILLION}


class Loading(NamedTuple):
    """What pressing pads up to a contact area shows; NaN beyond the range of the laws.

    Slopes of A against πξ with an intercept and without; the indentation at which the line with an intercept
    reaches A = 0; n of A ∝ W^n and m of W ∝ ξ^m.
    """

    slope: FloatArray
    slope_through_origin: FloatArray
    contact_shift: FloatArray
    area_exponent: FloatArray
    load_exponent: FloatArray


def loading_of(placement: Placement, tissue: Tissue, area: FloatArray, lowest: float = 0.0) -> Loading:
    """Fit 64 evenly spaced loads, above `lowest` of the one that gives the area."""
    highest = fast_contact(placement, tissue, area=area).load
    loads = np.multiply.outer(np.linspace(lowest, 1, 65)[1:], highest)
    contact = fast_contact(placement, tissue, load=loads)
    x, y = np.pi * contact.indentation, contact.area
    slope = _slope(x, y)
    return Loading(
        slope=slope,
        slope_through_origin=np.sum(x * y, axis=0) / np.sum(x * x, axis=0),
        contact_shift=(x.mean(axis=0) - y.mean(axis=0) / slope) / np.pi,
        area_exponent=_slope(np.log(loads), np.log(y)),
        load_exponent=_slope(np.log(x), np.log(loads)),
    )


def _slope(x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the slope of y on x over the first axis, by least squares."""
    deviation = x - x.mean(axis=0)
    slope: FloatArray = np.sum(deviation * y, axis=0) / np.sum(deviation**2, axis=0)
    return slope


def line(name: str, lowest: float = 0.0) -> Callable[[Placement, Tissue, FloatArray], FloatArray]:
    """Return R_g read as the slope of a line."""

    def read(placement: Placement, tissue: Tissue, area: FloatArray) -> FloatArray:
        slope: FloatArray = getattr(loading_of(placement, tissue, area, lowest), name)
        return slope

    return read


def area_over_pi_indentation(placement: Placement, tissue: Tissue, area: FloatArray) -> FloatArray:
    """Return R_g read as A/(πξ)."""
    return fast_contact(placement, tissue, area=area).area_over_pi_indentation


LINES = ("slope", "slope_through_origin")
READINGS = {"ratio": area_over_pi_indentation} | {name: line(name) for name in LINES}


def placed(method: str, wedge: PublishedWedge) -> Placement:
    """Return the printed pad on its wedge."""
    pad = _SOURCE.semi_axes[method].ellipsoid
    return Placement(pad, wedge_angle=np.radians(wedge.wedge_angle_deg))


def thicknesses() -> None:
    """Print the fitted thickness over axes, ν, reading and load range."""
    print("\naxes     ν     reading               t (mm)  95 %           χ²    t, R_g at 30° and 45° (mm)")
    for method in ("ellipse", "direct"):
        for name, reading in READINGS.items():
            for nu in (0.5, 0.48, 0.45):
                fit = fit_tissue_thickness(method=method, reading=reading, poisson_ratio=nu)
                low, high = fit.interval_mm
                print(
                    f"{method:<8} {nu:<5} {name:<21} {fit.thickness_mm:6.2f}  {low:.1f} to {high:<6.1f} "
                    f"{fit.chi_square:5.2f}   {fit.thickness_by_angle_mm.round(2)}       "
                    f"{fit.loading_radius_mm.round(2)}"
                )
    print("\nsmallest load of the line (N), and t by slope and by slope through the origin (mm)")
    for load in (0.0, 0.2, 0.5, 1.0):
        found = [fit_tissue_thickness(reading=line(name, load / 2)) for name in LINES]
        print(f"    {load:<6}", *(f"{fit.thickness_mm:.2f}" for fit in found))
    fit = fit_tissue_thickness()
    print("\nstandard uncertainty of t (mm):", f"{fit.std_mm:.2f}", fit.contribution_mm)


def solver() -> None:
    """Print R_g, E* and axis ratio on 8 mm of tissue, by the laws and by the solver on 256² cells."""
    print("\naxes     θ    A/(πξ): laws, solver      E* (kPa)  along/across: laws, solver")
    for method in ("ellipse", "direct"):
        for angle, wedge in _WEDGES.items():
            place = placed(method, wedge)
            modulus, contact = _of_printed_area(place, wedge, 8.0)
            solved = solve_contact(
                place, Tissue.of_reduced_modulus(modulus, thickness=8.0), load=wedge.load_N
            )
            ratio = solved.area_over_pi_indentation
            print(
                f"{method:<8} {angle}°  {contact.area_over_pi_indentation:.3f}, {ratio:.3f} mm        "
                f"{1e3 * modulus:6.1f}    {_along_over_across(contact):.3f}, {_along_over_across(solved):.3f}"
            )


def _of_printed_area(place: Placement, wedge: PublishedWedge, thickness: float) -> tuple[float, Contact]:
    """Return E* with which the printed load gives the printed area, and the contact."""
    tissue = Tissue.of_reduced_modulus(1.0, thickness=thickness)
    contact = fast_contact(place, tissue, area=wedge.area_mm2.value)
    return float(wedge.load_N / contact.load), contact


def _along_over_across(contact: Contact) -> float:
    return float(contact.aspect_ratio if contact.along else 1 / contact.aspect_ratio)


def consequences() -> None:
    """Print what follows from the fitted thickness without another fit."""
    thickness = fit_tissue_thickness().thickness_mm
    moduli = {}
    for name, depth in (("half-space", np.inf), (f"{thickness:.1f} mm", thickness)):
        for angle, wedge in _WEDGES.items():
            place = placed("ellipse", wedge)
            moduli[name, angle], contact = _of_printed_area(place, wedge, depth)
            loading = loading_of(place, Tissue(1.0, thickness=depth), np.array(wedge.area_mm2.value))
            print(
                f"\n{name}, {angle}°: R_g {contact.area_over_pi_indentation:.2f}, {loading.slope:.2f}, "
                f"{loading.slope_through_origin:.2f} mm; E* {1e3 * moduli[name, angle]:.1f} kPa; "
                f"A ~ W^{loading.area_exponent:.3f}, W ~ ξ^{loading.load_exponent:.3f}; "
                f"shift {loading.contact_shift:.3f} mm; along/across {_along_over_across(contact):.3f}",
                end="",
            )
    tissue = Tissue.of_reduced_modulus(moduli[name, 30], thickness=thickness)
    contact = fast_contact(placed("ellipse", _WEDGES[45]), tissue, load=2.0)
    print(f"\narea at 45° and 2 N with E* of 30°: {contact.area:.1f} mm²")
    for angle, wedge in _WEDGES.items():
        indentation = wedge.area_mm2.value / (np.pi * wedge.measured_radius_mm.value)
        placement = placed("ellipse", wedge)
        shifted = []
        for error in (-0.1, 0.1):
            radius = wedge.area_mm2.value / (np.pi * (indentation + error))
            depths = np.linspace(4, 14, 1001)
            pressed = fast_contact(placement, Tissue(1.0, thickness=depths), area=wedge.area_mm2.value)
            ratio = pressed.area_over_pi_indentation
            shifted.append(float(np.interp(-radius, -ratio, depths)))
        print(f"{angle}°: t with ξ wrong by ∓0.1 mm: {shifted[0]:.1f}, {shifted[1]:.1f} mm")


@in_style
def radius_against_thickness() -> None:
    """Draw R_g against the thickness for both angles, with the measured R_g as bands."""
    figure, (axes,) = new_figure(width_mm=125, height_mm=82)
    depths = np.linspace(3, 16, 200)
    fit = fit_tissue_thickness()
    axes.axvspan(*fit.interval_mm, color="#eeeeee", lw=0, zorder=0)
    axes.axvline(fit.thickness_mm, color=GREY, lw=0.8, zorder=1)
    for angle, wedge in _WEDGES.items():
        colour, measured = _COLOURS[angle], wedge.measured_radius_mm.value
        std = wedge.pooled_uncertainty_mm.value
        axes.axhspan(measured - std, measured + std, color=colour, alpha=0.13, lw=0)
        axes.axhline(measured, color=colour, lw=0.8, ls=(0, (1, 1.5)))
        axes.text(3.15, measured - 0.15, f"measured $R_g$, {angle}°", color=colour, va="top")
        for method, dashes in (("ellipse", "-"), ("direct", (0, (4, 2)))):
            place, area = placed(method, wedge), np.array(wedge.area_mm2.value)
            ratio = area_over_pi_indentation(place, Tissue(1.0, thickness=depths), area)
            axes.plot(depths, ratio, color=colour, ls=dashes)
            if method == "ellipse":
                axes.text(14, ratio[-40] + 0.5, f"θ = {angle}°", color=colour, weight="bold", ha="center")
            axes.plot(
                [16.6, 17.6],
                [area_over_pi_indentation(place, Tissue(1.0), area)] * 2,
                color=colour,
                ls=dashes,
                clip_on=False,
            )
    axes.plot([], [], color=BLACK, label="semi-axes by fitted ellipses")
    axes.plot([], [], color=BLACK, ls=(0, (4, 2)), label="semi-axes measured directly")
    axes.legend(loc="upper right")
    axes.text(
        fit.thickness_mm + 0.12,
        27.7,
        f"t = {fit.thickness_mm:.1f} mm\n({fit.interval_mm[0]:.1f} to {fit.interval_mm[1]:.1f})",
        va="top",
    )
    axes.axvline(16.3, color="white", lw=3.5, zorder=4)
    axes.set(
        xlim=(3, 17.6),
        ylim=(8, 28),
        xlabel="thickness t of the tissue (mm); ∞: half-space",
        ylabel="A/(πξ) at 2 N (mm)",
        yticks=range(8, 29, 4),
    )
    axes.set_xticks([*range(4, 17, 2), 17.1], [*map(str, range(4, 17, 2)), "∞"])
    figure.savefig(_IMAGES / "bone_thickness.png", dpi=200, metadata={"Software": None})


@in_style
def area_against_indentation() -> None:
    """Draw A against πξ at both angles: Hertz theory, half-space, layer, and the measured slope."""
    figure, panels = new_figure(width_mm=170, height_mm=82, columns=2)
    for axes, (angle, wedge) in zip(panels, _WEDGES.items(), strict=True):
        _area_panel(axes, angle, wedge)
    figure.set_layout_engine("constrained", wspace=0.08)
    figure.savefig(_IMAGES / "bone_area.png", dpi=200, metadata={"Software": None})


def _area_panel(axes: Axes, angle: int, wedge: PublishedWedge) -> None:
    placement, colour = placed("ellipse", wedge), _COLOURS[angle]
    last, thickness = wedge.area_mm2.value, fit_tissue_thickness().thickness_mm
    area = np.linspace(0, last, 200)[1:]

    def whole_pad(depth: float) -> FloatArray:
        return np.pi * fast_contact(placement, Tissue(1.0, thickness=depth), area=area).indentation

    paraboloid = np.pi * hertz_contact(placement, Tissue(1.0), area=area).indentation
    measured, std = wedge.measured_radius_mm.value, wedge.pooled_uncertainty_mm.value
    far = np.array([0, 1.15 * last / measured])
    axes.fill_between(far, far * (measured - std), far * (measured + std), color=BLACK, alpha=0.1, lw=0)
    axes.plot(
        far, far * measured, color=BLACK, ls=(0, (1, 1.5)), label=f"slope $R_g$ = {measured} mm, measured"
    )
    axes.plot(paraboloid, area, color=GREY, ls=(0, (4, 2)), label="Hertz theory")
    axes.plot(whole_pad(np.inf), area, color=GREY, label="whole pad, half-space")
    axes.plot(
        whole_pad(thickness), area, color=colour, lw=1.8, label=f"whole pad, {thickness:.1f} mm on bone"
    )
    axes.plot(
        whole_pad(thickness)[-1],
        last,
        "o",
        color=colour,
        mfc="white",
        ms=5,
        label="printed area, 2 N",
        ls="none",
    )
    axes.set(
        xlim=(0, 1.02 * whole_pad(np.inf)[-1]),
        ylim=(0, 1.18 * last),
        xlabel="πξ (mm)",
        ylabel="contact area A (mm²)",
        title=f"θ = {angle}°",
    )
    axes.legend(loc="lower right")


def report() -> None:
    """Print all tables."""
    thicknesses()
    solver()
    consequences()
    radius_against_thickness()
    area_against_indentation()
