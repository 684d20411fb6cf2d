"""The methods section of a study in words, what is missing in it, and where results come from."""

import platform
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from datetime import UTC, datetime
from typing import Any, Final

import numpy as np

import fingerpad
from fingerpad._arrays import FloatArray
from fingerpad._rounding import two_digits, value_with_uncertainty
from fingerpad._words import counted, joined
from fingerpad.study.engine.task import MEASUREMENT_VERSIONS, library_versions
from fingerpad.study.manifest.models import is_exact
from fingerpad.study.results.study_result import StudyResult
from fingerpad.study.results.summary_file import MethodsRecord

FORMULAS: Final = {
    "contact_edge": "where the pressure vanishes: the outline at half the ridges' local contrast, moved out "
    "by what the contrast within 1.33 ridge periods of it, over the interior's, tells of fading",
    "mean_curvature_radius": "R₀g = 1/H, H from the ellipsoid's shape operator, ESM Eq. (1); of fingers with "
    "photographs the radius along the finger is the mean of the ellipsoid's and the outline's, weighted by "
    "inverse variances, and the uncertainty contains that of the pad's shape",
    "geometric_mean_radius": "R_e = √(R′R″), Johnson (4.25)",
    "radius_from_indentation": "R₀g F₂⁻³, what ESM Eq. (2) means, with Johnson's F₂ (4.26c)",
    "radius_from_area": "R₀g F₁³, Johnson's F₁ (4.29)",
    "radius_from_compliance": "R₀g F₁²/F₂, which matches R_g, the slope of A against πξ",
    "indentation": "ξ = A/(π R_e F₁²/F₂), Johnson (4.26)",
    "reduced_modulus": "E* = 3 W R_e F₁³/(4 (ℓd ℓe)^(3/2)), Johnson (4.26a)",
    "loading_radius": "R_g of A = π R_g ξ, fitted together with the force, F = W(ξ) + zero + drift",
    "uncertainty": "J Σ Jᵀ (GUM Eq. 13), J by complex steps, with the second-order term of each input; or "
    "Monte Carlo (GUM Supplement 1)",
    "pooled": "inverse-variance mean; its standard uncertainty times the Birge ratio where that exceeds one, "
    "and with what contacts share added. The frames of a sequence count as one contact",
}


def provenance(files: Iterable[str], digest: Callable[[str], str]) -> dict[str, Any]:
    """Return what is needed to repeat a run: versions, SHA-256 of every input by `digest`, formulas."""
    return {
        "fingerpad": fingerpad.__version__,
        "python": platform.python_version(),
        "libraries": library_versions(),
        "measurement_versions": dict(MEASUREMENT_VERSIONS),
        "made": datetime.now(UTC).isoformat(timespec="seconds"),
        "inputs_sha256": {name: digest(name) for name in sorted(set(files))},
        "formulas": FORMULAS,
    }


_FACES: Final = ("palmar", "distal", "radial", "ulnar")
_MOST_LISTED: Final = 4


def methods_section(result: StudyResult) -> MethodsRecord:
    """Describe how the numbers of a study came about, as a paper does."""
    paragraphs = (_fingers(result), _contacts(result), _images(result), _models(result), _uncertainty(result))
    texts = (" ".join(sentences) for sentences in paragraphs)
    return MethodsRecord(paragraphs=list(filter(None, texts)), missing=list(_missing(result)))


def _fingers(result: StudyResult) -> Iterator[str]:
    fingers = [finger for finger in result.fingers.values() if finger.has_semi_axes]
    if areas_alone := [finger.name for finger in result.fingers.values() if not finger.has_semi_axes]:
        yield f"Of {_named(areas_alone)}, whose semi-axes are not known, contact areas alone were measured."
    if not fingers:
        return
    persons = len({finger.person for finger in fingers} - {None})
    whose = f" ({counted(persons, 'person')})" if persons else ""
    one = len(fingers) == 1
    model = "modelled as an ellipsoidal cap" if one else "modelled as ellipsoidal caps"
    yield (
        f"The {'pad' if one else 'pads'} of {_named([finger.name for finger in fingers])}{whose} "
        f"{'was' if one else 'were'} {model} (Dzidek et al., J. R. Soc. Interface 14:20160935, 2017)."
    )
    ways: dict[str, list[str]] = {}
    for finger in fingers:
        ways.setdefault(_semi_axes_from(result, finger.name), []).append(finger.name)
    listed = [way if len(ways) == 1 else f"{way} for {_named(names)}" for way, names in ways.items()]
    yield f"{'Its' if one else 'Their'} semi-axes were {joined(listed)}."
    if rendered := [finger.name for finger in fingers if finger.synthetic]:
        yield f"All data of {_named(rendered)} are synthetic, made from known truth."


def _named(fingers: list[str]) -> str:
    """Name fingers, since one may stand under two names, measured in two ways; count many."""
    return joined(fingers) if len(fingers) <= _MOST_LISTED else counted(len(fingers), "finger")


def _semi_axes_from(result: StudyResult, name: str) -> str:
    photographs = next(one for one in result.study.fingers if one.name == name).photographs
    if not photographs:
        return "given"
    seen = [face for face in _FACES if any(one.face == face for one in photographs)]
    kind = "photographs" if any(one.file for one in photographs) else "outlines"
    return f"fitted to {kind} of the {joined(seen)} faces"


def _contacts(result: StudyResult) -> Iterator[str]:
    study, of = result.study, result.study.apparatus
    placed = [*study.observations, *study.sequences]
    if not placed:
        return
    std = study.uncertainty
    wedge = _listed(one.wedge_angle_deg for one in placed)
    alike = len({one.wedge_angle_deg for one in placed}) == 1
    roll = _listed(one.roll_angle_deg for one in placed)
    wedge_std, roll_std = _doubt(std.wedge_angle_deg_std, "°"), _doubt(std.roll_angle_deg_std, "°")
    jig = f", and of the jig ± {std.jig_angle_deg_std:.2g}° for all angles" if std.jig_angle_deg_std else ""
    gain = 100 * std.load_gain_relative_std
    gain_std = f", and of the sensor's gain ± {gain:.2g} % for all loads" if gain else ""
    yield (
        f"{'The pad was' if len(result.fingers) == 1 else 'The pads were'} pressed against "
        f"{of.platen or 'a flat platen'} at {'a wedge angle' if alike else 'wedge angles'} of {wedge}° "
        f"({wedge_std}{jig}) and a roll of {roll}° ({roll_std})."
    )
    # Not contacts: one may be given for each of two ways to measure its finger.
    counts = {"observation": len(study.observations), "sequence": len(study.sequences)}
    given = joined([counted(count, noun) for noun, count in counts.items() if count])
    load = result.rows["load_N"].to_numpy()
    loads = f" of {_range(load)} N" if np.isfinite(load).any() else ""
    sensor = f", measured by {of.force_sensor}" if of.force_sensor else ""
    yield (
        f"Normal loads{loads}{sensor} ({_doubt(100 * std.load_relative_std, ' %')}{gain_std}) are those "
        f"of {given}."
    )
    if moved := " ".join(filter(None, (of.stage and f"by {of.stage}", _velocity(result)))):
        yield f"Finger and platen approached each other {moved}."
    if of.dwell_s:
        yield f"A contact was held for {of.dwell_s:g} s before its image was taken."


def _velocity(result: StudyResult) -> str:
    if stated := result.study.apparatus.approach_mm_per_s:
        return f"at {stated:g} mm/s"
    found = np.array([curve.velocity for curve in result.curves])
    return f"at {_range(found)} mm/s in the loading curves" if np.isfinite(found).any() else ""


def _images(result: StudyResult) -> Iterator[str]:
    of, edge = result.study.apparatus, result.rows["edge_offset_mm_std"].to_numpy()
    if not _has_images(result):
        return
    if of.imaging:
        yield f"Contact images were taken with {of.imaging}."
    if scales := [_scale(result, name) for name in result.scales]:
        more = [f"{len(scales) - _MOST_LISTED} more"] if len(scales) > _MOST_LISTED else []
        calibrated = f", calibrated by {of.scale_calibration}" if of.scale_calibration else ""
        yield f"Scales of pictures{calibrated}: {'; '.join([*scales[:_MOST_LISTED], *more])}."
    yield (
        "The edge of a contact is where the pressure vanishes: the outline at which the ridges fall to half "
        "of their local contrast, moved outwards by what the contrast on both sides of it tells of fading."
    )
    if (edge > 0).any():
        yield f"Its place has a standard uncertainty of {_edge(edge)} mm, which images of one scale share."
    yield "The contact ellipse has its area, and the axis ratio and direction of its second moments."
    yield from _reviewed(result)


def _has_images(result: StudyResult) -> bool:
    return bool(result.study.sequences) or any(one.file for one in result.study.observations)


def _edge(stds: FloatArray) -> str:
    known = stds[stds > 0]
    return " to ".join(dict.fromkeys(two_digits(end) for end in (known.min(), known.max())))


def _reviewed(result: StudyResult) -> Iterator[str]:
    corrected = result.corrected
    if len(corrected):
        counts = Counter(corrected["reviewed"])
        people = sorted(set(corrected["reviewed_by"]) - {None})
        listed = joined([f"{count} {verdict}" for verdict, count in counts.items()])
        yield f"All was measured automatically, then {listed} manually by {joined(people)}."
    else:
        yield "All was measured automatically, without manual review."
    single = (result.rows["status"] == "measured") & result.rows["frame"].isna()
    if left_out := int((single & ~result.rows["pooled"]).sum()):
        contacts = counted(int(single.sum()), "single contact")
        yield f"Because of flags {left_out} of {contacts} were not pooled."


def _models(result: StudyResult) -> Iterator[str]:
    if not result.study.has_models:
        return
    study, of = result.study, result.study.apparatus
    basis = f", {of.poisson_ratio_basis}" if of.poisson_ratio_basis else ""
    yield (
        "Indentation, Young's modulus and corrected radius of curvature follow from load and ellipse by "
        "Hertz theory of elliptical contacts on an elastic half-space (Johnson, Contact Mechanics, 1985), "
        f"with a Poisson's ratio of {study.poisson_ratio:g} "
        f"({_doubt(study.uncertainty.poisson_ratio_std)}){basis}."
    )
    thick = [finger for finger in result.fingers.values() if finger.effective_thickness is not None]
    if thick:
        stated = [(one.name, one.effective_thickness, one.effective_thickness_std) for one in thick]
        listed = joined([f"{value_with_uncertainty(t, std)} mm ({name})" for name, t, std in stated])
        basis = f", {of.thickness_basis}" if of.thickness_basis else ""
        yield (
            "Beside it stands the whole ellipsoid on a layer bonded to rigid bone, of an effective thickness "
            f"of {listed}{basis}."
        )
    if fitted := sum(curve.fit is not None for curve in result.curves):
        yield (
            f"Force, displacement and area of {counted(fitted, 'loading curve')} were fitted together, with "
            "the place of contact, the zero and the drift of the force."
        )


def _uncertainty(result: StudyResult) -> Iterator[str]:
    first_order = result.study.uncertainty.method == "first_order"
    how = "to first order (GUM)" if first_order else "by Monte Carlo simulation (GUM Supplement 1)"
    yield f"Numbers are given ± one standard uncertainty, propagated {how}."
    for synthetic, repeats in result.repeatability.items():
        if repeats.known:
            kind = "synthetic contacts" if synthetic else "contacts"
            yield (
                f"Of {kind} of one finger, placement and load {repeats.groups} were repeated, "
                f"{repeats.count} impressions in all: beyond the noise of their images areas scatter by "
                f"{100 * repeats.area_std:.2g} % and aspect ratios by {100 * repeats.aspect_ratio_std:.2g} % "
                "(standard deviations), which is part of each uncertainty."
            )
    if assumed := result.study.assumed():
        yield f"Assumed to be known: {joined(assumed)}."
    if exact := result.study.taken_as_exact():
        yield f"Taken as exact: {joined(exact)}."
    made = result.provenance
    versions = joined([f"{name} {version}" for name, version in made["measurement_versions"].items()])
    yield f"All was computed with fingerpad {made['fingerpad']} (versions of the measurements: {versions})."


def _missing(result: StudyResult) -> Iterator[str]:
    study, of = result.study, result.study.apparatus
    images, models = _has_images(result), study.has_models
    thickness = any(finger.effective_thickness_mm for finger in study.fingers)
    kinds = set(result.rows["synthetic"].tolist())
    repeated = all(result.repeatability[kind].known for kind in kinds)
    asked = (
        (True, repeated, "repeats, which tell by how much a second impression would differ"),
        (images, of.imaging, "the device that took the contact images (apparatus.imaging)"),
        (images, of.scale_calibration, "how the scales were calibrated (apparatus.scale_calibration)"),
        (True, of.platen, "what the finger was pressed against (apparatus.platen)"),
        (True, of.force_sensor, "the force sensor (apparatus.force_sensor)"),
        (True, of.stage, "what moved finger or platen (apparatus.stage)"),
        (True, _velocity(result), "the velocity of approach (apparatus.approach_mm_per_s)"),
        (bool(study.observations), of.dwell_s, "how long contacts were held (apparatus.dwell_s)"),
        (models, of.poisson_ratio_basis, "the basis of Poisson's ratio (apparatus.poisson_ratio_basis)"),
        (models, thickness, "the thickness of the tissue over bone (effective_thickness_mm of the fingers)"),
        (thickness, of.thickness_basis, "the basis of the effective thickness (apparatus.thickness_basis)"),
    )
    return (words for needed, stated, words in asked if needed and not stated)


def _scale(result: StudyResult, name: str) -> str:
    found, table = result.scales[name], result.study.scales[name]
    if isinstance(found, str):
        return f"{name}, not found"
    if is_exact(table):
        return f"{name}, {found.scale.mm_per_px:.4g} mm/px, taken as exact"
    return f"{name}, {value_with_uncertainty(found.scale.mm_per_px, found.scale.mm_per_px_std)} mm/px"


def _doubt(std: float, unit: str = "") -> str:
    return f"± {std:.2g}{unit}" if std else "taken as exact"


def _listed(values: Iterable[float]) -> str:
    found = sorted(set(values))
    if len(found) > _MOST_LISTED:
        return f"{found[0]:g} to {found[-1]:g}"
    return joined([f"{value:g}" for value in found])


def _range(values: FloatArray) -> str:
    return " to ".join(dict.fromkeys(f"{end:.2g}" for end in (np.nanmin(values), np.nanmax(values))))
