"""One finger of a finished run as a pad with its tissue, for questions beyond the study."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from fingerpad.contact import Tissue, youngs_modulus
from fingerpad.exceptions import FingerpadError
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.study.results.result_set import require_result_set
from fingerpad.study.results.summary_file import PlacementRecord, SummaryFile
from fingerpad.units import KPA_PER_MPA

_CLOSE: Final = 1e-6  # degrees


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredPad:
    """A pad at its placement, its tissue, standard uncertainties by name, and where all that is from."""

    placement: Placement
    tissue: Tissue
    stds: dict[str, float]
    source: str


def measured_pad(
    folder: Path,
    *,
    finger: str | None,
    wedge_deg: float,
    thickness_mm: float | None = None,
    poisson_ratio: float = 0.5,
) -> MeasuredPad:
    """Return a finger of a finished run at one angle of the wedge.

    E and thickness are those that a loading curve gives; without one, or with a thickness stated, E is that
    with which the whole pad has the contact area seen at the highest load.

    Raises
    ------
    FingerpadError
        If there is no finished run, no such finger or placement, or nothing that gives its modulus.
    """
    require_result_set(folder)
    summary = SummaryFile.read(folder)
    found = _placed(summary, folder, finger, wedge_deg)
    axes = summary.finger(found.finger)
    if axes is None or math.isnan(axes.palmar_mm):
        raise FingerpadError(f"{folder}: the semi-axes of {found.finger} are not known there")
    pad = Ellipsoid(palmar=axes.palmar_mm, distal=axes.distal_mm, radial_ulnar=axes.radial_ulnar_mm)
    placement = Placement(
        pad,
        wedge_angle=math.radians(found.wedge_angle_deg),
        roll_angle=math.radians(found.roll_angle_deg),
    )
    stds = dict(
        zip(
            ("palmar", "distal", "radial_ulnar"),
            map(float, np.sqrt(np.diagonal(axes.covariance_mm2))),
            strict=True,
        )
    )
    layers = [
        curve.layer
        for curve in summary.curves
        if curve.layer is not None
        and (curve.finger, curve.wedge_angle_deg, curve.synthetic)
        == (found.finger, found.wedge_angle_deg, found.synthetic)
        and not math.isnan(curve.layer.thickness_mm + curve.layer.youngs_modulus_kpa)
    ]
    if layers and thickness_mm is None:
        best = min(layers, key=lambda layer: layer.thickness_mm_std / layer.thickness_mm)
        modulus, modulus_std = best.youngs_modulus_kpa, best.youngs_modulus_kpa_std
        thickness, thickness_std = best.thickness_mm, best.thickness_mm_std
        source = "E and thickness are those of its loading curve"
    else:
        stated = found.on_layer
        thickness, thickness_std = math.inf, 0.0
        if thickness_mm is not None:
            thickness = thickness_mm
        elif stated is not None:
            thickness, thickness_std = stated.effective_thickness_mm, stated.effective_thickness_mm_std
        modulus, modulus_std, load = _of_contacts(summary, found, placement, thickness, poisson_ratio)
        deep = "deep tissue" if math.isinf(thickness) else f"{thickness:g} mm of tissue"
        source = f"E is that of {deep} with the contact area seen at {load:g} N"
    stds |= {"youngs_modulus": modulus_std / KPA_PER_MPA, "thickness": thickness_std}
    return MeasuredPad(
        placement=placement,
        tissue=Tissue(modulus / KPA_PER_MPA, poisson_ratio, thickness),
        stds={name: std for name, std in stds.items() if std > 0},
        source=f"{found.finger} at {found.wedge_angle_deg:g}°: {source}",
    )


def _placed(summary: SummaryFile, folder: Path, finger: str | None, wedge_deg: float) -> PlacementRecord:
    """Return the one record of a finger at an angle, or say which there are."""
    known = sorted({one.finger for one in summary.summaries})
    if finger is None and len(known) == 1:
        finger = known[0]
    if finger is None or finger not in known:
        what = "name one" if finger is None else f"found no finger {finger!r}"
        raise FingerpadError(f"{folder}: {what}; it has {', '.join(known) or 'none'}")
    placed = [one for one in summary.summaries if one.finger == finger]
    at = [one for one in placed if abs(one.wedge_angle_deg - wedge_deg) < _CLOSE]
    if not at:
        angles = ", ".join(f"{angle:g}°" for angle in sorted({one.wedge_angle_deg for one in placed}))
        raise FingerpadError(f"{folder}: {finger} was not pressed at {wedge_deg:g}°; it was at {angles}")
    return min(at, key=lambda one: (one.synthetic, abs(one.roll_angle_deg)))


def _of_contacts(
    summary: SummaryFile, found: PlacementRecord, placement: Placement, thickness: float, poisson_ratio: float
) -> tuple[float, float, float]:
    """Return E, kPa, its standard uncertainty, and the load of the contacts that give it."""
    seen = [one for one in summary.by_load if one.key == found.key and not math.isnan(one.contact_area_mm2)]
    for one in sorted(seen, key=lambda one: -one.load_N):
        modulus = KPA_PER_MPA * float(
            youngs_modulus(
                placement,
                load=one.load_N,
                area=one.contact_area_mm2,
                thickness=thickness,
                poisson_ratio=poisson_ratio,
            )
        )
        if not math.isnan(modulus):
            relative = one.youngs_modulus_kpa_std / one.youngs_modulus_kpa
            return modulus, 0.0 if math.isnan(relative) else relative * modulus, one.load_N
    raise FingerpadError(
        f"{found.finger} at {found.wedge_angle_deg:g}°: neither a loading curve nor a contact "
        "within the range of the laws gives its modulus; give --semi-axes-mm and --youngs-modulus-kpa in "
        "place of the folder"
    )
