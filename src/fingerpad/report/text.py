"""Remarks in words."""

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from operator import itemgetter
from typing import Any, Final

import numpy as np
import pandas as pd

from fingerpad._rounding import value_with_uncertainty
from fingerpad._words import capitalized, counted, joined
from fingerpad.flags import FLAGS, Flag, beside_a_layer, flags_in
from fingerpad.image import PadSemiAxes
from fingerpad.loading.layer import THICKER_THAN_FINGER, LayerThicknessFit
from fingerpad.study.corrections.apply import ManualPhases
from fingerpad.study.measuring.curves import CurveResult, loading_radius
from fingerpad.study.measuring.fingers import FingerResult
from fingerpad.study.results.output import Answer
from fingerpad.study.results.pooling import Summary
from fingerpad.study.results.repeats import unlike_growth, unlike_repeats
from fingerpad.study.results.study_result import StudyResult
from fingerpad.study.results.summary_file import CheckRecord, UncertaintyCheckRecord
from fingerpad.study.results.table import items, records
from fingerpad.study.results.validity.checks import PRESS_STD
from fingerpad.study.results.validity.model_checks import (
    AREA_FALLS,
    FAILS,
    HOLDS,
    INDENTATION,
    MODULUS,
    NOT_TESTED,
    RADIUS,
    STRAINED,
)
from fingerpad.uncertainty.scatter import MIN_REPEAT_FREEDOM
from fingerpad.units import KPA_PER_MPA

# They differ in shades of grey too.
VERDICT_SYMBOLS: Final[Mapping[str, str]] = {HOLDS: "✓", STRAINED: "◐", FAILS: "✕", NOT_TESTED: "–"}

# Name, unit and symbol of what has a verdict.
HEADLINE_WORDS: Final[Mapping[str, str]] = {
    RADIUS: "corrected radius (mm)",
    MODULUS: "Young's modulus E from load and area (kPa)",
    INDENTATION: "indentation ξ from the area (mm)",
}

# What to do about a difference, by the name of its check.
_ON_LAYER: Final = "take E and ξ on tissue over bone, which follow from the finger's effective_thickness_mm"
_PRESS_LESS: Final = (
    "press less: the contact is beyond the laws of the whole pad, and no better value is known"
)
_SHAPE: Final = "check wedge and roll angles and semi-axes, from which the shape follows"
_REMEDIES: Final[Mapping[str, str]] = {
    "radius_against_loading": _ON_LAYER,
    "modulus_against_curve": _ON_LAYER,
    "indentation_against_curve": _ON_LAYER,
    "shape": _SHAPE,
    "shape_on_layer": _SHAPE,
    "area_against_load": "give E and ξ with their load, by which they differ; of a sequence check its timing",
    AREA_FALLS: "check loads and outlines of these contacts: under more load an area does not get smaller",
    "youngs_modulus_on_half_space": "press less, or take the value of the whole pad, which stands beside it",
    "indentation_on_half_space": "press less, or take the value of the whole pad, which stands beside it",
    "youngs_modulus_on_layer": "take the value on the layer, which stands beside it",
    "indentation_on_layer": "take the value on the layer, which stands beside it",
    "loading_radius_on_layer": "check the thickness, and the scales of area and displacement",
    "modulus_on_layer": "check the thickness, and the scales of area and displacement",
}

# What makes a source of uncertainty smaller. Of a pad's shape and Poisson's ratio nothing does.
_SMALLER: Final[Mapping[str, str]] = {
    "semi-axes": "measure the semi-axes better, as by photographs of more faces",
    "wedge angle": "measure the wedge angle better",
    "roll angle": "measure the roll angle better",
    "jig angle": "measure the pose of the jig better",
    "image scale": "calibrate the scale better, as by a grid",
    "contact edge": "take pictures with a sharper contact edge",
    "load": "measure the load better",
    "force gain": "calibrate the force better",
    "contact ellipse": "take more contacts",
    "repeatability": "take more contacts",
    "scatter": "take more contacts",
}
_LARGE_SHARE: Final = 0.3

# Moduli of a finger further apart than these, in standard uncertainties and as a ratio, under loads that
# differ by no more than the last, are not of one tissue.
_MOST_APART, _FAR_APART, _LIKE_LOADS = 3.0, 1.2, 1.25

_MOST_NAMED: Final = 3
# Relative scatter of areas of repeats by which images, loads or angles look mixed up.
_MOST_SCATTER: Final = 0.15
# Beyond these, kPa, a modulus is no finger pad's, as of loads in another unit.
_SOFTEST, _HARDEST = 8.0, 500.0
# Range notes of what no finger has.
_OF_NO_FINGER: Final = ("implausible_size", "implausible_modulus", "deeper_than_pad", "as_wide_as_pad")
_NOT_LOADING: Final = "no loading frame, or too small an ellipse"
_AXIS_WORDS: Final[Mapping[str, str]] = {
    "palmar": "palmar",
    "distal": "distal",
    "radial_ulnar": "radial–ulnar",
}


def contact_flags(codes: str | None) -> list[Flag]:
    """Return the flags of a contact, and the range notes that keep it out of pooled results."""
    return list(flags_in(codes or "", "contact", "scale", "frame", "row"))


def photograph_flags(codes: Iterable[str]) -> list[Flag]:
    """Return the flags of a photograph."""
    return list(flags_in(codes, "photograph", "scale"))


def advice(flag: Flag) -> str:
    """Return what a flag means, and what to do about it, as sentences."""
    return f"{capitalized(flag.words)}. To do: {flag.to_do}."


def phase_words(phases: ManualPhases) -> str:
    """Say who set the phases of a sequence manually, where, and why."""
    starts = ", ".join(f"{one.phase} from {one.start_s:.4g} s" for one in phases.correction.starts)
    return f"phases set manually by {phases.who} on {phases.when[:10]}: {starts} ({phases.correction.why})"


def remedies(checks: Iterable[CheckRecord]) -> dict[str, str]:
    """Return what to do about each check that does not hold, by its name; what is said twice at the first."""
    off = [one for one in checks if one.verdict in {STRAINED, FAILS} and one.check in _REMEDIES]
    words = [_PRESS_LESS if math.isnan(one.value) else _REMEDIES[one.check] for one in off]
    first = {to_do: one.check for to_do, one in zip(words[::-1], off[::-1], strict=True)}
    return {check: to_do for to_do, check in first.items()}


def check_words(check: CheckRecord) -> str:
    """Return what a check of the model compares, its verdict, and by how much it is off."""
    off, of = check.relative_difference, f"{check.difference_of} by " if check.difference_of else ""
    numbers = [
        "" if math.isnan(off) else f"{of}{percent(off)}",
        "" if math.isnan(check.p_value) else p_words(check.p_value),
        check.note or "",
    ]
    said = ", ".join(filter(None, numbers))
    return f"{check.compared}: {check.verdict}{f' ({said})' if said else ''}"


def p_words(p_value: float) -> str:
    """Return a probability with its letter."""
    words = probability(p_value)
    return f"p {words}" if words.startswith("<") else f"p = {words}"


def pooling_words(row: Mapping[str, Any]) -> str:
    """Return why a measured row is pooled or not, in words; empty where nothing speaks against it."""
    flags = "; ".join(flag.words for flag in contact_flags(row["excluding_flags"]))
    if row["pooling_corrected_by"]:
        done = "included" if row["pooled"] else "left out"
        words = f"{done} by {row['pooling_corrected_by']}: {row['pooling_reason']}"
        return f"{words} ({flags})" if flags else words
    return flags


def to_do(rows: pd.DataFrame) -> Iterator[str]:
    """Yield what to do about doubtful contacts, for each flag; first about those that are left out."""
    out = rows[~rows["pooled"]]
    cells = (*items(out["excluding_flags"]), *items(out["flags"]), *items(rows["flags"]))
    codes = dict.fromkeys(code for cell in cells for code in (cell or "").split())
    for flag in contact_flags(" ".join(codes)):
        yield f"{flag.words}: {flag.to_do}"


def to_measure_better(result: StudyResult) -> Iterator[str]:
    """Yield what would tell most more: of the tissue, of loading, of repeats, and of the largest uncertainty.

    Synthetic contacts are passed over where there are real ones.
    """
    synthetic = all(summary.synthetic for summary in result.summaries)
    placed = [
        (summary, found.validity)
        for summary, found in zip(result.summaries, result.placements, strict=True)
        if summary.corrected_radius and summary.synthetic == synthetic
    ]
    if shapeless := [name for name, finger in result.fingers.items() if not finger.has_semi_axes]:
        yield f"give semi-axes or photographs of {joined(shapeless, _MOST_NAMED)}: radius and modulus follow"
    if not placed:
        return
    bare = {
        summary.finger: None
        for summary, validity in placed
        if summary.on_layer is None and validity.verdict in {STRAINED, FAILS}
    }
    for curve in result.curves:
        name, layer = curve.manifest.finger, curve.layer
        if name not in bare or layer is None or curve.manifest.synthetic != synthetic:
            continue
        if state := _thickness_keys(layer):
            del bare[name]
            yield f"{state}, for {name} ({curve.name})"
    if bare:
        named = joined(bare, _MOST_NAMED)
        yield f"state the thickness of the tissue over bone of {named}, where Hertz theory is off"
    yield from _to_test_better(result.curves, [summary for summary, _ in placed])
    repeats = result.repeatability[synthetic]
    if repeats.freedom < MIN_REPEAT_FREEDOM:
        few = "the repeats are too few to tell" if repeats.known else "no ± holds"
        yield f"press again under one load, four times or more: {few} what another impression would change"
    shares: Counter[str] = Counter()
    for summary, _ in placed:
        if summary.corrected_radius is not None:
            shares.update(summary.corrected_radius.budget)
    source = max(_SMALLER, key=lambda name: shares[name])
    if (share := shares[source] / len(placed)) > _LARGE_SHARE:
        from_what = "it" if source in _SMALLER[source] else source
        yield (
            f"{_SMALLER[source]}: {100 * share:.0f} % of the variance of the corrected radius, apart from "
            f"the theory's own error, comes from {from_what}"
        )


def _to_test_better(curves: Sequence[CurveResult], summaries: Iterable[Summary]) -> Iterator[str]:
    """Yield what loading data would test that no contact image does."""
    fitted = {curve.manifest.finger_and_wedge for curve in curves if curve.fit}
    doubtful = {curve.manifest.finger_and_wedge for curve in curves if not curve.is_plausible}
    failed = {curve.manifest.finger_and_wedge for curve in curves if curve.failed}
    areas = "record contact areas along the loading curve of {}: without, only its ξ is compared"
    again = "record the loading curve of {} again: it could not be fitted"
    first = "record a loading curve of {}: no contact image tests its own modulus"
    untested: dict[str, dict[str, None]] = {areas: {}, again: {}, first: {}}
    for one in summaries:
        at = one.finger_and_wedge
        if not (loading_radius(curves, at) or at in doubtful):
            wish = areas if at in fitted else again if at in failed else first
            untested[wish][f"{one.finger} at {one.wedge_angle_deg:g}°"] = None
    for wish, where in untested.items():
        if where:
            yield wish.format(joined(where, _MOST_NAMED))


def placement_words(summary: Summary) -> str:
    """Return which finger at which angles a summary is of."""
    roll = f", roll {summary.roll_angle_deg:g}°" if summary.roll_angle_deg else ""
    return f"{summary.finger}, wedge {summary.wedge_angle_deg:g}°{roll}"


def pooled_from(summary: Summary) -> str:
    """Return what the pooled radii come from, in words, and of how many observations."""
    pooled, framed = summary.column("pooled"), summary.column("frame").notna()
    frames = int((pooled & framed).sum())
    sequences = len(set(summary.column("sequence")[pooled]) - {None})
    contacts, seen = int(pooled.sum()) - frames, int((~framed).sum())
    singles = counted(contacts, "observation")
    if contacts < seen:
        singles = f"{contacts} of {counted(seen, 'observation')}"
    parts = [singles] if seen or not sequences else []
    if sequences:
        parts.append(f"{counted(frames, 'frame')} of {counted(sequences, 'sequence')}")
    return " and ".join(parts)


def interval_difference(check: UncertaintyCheckRecord) -> float:
    """Return by how much the ends of a check's two intervals differ at most, mm."""
    return max(abs(one - other) for one, other in zip(check.interval, check.simulated_interval, strict=True))


def names_by_note(summary: Summary) -> dict[str, list[str]]:
    """Return the rows of a summary that have each range note, by name."""
    names: dict[str, list[str]] = {}
    for name, codes in zip(summary.column("observation"), summary.column("range_notes"), strict=True):
        for code in (codes or "").split():
            names.setdefault(code, []).append(name)
    return names


def sequence_notes(result: StudyResult) -> Iterator[str]:
    """Yield what was odd about sequences and what was done about it, as a force that was subtracted."""
    for one, frames in zip(result.sequences, result.frames(), strict=True):
        name, least = one.manifest.name, one.manifest.pool_min_load_N
        yield from (f"{name}: {note}" for note in (one.summary.notes if one.summary else ()))
        rows = frames[frames["status"] == "measured"]
        # What flags leave out is said with them.
        if len(rows) and not rows["pooled"].any() and not rows["excluding_flags"].any():
            why = "none is of the loading phase"
            if (rows["phase"] == "loading").any():
                axis = "the semi-minor axis spans five ridge periods"
                asked = axis if least is None else f"the load is {least:g} N"
                why = f"in none of the loading ones {asked} or more"
            yield f"{name}: none of {len(rows)} frames is pooled: {why}"


def implausible_values(result: StudyResult) -> Iterator[str]:
    """Yield what no finger has, for each finger and placement: a wrong scale, load or unit."""
    for summary, found in zip(result.summaries, result.placements, strict=True):
        for check in found.validity.checks:
            if check.check == AREA_FALLS and check.verdict in {STRAINED, FAILS}:
                falls = f"the area falls by {100 * (1 - check.value):.0f} % {check.note}"
                yield f"{placement_words(summary)}: {falls}: {_REMEDIES[AREA_FALLS]}"
    for summary, found in zip(result.summaries, result.placements, strict=True):
        names, modulus = names_by_note(summary), found.validity.headlines[MODULUS]
        unusual = modulus.value < _SOFTEST or modulus.value > _HARDEST
        if unusual and result.study.surface == "ridged" and "implausible_modulus" not in names:
            yield (
                f"{placement_words(summary)}: Young's modulus is "
                f"{value_with_uncertainty(modulus.value, modulus.total_std)} kPa, where 20 to 200 kPa are "
                "known of finger pads: check loads, in N, and scale"
            )
        for flag in (FLAGS["row"][code] for code in _OF_NO_FINGER if code in names):
            which = joined(names[flag.code], _MOST_NAMED)
            yield f"{placement_words(summary)}: {which}: {flag.words}: {flag.to_do}"


def presses_unlike_repeats(result: StudyResult) -> Iterator[str]:
    """Yield contacts that may be of another finger, load or angle than is stated, by their repeats."""
    for repeats in result.repeatability.values():
        if repeats.known and repeats.area_std > _MOST_SCATTER:
            yield (
                f"presses of one finger under one load differ in area by {100 * repeats.area_std:.0f} %, "
                f"where {100 * PRESS_STD:.0f} % is usual: check that each image has its own load and angle"
            )
    unlike, usual = unlike_repeats(result.rows, result.repeatability.values())
    grown = unlike_growth(result.rows, usual)
    for ratios, of in (
        (unlike, "median area of the presses under one load"),
        ({name: ratio for name, ratio in grown.items() if name not in unlike}, "growth of the other areas"),
    ):
        if ratios:
            off = [f"{100 * abs(ratio - 1):.0f}" for ratio in ratios.values()]
            how_far = " to ".join(dict.fromkeys((min(off, key=int), max(off, key=int))))
            yield (
                f"{joined(ratios, _MOST_NAMED)}: {how_far} % off the {of}, where {100 * usual:.1f} % is "
                "usual: check finger, load, scale and angle"
            )


def to_check(result: StudyResult, answers: Iterable[Answer]) -> Iterator[str]:
    """Yield what looks wrong of the results: what, by how much, and what to do."""
    yield from implausible_values(result)
    yield from presses_unlike_repeats(result)
    yield from moduli_apart(answers)


def curve_words(curve: CurveResult, result: StudyResult) -> dict[str, Any]:
    """Return what a loading curve tells: symbols with their values in words, and its doubts."""
    fit, of = curve.fit, curve.manifest
    facts = {"R_g": value_with_uncertainty(curve.loading_radius, curve.loading_radius_std) + " mm"}
    if fit is not None:
        exponents = {"m of W ∝ ξᵐ": fit.load_exponent, "n of A ∝ Wⁿ": fit.area_exponent}
        facts |= {words: value_with_uncertainty(one.value, one.std) for words, one in exponents.items()}
        modulus = fit.youngs_modulus.times(KPA_PER_MPA)
        facts["E"] = f"{value_with_uncertainty(modulus.value, modulus.std)} kPa"
    doubts = [advice(flag) for flag in _curve_flags(curve, result)]
    return {
        "title": f"{of.finger}, {of.wedge_angle_deg:g}°: {of.file or 'R_g as given'}",
        "synthetic": of.synthetic,
        "facts": {words: value for words, value in facts.items() if not value.startswith("–")},
        "verdict": counted(len(doubts), "doubt") if doubts else "no doubts" if fit else "",
        "doubts": [*filter(None, [curve.reason]), *doubts],
    }


def moduli_apart(answers: Iterable[Answer]) -> Iterator[str]:
    """Yield which moduli of a finger at two angles, under like loads, differ most beyond chance."""
    by_finger: dict[tuple[str, bool, bool], list[Answer]] = {}
    for one in answers:
        by_finger.setdefault((one.of.finger, one.of.synthetic, one.on_bone), []).append(one)
    far = [
        (apart, pair)
        for found in by_finger.values()
        for pair in combinations(found, 2)
        if (apart := _apart(*pair)) > _MOST_APART
    ]
    if not far:
        return
    most, pair = max(far, key=itemgetter(0))
    pairs = Counter(first.of.finger for _, (first, _) in far)
    count = pairs.pop(finger := pair[0].of.finger)
    both = " and ".join(
        f"{value_with_uncertainty(one.modulus, one.modulus_std)} kPa at {one.angles}" for one in pair
    )
    of = f", the furthest of {count} pairs" if count > 1 else ""
    also = f", as moduli of {joined(pairs, _MOST_NAMED)} are too" if pairs else ""
    yield (
        f"{finger}: the moduli {both} are {most:.1f} standard uncertainties apart{of}{also}; one tissue has "
        "one: state each with its angle, and check angles, semi-axes and thickness"
    )


def _apart(first: Answer, second: Answer) -> float:
    """Return how many standard uncertainties two moduli differ by; 0 if by little, or if loads differ."""
    ratio, loads = second.modulus / first.modulus, second.modulus_load / first.modulus_load
    if abs(math.log(ratio)) > math.log(_FAR_APART) and abs(math.log(loads)) < math.log(_LIKE_LOADS):
        return abs(first.modulus - second.modulus) / math.hypot(first.modulus_std, second.modulus_std)
    return 0.0


def why_not_pooled(summary: Summary) -> str:
    """Return why nothing at a placement is pooled, each reason with the number of contacts or frames."""
    contacts = int(summary.column("frame").isna().sum())
    counts = {"contact": contacts, "frame": len(summary.places) - contacts}
    seen = " and ".join(counted(count, noun) for noun, count in counts.items() if count)
    fields = ("excluding_flags", "pooling_corrected_by", "pooling_reason", "pooled")
    rows = summary.table[[*fields]].iloc[summary.places]
    reasons = Counter(pooling_words(row) or _NOT_LOADING for row in records(rows))
    return f"0 of {seen} pooled: " + "; ".join(
        f"{words} ({count})" if len(reasons) > 1 else words for words, count in reasons.items()
    )


def fingers_without_results(result: StudyResult) -> Iterator[str]:
    """Yield what was found of fingers without a measured contact: semi-axes, and radii from loading data."""
    with_contacts = {summary.finger for summary in result.summaries}
    places = dict.fromkeys(one.manifest.finger_and_wedge for one in result.curves)
    for finger in result.fingers.values():
        if finger.name in with_contacts or finger.reason is not None:
            continue
        stds = np.sqrt(np.diag(finger.covariance))
        axes = ", ".join(
            f"{words} {value_with_uncertainty(axis, std)} mm"
            for words, axis, std in zip(_AXIS_WORDS.values(), finger.semi_axes, stds, strict=True)
        )
        axes = f"semi-axes {axes}" if finger.has_semi_axes else "no semi-axes"
        contacts = int(np.count_nonzero(result.rows["finger"] == finger.name))
        pressed = any(one.manifest.finger == finger.name for one in result.sequences)
        why = (
            f"none of {counted(contacts, 'contact')} was measured"
            if contacts
            else "no frame of its sequences is a contact under a known force"
            if pressed
            else "no contact is given"
        )
        yield f"{finger.name}: {axes}{'  (synthetic)' if finger.synthetic else ''}; {why}"
        for place in places:
            name, wedge_angle_deg, synthetic = place
            found = loading_radius(result.curves, place) if name == finger.name else None
            if found is not None:
                label = "  (synthetic)" if synthetic else ""
                radius = f"R_g {value_with_uncertainty(found.value, found.std)} mm"
                words = ", ".join((radius, *_moduli_of_curves(result.curves, place)))
                yield f"{name}, wedge {wedge_angle_deg:g}°: {words} from loading data{label}"


def _moduli_of_curves(curves: Iterable[CurveResult], place: tuple[str, float, bool]) -> Iterator[str]:
    """Yield Young's modulus of each curve of a finger at an angle."""
    for one in curves:
        if one.manifest.finger_and_wedge == place and one.fit is not None and one.is_plausible:
            modulus = one.fit.youngs_modulus.times(KPA_PER_MPA)
            if modulus.known:
                words = value_with_uncertainty(modulus.value, modulus.std)
                yield f"E {words} kPa at {one.fit.modulus_load:.2g} N"


def doubtful_results(result: StudyResult) -> Iterator[str]:
    """Yield what is doubtful of fingers, contacts, sequences and loading curves, and what to do about it."""
    for finger in result.fingers.values():
        for words in _finger_doubts(finger):
            yield f"doubtful: {finger.name}: {words}"
    # Of a large study a copy of all columns takes as much memory as the rest of a run.
    said = result.rows[["observation", "flags", "excluding_flags", "pooled"]]
    contacts = said[result.rows["frame"].isna()]
    for row in records(contacts):
        if row["flags"]:
            words = ", ".join(flag.words for flag in contact_flags(row["flags"]))
            yield f"doubtful: {row['observation']}: {words}"
    for words in to_do(contacts):
        yield f"to do: {words}"
    found: dict[Flag, list[str]] = {}
    for name, count, flag in doubtful_frames(result):
        found.setdefault(flag, []).append(f"{name} ({counted(count, 'frame')})")
    for flag, names in found.items():
        yield f"doubtful: {', '.join(names)}: {flag.words}; to do: {flag.to_do}"
    for flag, names in doubtful_curves(result).items():
        yield f"doubtful: {', '.join(names)}: {flag.words}; to do: {flag.to_do}"


def doubtful_curves(result: StudyResult) -> dict[Flag, list[str]]:
    """Return for each flag of the fits of loading curves the names of the curves."""
    found: dict[Flag, dict[str, None]] = {}  # each curve once, in their order
    for curve in result.curves:
        for flag in _curve_flags(curve, result):
            found.setdefault(flag, {})[curve.name] = None
    return {flag: list(names) for flag, names in found.items()}


def _curve_flags(curve: CurveResult, result: StudyResult) -> Iterator[Flag]:
    """Yield the flags of a curve's fit; where a layer was fitted too, what that says is to be done."""
    fit = curve.fit
    for flag in flags_in(fit.flags, "curve", notes=fit.notes) if fit else ():
        said = flag
        if curve.layer is not None and (said := beside_a_layer(flag)) != flag:
            thick = result.fingers[curve.manifest.finger].manifest.effective_thickness_mm is not None
            state = "" if thick else _thickness_keys(curve.layer)
            said = replace(said, to_do=state or curve.layer.advice)
        yield said


def _thickness_keys(layer: LayerThicknessFit) -> str:
    """Say how to state the thickness that a curve tells, and its E; empty where it tells none."""
    if not (layer.youngs_modulus.known and layer.preferred_model.startswith("layer")):
        return ""
    t = layer.thickness
    if not 0 < t.lower < t.upper < math.inf or THICKER_THAN_FINGER in layer.notes:
        return ""
    value, std = value_with_uncertainty(t.value, t.std).split(" ± ")
    modulus = layer.youngs_modulus.times(KPA_PER_MPA)
    return (
        f"state effective_thickness_mm = {value}, effective_thickness_mm_std = {std}, with which the curve "
        f"gives E = {modulus} kPa"
    )


def doubtful_frames(result: StudyResult) -> Iterator[tuple[str, int, Flag]]:
    """Yield for each sequence and flag the sequence's name, the number of frames, and the flag."""
    frames = result.rows[["sequence", "flags"]][result.rows["frame"].notna()]  # all columns take much memory
    doubts = Counter(zip(frames["sequence"].to_numpy(), frames["flags"].to_numpy(), strict=True))
    counts: Counter[tuple[str, str]] = Counter()
    for (name, flags), count in doubts.items():
        for flag in flags.split():
            counts[name, flag] += count
    for (name, flag), count in counts.items():
        yield name, count, contact_flags(flag)[0]


def probability(p_value: float) -> str:
    """Return a probability with two digits, or as less than a thousandth."""
    if math.isnan(p_value):
        return "–"
    return "< 0.001" if p_value < 0.001 else f"{p_value:.2g}"


def face_differences(outlines: PadSemiAxes) -> str:
    """Return by how much the semi-axes of each face exceed the joint ones, in percent."""
    return "; ".join(
        f"{one.face} face: " + ", ".join(f"{_AXIS_WORDS[axis]} {percent(off)}" for axis, off in found.items())
        for one, found in zip(outlines.faces, outlines.disagreements, strict=True)
    )


def outline_doubts(finger: FingerResult) -> list[str]:
    """Return what makes the outlines of a finger that were given as points doubtful, one text for each."""
    shown = {one.manifest.face for one in finger.photographs}
    return [
        f"{one.face} face: "
        + "; ".join(f"{flag.words} (to do: {flag.to_do})" for flag in photograph_flags(sorted(one.flags)))
        for one in (finger.outlines.faces if finger.outlines else ())
        if one.flags and one.face not in shown
    ]


def _finger_doubts(finger: FingerResult) -> list[str]:
    """Return what makes the semi-axes of a finger doubtful, one text for each doubt."""
    outlines = finger.outlines
    if outlines is None:
        return []
    disagree = f"its faces disagree (p = {outlines.p_value:.2g}): {face_differences(outlines)}"
    return [disagree] * outlines.disagree + [f"outline of the {words}" for words in outline_doubts(finger)]


def percent(share: float) -> str:
    """Return a relative difference in percent, with its sign."""
    return f"{round(100 * share, 1) + 0.0:+.1f} %".replace("-", "−")
