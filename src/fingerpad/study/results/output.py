"""Writing a study's tables: one row per contact, one per load, scatter of repeats, and summary.json."""

import csv
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from json.encoder import encode_basestring
from pathlib import Path
from typing import Any

from fingerpad._csv import csv_cell, write_csv
from fingerpad._json import dumps
from fingerpad.exceptions import FingerpadError
from fingerpad.image import PadSemiAxes
from fingerpad.study.measuring.scales import FoundScale
from fingerpad.study.measuring.sequences import SequenceResult
from fingerpad.study.results.check import UncertaintyCheck
from fingerpad.study.results.columns import COLUMNS
from fingerpad.study.results.exponent import area_exponent
from fingerpad.study.results.loading import LoadingRadius, loading_radius
from fingerpad.study.results.methods import methods_section
from fingerpad.study.results.pooling import PooledRadius
from fingerpad.study.results.study_result import StudyResult
from fingerpad.study.results.summary import Summary
from fingerpad.study.results.table import ResultsTable
from fingerpad.study.results.validity import RADIUS, Validity


def write_tables(result: StudyResult, out: Path) -> None:
    """Write the tables of a run into `out`.

    They are ``results.csv``, ``results_columns.csv``, ``results.json``, ``by_load.csv``,
    ``repeatability.csv``, ``summary.json`` and, where a second person outlined images,
    ``second_operator.csv``.

    Raises
    ------
    FingerpadError
        If a file cannot be written.
    """
    try:
        write_rows(result.rows, out / "results.csv", out / "results.json")
        dictionary = (
            (each.name, each.dtype, each.unit, each.group, each.meaning) for each in COLUMNS.values()
        )
        write_csv(out / "results_columns.csv", [("column", "type", "unit", "group", "meaning"), *dictionary])
        _write_records(out / "by_load.csv", [one.as_record() for one in result.by_load])
        _write_records(out / "repeatability.csv", [line for one in result.scatter for line in one.lines()])
        if result.operator_pairs:
            _write_records(out / "second_operator.csv", [one.as_record() for one in result.operator_pairs])
        record = dumps(summary_record(result), indent=1)
        (out / "summary.json").write_text(record + "\n", encoding="utf-8")
    except OSError as error:
        raise FingerpadError(f"{error.filename}: cannot be written ({error.strerror})") from error


def _write_records(path: Path, records: Sequence[Mapping[str, Any]]) -> None:
    """Write records with the same keys as a table, none as an empty file."""
    write_csv(path, [tuple(records[0]), *(record.values() for record in records)] if records else [])


def write_rows(rows: ResultsTable, table: Path, records: Path) -> None:
    """Write rows as a CSV table and as a JSON array of objects, batch by batch."""
    with (
        table.open("w", newline="", encoding="utf-8") as file,
        records.open("w", encoding="utf-8") as array,
    ):
        lines = csv.writer(file)
        lines.writerow(COLUMNS)
        array.write("[")
        between = "\n"
        for batch in rows.batches():
            # To write a float in decimals costs more than all else: once for both files.
            cells = {name: list(map(csv_cell, batch.items(name))) for name in COLUMNS}
            lines.writerows(zip(*cells.values(), strict=True))
            keyed = (
                [f'  "{name}": {literal}' for literal in _literals(batch, name, cells[name])]
                for name in COLUMNS
            )
            objects = (" {\n" + ",\n".join(items) + "\n }" for items in zip(*keyed, strict=True))
            array.write(between + ",\n".join(objects))
            between = ",\n"
        array.write("\n]\n" if rows else "]\n")


def _literals(rows: ResultsTable, name: str, cells: Sequence[str]) -> list[str]:
    """Return a column as JSON literals, which are its CSV cells but for text and what is not known."""
    if COLUMNS[name].dtype == "text":
        return ["null" if item is None else encode_basestring(item) for item in rows.items(name)]
    return [cell or "null" for cell in cells]


def summary_record(result: StudyResult) -> dict[str, Any]:
    """Return the content of ``summary.json``."""
    return {
        "title": result.study.title,
        "fingers": [
            {
                "finger": finger.name,
                "person": finger.person,
                "source": finger.source,
                "synthetic": finger.synthetic,
                "palmar_mm": finger.semi_axes[0],
                "distal_mm": finger.semi_axes[1],
                "radial_ulnar_mm": finger.semi_axes[2],
                "covariance_mm2": finger.covariance,
                "scale": finger.scale,
                "chi_square": finger.outlines and finger.outlines.chi_square,
                "degrees_of_freedom": finger.outlines and finger.outlines.degrees_of_freedom,
                "p_value": finger.outlines and finger.outlines.p_value,
                "between_faces_relative_std": finger.outlines and finger.outlines.between_relative_std,
                "faces": finger.outlines and _faces(finger.outlines),
                "photographs": [
                    {
                        "face": one.manifest.face,
                        "file": one.manifest.file,
                        "uncertainty_mm_std": one.uncertainty,
                        "arc_deg": one.arc_deg,
                        "exponent": one.exponent and one.exponent[0],
                        "exponent_std": one.exponent and one.exponent[1],
                        "outline_radii_deg_mm": one.outline_radii,
                        "flags": one.flags,
                    }
                    for one in finger.photographs
                ],
                "reason": finger.reason,
            }
            for finger in result.fingers.values()
        ],
        "summaries": [
            _summary(
                summary,
                check,
                loading_radius(result.curves, summary.place),
            )
            | _headline(validity)
            | {"validity": validity.as_record()}
            for summary, check, validity in zip(
                result.summaries, result.checks, result.validities, strict=True
            )
        ],
        "repeatability": {
            "contact": [
                {
                    "synthetic": synthetic,
                    "contact_area_log_std": one.area_std if one.known else None,
                    "aspect_ratio_log_std": one.aspect_ratio_std if one.known else None,
                    "log_radius_and_elongation_covariance": one.covariance if one.known else None,
                    "degrees_of_freedom": one.freedom,
                    "groups": one.groups,
                    "count": one.count,
                    "missing": one.missing or None,
                }
                for synthetic, one in result.repeatability.items()
                if (result.rows.column("synthetic") == synthetic).any()
            ],
            "scatter": [one.as_record() for one in result.scatter],
        },
        "second_operator": [one.as_record() for one in result.operators],
        "by_load": [one.as_record() for one in result.by_load],
        "sequences": [
            _sequence(sequence, frames)
            for sequence, frames in zip(result.sequences, result.frames(), strict=True)
        ],
        "scales": {name: _scale(scale) for name, scale in result.scales.items()},
        "curves": [
            {
                "file": curve.manifest.file,
                "finger": curve.manifest.finger,
                "wedge_angle_deg": curve.manifest.wedge_angle_deg,
                "synthetic": curve.manifest.synthetic,
                "loading_radius_mm": curve.loading_radius,
                "loading_radius_mm_std": curve.loading_radius_std,
                "velocity_mm_per_s": curve.velocity,
                "reason": curve.reason,
                "fit": curve.fit and curve.fit.as_record(),
                "layer": curve.layer and curve.layer.as_record(),
                "on_layer": layered and layered.as_record(),
            }
            for curve, layered in zip(result.curves, result.curves_on_layer(), strict=True)
        ],
        "failures": result.failures,
        "methods": asdict(methods_section(result)),
        "provenance": result.provenance,
    }


def _faces(outlines: PadSemiAxes) -> list[dict[str, Any]]:
    """Return the semi-axes of each face, mm, and by how much they exceed the joint ones, relative to them."""
    return [
        {
            "face": one.face,
            **{f"{axis}_mm": float(length) for axis, length in zip(off, one.semi_axes, strict=True)},
            **{f"{axis}_relative_difference": value for axis, value in off.items()},
            "flags": sorted(one.flags),
        }
        for one, off in zip(outlines.faces, outlines.disagreements, strict=True)
    ]


def _summary(
    summary: Summary, check: UncertaintyCheck | None, loading: LoadingRadius | None
) -> dict[str, Any]:
    first, contacts = summary.rows[0], summary.contacts
    return {
        "finger": summary.finger,
        "wedge_angle_deg": summary.wedge_angle_deg,
        "roll_angle_deg": summary.roll_angle_deg,
        "synthetic": summary.synthetic,
        "count": len(contacts),
        "frames": len(summary.rows) - len(contacts),
        "mean_curvature_radius_mm": first["mean_curvature_radius_mm"],
        "mean_curvature_radius_mm_std": first["mean_curvature_radius_mm_std"],
        "geometric_mean_radius_mm": first["geometric_mean_radius_mm"],
        "geometric_mean_radius_mm_std": first["geometric_mean_radius_mm_std"],
        **_pooled("radius_from_indentation", summary.corrected_radius),
        **_pooled("radius_from_compliance", summary.compliance_radius),
        "on_layer": summary.layer and summary.layer.as_record(),
        "loading_radius_mm": loading and loading.value,
        "loading_radius_mm_std": loading and loading.std,
        **_exponent(contacts or summary.rows),
        "uncertainty_check": check and asdict(check),
    }


def _headline(validity: Validity) -> dict[str, Any]:
    """Return what stands beside the pooled corrected radius: its total uncertainty, and the verdict on it."""
    radius = validity.headlines[RADIUS]
    return {
        f"{RADIUS}_model_std": radius.model_std,
        f"{RADIUS}_total_std": radius.total_std,
        f"{RADIUS}_verdict": radius.verdict,
    }


def _sequence(sequence: SequenceResult, frames: ResultsTable) -> dict[str, Any]:
    of, summary = sequence.manifest, sequence.summary
    counts = (
        {}
        if summary is None
        else {
            "frames": summary.count,
            "frames_with_contact": summary.measured,
            "frames_without_contact": summary.without_contact,
            "frames_failed": summary.failed,
            "phases": summary.phases,
            "first_contact_frame": summary.first_contact,
            "notes": summary.notes,
        }
    )
    manual = of_phases.correction if (of_phases := sequence.phases) else None
    return {
        "sequence": of.name,
        "finger": of.finger,
        "wedge_angle_deg": of.wedge_angle_deg,
        "roll_angle_deg": of.roll_angle_deg,
        "synthetic": of.synthetic,
        **counts,
        "phases_corrected_by": of_phases and of_phases.who,
        "phases_corrected_at": of_phases and of_phases.when,
        "phases_reason": manual and manual.why,
        "phase_starts_s": manual and [[one.phase, one.start_s] for one in manual.starts],
        "rows": len(frames),
        "pooled": int(frames.column("pooled").sum()),
        **_exponent(frames),
        "overlays": [overlay._asdict() for overlay in sequence.overlays],
        "reason": sequence.reason,
    }


def _exponent(rows: ResultsTable) -> dict[str, float]:
    exponent = area_exponent(rows)
    return {"area_exponent": exponent.value, "area_exponent_std": exponent.std}


def _scale(scale: FoundScale | str) -> dict[str, Any]:
    if isinstance(scale, str):
        return {"reason": scale}
    return {
        "mm_per_px": scale.scale.mm_per_px,
        "mm_per_px_std": scale.scale.mm_per_px_std,
        "flags": scale.flags,
    }


def _pooled(name: str, pooled: PooledRadius | None) -> dict[str, Any]:
    if pooled is None:
        return {f"{name}_mm": None, f"{name}_count": 0}
    return {
        f"{name}_mm": pooled.value,
        f"{name}_mm_std": pooled.std,
        f"{name}_mm_fixed_geometry_std": pooled.fixed_geometry,
        f"{name}_mm_ci95": pooled.random.interval,
        f"{name}_count": pooled.count,
        f"{name}_effective_count": pooled.effective_count,
        f"{name}_largest_weight": pooled.largest_weight,
        f"{name}_birge_ratio": pooled.fixed.birge_ratio,
        f"{name}_same_for_all_mm": pooled.fixed.value,
        f"{name}_same_for_all_mm_std": pooled.fixed.total_std,
        f"{name}_between_std_mm": pooled.random.between_std,
        f"{name}_scatter_within_loads_mm": pooled.scatter.components["repeat"].std,
        f"{name}_scatter_between_loads_mm": pooled.scatter.components["load"].std,
        f"{name}_variance_shares": pooled.budget,
    }
