"""Figures of docs/reference/validation.md."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from benchmarks.claims.fast_laws import kept_contacts
from benchmarks.derive.solved_contacts import AREA_BIAS, KEPT, circular_contacts
from fingerpad._arrays import FloatArray
from fingerpad.contact import SolvedContact, Tissue, fast_contact, hertz_contact, solve_contact
from fingerpad.figures.style import BLACK, BLUE, GREEN, GREY, VERMILLION, in_style, new_figure
from fingerpad.geometry import Paraboloid

_IMAGES = Path(__file__).parents[2] / "docs" / "images"
_RADIUS, _MODULUS = 10.0, 0.1
_BALL = Paraboloid(_RADIUS, _RADIUS)
_COLOURS = {0.5: BLUE, 0.3: VERMILLION}
_SOLVED = np.array([0.05, 0.1, 0.2, 0.35, 0.6, 1.0, 1.7, 3.0])
_LINES = np.geomspace(0.03, 3.0, 300)
_LIMIT = 0.005
_SYMBOLS = {"load": "W", "area": "A", "indentation": "ξ"}
_GIVEN_WANTED = ("load", "area"), ("load", "indentation"), ("indentation", "load")
# Powers of √(Rξ)/t in W/W_Hertz at one ξ, ν = 0.5.
_SERIES = {
    "García 2018": (1, 1.133, 1.497, 1.469, 0.755),
    "Dimitriadis 2002": (1, 1.133, 1.283, 0.769, 0.0975),
}


class Circles:
    """Circular contacts of a paraboloid on a bonded layer of thickness 1, by the integral equation."""

    def __init__(self, sizes: FloatArray, poisson_ratio: float) -> None:
        load, depth, _ = circular_contacts(sizes, poisson_ratio).T
        self.tissue = Tissue.of_reduced_modulus(_MODULUS, poisson_ratio, thickness=1.0)
        self.area, self.indentation = np.pi * sizes**2, sizes**2 / _RADIUS * depth
        self.load = 4 / 3 * _MODULUS * sizes**3 / _RADIUS * load
        self.area_ratio, self.load_at_area, self.load_at_depth = 1 / depth, load, load / depth**1.5

    def series(self, name: str) -> FloatArray:
        """Return W/W_Hertz at the same ξ by a published series."""
        ratio: FloatArray = np.polynomial.polynomial.polyval(
            np.sqrt(_RADIUS * self.indentation), _SERIES[name]
        )
        return ratio

    def solved(self, *, at_load: bool) -> list[SolvedContact]:
        """Solve the same contacts on 256² cells, by their loads or their indentations."""
        given, values = ("load", self.load) if at_load else ("indentation", self.indentation)
        return [solve_contact(_BALL, self.tissue, **{given: value}) for value in values.tolist()]


@in_style
def layer() -> None:
    """Draw what a layer changes of a circular contact, and the errors of each way to calculate it."""
    figure, panels = new_figure(width_mm=180, height_mm=125, rows=2, columns=3)
    above, below = panels[:3], panels[3:]
    for nu, colour in _COLOURS.items():
        exact, points = Circles(_LINES, nu), Circles(_SOLVED, nu)
        at_load, at_depth = points.solved(at_load=True), points.solved(at_load=False)
        for axes, line in zip(
            above, (exact.area_ratio, exact.load_at_depth, exact.load_at_area), strict=True
        ):
            axes.plot(_LINES, line, color=colour, label=f"exact, ν = {nu:g}")
        fast = fast_contact(_BALL, exact.tissue, load=exact.load)
        by_depth = fast_contact(_BALL, exact.tissue, indentation=exact.indentation)
        hertz = hertz_contact(_BALL, exact.tissue, load=exact.load)
        by_hertz = hertz.area / exact.area, hertz.indentation / exact.indentation, 1 / exact.load_at_depth
        by_law = fast.area / exact.area, fast.indentation / exact.indentation, by_depth.load / exact.load
        by_solver = (
            np.array([each.area for each in at_load]) / points.area,
            np.array([each.indentation for each in at_load]) / points.indentation,
            np.array([each.load for each in at_depth]) / points.load,
        )
        for axes, ours, law, theirs in zip(below, by_solver, by_law, by_hertz, strict=True):
            axes.plot(_LINES, np.abs(theirs - 1), color=colour, ls=(0, (4, 2)))
            axes.plot(_LINES, np.abs(law - 1), color=colour)
            axes.plot(_SOLVED, np.abs(ours - 1), color=colour, ls="", marker="o", ms=3.5)
    _series(above[1], below[2])
    for limit, nu in ((4, 0.5), (2, 0.3)):
        above[0].axhline(limit, color=_COLOURS[nu], lw=0.8, ls=(0, (1, 1.5)))
        above[0].text(0.033, limit - 0.04, f"thin layer, ν {'=' if nu == 0.5 else '<'} 0.5", va="top")
    for axes, title in zip(
        above, ("A/(πRξ)", "W/W$_{Hertz}$ at the same ξ", "W/W$_{Hertz}$ at the same A"), strict=True
    ):
        axes.axhline(1, color=GREY, lw=0.8, ls=(0, (4, 2)))
        axes.set(xscale="log", xlim=(0.03, 3), title=title)
        _plain_ticks(axes)
    above[0].set(ylim=(0.9, 4.2))
    for axes in above[1:]:
        axes.set(
            yscale="log", yticks=[1, 2, 5, 10, 20], ylim=(0.9, 20), yticklabels=["1", "2", "5", "10", "20"]
        )
    for axes, title in zip(below, ("A at given W", "ξ at given W", "W at given ξ"), strict=True):
        _error_axes(axes)
        axes.set(xscale="log", xlim=(0.03, 3), xlabel="contact radius over thickness, a/t", title=title)
        _plain_ticks(axes)
    above[1].legend(loc="upper left")
    below[0].set_ylabel("relative error")
    below[0].plot([], [], color=BLACK, ls=(0, (4, 2)), label="Hertz theory")
    below[0].plot([], [], color=BLACK, label="fast law")
    below[0].plot([], [], color=BLACK, ls="", marker="o", ms=3.5, label="solver, 256² cells")
    below[0].legend(loc="lower left")
    _save(figure, "validation_layer.png")


def _plain_ticks(axes: Axes) -> None:
    axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_locator(NullLocator())


def _series(values: Axes, errors: Axes) -> None:
    exact = Circles(_LINES, 0.5)
    for name, dashes in zip(_SERIES, ((0, (1, 1.5)), (0, (3, 1.5, 1, 1.5))), strict=True):
        found = exact.series(name)
        values.plot(_LINES, found, color=BLACK, lw=0.9, ls=dashes, label=name)
        errors.plot(_LINES, np.abs(found / exact.load_at_depth - 1), color=BLACK, lw=0.9, ls=dashes)


@in_style
def pads() -> None:
    """Draw the errors of Hertz theory and of the laws for whole pads that nothing was fitted to."""
    figure, panels = new_figure(width_mm=180, height_mm=120, rows=2, columns=3)
    kept = np.load(KEPT)
    for row, name in zip((panels[:3], panels[3:]), ("pads_held_out", "layered_held_out"), strict=True):
        data = kept[name]
        placement, tissue = kept_contacts(data, is_pad=True)
        values = {"load": data[:, -5], "area": data[:, -4] / AREA_BIAS, "indentation": data[:, -3]}
        on_layer = not tissue.is_deep
        size = np.sqrt(values["area"] / np.pi) / (tissue.thickness if on_layer else _silhouette(data))
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


def _silhouette(rows: FloatArray) -> FloatArray:
    """Return the mean radius of the pads' silhouettes seen along the plate's normal."""
    axes, wedge, roll = rows[:, :3], rows[:, 3], rows[:, 4]
    normal = np.stack([np.cos(wedge) * np.cos(roll), np.sin(wedge), np.cos(wedge) * np.sin(roll)], axis=-1)
    radius: FloatArray = np.sqrt(axes.prod(axis=-1) * np.sqrt(((normal / axes) ** 2).sum(axis=-1)))
    return radius


def _error_axes(axes: Axes) -> None:
    axes.axhline(_LIMIT, color=BLACK, lw=0.5)
    axes.text(1, _LIMIT, "0.5 %", va="center", transform=axes.get_yaxis_transform())
    axes.set(yscale="log", ylim=(1e-7, 10), yticks=[1e-6, 1e-4, 1e-2, 1])
    axes.yaxis.set_minor_locator(NullLocator())


def _save(figure: Figure, name: str) -> None:
    figure.savefig(_IMAGES / name, dpi=200, metadata={"Software": None})


def report() -> None:
    """Draw both figures."""
    layer()
    pads()
