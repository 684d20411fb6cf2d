"""Side by side with what people use today, in one run on one machine.

lmfit and scikit-image are dependencies of the tests; the steps of scripts and macros are written out.
"""

import math
import time
from dataclasses import replace
from typing import Final, TypeAlias

import cv2
import lmfit
import numpy as np
from scipy import ndimage
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk
from skimage import filters, measure, morphology

from benchmarks import ROOT
from benchmarks.arrays import Array, Pixels
from benchmarks.claims.loading_truth import CONDITIONS as CURVES
from benchmarks.claims.loading_truth import make_curve, random_pad
from benchmarks.cost import best
from benchmarks.tables import off, percent, stated, table
from benchmarks.truth.hertz import exact_contact, hertz_factors
from benchmarks.truth.independent_images import CONDITIONS, IndependentImage, independent_images
from fingerpad._arrays import ArrayLike, as_float_array
from fingerpad.contact import Contact, Tissue, hertz_contact
from fingerpad.exceptions import ImageError
from fingerpad.geometry import Paraboloid
from fingerpad.image import measure_contact_image
from fingerpad.loading import LoadingCurve, fit_loading_curve, read_loading_curve

RADII_RATIOS: Final = (1.0, 1.001, 1.1, 1.5, 3.0, 10.0, 100.0)
RADIUS, LOAD, MODULUS = 8.0, 2.0, 0.1365  # mm, N, MPa
# Radius, published E* in Pa, and Pa of its unit (tests/loading/data/README.md).
RECORDS: Final = {"chiaro_gel.csv": (27.5, 156.0, 1e6), "afm_cell.csv": (5.0, 480.3, 1e3)}

# Semi-axes with the indentation of a contact, or with its area in an image; NaN where nothing is found.
Measured: TypeAlias = tuple[float, float, float]
_NONE: Final = (math.nan,) * 3


def _pressed(ratio: ArrayLike) -> Contact:
    bodies = Paraboloid(RADIUS * as_float_array(ratio), RADIUS)
    return hertz_contact(bodies, Tissue.of_reduced_modulus(MODULUS), load=LOAD)


def hertz() -> None:
    """Print the largest error of semi-axes and indentation, and the time of a contact."""
    exact = np.array([[float(x) for x in exact_contact(r, RADIUS, LOAD, MODULUS)[:3]] for r in RADII_RATIOS])
    ratios = np.tile(RADII_RATIOS, 20_000)
    ours = _pressed(np.array(RADII_RATIOS))
    one, many = 1e6 * best(lambda: _pressed(3.0)), best(lambda: _pressed(ratios), repeats=3)
    found = np.stack([ours.semi_major, ours.semi_minor, ours.indentation], axis=1)
    rooted = np.array([_by_root(r) for r in RADII_RATIOS])
    rows = [
        _errors("fingerpad", found, exact, f"{one:.0f} µs; {1e6 * many / ratios.size:.2f} µs of 140,000"),
        _errors("SciPy, root-finder", rooted, exact, f"{1e6 * best(lambda: _by_root(3.0)):.0f} µs"),
    ]
    table(
        ("elliptical Hertz contact", "semi-axes, largest error", "indentation", "one contact"),
        rows,
        "Elliptical Hertz contact, R'/R'' from 1 to 100, against 50 digits",
    )


def _errors(name: str, found: Array, exact: Array, seconds: str) -> tuple[str, ...]:
    error = np.abs(found / exact - 1)
    missing = int(np.isnan(error).any(axis=1).sum())
    fails = f", fails at {missing} of {len(exact)}" if missing else ""
    axes, depth = np.nanmax(error[:, :2]), np.nanmax(error[:, 2])
    return name + fails, f"{axes:.1e}", f"{depth:.1e}", seconds


def _by_root(ratio: float) -> Measured:
    """Solve as a script does: SciPy's integrals as Johnson prints them, and Brent's method."""

    def residual(k: float) -> float:
        K, E = ellipk(1 - k * k), ellipe(1 - k * k)
        return float((E / k**2 - K) / (K - E) - ratio)

    try:
        k = brentq(residual, 1e-6, 1 - 1e-9, xtol=1e-15)
    except ValueError:  # no change of sign: a circle
        return _NONE
    size, depth = hertz_factors(k)
    mean = RADIUS * np.sqrt(ratio)
    c = (3 * LOAD * mean / (4 * MODULUS)) ** (1 / 3) * size
    return c / np.sqrt(k), c * np.sqrt(k), (9 * LOAD**2 / (16 * MODULUS**2 * mean)) ** (1 / 3) * depth


def contact_image(count: int) -> None:
    """Print errors of gross area and semi-axes on images of known truth, and the time of an image."""
    images = [image for _, image in independent_images(count, seed=77)]
    truth = np.array([(image.gross_area, *image.semi_axes) for image in images])
    rows = []
    for name, way in (
        ("fingerpad", _by_fingerpad),
        ("scikit-image: Otsu, closing, largest region", _by_scikit_image),
        ("blur over a ridge, Otsu, largest region, as MATLAB scripts do", _by_blur),
        ("as an ImageJ macro: median, IsoData, close, fill, fit", _by_imagej),
    ):
        errors = np.array([way(image) for image in images]) / truth - 1
        area, rms = errors[:, 0], float(np.sqrt(np.nanmean(errors[:, 1:] ** 2)))
        seconds = best(lambda way=way: way(images[0]), repeats=3)  # type: ignore[misc]
        none, worst = int(np.isnan(area).sum()), percent(float(np.nanmax(np.abs(area))))
        rows.append((name, off(area), worst, percent(rms), f"{1e3 * seconds:.0f} ms", none))
    table(
        ("contact images", "area: bias, rms error", "worst", "semi-axes, rms", "one image", "none found"),
        rows,
        f"{len(images)} contact images of independent truth in {len(CONDITIONS)} conditions",
    )


def _by_fingerpad(image: IndependentImage) -> Measured:
    try:
        found = measure_contact_image(image.pixels, image.mm_per_px)
    except ImageError:
        return _NONE
    ellipse = found.ellipse
    return found.gross_area, float(ellipse.semi_major), float(ellipse.semi_minor)


def _by_scikit_image(image: IndependentImage) -> Measured:
    """Measure as a script does: darker than Otsu's level, valleys closed over 1 mm, the largest region."""
    grey = _dark_on_light(image)
    disk = morphology.disk(round(0.5 / image.mm_per_px))
    return _largest_region(morphology.closing(grey < filters.threshold_otsu(grey), disk), image)


def _by_blur(image: IndependentImage) -> Measured:
    """Measure as scripts do: blurred over half a ridge period, below Otsu's level, the largest region."""
    grey = cv2.GaussianBlur(_dark_on_light(image), (0, 0), 0.25 / image.mm_per_px)
    return _largest_region(ndimage.binary_fill_holes(grey < filters.threshold_otsu(grey)), image)


def _by_imagej(image: IndependentImage) -> Measured:
    """Measure as a macro does: despeckle, IsoData, dilate and erode, fill holes, fit an ellipse."""
    grey = cv2.medianBlur(_dark_on_light(image), 3)
    ridges = (grey < filters.threshold_isodata(grey)).astype(np.uint8)
    kernel, times = np.ones((3, 3), np.uint8), round(0.5 / image.mm_per_px)
    closed = cv2.erode(cv2.dilate(ridges, kernel, iterations=times), kernel, iterations=times)
    return _largest_region(ndimage.binary_fill_holes(closed), image)


def _dark_on_light(image: IndependentImage) -> Pixels:
    depth = np.iinfo(image.pixels.dtype).max
    grey = (image.pixels * (255.0 / depth)).astype(np.uint8)
    return 255 - grey if image.condition.bright else grey


def _largest_region(mask: Array, image: IndependentImage) -> Measured:
    regions = measure.regionprops(measure.label(mask))
    if not regions:
        return _NONE
    one = max(regions, key=lambda region: region.area)
    scale = image.mm_per_px
    return one.area_filled * scale**2, one.axis_major_length / 2 * scale, one.axis_minor_length / 2 * scale


def loading(count: int) -> None:
    """Print errors of modulus and place of contact from records of force and displacement, radius known."""
    rows = []
    for name in ("Hertz, white noise", "Hertz, 1/f noise", "layer of 8 mm on bone"):
        for way, fit in WAYS.items():
            found = []
            for seed in range(count):
                rng = np.random.default_rng([7, seed])
                pad, place = random_pad(CURVES[name], rng), rng.uniform(-2, 2)
                curve = replace(make_curve(CURVES[name], pad, place, rng), area=None)
                start = time.perf_counter()
                value, std, at = fit(curve, pad.radius)
                spent = time.perf_counter() - start
                found.append((value / pad.modulus - 1, std / pad.modulus, at - place, spent))
            e, std, at, spent = np.array(found).T
            micrometres = f"{1e3 * np.sqrt(np.mean(at**2)):.0f} µm"
            rows.append((name, way, off(e), stated(e, std), micrometres, f"{1e3 * np.median(spent):.0f} ms"))
    table(
        ("curves", "fitted by", "E: bias, rms error", "stated, held", "place of contact, rms", "a fit"),
        rows,
        f"{count} loading curves each to 2 N, no areas, radius known, zero and place of contact not",
    )
    records = []
    for name, (radius, instrument, unit) in RECORDS.items():
        whole = read_loading_curve(ROOT / "tests" / "loading" / "data" / name)
        ours = fit_loading_curve(whole, loading_radius=radius, stage_compliance=0.0, thickness=math.inf)
        secant = f"{unit * ours.reduced_modulus.value:.4g} ± {unit * ours.reduced_modulus.std:.2g}"
        theirs = f"{unit * _fit_lmfit(whole, radius)[0] / 0.75:.4g}"
        records.append((name, f"{instrument:g}", secant, theirs))
    table(
        ("real record", "E* as published, Pa", "fingerpad", "lmfit"),
        records,
        "Real records of gel and cell, made of the whole approach",
    )


def _fit_ours(curve: LoadingCurve, radius: float) -> tuple[float, float, float]:
    fit = fit_loading_curve(curve, loading_radius=radius, stage_compliance=0.0)
    return fit.initial_modulus.value, fit.initial_modulus.std, fit.contact_offset.value


def _approach(curve: LoadingCurve) -> tuple[Array, Array]:
    end = int(np.argmax(curve.load)) + 1
    return curve.indentation[:end], curve.load[:end]


def _start(x: Array, load: Array, radius: float) -> tuple[float, float]:
    zero = float(np.median(load[: len(load) // 5]))
    at = float(x[np.flatnonzero(load - zero < 0.1 * (load[-1] - zero))[-1]])
    return at, 0.75 * 0.75 * float(load[-1] - zero) / np.sqrt(radius) / max(float(x[-1]) - at, 1e-9) ** 1.5


def _fit_lmfit(curve: LoadingCurve, radius: float) -> tuple[float, float, float]:
    """Fit a paraboloid as a script does: least squares of force, with zero and place of contact free."""
    x, load = _approach(curve)
    at, modulus = _start(x, load, radius)

    def force(x: Array, E: float, at: float, zero: float) -> Array:
        return 4 / 3 * E / 0.75 * np.sqrt(radius) * np.maximum(x - at, 0) ** 1.5 + zero

    fit = lmfit.Model(force).fit(load, x=x, E=modulus, at=at, zero=float(np.median(load[: len(load) // 5])))
    return fit.params["E"].value, fit.params["E"].stderr or np.nan, fit.params["at"].value


WAYS: Final = {"fingerpad": _fit_ours, "lmfit, paraboloid": _fit_lmfit}


def report(images: int = 1, curves: int = 8) -> None:
    """Print all comparisons."""
    hertz()
    contact_image(images)
    loading(curves)
