"""False alarms, detection and coverage of verdicts on the model.

Truths come from equations of benchmarks alone: Johnson (1985), ch. 4, and for tissue
over bone the ratios of a circular contact on a bonded layer (ν = 0.5) by its contact radius over thickness.
"""

import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import pandas as pd
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

from benchmarks.arrays import Array, Rng
from benchmarks.simulated import Seen, contact, finger, study_of
from benchmarks.tables import share, table
from benchmarks.truth.hertz import hertz_ellipse
from fingerpad.geometry import Ellipsoid
from fingerpad.study.manifest.models import Curve, Uncertainty
from fingerpad.study.measuring.curves import CurveResult, RecordedCurve
from fingerpad.study.measuring.fingers import FingerResult
from fingerpad.study.results.pooling import pool_contacts
from fingerpad.study.results.rows import Rows
from fingerpad.study.results.summary_file import ValidityRecord
from fingerpad.study.results.validity.checks import validity_of
from fingerpad.study.results.validity.model_checks import INDENTATION, MODULUS, RADIUS

HEADLINES: Final = (RADIUS, MODULUS, INDENTATION)
VERDICTS: Final = ("holds", "strained", "fails")
LOADS: Final = (0.125, 0.25, 0.5, 1.0)
AXES_STD, WEDGE_STD, LOAD_STD, SCALE_STD, EDGE_STD, NOISE_STD = 0.1, 0.5, 0.02, 0.01, 0.03, 0.04
# Relative, of a radius from loading data that is given without a curve.
LOADING_STD: Final = 0.03

# A/(πRξ), and load over that of Hertz theory at the same area, by a/t.
_OVER_THICKNESS = (0.0, 0.1, 0.3, 0.5, 1.0, 2.0)
_AREA_RATIO = PchipInterpolator(_OVER_THICKNESS, (1.0, 1.086, 1.264, 1.447, 1.80, 2.20))
_LOAD_RATIO = PchipInterpolator(_OVER_THICKNESS, (1.0, 1.00, 1.01, 1.07, 1.39, 2.55))


@dataclass(frozen=True, slots=True, kw_only=True)
class Truth:
    """A pad, and how its contacts depart from Hertz theory on a half-space."""

    modulus: float = 0.3  # E*, MPa
    thickness: float = np.inf  # of the tissue over bone, mm
    curvature: float = 1.0  # radius of the pressed pad over that of its photographs
    area_power: float = 0.0  # extra exponent of the area's growth with load
    falls_above: float = np.inf  # load above which the area falls with it, N
    elongation: float | None = None  # ln of length along the finger over across, if not Hertz theory's
    loads: tuple[float, ...] = LOADS
    press_std: float = 0.0  # relative, of the areas of presses under one load
    with_curve: bool = False  # whether the finger has a loading curve, or R_g alone
    with_areas: bool = True  # whether the curve has areas
    stated_thickness: float | None = None  # what the manifest says of the effective thickness, mm


CASES: Final = {
    "Hertz theory": Truth(),
    "Hertz theory, with curve": Truth(with_curve=True),
    "Hertz theory, with curve without areas": Truth(with_curve=True, with_areas=False),
    "Hertz theory, presses differ by 4.6 %": Truth(press_std=0.046),
    "Hertz theory, two presses that differ so": Truth(press_std=0.046, loads=(0.5, 1.0)),
    "7 mm of tissue over bone": Truth(thickness=7.0, modulus=0.1),
    "7 mm over bone, with curve": Truth(thickness=7.0, modulus=0.1, with_curve=True),
    "7 mm over bone, with curve without areas": Truth(
        thickness=7.0, modulus=0.1, with_curve=True, with_areas=False
    ),
    "4 mm of tissue over bone": Truth(thickness=4.0, modulus=0.1),
    "pad flatter than its photographs by 1.4": Truth(curvature=1.4),
    "the same area at all loads": Truth(area_power=-2 / 3),
    "area falling above 0.4 N": Truth(falls_above=0.4),
    "long axis the other way, 1.4:1": Truth(elongation=np.log(1.4)),
}
HOLDING: Final = ("Hertz theory", "Hertz theory, with curve")


def principal_radii(axes: Array, wedge: float) -> tuple[float, float]:
    """Return the radii of curvature along and across the finger where the wedge's plate touches."""
    a, b, c = axes
    u = np.arctan(b / a * np.tan(wedge))
    S = b**2 * np.cos(u) ** 2 + a**2 * np.sin(u) ** 2
    return float(S**1.5 / (a * b)), float(c**2 * np.sqrt(S) / (a * b))


def press(truth: Truth, radii: tuple[float, float], load: float) -> tuple[float, float, float]:
    """Press the pad: Johnson (4.25)–(4.29), on a layer by its ratios, then as the case has it.

    Returned are contact area, elongation ln(along/across) and indentation.
    """
    along, across = (truth.curvature * radius for radius in radii)
    R = np.sqrt(along * across)
    k, F1, F2 = hertz_ellipse(max(along, across) / min(along, across))

    def surplus(c: float) -> float:
        hertz = 4 * truth.modulus * (c / F1) ** 3 / (3 * R)
        return float(hertz * _LOAD_RATIO(c / truth.thickness)) - load

    top = 10 * (3 * load * R / (4 * truth.modulus)) ** (1 / 3)
    c = brentq(surplus, 1e-3, min(top, 2 * truth.thickness))
    # ξ = a²/R in Hertz theory, times F2/F1² for an ellipse; on a layer divided by A/(πRξ).
    indentation = c**2 / R * F2 / F1**2 / float(_AREA_RATIO(c / truth.thickness))
    area = np.pi * c**2 * (load / LOADS[-1]) ** truth.area_power
    if load > truth.falls_above:
        area *= (truth.falls_above / load) ** 0.9
    direction = 1 if along > across else -1
    elongation = direction * -np.log(k) if truth.elongation is None else truth.elongation
    return float(area), float(elongation), float(indentation)


def measured(truth: Truth, rng: Rng) -> tuple[FingerResult, float, Rows, tuple[float, float]]:
    """Measure contacts of a pad with errors of every input.

    Returned are its finger, the stated wedge angle, its contacts, and the true radii of curvature.
    """
    # Pads with the place of contact longer across the finger, as fingers have it.
    axes, wedge = rng.uniform([7, 12.5, 11], [9, 15, 13]), rng.uniform(30, 45)
    radii = principal_radii(axes, np.radians(wedge + rng.normal(0, WEDGE_STD)))
    study = study_of({"f": None}, axes, AXES_STD, wedge_angle_deg_std=WEDGE_STD, load_relative_std=LOAD_STD)
    t = truth.stated_thickness
    thickness: dict[str, Any] = {"effective_thickness_mm": t, "effective_thickness_mm_std": t and 0.1 * t}
    pad = finger("f", axes + rng.normal(0, AXES_STD, 3), AXES_STD, **thickness)
    rows = Rows(study, {"f": pad}, list(_contacts(truth, radii, wedge, rng)))
    return pad, wedge, rows, radii


def simulated(truth: Truth, seed: int, folder: Path) -> tuple[ValidityRecord, dict[str, float]]:
    """Return what a study says of the model, and what is true of its contact at the highest load."""
    rng = np.random.default_rng([seed, 17])
    pad, wedge, rows, radii = measured(truth, rng)
    summaries = pool_contacts(rows)
    curve = _curve(truth, radii, wedge, pad.semi_axes, rng=rng, folder=folder)
    (validity,) = validity_of(rows, summaries, [curve])
    area, _, indentation = press(truth, radii, truth.loads[-1])
    radius = area / (np.pi * indentation)  # the sphere of the true area and indentation
    return validity, {RADIUS: radius, MODULUS: 750 * truth.modulus, INDENTATION: indentation}


def _contacts(truth: Truth, radii: tuple[float, float], wedge: float, rng: Rng) -> Iterator[Seen]:
    scale, edge = 1 + rng.normal(0, SCALE_STD), rng.normal(0, EDGE_STD)
    for number, load in enumerate(truth.loads):
        area, elongation, _ = press(truth, radii, load)
        c, half = np.sqrt(area / np.pi), np.exp(elongation / 2)
        if truth.press_std:
            c *= np.exp(rng.normal(0, truth.press_std) / 2)
        sides = scale * (np.array([c * half, c / half]) + edge) + rng.normal(0, NOISE_STD, 2)
        yield contact(
            f"c{number}",
            load,
            sides,
            NOISE_STD**2 * np.eye(2) + EDGE_STD**2,
            measured_load=load * (1 + rng.normal(0, LOAD_STD)),
            wedge_deg=wedge,
            edge_offset_mm_std=EDGE_STD,
            long_axis="along" if sides[0] > sides[1] else "across",
            orientation_deg=0.0 if sides[0] > sides[1] else 90.0,
            relative_scale_std=SCALE_STD,
        )


def _curve(
    truth: Truth, radii: tuple[float, float], wedge: float, axes: Array, *, rng: Rng, folder: Path
) -> CurveResult:
    """Return the finger's loading data: R_g with its uncertainty, or a fitted record."""
    if not truth.with_curve:
        area, _, indentation = press(truth, radii, LOADS[-1])
        radius = area / (np.pi * indentation) * (1 + rng.normal(0, LOADING_STD))
        std = LOADING_STD * radius
        curve = Curve(finger="f", wedge_angle_deg=wedge, loading_radius_mm=radius, loading_radius_mm_std=std)
        return CurveResult(manifest=curve, loading_radius=radius, loading_radius_std=std)
    loads = 1.05 * np.linspace(0, 1, 81)[1:] ** 1.5
    areas, _, indentations = np.transpose([press(truth, radii, load) for load in loads])
    force = np.append(np.zeros(20), loads) + rng.normal(0, 0.003, 100)
    areas = np.append(np.zeros(20), areas) + rng.normal(0, 0.3, 100)
    depth = np.append(np.linspace(0, 0.38, 20), 0.4 + indentations) + rng.normal(0, 0.002, 100)
    record = np.column_stack([np.arange(100) * 0.02, force, depth, np.maximum(areas, 0)])
    names = ["time_s", "force_N", "displacement_mm", *(["area_mm2"] if truth.with_areas else [])]
    columns = record[:, : len(names)]
    np.savetxt(folder / "curve.csv", columns, delimiter=",", header=",".join(names), comments="")
    curve = Curve(finger="f", wedge_angle_deg=wedge, file="curve.csv")
    recorded = RecordedCurve(manifest=curve, poisson_ratio=0.5, given=Uncertainty())
    return recorded.fitted(folder, Ellipsoid(*axes))


def scored(validity: ValidityRecord, truth: dict[str, float]) -> dict[str, Any]:
    """Return a verdict, its p-values, and whether intervals hold, with the model's part and without."""
    p_values = [check.p_value for check in validity.checks if np.isfinite(check.p_value)]
    row: dict[str, Any] = {"verdict": validity.verdict, "p_values": p_values}
    for name, true in truth.items():
        found = validity.headlines[name]
        row[name] = abs(found.value - true) < 1.96 * found.total_std
        row[f"{name} without"] = abs(found.value - true) < 1.96 * found.value_std
    return row


def scores(repeats: int, curve_repeats: int, cases: dict[str, Truth] = CASES) -> dict[str, pd.DataFrame]:
    """Return for each case what its simulated studies came to."""
    with tempfile.TemporaryDirectory() as folder:
        found = {}
        for name, truth in cases.items():
            seeds = range(curve_repeats if truth.with_curve else repeats)
            found[name] = pd.DataFrame(scored(*simulated(truth, seed, Path(folder))) for seed in seeds)
        return found


def report(repeats: int = 200, curve_repeats: int = 30) -> None:
    """Print verdicts and coverage."""
    found = scores(repeats, curve_repeats)

    def cells(studies: pd.DataFrame) -> Iterator[str]:
        yield from (share(studies["verdict"] == word) for word in VERDICTS)
        yield from (f"{share(studies[key])} ({share(studies[f'{key} without'])})" for key in HEADLINES)

    head = "truth", "studies", *VERDICTS, "A/(πξ): held (without the model's part)", "E", "ξ"
    rows = ((name, len(studies), *cells(studies)) for name, studies in found.items())
    table(head, rows, "Verdicts on studies of four loads each, and intervals at the highest load")
    p_values = np.concatenate([p for name in HOLDING for p in found[name]["p_values"]])
    below = [f"{100 * np.mean(p_values < limit):.1f} % below {limit:g}" for limit in (0.5, 0.05, 0.001)]
    print(f"\nOf p where the model holds, {', '.join(below)}.")
