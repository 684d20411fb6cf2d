"""One summary per finger and placement: pooled radii, and the radius from loading data beside them."""

import math
import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.exceptions import FingerpadError
from fingerpad.loading import ContactCompliance, LoadingCurve, fit_contact_compliance, read_loading_curve
from fingerpad.study.manifest import Curve
from fingerpad.study.rows import Row, Rows
from fingerpad.uncertainty import PAD_OUTPUTS, Pooled, pool


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CurveResult:
    """Loading data and the effective radius R_g from them.

    Attributes
    ----------
    manifest : Curve
        What the manifest says of it.
    effective_radius, effective_radius_std : float
        R_g, mm; NaN where it could not be had, and for an uncertainty that was not given.
    curve : LoadingCurve or None
        The data; None where R_g was given or they could not be read.
    fit : ContactCompliance or None
        The line whose slope is R_g.
    reason : str or None
        Why there is no R_g.
    """

    manifest: Curve
    effective_radius: float = math.nan
    effective_radius_std: float = math.nan
    curve: LoadingCurve | None = None
    fit: ContactCompliance | None = None
    reason: str | None = None

    @property
    def name(self) -> str:
        """The file, or whose radius was given."""
        return (
            self.manifest.file
            or f"{self.manifest.finger} at {self.manifest.wedge_angle_deg:g}°, R_g as given"
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Summary:
    """All good rows of one finger at one placement.

    Attributes
    ----------
    finger, wedge_angle_deg, roll_angle_deg, synthetic
        What the rows have in common.
    rows : tuple of Row
        The rows, by load.
    corrected_radius : Pooled or None
        Pooled ``radius_from_indentation_mm``, the source's combined R_g^corr; None without a sound row.
    compliance_radius : Pooled or None
        Pooled ``radius_from_compliance_mm``, the one to compare with R_g.
    """

    finger: str
    wedge_angle_deg: float
    roll_angle_deg: float
    synthetic: bool
    rows: tuple[Row, ...]
    corrected_radius: Pooled | None
    compliance_radius: Pooled | None


def curve_result(curve: Curve, folder: Path) -> CurveResult:
    """Read and fit one loading curve; one that cannot be used costs itself only."""
    if curve.file is None:
        assert curve.effective_radius_mm is not None  # the manifest's own rule
        return CurveResult(
            manifest=curve,
            effective_radius=curve.effective_radius_mm,
            effective_radius_std=curve.effective_radius_std_mm or math.nan,
        )
    data = None
    try:
        data = read_loading_curve(
            folder / curve.file, {str(key): value for key, value in curve.columns.items()}
        )
        fit = fit_contact_compliance(data)
    except FingerpadError as error:
        return CurveResult(manifest=curve, curve=data, reason=_named(error, curve.file, folder))
    return CurveResult(
        manifest=curve,
        effective_radius=fit.effective_radius,
        effective_radius_std=fit.effective_radius_std,
        curve=data,
        fit=fit,
    )


def _named(error: FingerpadError, file: str, folder: Path) -> str:
    """Return an error's words, which begin with the file's name in the study."""
    words = str(error).replace(f"{folder}{os.sep}", "")
    return words if words.startswith(file) else f"{file}: {words}"


def curve_of(curves: Iterable[CurveResult], summary: "Summary") -> CurveResult | None:
    """Return the loading data of a summary's finger at its angle, as real or as synthetic as its rows."""
    for curve in curves:
        same = curve.manifest.finger == summary.finger and curve.manifest.synthetic == summary.synthetic
        if same and curve.manifest.wedge_angle_deg == summary.wedge_angle_deg and curve.reason is None:
            return curve
    return None


def summaries(rows: Rows) -> list[Summary]:
    """Pool the good rows of each finger at each placement; synthetic and real rows never mix."""
    groups: dict[tuple[str, float, float, bool], list[int]] = {}
    for place, index in enumerate(rows.good):
        row = rows.rows[index]
        key = (row["finger"], row["wedge_angle_deg"], row["roll_angle_deg"], row["synthetic"])
        groups.setdefault(key, []).append(place)
    return [_summary(key, rows, places) for key, places in groups.items()]


def _summary(key: tuple[str, float, float, bool], rows: Rows, places: list[int]) -> Summary:
    sound = [place for place in places if rows.rows[rows.good[place]]["pooled"]]

    def pooled(output: str) -> Pooled | None:
        if not sound:
            return None
        column = PAD_OUTPUTS.index(output)
        shared: FloatArray = rows.shared[sound, column]
        return pool(rows.value[sound, column], rows.own_std[sound, column], shared @ shared.T)

    members = sorted((rows.rows[rows.good[place]] for place in places), key=lambda row: float(row["load_N"]))
    return Summary(
        finger=key[0],
        wedge_angle_deg=key[1],
        roll_angle_deg=key[2],
        synthetic=key[3],
        rows=tuple(members),
        corrected_radius=pooled("radius_from_indentation"),
        compliance_radius=pooled("radius_from_compliance"),
    )


def area_exponent(summary: Summary) -> float:
    """Return the slope of ln A against ln W over a summary's sound rows, NaN with fewer than two loads."""
    sound = [row for row in summary.rows if row["pooled"]]
    load = np.array([row["load_N"] for row in sound])
    area = np.pi * np.array([row["semi_major_mm"] * row["semi_minor_mm"] for row in sound])
    if np.unique(load).size < 2:
        return float("nan")
    return float(np.polyfit(np.log(load), np.log(area), 1)[0])
