"""Writing a study's tables: rows of contacts and loads, scatter of repeats, summary.json and its answer."""

import csv
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from json.encoder import encode_basestring
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from fingerpad._csv import csv_cell, write_csv
from fingerpad._files import explain_write_errors
from fingerpad._rounding import positive_with_uncertainty
from fingerpad._words import counted
from fingerpad.image import SEMI_AXES, PadSemiAxes
from fingerpad.study.measuring.context import FoundScale
from fingerpad.study.measuring.curves import CurveResult
from fingerpad.study.measuring.fingers import FingerResult, PhotographResult
from fingerpad.study.measuring.sequences import SequenceResult
from fingerpad.study.results import summary_file
from fingerpad.study.results.layer import curve_on_layer
from fingerpad.study.results.methods import methods_section
from fingerpad.study.results.pooling import exponent_keys
from fingerpad.study.results.study_result import StudyResult
from fingerpad.study.results.table import COLUMNS, DEFAULT_COLUMNS, batches, items
from fingerpad.study.results.validity import model_checks


def write_tables(result: StudyResult, out: Path, *, all_columns: bool = False) -> None:
    """Write the tables of a run into `out`: of rows, loads, repeats and persons, and the summary."""
    way_out = "what was measured is kept; make room, or choose another --out, and run again to go on"
    with explain_write_errors(out, way_out):
        names = tuple(COLUMNS) if all_columns else DEFAULT_COLUMNS
        write_rows(result.rows, names, out / "results.csv", out / "results.json")
        columns = [COLUMNS[name] for name in names]
        dictionary = ((each.name, each.dtype, each.unit, each.group, each.meaning) for each in columns)
        write_csv(out / "results_columns.csv", [("column", "type", "unit", "group", "meaning"), *dictionary])
        summary = summary_of(result)
        loads = (dict(one).values() for one in summary.by_load)
        write_csv(out / "by_load.csv", [summary_file.AtLoadRecord.model_fields, *loads])
        levels = (dict(level).values() for one in summary.repeatability.scatter for level in one.levels)
        write_csv(out / "repeatability.csv", [summary_file.ScatterLevelRecord.model_fields, *levels])
        if pairs := [one.as_record() for one in result.operator_pairs]:
            write_csv(out / "second_operator.csv", [pairs[0], *(pair.values() for pair in pairs)])
        (out / "summary.json").write_text(summary.text(), encoding="utf-8")


def write_rows(rows: pd.DataFrame, names: Sequence[str], table: Path, records: Path) -> None:
    """Write some columns of rows as a CSV table and as a JSON array of objects, batch by batch."""
    with (
        table.open("w", newline="", encoding="utf-8") as csv_file,
        records.open("w", encoding="utf-8") as array,
    ):
        lines = csv.writer(csv_file)
        lines.writerow(names)
        array.write("[")
        between = "\n"
        for batch in batches(rows):
            # To write a float in decimals costs more than all else: once for both files.
            cells = {name: _cells(batch[name]) for name in names}
            lines.writerows(zip(*cells.values(), strict=True))
            for name in names:
                if COLUMNS[name].dtype == "text":
                    texts = items(batch[name])
                    cells[name] = ["null" if text is None else encode_basestring(text) for text in texts]
            for row in zip(*cells.values(), strict=True):  # at once they would take much memory
                pairs = (f'  "{name}": {cell or "null"}' for name, cell in zip(names, row, strict=True))
                array.write(between + " {\n" + ",\n".join(pairs) + "\n }")
                between = ",\n"
        array.write("\n]\n" if len(rows) else "]\n")


def _cells(column: pd.Series) -> list[str]:
    """Return a column as CSV cells."""
    if column.dtype != float:
        return list(map(csv_cell, items(column)))
    cells = list(map(repr, column.tolist()))
    for row in np.flatnonzero(~np.isfinite(column.to_numpy())).tolist():
        cells[row] = ""
    return cells


def summary_of(result: StudyResult) -> summary_file.SummaryFile:
    """Return the content of ``summary.json``."""
    gain, poisson_ratio = result.study.uncertainty.load_gain_relative_std, result.study.poisson_ratio
    return summary_file.SummaryFile(
        **({"load_gain_relative_std": gain} if gain else {}),
        **({"poisson_ratio": poisson_ratio} if poisson_ratio != 0.5 else {}),
        title=result.study.title,
        fingers=[_finger(finger) for finger in result.fingers.values()],
        summaries=result.placements,
        repeatability=summary_file.RepeatabilityRecord(
            contact=[
                summary_file.ContactRepeatabilityRecord.of(
                    one,
                    synthetic=synthetic,
                    contact_area_log_std=one.area_std if one.known else None,
                    aspect_ratio_log_std=one.aspect_ratio_std if one.known else None,
                    log_radius_and_elongation_covariance=one.covariance.tolist() if one.known else None,
                    degrees_of_freedom=one.freedom,
                )
                for synthetic, one in result.repeatability.items()
                if (result.rows["synthetic"].to_numpy() == synthetic).any()
            ],
            scatter=result.scatter,
        ),
        second_operator=result.operators,
        by_load=result.by_load,
        sequences=[
            _sequence(sequence, frames)
            for sequence, frames in zip(result.sequences, result.frames(), strict=True)
        ],
        scales={name: _scale(found) for name, found in result.scales.items()},
        curves=[_curve(result, curve) for curve in result.curves],
        failures=result.failures,
        methods=methods_section(result),
        provenance=summary_file.ProvenanceRecord.model_validate(result.provenance),
    )


def _scale(found: FoundScale | str) -> summary_file.ScaleRecord:
    if isinstance(found, str):
        return summary_file.ScaleRecord(reason=found)
    scale, flags = found.scale, list(found.flags)
    return summary_file.ScaleRecord(mm_per_px=scale.mm_per_px, mm_per_px_std=scale.mm_per_px_std, flags=flags)


def _finger(finger: FingerResult) -> summary_file.FingerRecord:
    outlines = finger.outlines
    return summary_file.FingerRecord.of(
        finger,
        finger.manifest,
        outlines,
        finger=finger.name,
        **({"digit": finger.manifest.digit} if finger.manifest.digit else {}),
        **{f"{axis}_mm": of for axis, of in zip(SEMI_AXES, finger.semi_axes.tolist(), strict=True)},
        covariance_mm2=finger.covariance.tolist(),
        between_faces_relative_std=outlines and outlines.between_relative_std,
        faces=outlines and _faces(outlines),
        photographs=[_photograph(one) for one in finger.photographs],
    )


def _faces(outlines: PadSemiAxes) -> list[summary_file.FaceRecord]:
    """Return the semi-axes of each face, and by how much they exceed the joint ones, relative to them."""
    return [
        summary_file.FaceRecord(
            face=one.face,
            **{f"{axis}_mm": length for axis, length in zip(off, one.semi_axes.tolist(), strict=True)},
            **{f"{axis}_relative_difference": value for axis, value in off.items()},
            flags=sorted(one.flags),
        )
        for one, off in zip(outlines.faces, outlines.disagreements, strict=True)
    ]


def _photograph(one: PhotographResult) -> summary_file.PhotographRecord:
    exponent, exponent_std = one.exponent or (None, None)
    return summary_file.PhotographRecord.of(
        one, one.manifest, uncertainty_mm_std=one.uncertainty, exponent=exponent, exponent_std=exponent_std
    )


def _sequence(sequence: SequenceResult, frames: pd.DataFrame) -> summary_file.SequenceRecord:
    of, summary, phases = sequence.manifest, sequence.summary, sequence.phases
    counts: dict[str, Any] = {"notes": []}  # the manifest has notes of its own
    if summary is not None:
        counts = {
            "frames": summary.count,
            "frames_with_contact": summary.measured,
            "frames_without_contact": summary.without_contact,
            "frames_failed": summary.failed,
            "phases": summary.phases,
            "first_contact_frame": summary.first_contact,
            "notes": list(summary.notes),
        }
    return summary_file.SequenceRecord.of(
        of,
        sequence=of.name,
        **counts,
        phases_corrected_by=phases and phases.who,
        phases_corrected_at=phases and phases.when,
        phases_reason=phases and phases.correction.why,
        phase_starts_s=phases and [(one.phase, one.start_s) for one in phases.correction.starts],
        rows=len(frames),
        pooled=int(frames["pooled"].sum()),
        **exponent_keys(frames),
        overlays=sequence.overlays,
        reason=sequence.reason,
    )


def _curve(result: StudyResult, curve: CurveResult) -> summary_file.CurveRecord:
    return summary_file.CurveRecord.of(
        curve,
        curve.manifest,
        **({"cycle": curve.manifest.cycle} if curve.manifest.cycle else {}),
        fit=curve.fit and curve.fit.as_record(),
        layer=curve.layer and curve.layer.as_record(),
        on_layer=curve_on_layer(result.study, result.fingers[curve.manifest.finger], curve),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """What was found of a finger at a placement."""

    of: summary_file.PlacementRecord  # the placement, its corrected radius, R_g and checks
    load: float  # its highest load, N; NaN where no contact counts
    area: float  # contact area there, mm²
    area_std: float
    modulus: float  # Young's modulus, kPa
    modulus_std: float  # with the model's part
    modulus_load: float  # its load, N: on bone the highest that is in the range of the laws
    on_bone: bool  # whether that is of tissue of the stated thickness over bone, not by Hertz theory

    @property
    def angles(self) -> str:
        """The wedge angle, and the roll where there is one."""
        roll = f", roll {self.of.roll_angle_deg:g}°".replace("-", "−") if self.of.roll_angle_deg else ""
        return f"{self.of.wedge_angle_deg:g}°{roll}"

    @property
    def label(self) -> str:
        """The finger and its angles."""
        return f"{self.of.finger}, {self.angles}"

    @property
    def text(self) -> str:
        """What was found, without whose it is."""
        of, hertz = self.of, self.of.validity
        seen = counted(of.count or of.frames, "contact" if of.count else "frame")
        off = _largest(hertz.verdict, hertz.checks)
        off = off and f" ({off})"
        if math.isnan(of.mean_curvature_radius_mm):  # a finger without semi-axes
            area = f"contact areas of {seen}"
            if not math.isnan(self.area):
                area = f"{_quantity('contact area', self.area, self.area_std, 'mm²')} under {self.load:.3g} N"
            theory = off and f"; Hertz theory {hertz.verdict}{off}"
            return f"{area}{theory}; no modulus and no radius, as the finger's semi-axes are not known"
        if not of.radius_from_indentation_count:
            return f"no modulus and no corrected radius, as none of {seen} counts"
        layer = hertz.on_layer if self.on_bone else None
        bone = " on its bone" if self.on_bone else " without bone" if of.on_layer else ", bone unknown"
        if layer and layer.verdict in {model_checks.STRAINED, model_checks.FAILS}:
            of_layer = _largest(layer.verdict, layer.checks)
            bone += f" (layer {layer.verdict}{of_layer and f': {of_layer}'})"
        theory = f"; Hertz theory {hertz.verdict}{off}"
        if layer and layer.verdict == hertz.verdict == model_checks.FAILS:
            # The modulus is known to a range at best.
            other = hertz.headlines[model_checks.MODULUS]
            value = _quantity("or", other.value, other.total_std, "kPa")
            theory = f" {value} by Hertz theory, which fails too{off}: report the range"
        elif not self.on_bone and off:
            # Of no use where loading data contradict the pad without bone more than that.
            pad = next(one for one in hertz.checks if one.check == model_checks.OF_PAD)
            routes = {one.verdict for one in hertz.checks if one.check in model_checks.ROUTES.values()}
            off_by_size = pad.verdict in {model_checks.STRAINED, model_checks.FAILS}
            contradicted = model_checks.overall_verdict((*routes, pad.verdict)) != pad.verdict
            if off_by_size and not contradicted and not math.isnan(pad.reference):
                value = _quantity("for the whole pad", pad.reference, pad.reference_std, "kPa")
                theory += f", {value}"
        modulus = _quantity("modulus", self.modulus, self.modulus_std, "kPa")
        if not math.isnan(self.modulus):
            modulus += f" ({self.modulus_load:.3g} N)"
        corrected = of.radius_from_indentation_mm, of.radius_from_indentation_mm_total_std
        return f"{modulus}{bone}{theory}; {_quantity('corrected radius', *corrected, 'mm')}"

    @property
    def sentence(self) -> str:
        """Both as one sentence."""
        return f"{self.label}{' (synthetic)' if self.of.synthetic else ''}: {self.text}."


def answers(
    placements: Iterable[summary_file.PlacementRecord], by_load: Iterable[summary_file.AtLoadRecord]
) -> list[Answer]:
    """Return what was found at each placement."""
    at_loads: dict[summary_file.PlacementKey, list[summary_file.AtLoadRecord]] = {}
    for one in sorted(by_load, key=lambda one: one.load_N):
        at_loads.setdefault(one.key, []).append(one)
    return [_answer(one, at_loads.get(one.key, [])) for one in placements]


def _answer(of: summary_file.PlacementRecord, at_loads: Sequence[summary_file.AtLoadRecord]) -> Answer:
    if not at_loads:  # frames alone: of the one at the highest load
        load, area, area_std = of.highest_load_N, of.highest_area_mm2, of.highest_area_mm2_std
        hertz = of.validity.headlines[model_checks.MODULUS]
        modulus, std = hertz.value, hertz.total_std
    else:
        at = at_loads[-1]
        load, area, area_std = at.load_N, at.contact_area_mm2, at.contact_area_mm2_std
        modulus, std = at.youngs_modulus_kpa, at.youngs_modulus_kpa_std
    modulus_load, on_bone = load, False
    for at in at_loads:  # at the highest in the range of the laws, if any is
        if not math.isnan(at.youngs_modulus_on_layer_kpa):
            modulus, std = at.youngs_modulus_on_layer_kpa, at.youngs_modulus_on_layer_kpa_std
            modulus_load, on_bone = at.load_N, True
    return Answer(
        of=of,
        load=load,
        area=area,
        area_std=area_std,
        modulus=modulus,
        modulus_std=std,
        modulus_load=modulus_load,
        on_bone=on_bone,
    )


def _quantity(words: str, value: float, std: float, unit: str) -> str:
    if math.isnan(value):
        return f"{words} unknown"
    return f"{words} {positive_with_uncertainty(value, std)} {unit}"


def _largest(verdict: str, checks: Sequence[summary_file.CheckRecord]) -> str:
    """Return the largest difference that a verdict rests on; empty where it rests on none."""
    concerned = [one for one in checks if one.verdict == verdict and math.isfinite(one.relative_difference)]
    if verdict not in {model_checks.STRAINED, model_checks.FAILS} or not concerned:
        return ""
    # Of one comparison in several words the first.
    worst = max(concerned, key=lambda one: round(abs(math.log1p(one.relative_difference)), 9))
    if worst.check == model_checks.AREA_FALLS:
        return f"area falls {worst.note}"
    difference = f"{100 * worst.relative_difference:+.0f} %".replace("-", "−")
    return f"{model_checks.QUANTITIES_COMPARED[worst.check]} {difference}"


def answers_of(result: StudyResult) -> list[Answer]:
    """Return what was found of each finger at each placement."""
    return answers(result.placements, result.by_load)
