"""Studies whose pads and contacts are drawn at random: what claims about radii, moduli and means share."""

from collections.abc import Mapping
from typing import Any, TypeAlias

import numpy as np

from benchmarks.arrays import Array
from fingerpad._arrays import ArrayLike
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.study.manifest.models import Finger, Observation, Study
from fingerpad.study.measuring.contacts import Measurement
from fingerpad.study.measuring.fingers import FingerResult

# What a study has of one contact.
Seen: TypeAlias = tuple[Observation, Measurement]
NAMES = "palmar", "distal", "radial_ulnar"
# The pad of Table 1 of Dzidek et al. (2017), and its place on a wedge of 30 degrees.
TABLE_1 = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
PLACED = Placement(TABLE_1, wedge_angle=np.radians(30))
# What a semi-axis that is given exactly states, mm.
EXACT = 1e-9


def study_of(
    fingers: Mapping[str, str | None], axes: Array, std: float = EXACT, **uncertainty: float
) -> Study:
    """Return a study of fingers, each with its person, of one pad; angles are exact unless they are given."""
    known = {"wedge_angle_deg_std": 0.0, "roll_angle_deg_std": 0.0} | uncertainty
    lengths, stds = dict(zip(NAMES, axes.tolist(), strict=True)), dict.fromkeys(NAMES, std)
    given = [
        {"name": name, "person": who, "semi_axes_mm": lengths, "semi_axes_mm_std": stds}
        for name, who in fingers.items()
    ]
    return Study.model_validate({"title": "simulated", "fingers": given, "uncertainty": known})


def finger(name: str, axes: Array, std: float = EXACT, **more: Any) -> FingerResult:
    """Return a finger whose semi-axes were given; `more` is what its manifest says beside them."""
    manifest = Finger(name=name, **more)
    return FingerResult(manifest=manifest, semi_axes=axes, covariance=std**2 * np.eye(3), source="given")


def contact(
    name: str,
    load: float,
    axes: ArrayLike,
    covariance: Array,
    *,
    measured_load: float | None = None,
    finger: str = "f",
    session: str | None = None,
    wedge_deg: float = 30.0,
    relative_scale_std: float = 0.0,
    **more: Any,
) -> Seen:
    """Return a contact image and what was measured in it: semi-axes, mm, sorted, and their covariance.

    What the scale leaves open is added to the covariance. The area is the ellipse's.
    """
    sizes = np.sort(np.asarray(axes, dtype=float))[::-1]
    area, edge_std = float(np.pi * sizes.prod()), more.get("edge_offset_mm_std", 0.0)
    noise = area * np.sqrt((1 / sizes) @ (covariance - edge_std**2) @ (1 / sizes))
    edge = area * edge_std * (1 / sizes).sum()
    image: Any = {"name": name, "file": "x.png", "scale": "s", "finger": finger, "session": session}
    return Observation(wedge_angle_deg=wedge_deg, load_N=load, **image), Measurement(
        observation=name,
        load_N=load if measured_load is None else measured_load,
        semi_major_mm=float(sizes[0]),
        semi_minor_mm=float(sizes[1]),
        covariance_mm2=covariance + relative_scale_std**2 * np.outer(sizes, sizes),
        gross_area_mm2=area,
        gross_area_mm2_std=float(np.hypot(np.hypot(noise, edge), 2 * relative_scale_std * area)),
        gross_area_mm2_noise_std=float(noise),
        gross_area_mm2_edge_std=float(edge),
        relative_scale_std=relative_scale_std,
        scale="s",
        **more,
    )
