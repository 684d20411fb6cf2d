"""Side by side with what people use today.

Peers that need old versions of their dependencies run in an environment of their own: make one with slippy
and tribology, and name its interpreter in ``FINGERPAD_PEERS``. Without it their rows say so.
So does pyfing's without ``pip install --no-deps pyfing``, whose classical method needs none of its networks.
"""

import json
import os
import subprocess
import sys
from dataclasses import dataclass
from importlib import import_module
from types import ModuleType
from typing import Final

import cv2
import numpy as np
import numpy.typing as npt
from scipy import ndimage
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk
from skimage import filters, measure, morphology
from statsmodels.stats.meta_analysis import combine_effects

from benchmarks.claims import contact_solver
from benchmarks.timing import best
from benchmarks.truth.hertz import exact_contact
from benchmarks.truth.independent_images import CONDITIONS, IndependentImage, independent_images
from fingerpad._arrays import ArrayLike, as_float_array
from fingerpad.contact import Contact, Tissue, hertz_contact
from fingerpad.exceptions import ImageError
from fingerpad.geometry import Paraboloid
from fingerpad.image import measure_contact_image
from fingerpad.uncertainty import pool_random_effects

FloatArray = npt.NDArray[np.float64]

RADII_RATIOS: Final = (1.0, 1.001, 1.1, 1.5, 3.0, 10.0, 100.0)
RADIUS, LOAD, MODULUS = 8.0, 2.0, 0.1365  # mm, N, MPa

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
    print("Elliptical Hertz contact, R'/R'' from 1 to 100: largest relative error against 50 digits")
    print(f"    {'':<28}{'semi-axes':>11}{'indentation':>13}{'microseconds a contact':>25}")
    _print_errors("fingerpad", found, exact, f"{one:.0f} (of 140,000: {1e6 * many / ratios.size:.2f})")
    rooted = np.array([_by_root(r) for r in RADII_RATIOS])
    _print_errors("SciPy root-finder", rooted, exact, f"{1e6 * best(lambda: _by_root(3.0)):.0f}")
    for peer in ("slippy", "tribology"):
        answer = _ask(peer)
        if answer is None:
            print(f"    {peer:<28}not run: FINGERPAD_PEERS names no interpreter that has it")
        else:
            _print_errors(peer, np.array(answer[0]), exact, f"{1e6 * answer[1]:.0f}")


def _print_errors(name: str, found: FloatArray, exact: FloatArray, seconds: str) -> None:
    error = np.abs(found / exact - 1)
    missing = int(np.isnan(error).any(axis=1).sum())
    fails = f"; fails at {missing} of {len(exact)}" if missing else ""
    print(
        f"    {name:<28}{np.nanmax(error[:, :2]):>11.1e}{np.nanmax(error[:, 2]):>13.1e}{seconds:>25}{fails}"
    )


def _by_root(ratio: float) -> tuple[float, float, float]:
    """Solve as a script does: SciPy's integrals as Johnson prints them, and Brent's method."""

    def shape(k: float) -> tuple[float, float]:
        m = 1 - k * k
        return float(ellipk(m)), float(ellipe(m))

    def residual(k: float) -> float:
        K, E = shape(k)
        return float((E / k**2 - K) / (K - E) - ratio)

    try:
        k = brentq(residual, 1e-6, 1 - 1e-9, xtol=1e-15)
    except ValueError:  # no change of sign: a circle
        return (float("nan"),) * 3
    K, E = shape(k)
    size = (4 / (np.pi * (1 - k * k)) * k**1.5 * np.sqrt((E / k**2 - K) * (K - E))) ** (1 / 3)
    mean = RADIUS * np.sqrt(ratio)
    c = (3 * LOAD * mean / (4 * MODULUS)) ** (1 / 3) * size
    depth = (9 * LOAD**2 / (16 * MODULUS**2 * mean)) ** (1 / 3) * 2 / np.pi * np.sqrt(k) * K / size
    return c / np.sqrt(k), c * np.sqrt(k), depth


def _ask(peer: str) -> tuple[list[list[float]], float] | None:
    interpreter = os.environ.get("FINGERPAD_PEERS")
    if not interpreter:
        return None
    asked = json.dumps([peer, RADIUS, LOAD, MODULUS, RADII_RATIOS])
    command = [interpreter, "-W", "ignore", "-c", _IN_OWN_ENVIRONMENT, asked]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
    if done.returncode:
        return None
    rows, seconds = json.loads(done.stdout.splitlines()[-1])
    return rows, seconds


@dataclass(frozen=True)
class Measured:
    """Area and semi-axes that one way of measuring finds; NaN where it finds none."""

    area: float
    semi_major: float
    semi_minor: float


_NONE: Final = Measured(np.nan, np.nan, np.nan)


def contact_image(count: int = 2) -> None:
    """Print errors of gross area and semi-axes on images of known truth, and the time of an image."""
    images = [image for _, image in independent_images(count, seed=77)]
    print(f"\nContact images of independent truth: {len(images)} in {len(CONDITIONS)} conditions")
    print(f"    {'':<40}{'area: bias, rms, worst':>28}{'semi-axes: rms':>17}{'ms an image':>14}{'none':>6}")
    for name, way in (
        ("fingerpad", _by_fingerpad),
        ("scikit-image: Otsu, closing, regionprops", _by_scikit_image),
        ("as in ImageJ: IsoData, close, fill, fit", _by_imagej),
        ("pyfing: GMFS", _by_pyfing),
    ):
        found = [way(image) for image in images]
        area = np.array([one.area / image.gross_area - 1 for one, image in zip(found, images, strict=True)])
        axes = np.array(
            [
                (one.semi_major / image.semi_major - 1, one.semi_minor / image.semi_minor - 1)
                for one, image in zip(found, images, strict=True)
            ]
        )
        seconds = best(lambda way=way: way(images[0]), repeats=3)  # type: ignore[misc]
        errors = (np.nanmean(area), _rms(area), np.nanmax(np.abs(area)))
        numbers = ", ".join(f"{100 * value:.1f} %" for value in errors)
        none = int(np.isnan(area).sum())
        print(f"    {name:<40}{numbers:>28}{100 * _rms(axes):>15.1f} %{1e3 * seconds:>14.0f}{none:>6}")


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.nanmean(values**2)))


def _by_fingerpad(image: IndependentImage) -> Measured:
    try:
        found = measure_contact_image(image.pixels, image.mm_per_px)
    except ImageError:
        return _NONE
    ellipse = found.ellipse
    return Measured(found.gross_area, float(ellipse.semi_major), float(ellipse.semi_minor))


def _by_scikit_image(image: IndependentImage) -> Measured:
    """Measure as a script does: darker than Otsu's level, valleys closed over 1 mm, the largest region."""
    grey = _dark_on_light(image)
    ridges = grey < filters.threshold_otsu(grey)
    return _largest_region(morphology.closing(ridges, morphology.disk(round(0.5 / image.mm_per_px))), image)


def _by_imagej(image: IndependentImage) -> Measured:
    """Measure as a macro does: despeckle, IsoData, dilate and erode, fill holes, fit an ellipse."""
    grey = cv2.medianBlur(_dark_on_light(image), 3)
    ridges = (grey < filters.threshold_isodata(grey)).astype(np.uint8)
    kernel = np.ones((3, 3), np.uint8)
    times = round(0.5 / image.mm_per_px)
    closed = cv2.erode(cv2.dilate(ridges, kernel, iterations=times), kernel, iterations=times)
    filled = ndimage.binary_fill_holes(closed)
    return _largest_region(filled, image)


def _by_pyfing(image: IndependentImage) -> Measured:
    """Measure by the gradient-magnitude segmentation of Cappelli (2023), nothing if pyfing is not there."""
    sys.modules.setdefault(
        "keras", ModuleType("keras")
    )  # imported for networks that this method does without
    try:
        methods = import_module("pyfing.segmentation")
    except ImportError:
        return _NONE
    parameters = methods.GmfsParameters(image_dpi=round(25.4 / image.mm_per_px))
    return _largest_region(methods.Gmfs(parameters).run(_dark_on_light(image)) > 0, image)


def _dark_on_light(image: IndependentImage) -> npt.NDArray[np.uint8]:
    depth = np.iinfo(image.pixels.dtype).max
    grey = (image.pixels * (255.0 / depth)).astype(np.uint8)
    return 255 - grey if image.condition.bright else grey


def _largest_region(mask: npt.NDArray[np.bool_], image: IndependentImage) -> Measured:
    regions = measure.regionprops(measure.label(mask))
    if not regions:
        return _NONE
    one = max(regions, key=lambda region: region.area)
    scale = image.mm_per_px
    return Measured(
        one.area_filled * scale**2, one.axis_major_length / 2 * scale, one.axis_minor_length / 2 * scale
    )


def pooled() -> None:
    """Print how pooled means of random effects differ from statsmodels' on the same numbers."""
    random = np.random.default_rng(4)
    worst = np.zeros(2)
    for count in (3, 5, 10, 20):
        std = random.uniform(0.2, 1.0, count)
        values = 14 + 0.6 * random.standard_normal(count) + std * random.standard_normal(count)
        ours = pool_random_effects(values, std)
        theirs = combine_effects(values, std**2, method_re="iterated")
        table = theirs.summary_frame()
        difference = ours.value - table.loc["random effect", "eff"], ours.between_std - np.sqrt(theirs.tau2)
        worst = np.maximum(worst, np.abs(difference))
    print("\nMeans of random effects, 3 to 20 values, against statsmodels (Paule and Mandel)")
    print(f"    largest difference: mean {worst[0]:.1e} mm, standard deviation between {worst[1]:.1e} mm")


def report() -> None:
    """Print all comparisons."""
    hertz()
    contact_image()
    pooled()
    print()
    contact_solver.speed()
