"""Figures of docs/reference/validation.md and docs/explanation/bone.md: ``python -m benchmarks.figures``."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from benchmarks import ROOT
from benchmarks.arrays import Array
from benchmarks.claims.fast_laws import SERIES, Circles, silhouette_radius
from benchmarks.claims.tissue_thickness import READINGS, WEDGES, placed
from benchmarks.derive.solved_contacts import AREA_BIAS, KEPT, kept_contacts, kept_pads
from fingerpad.contact import Tissue, fast_contact, hertz_contact
from fingerpad.figures.style import BLACK, BLUE, GREEN, GREY, VERMILLION, in_style, new_figure
from fingerpad.published import fit_tissue_thickness
from fingerpad.published.dzidek2017 import PublishedWedge

_COLOURS = {0.5: BLUE, 0.3: VERMILLION}  # by ν
_OF_ANGLE = {30: BLUE, 45: VERMILLION}
_SOLVED = np.array([0.05, 0.1, 0.2, 0.35, 0.6, 1.0, 1.7, 3.0])
_LINES = np.geomspace(0.03, 3.0, 300)
_LIMIT = 0.005
_SYMBOLS = {"load": "W", "area": "A", "indentation": "ξ"}
_GIVEN_WANTED = ("load", "area"), ("load", "indentation"), ("indentation", "load")


@in_style()
def layer() -> None:
    """Draw what a layer changes of a circular contact, and the errors of each way to calculate it."""
    figure, panels = new_figure(width_mm=180, height_mm=125, rows=2, columns=3)
    above, below = panels[:3], panels[3:]
    for nu, colour in _COLOURS.items():
        exact, points = Circles(_LINES, nu), Circles(_SOLVED, nu)
        solved, load = points.solved("load"), points.solved("indentation").load / points.load
        by_solver = solved.area / points.area, solved.indentation / points.indentation, load
        lines = exact.area_ratio, exact.load_at_depth, exact.load_at_area
        for axes, line in zip(above, lines, strict=True):
            axes.plot(_LINES, line, color=colour, label=f"exact, ν = {nu:g}")
        fast, by_depth = exact.pressed(fast_contact, "load"), exact.pressed(fast_contact, "indentation")
        hertz = exact.pressed(hertz_contact, "load")
        by_hertz = hertz.area / exact.area, hertz.indentation / exact.indentation, 1 / exact.load_at_depth
        by_law = fast.area / exact.area, fast.indentation / exact.indentation, by_depth.load / exact.load
        for axes, ours, law, theirs in zip(below, by_solver, by_law, by_hertz, strict=True):
            axes.plot(_LINES, np.abs(theirs - 1), color=colour, ls=(0, (4, 2)))
            axes.plot(_LINES, np.abs(law - 1), color=colour)
            axes.plot(_SOLVED, np.abs(ours - 1), color=colour, ls="", marker="o", ms=3.5)
    exact = Circles(_LINES, 0.5)
    for name, dashes in zip(SERIES, ((0, (1, 1.5)), (0, (3, 1.5, 1, 1.5))), strict=True):
        found = exact.series(name)
        above[1].plot(_LINES, found, color=BLACK, lw=0.9, ls=dashes, label=name)
        below[2].plot(_LINES, np.abs(found / exact.load_at_depth - 1), color=BLACK, lw=0.9, ls=dashes)
    for limit, nu in ((4, 0.5), (2, 0.3)):
        above[0].axhline(limit, color=_COLOURS[nu], lw=0.8, ls=(0, (1, 1.5)))
        above[0].text(0.033, limit - 0.04, f"thin layer, ν {'=' if nu == 0.5 else '<'} 0.5", va="top")
    ratios = "A/(πRξ)", "W/W$_{Hertz}$ at the same ξ", "W/W$_{Hertz}$ at the same A"
    errors = "A at given W", "ξ at given W", "W at given ξ"
    for axes, title in zip(panels, ratios + errors, strict=True):
        axes.set(xscale="log", xlim=(0.03, 3), title=title)
        axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.xaxis.set_minor_locator(NullLocator())
    for axes in above:
        axes.axhline(1, color=GREY, lw=0.8, ls=(0, (4, 2)))
    above[0].set(ylim=(0.9, 4.2))
    ticks = [1, 2, 5, 10, 20]
    for axes in above[1:]:
        axes.set(yscale="log", yticks=ticks, ylim=(0.9, 20), yticklabels=map(str, ticks))
    for axes in below:
        _error_axes(axes)
        axes.set_xlabel("contact radius over thickness, a/t")
    above[1].legend(loc="upper left")
    below[0].set_ylabel("relative error")
    below[0].plot([], [], color=BLACK, ls=(0, (4, 2)), label="Hertz theory")
    below[0].plot([], [], color=BLACK, label="fast law")
    below[0].plot([], [], color=BLACK, ls="", marker="o", ms=3.5, label="solver, 256² cells")
    below[0].legend(loc="upper left")
    _save(figure, "validation_layer.png")


@in_style()
def pads() -> None:
    """Draw the errors of Hertz theory and of the laws for whole pads that nothing was fitted to."""
    figure, panels = new_figure(width_mm=180, height_mm=120, rows=2, columns=3)
    kept = np.load(KEPT)
    for row, name in zip((panels[:3], panels[3:]), ("pads_held_out", "layered_held_out"), strict=True):
        data = kept[name]
        placement, tissue = kept_contacts(data, is_pad=True)
        values = {"load": data[:, -5], "area": data[:, -4] / AREA_BIAS, "indentation": data[:, -3]}
        on_layer = not tissue.is_deep
        largest = tissue.thickness if on_layer else silhouette_radius(kept_pads(data))
        size = np.sqrt(values["area"] / np.pi) / largest
        for axes, (given, wanted) in zip(row, _GIVEN_WANTED, strict=True):
            fast = fast_contact(placement, tissue, **{given: values[given]})
            hertz = hertz_contact(placement, tissue, **{given: values[given]})
            inside = fast.flag_code == 0
            for found, colour, words in ((hertz, GREY, "Hertz theory"), (fast, GREEN, "fast law")):
                error = np.abs(getattr(found, wanted) / values[wanted] - 1)
                axes.plot(size[inside], error[inside], color=colour, ls="", marker=".", ms=3.5, label=words)
            _error_axes(axes)
            axes.set_title(f"{_SYMBOLS[wanted]} at given {_SYMBOLS[given]}")
            axes.set_xlabel("a/t" if on_layer else "a over mean radius of silhouette")
            axes.set_xlim(0, 3.1 if on_layer else 0.62)
        row[0].set_ylabel(("on a layer" if on_layer else "on a half-space") + "\nrelative error")
    panels[0].legend(loc="upper left", markerscale=2)
    _save(figure, "validation_pads.png")


def _error_axes(axes: Axes) -> None:
    axes.axhline(_LIMIT, color=BLACK, lw=0.5)
    axes.text(1, _LIMIT, "0.5 %", va="center", transform=axes.get_yaxis_transform())
    axes.set(yscale="log", ylim=(1e-7, 10), yticks=[1e-6, 1e-4, 1e-2, 1])
    axes.yaxis.set_minor_locator(NullLocator())


def _save(figure: Figure, name: str) -> None:
    figure.savefig(ROOT / "docs" / "images" / name, dpi=200, metadata={"Software": None})


@in_style()
def radius_against_thickness() -> None:
    """Draw R_g against the thickness for both angles, with the measured R_g as bands."""
    figure, (axes,) = new_figure(width_mm=125, height_mm=82)
    depths = np.linspace(3, 16, 200)
    fit = fit_tissue_thickness()
    axes.axvspan(*fit.interval_mm, color="#eeeeee", lw=0, zorder=0)
    axes.axvline(fit.thickness_mm, color=GREY, lw=0.8, zorder=1)
    for angle, wedge in WEDGES.items():
        colour, measured = _OF_ANGLE[angle], wedge.measured_radius_mm.value
        std = wedge.pooled_uncertainty_mm.value
        axes.axhspan(measured - std, measured + std, color=colour, alpha=0.13, lw=0)
        axes.axhline(measured, color=colour, lw=0.8, ls=(0, (1, 1.5)))
        axes.text(3.15, measured - 0.15, f"measured $R_g$, {angle}°", color=colour, va="top")
        for method, dashes in (("ellipse", "-"), ("direct", (0, (4, 2)))):
            place, area = placed(method, wedge), np.array(wedge.area_mm2.value)
            ratio = READINGS["ratio"](place, Tissue(1.0, thickness=depths), area)
            axes.plot(depths, ratio, color=colour, ls=dashes)
            if method == "ellipse":
                axes.text(14, ratio[-40] + 0.5, f"θ = {angle}°", color=colour, weight="bold", ha="center")
            deep = READINGS["ratio"](place, Tissue(1.0), area)
            axes.plot([16.6, 17.6], [deep, deep], color=colour, ls=dashes, clip_on=False)
    axes.plot([], [], color=BLACK, label="semi-axes by fitted ellipses")
    axes.plot([], [], color=BLACK, ls=(0, (4, 2)), label="semi-axes measured directly")
    axes.legend(loc="upper right")
    low, high = fit.interval_mm
    words = f"t = {fit.thickness_mm:.1f} mm\n({low:.1f} to {high:.1f})"
    axes.text(fit.thickness_mm + 0.12, 27.7, words, va="top")
    axes.axvline(16.3, color="white", lw=3.5, zorder=4)
    axes.set(xlim=(3, 17.6), ylim=(8, 28), ylabel="A/(πξ) at 2 N (mm)", yticks=range(8, 29, 4))
    axes.set_xlabel("thickness t of the tissue (mm); ∞: half-space")
    axes.set_xticks([*range(4, 17, 2), 17.1], [*map(str, range(4, 17, 2)), "∞"])
    _save(figure, "bone_thickness.png")


@in_style()
def area_against_indentation() -> None:
    """Draw A against πξ at both angles: Hertz theory, half-space, layer, and the measured slope."""
    figure, panels = new_figure(width_mm=170, height_mm=82, columns=2)
    for axes, (angle, wedge) in zip(panels, WEDGES.items(), strict=True):
        _area_panel(axes, angle, wedge)
    figure.set_layout_engine("constrained", wspace=0.08)
    _save(figure, "bone_area.png")


def _area_panel(axes: Axes, angle: int, wedge: PublishedWedge) -> None:
    placement, colour = placed("ellipse", wedge), _OF_ANGLE[angle]
    last, thickness = wedge.area_mm2.value, fit_tissue_thickness().thickness_mm
    area = np.linspace(0, last, 200)[1:]

    def whole_pad(depth: float) -> Array:
        return np.pi * fast_contact(placement, Tissue(1.0, thickness=depth), area=area).indentation

    paraboloid = np.pi * hertz_contact(placement, Tissue(1.0), area=area).indentation
    measured, std = wedge.measured_radius_mm.value, wedge.pooled_uncertainty_mm.value
    far = np.array([0, 1.15 * last / measured])
    axes.fill_between(far, far * (measured - std), far * (measured + std), color=BLACK, alpha=0.1, lw=0)
    words = f"slope $R_g$ = {measured} mm, measured"
    axes.plot(far, far * measured, color=BLACK, ls=(0, (1, 1.5)), label=words)
    axes.plot(paraboloid, area, color=GREY, ls=(0, (4, 2)), label="Hertz theory")
    axes.plot(whole_pad(np.inf), area, color=GREY, label="whole pad, half-space")
    on_bone = whole_pad(thickness)
    axes.plot(on_bone, area, color=colour, lw=1.8, label=f"whole pad, {thickness:.1f} mm on bone")
    axes.plot(on_bone[-1], last, "o", color=colour, mfc="white", ms=5, label="printed area, 2 N", ls="none")
    axes.set(xlim=(0, 1.02 * whole_pad(np.inf)[-1]), ylim=(0, 1.18 * last), title=f"θ = {angle}°")
    axes.set(xlabel="πξ (mm)", ylabel="contact area A (mm²)")
    axes.legend(loc="lower right")


if __name__ == "__main__":
    layer()
    pads()
    radius_against_thickness()
    area_against_indentation()
