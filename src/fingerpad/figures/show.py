"""Draw one result: the overlay of an image, or the plot of a fit or a contact."""

import io
from dataclasses import dataclass
from functools import singledispatch
from os import PathLike
from pathlib import Path
from typing import Any, Final

import numpy as np
from PIL import Image

from fingerpad._arrays import broadcast
from fingerpad.contact import Contact
from fingerpad.exceptions import FingerpadError
from fingerpad.figures.loading import law_lines, plot_load_indentation, plot_load_residuals, predicted_band
from fingerpad.figures.marks import Axis, Figure, Line, Text, new_panels
from fingerpad.figures.publish import FigureSettings, figure_file, save_figure
from fingerpad.figures.style import BLUE
from fingerpad.figures.wedge import plot_wedge
from fingerpad.geometry import Placement
from fingerpad.image import ContactImageResult, PhotographFit, draw_overlay
from fingerpad.loading import LoadingFit

# More contacts than these make no readable figure.
_MAX_CONTACTS: Final = 20
_MAX_NAMED: Final = 6
_SETTINGS: Final = FigureSettings(dpi=144.0)
_PREVIEW_PX: Final = 640


@dataclass(frozen=True, slots=True)
class Drawing:
    """A drawing of a result, which a notebook shows.

    Attributes
    ----------
    content : Figure or Image
        The figure as data, or the overlay.
    """

    content: Figure | Image.Image

    def __repr__(self) -> str:
        return "<Drawing: a notebook shows it; fp.show(result, 'file.png') saves it>"

    @property
    def png(self) -> bytes:
        """The drawing as a PNG file of a size for a notebook."""
        if isinstance(self.content, Figure):
            return figure_file(self.content, "png", _SETTINGS)
        small, buffer = self.content.copy(), io.BytesIO()
        small.thumbnail((_PREVIEW_PX, _PREVIEW_PX))
        small.save(buffer, "png")
        return buffer.getvalue()

    def _repr_png_(self) -> bytes:
        return self.png

    def save(self, path: str | PathLike[str]) -> Path:
        """Write the drawing in the format that the file's ending names.

        Parameters
        ----------
        path : path-like
            The file to write.

        Returns
        -------
        Path
            The file written.

        Raises
        ------
        FingerpadError
            If there is no such format, or the file cannot be written.
        """
        path = Path(path)
        if isinstance(self.content, Figure):
            return save_figure(self.content, path, settings=_SETTINGS)
        try:
            self.content.save(path)
        except (OSError, ValueError) as error:
            raise FingerpadError(
                f"{path}: cannot be written ({error}): check the folder and end the name in .png"
            ) from error
        return path


def show(result: object, path: str | PathLike[str] | None = None) -> Drawing:
    """Draw a result: in a notebook as the last line of a cell, or into a file.

    A measured picture is drawn with its overlay, a fitted loading curve with its force models, a Hertz
    contact by its ellipse and its pressure, a placement by the finger on its wedge.

    Parameters
    ----------
    result : ContactImageResult, PhotographFit, LoadingFit, Contact or Placement
        From `measure_contact_image`, `measure_photograph`, `fit_loading_curve` or `hertz_contact`, or a
        `Placement`.
    path : path-like, optional
        File to write: PNG for all, SVG and PDF for plots, JPEG and TIFF for overlays, by its ending.

    Returns
    -------
    Drawing

    Raises
    ------
    FingerpadError
        If there is no drawing of such a result, or the file cannot be written.

    Examples
    --------
    >>> from fingerpad.contact import Tissue, hertz_contact
    >>> from fingerpad.geometry import Paraboloid
    >>> show(hertz_contact(Paraboloid(12.955, 14.330), Tissue(youngs_modulus=0.1024), load=2.0))
    <Drawing: a notebook shows it; fp.show(result, 'file.png') saves it>
    """
    drawing = draw(result)
    if path is not None:
        drawing.save(path)
    return drawing


@singledispatch
def draw(result: Any) -> Drawing:
    """Return the drawing of a result."""
    raise FingerpadError(
        f"no drawing of a {type(result).__name__}: give a measured image or photograph, a fitted loading "
        "curve, a Hertz contact or a placement"
    )


@draw.register
def _(result: ContactImageResult | PhotographFit) -> Drawing:
    if result.picture is None:
        raise FingerpadError(
            "the picture is not kept with this result: draw it by draw_overlay(pixels, result)"
        )
    return Drawing(Image.fromarray(draw_overlay(result.picture, result)))


@draw.register
def _(result: LoadingFit) -> Drawing:
    figure, (loads, residuals) = new_panels(width_mm=170, height_mm=75, columns=2)
    xi, load, phase = result.indentation, result.load, np.where(result.indentation > 0, "loading", "baseline")
    own = result.law
    if own is not None and own.phase == "unloading":
        out = own.displacement - result.main.values["contact_offset"]
        xi, load = np.append(xi, out), np.append(load, own.load)
        phase = np.append(phase, np.full(out.size, own.phase))
    plot_load_indentation(loads, xi, load, phase=phase, fits=law_lines(result), band=predicted_band(result))
    plot_load_residuals(residuals, result)
    return Drawing(figure)


@draw.register
def _(result: Placement) -> Drawing:
    if result.wedge_angle.ndim:
        raise FingerpadError(f"one placement can be drawn, found {result.wedge_angle.size}: give one of them")
    figure, (axes,) = new_panels()
    plot_wedge(axes, result.ellipsoid, wedge_angle=float(result.wedge_angle))
    return Drawing(figure)


@draw.register
def _(result: Contact) -> Drawing:
    contacts = [array.ravel() for array in broadcast(result.semi_major, result.semi_minor, result.load)]
    if contacts[0].size > _MAX_CONTACTS:
        raise FingerpadError(f"up to {_MAX_CONTACTS} contacts can be drawn, found {contacts[0].size}")
    figure, (ellipses, pressures) = new_panels(width_mm=140, columns=2)
    ellipses.x, ellipses.y = Axis("short axis (unit of the radii)"), Axis("long axis (unit of the radii)")
    ellipses.equal = True
    pressures.x = Axis("along the long axis (unit of the radii)")
    pressures.y = Axis("pressure (unit of E*)", low=0)
    t = np.linspace(0, 2 * np.pi, 181)
    for major, minor, load in zip(*contacts, strict=True):
        ellipses.add(Line(minor * np.cos(t), major * np.sin(t), colour=BLUE))
        # The pressure p0 √(1 − x²/ℓd²) along the long axis.
        peak = 1.5 * load / (np.pi * major * minor)
        pressures.add(Line(major * np.cos(t[:91]), peak * np.sin(t[:91]), colour=BLUE))
        if len(contacts[0]) <= _MAX_NAMED:
            pressures.add(Text(f"W = {load:.3g}", 0, peak, up=2, horizontal="center", halo="white"))
    return Drawing(figure)
