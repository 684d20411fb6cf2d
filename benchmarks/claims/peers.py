"""Side by side with what people use today, in one run on one machine.

statsmodels, lmfit and scikit-image are dependencies of the tests. The others are compared where they are
installed, and their rows say where they are not: ``pip install nanite``, ``pip install --no-deps pyfing``,
and in an environment of its own ``pip install slippy tribology``, with the old versions of NumPy and SciPy
that they need; ``FINGERPAD_PEERS`` names the interpreter of that environment.
"""

import json
import math
import os
import subprocess
import sys
import time
from dataclasses import replace
from importlib import import_module
from types import ModuleType
from typing import Any, Final, TypeAlias

import cv2
import lmfit
import numpy as np
from scipy import ndimage
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk
from skimage import filters, measure, morphology
from statsmodels.stats.meta_analysis import combine_effects

from benchmarks import ROOT
from benchmarks.arrays import Array, Pixels
from benchmarks.claims.loading_truth import CONDITIONS as CURVES
from benchmarks.claims.loading_truth import make_curve, random_pad
from benchmarks.cost import best
from benchmarks.tables import off, or_none, percent, stated, table
from benchmarks.truth import image_sets
from benchmarks.truth.hertz import exact_contact, hertz_factors
from benchmarks.truth.true_image import TrueImage
from fingerpad._arrays import ArrayLike, as_float_array
from fingerpad.contact import Contact, Tissue, hertz_contact
from fingerpad.geometry import Paraboloid
from fingerpad.image import measure_contact_image
from fingerpad.loading import LoadingCurve, fit_loading_curve, read_loading_curve
from fingerpad.uncertainty import pool_random_effects

RADII_RATIOS: Final = (1.0, 1.001, 1.1, 1.5, 3.0, 10.0, 100.0)
RADIUS, LOAD, MODULUS = 8.0, 2.0, 0.1365  # mm, N, MPa
# Radius, E* of the instrument or of nanite in Pa, and Pa of its unit (tests/loading/data/README.md).
RECORDS: Final = {"chiaro_gel.csv": (27.5, 156.0, 1e6), "afm_cell.csv": (5.0, 480.3, 1e3)}

# Semi-axes with the indentation of a contact, or with its area in an image; NaN where nothing is found.
Measured: TypeAlias = tuple[float, float, float]
_NONE: Final = (math.nan,) * 3

# Semi-axes and indentation of each ratio in turn, then seconds for one contact.
_IN_OWN_ENVIRONMENT: Final = """
import json, math, sys, time
peer, radius, load, modulus, ratios = json.loads(sys.argv[1])
inf = float("inf")
if peer == "slippy":
    from slippy.contact import hertz_full
    def solve(ratio):
        found = hertz_full([radius * ratio, radius], [inf, inf], [0.75 * modulus, 1e15], [0.5, 0.0], load)
        radii = found["contact_radii"]
        return max(radii), min(radii[:2]), found["total_deflection"]
else:
    import tribology
    def solve(ratio):
        effective, x, y = tribology.reff(radius * ratio, radius, inf, inf)
        a, b, _ = tribology.ahertz(effective, x, y, 2 * modulus, load)
        depth = tribology.dhertz(modulus, radius * ratio, radius, 1e30, 1e30, load)
        return max(a, b), min(a, b), depth
rows = []
for ratio in ratios:
    try:
        rows.append([float(x) for x in solve(ratio)])
    except Exception:
        rows.append([math.nan] * 3)
start = time.perf_counter()
for _ in range(20):
    solve(3.0)
print(json.dumps([rows, (time.perf_counter() - start) / 20]))
"""


def _pressed(ratio: ArrayLike) -> Contact:
    bodies = Paraboloid(RADIUS * as_float_array(ratio), RADIUS)
    return hertz_contact(bodies, Tissue.of_reduced_modulus(MODULUS), load=LOAD)


def hertz() -> None:
    """Print the largest error of semi-axes and indentation, and the time of a contact, of each peer."""
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
    for peer in ("slippy", "tribology"):
        if answer := _ask(peer):
            rows.append(_errors(peer, np.array(answer[0]), exact, f"{1e6 * answer[1]:.0f} µs"))
        else:
            rows.append((f"{peer}: not installed", "–", "–", "–"))
    head = "elliptical Hertz contact", "semi-axes, largest error", "indentation", "one contact"
    table(head, rows, "Elliptical Hertz contact, R'/R'' from 1 to 100, against 50 digits")


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


def _ask(peer: str) -> tuple[list[list[float]], float] | None:
    interpreter = os.environ.get("FINGERPAD_PEERS")
    if not interpreter:
        return None
    asked = json.dumps([peer, RADIUS, LOAD, MODULUS, RADII_RATIOS])
    command = [interpreter, "-W", "ignore", "-c", _IN_OWN_ENVIRONMENT, asked]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
    return None if done.returncode else tuple(json.loads(done.stdout.splitlines()[-1]))


def contact_image(count: int) -> None:
    """Print errors of gross area and semi-axes on images of known truth, and the time of an image."""
    images = [image for *_, image in image_sets.images(count, 77, ("independent images",))]
    truth = np.array([(image.gross_area, *image.semi_axes) for image in images])
    rows = []
    for name, way in OF_IMAGES.items():
        try:
            found = [way(image) for image in images]
        except ImportError:
            rows.append((f"{name}: not installed", *4 * ("–",), 0))
            continue
        errors = np.array(found) / truth - 1
        area, rms = errors[:, 0], float(np.sqrt(np.nanmean(errors[:, 1:] ** 2)))
        seconds = best(lambda way=way: way(images[0]), repeats=3)  # type: ignore[misc]
        none, worst = int(np.isnan(area).sum()), percent(float(np.nanmax(np.abs(area))))
        rows.append((name, off(area), worst, percent(rms), f"{1e3 * seconds:.0f} ms", none))
    head = "contact images", "area: bias, rms error", "worst", "semi-axes, rms", "one image", "none found"
    table(
        head, rows, f"{len(images)} contact images of independent truth in {len(images) // count} conditions"
    )


def _by_fingerpad(image: TrueImage) -> Measured:
    if (found := or_none(measure_contact_image, image.pixels, image.mm_per_px)) is None:
        return _NONE
    ellipse = found.ellipse
    return found.gross_area, float(ellipse.semi_major), float(ellipse.semi_minor)


def _by_scikit_image(image: TrueImage) -> Measured:
    """Measure as a script does: darker than Otsu's level, valleys closed over 1 mm, the largest region."""
    grey = _dark_on_light(image)
    disk = morphology.disk(round(0.5 / image.mm_per_px))
    return _largest_region(morphology.closing(grey < filters.threshold_otsu(grey), disk), image)


def _by_blur(image: TrueImage) -> Measured:
    """Measure as scripts do: blurred over half a ridge period, below Otsu's level, the largest region."""
    grey = cv2.GaussianBlur(_dark_on_light(image), (0, 0), 0.25 / image.mm_per_px)
    return _largest_region(ndimage.binary_fill_holes(grey < filters.threshold_otsu(grey)), image)


def _by_imagej(image: TrueImage) -> Measured:
    """Measure as a macro does: despeckle, IsoData, dilate and erode, fill holes, fit an ellipse."""
    grey = cv2.medianBlur(_dark_on_light(image), 3)
    ridges = (grey < filters.threshold_isodata(grey)).astype(np.uint8)
    kernel, times = np.ones((3, 3), np.uint8), round(0.5 / image.mm_per_px)
    closed = cv2.erode(cv2.dilate(ridges, kernel, iterations=times), kernel, iterations=times)
    return _largest_region(ndimage.binary_fill_holes(closed), image)


def _by_pyfing(image: TrueImage) -> Measured:
    """Measure by the gradient-magnitude segmentation of Cappelli (2023)."""
    # which imports keras for networks that this method does without
    sys.modules.setdefault("keras", ModuleType("keras"))
    methods = import_module("pyfing.segmentation")
    parameters = methods.GmfsParameters(image_dpi=round(25.4 / image.mm_per_px))
    return _largest_region(methods.Gmfs(parameters).run(_dark_on_light(image)) > 0, image)


def _dark_on_light(image: TrueImage) -> Pixels:
    depth = np.iinfo(image.pixels.dtype).max
    grey = (image.pixels * (255.0 / depth)).astype(np.uint8)
    return 255 - grey if np.median(grey) < 128 else grey


def _largest_region(mask: Array, image: TrueImage) -> Measured:
    regions = measure.regionprops(measure.label(mask))
    if not regions:
        return _NONE
    one = max(regions, key=lambda region: region.area)
    scale = image.mm_per_px
    return one.area_filled * scale**2, one.axis_major_length / 2 * scale, one.axis_minor_length / 2 * scale


def pooled() -> None:
    """Print how pooled means of random effects differ from statsmodels' on the same numbers."""
    random, differences = np.random.default_rng(4), []
    for count in (3, 5, 10, 20):
        std = random.uniform(0.2, 1.0, count)
        values = 14 + 0.6 * random.standard_normal(count) + std * random.standard_normal(count)
        ours = pool_random_effects(values, std)
        theirs = combine_effects(values, std**2, method_re="iterated")
        mean = theirs.summary_frame().loc["random effect", "eff"]
        differences.append((ours.value - mean, ours.between_std - np.sqrt(theirs.tau2)))
    worst = np.abs(differences).max(axis=0)
    head = "pooled means", "largest difference of the mean", "of the deviation between values"
    row = "statsmodels, Paule and Mandel", f"{worst[0]:.1e} mm", f"{worst[1]:.1e} mm"
    table(head, [row], "Means of random effects of 3 to 20 values")


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
                answer = fit(curve, pad.radius)
                spent = time.perf_counter() - start
                if answer is not None:
                    value, std, at = answer
                    found.append((value / pad.modulus - 1, std / pad.modulus, at - place, spent))
            if not found:
                rows.append((name, f"{way}: not installed", *4 * ("–",)))
                continue
            e, std, at, spent = np.array(found).T
            micrometres = f"{1e3 * np.sqrt(np.mean(at**2)):.0f} µm"
            rows.append((name, way, off(e), stated(e, std), micrometres, f"{1e3 * np.median(spent):.0f} ms"))
    head = "curves", "fitted by", "E: bias, rms error", "stated, held", "place of contact, rms", "a fit"
    title = f"{count} loading curves each to 2 N, no areas, radius known, zero and place of contact not"
    table(head, rows, title)
    records = []
    for name, (radius, instrument, unit) in RECORDS.items():
        whole = read_loading_curve(ROOT / "tests" / "loading" / "data" / name)
        ours = fit_loading_curve(whole, loading_radius=radius, stage_compliance=0.0, thickness=math.inf)
        secant = f"{unit * ours.reduced_modulus.value:.4g} ± {unit * ours.reduced_modulus.std:.2g}"
        theirs = (fit(whole, radius) for fit in (_fit_lmfit, _fit_nanite))
        cells = ("–" if one is None else f"{unit * one[0] / 0.75:.4g}" for one in theirs)
        records.append((name, f"{instrument:g}", secant, *cells))
    columns = "real record", "E* as published, Pa", "fingerpad", "lmfit", "nanite"
    table(columns, records, "Real records of gel and cell, made of the whole approach")


def _fit_ours(curve: LoadingCurve, radius: float) -> tuple[float, float, float] | None:
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


def _fit_nanite(curve: LoadingCurve, radius: float) -> tuple[float, float, float] | None:
    try:
        nanite = import_module("nanite")
    except ImportError:
        return None
    x, load = _approach(curve)
    # in metres, towards the sample negative
    data: dict[str, Any] = {"force": load, "tip position": -1e-3 * x, "height (measured)": -1e-3 * x}
    data |= {"time": np.arange(len(x)) * 1e-3, "segment": np.zeros(len(x), bool)}
    meta = {"spring constant": 1.0, "path": "curve", "enum": 0, "imaging mode": "force-distance"}
    record = nanite.Indentation(data=data, metadata=meta)
    model = import_module("nanite.model.model_hertz_paraboloidal")
    start = model.get_parameter_defaults()
    at, modulus = _start(x, load, radius)
    start["R"].value, start["nu"].value, start["E"].value = 1e-3 * radius, 0.5, 1e6 * modulus
    start["contact_point"].value = -1e-3 * at
    record.apply_preprocessing(["correct_force_offset"])
    record.fit_model(model_key="hertz_para", params_initial=start, weight_cp=False, segment="approach")
    found = record.fit_properties["params_fitted"]
    std = 1e-6 * (found["E"].stderr or np.nan)
    return 1e-6 * found["E"].value, std, -1e3 * found["contact_point"].value


OF_IMAGES: Final = {
    "fingerpad": _by_fingerpad,
    "scikit-image: Otsu, closing, largest region": _by_scikit_image,
    "blur over a ridge, Otsu, largest region, as MATLAB scripts do": _by_blur,
    "as an ImageJ macro: median, IsoData, close, fill, fit": _by_imagej,
    "pyfing: gradient magnitude (GMFS)": _by_pyfing,
}
WAYS: Final = {"fingerpad": _fit_ours, "lmfit, paraboloid": _fit_lmfit, "nanite, hertz_para": _fit_nanite}


def report(images: int = 1, curves: int = 8) -> None:
    """Print all comparisons."""
    hertz()
    contact_image(images)
    loading(curves)
    pooled()
