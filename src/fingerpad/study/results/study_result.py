"""Everything that a run found, once all is measured."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import compress
from pathlib import Path
from typing import Any, Final, TypeVar

import numpy as np
import pandas as pd

from fingerpad import uncertainty
from fingerpad._arrays import FloatArray
from fingerpad._digest import digest_of_values
from fingerpad._display import Displayed
from fingerpad._words import counted
from fingerpad.study.engine.runner import Perform
from fingerpad.study.engine.task import Record, Task, versions_of
from fingerpad.study.manifest.models import Study
from fingerpad.study.measuring.contacts import QUANTITIES, OperatorPair
from fingerpad.study.measuring.context import FoundScale
from fingerpad.study.measuring.curves import CurveResult, loading_radius
from fingerpad.study.measuring.fingers import FingerResult
from fingerpad.study.measuring.run import Measured
from fingerpad.study.measuring.sequences import SequenceResult
from fingerpad.study.results import summary_file
from fingerpad.study.results.pooling import PooledRadius, Summary, exponent_keys, pool_contacts
from fingerpad.study.results.repeats import contact_repeatability, pool_by_load, study_scatter
from fingerpad.study.results.rows import HighestLoad, Rows
from fingerpad.study.results.table import groups, records
from fingerpad.study.results.validity.checks import validity_of, with_verdicts
from fingerpad.study.results.validity.model_checks import RADIUS
from fingerpad.uncertainty.repeats import ContactRepeatability

_RADIUS: Final = "radius_from_indentation"
_Value = TypeVar("_Value")


def _corrected_radius(**inputs: FloatArray) -> dict[str, FloatArray]:
    return {_RADIUS: uncertainty.pad_model(**inputs)[_RADIUS]}


def check_uncertainty(observation: str, inputs: uncertainty.Inputs) -> summary_file.UncertaintyCheckRecord:
    """Propagate the inputs of one contact by first order and by Monte Carlo."""
    inputs = _with_independent_groups(inputs)
    first = uncertainty.propagate(_corrected_radius, inputs)
    simulated = uncertainty.run_monte_carlo(_corrected_radius, inputs)
    radius, drawn = first[_RADIUS], simulated[_RADIUS]
    return summary_file.UncertaintyCheckRecord(
        observation=observation,
        value=float(radius.value),
        std=float(radius.std),
        interval=(float(radius.lower), float(radius.upper)),
        simulated_std=float(drawn.std),
        simulated_interval=(float(drawn.lower), float(drawn.upper)),
        draws=simulated.draws,
        converged=simulated.converged[_RADIUS],
        valid=uncertainty.validate_linear_approximation(first, simulated)[_RADIUS].valid,
        shares={source: float(share) for source, share in first.budget(_RADIUS).items()},
        total=uncertainty.sobol_indices(_corrected_radius, inputs)[_RADIUS].total,
    )


def _with_independent_groups(inputs: uncertainty.Inputs) -> uncertainty.Inputs:
    """Return inputs with semi-axes and scale as one group where the same scale is in both."""
    axes, scale = (inputs.groups[source] for source in ("semi-axes", "image scale"))
    if not inputs.covariance[inputs.places(axes), inputs.places(scale)].any():
        return inputs
    rest = {source: names for source, names in inputs.groups.items() if names not in (axes, scale)}
    return replace(inputs, groups={"semi-axes and scale": axes + scale, **rest})


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class StudyResult(Displayed):
    """Everything that a run found."""

    study: Study
    folder: Path
    fingers: dict[str, FingerResult]  # semi-axes by finger
    # One per observation, and one per frame in contact of a sequence. Cells can be set in a copy alone.
    rows: pd.DataFrame
    sequences: list[SequenceResult]
    scales: dict[str, FoundScale | str]  # named scales, or why there is none
    summaries: list[Summary]  # one per finger and placement
    placements: list[summary_file.PlacementRecord]  # what each summary comes to, and whether the model holds
    # what repeats tell of one impression: of a real contact (False), of a synthetic one (True)
    repeatability: dict[bool, ContactRepeatability]
    scatter: list[summary_file.ScatterRecord]  # of each quantity between repeats, sessions, fingers, persons
    by_load: list[summary_file.AtLoadRecord]  # area and modulus of each finger at each load
    curves: list[CurveResult]
    provenance: dict[str, Any]  # versions, input hashes, formulas
    notes: tuple[str, ...] = ()  # what is odd about people's corrections
    # contact images that two persons outlined, the second without seeing what the first drew
    operator_pairs: list[OperatorPair] = field(default_factory=list)

    def compared_pairs(self, *, synthetic: bool) -> list[OperatorPair]:
        """Return the images that were measured under the outlines of both persons."""
        return [one for one in self.operator_pairs if one.synthetic == synthetic and one.iou is not None]

    @property
    def operators(self) -> list[summary_file.OperatorAgreementRecord]:
        """How two persons agree on the images that both outlined, real ones and synthetic ones."""
        both = (self.compared_pairs(synthetic=False), self.compared_pairs(synthetic=True))
        return [_agreement(pairs) for pairs in both if pairs]

    @property
    def failures(self) -> list[str]:
        """What failed and why, fingers, observations, sequences, scales and curves alike."""
        failed = self.failed_contacts
        given = {reason for _, reason in failed}
        return [
            *(f"{name}: {reason}" for name, reason in failed),
            *(reason for reason in self._shared_reasons if reason not in given),
            *(curve.reason for curve in self.curves if curve.failed and curve.reason is not None),
        ]

    @property
    def _shared_reasons(self) -> list[str]:
        """Why scales and fingers could not be had, each of which many contacts may need."""
        scales = [scale for scale in self.scales.values() if isinstance(scale, str)]
        return [*scales, *(one.reason for one in self.fingers.values() if one.reason is not None)]

    @property
    def failed_contacts(self) -> list[tuple[str, str]]:
        """Contacts that failed, with the reason: one line for those of a sequence, scale or finger."""
        said = self.rows[["observation", "sequence", "frame", "reason"]]  # all columns take much memory
        failed = said[self.rows["status"] == "failed"]
        shared = failed["reason"].isin(self._shared_reasons)
        lines = [
            (some[0] if len(some) == 1 else counted(len(some), "contact"), str(reason))
            for reason, some in failed[shared].groupby("reason", sort=False)["observation"].agg(list).items()
        ]
        failed = failed[~shared]
        frames = failed["frame"].notna()
        lines += [
            (row["observation"], row["reason"]) for row in records(failed[~frames], "observation", "reason")
        ]
        for name, framed in failed[frames].groupby("sequence", sort=False):
            first = framed.iloc[0]
            many = "1 frame" if len(framed) == 1 else f"{len(framed)} frames; the first:"
            lines.append((name, f"{many} {first['frame']}: {first['reason']}"))
        return lines

    @property
    def corrected(self) -> pd.DataFrame:
        """Rows that were corrected or reviewed manually."""
        return self.rows[self.rows["reviewed"].notna() | self.rows["pooling_corrected_by"].notna()]

    def frames(self) -> Iterator[pd.DataFrame]:
        """Yield the rows of frames of each of `sequences`."""
        framed, none = np.flatnonzero(self.rows["frame"].notna()), np.empty(0, dtype=np.intp)
        places = groups(self.rows[["sequence"]].iloc[framed], "sequence")
        for sequence in self.sequences:
            yield self.rows.iloc[framed[places.get((sequence.manifest.name,), none)]]

    def of_finger(self, name: str) -> "StudyResult":
        """Return what was found of one finger, as a study of its own, without the scatter over fingers."""
        lists: dict[str, Any] = {
            key: [one for one in getattr(self.study, key) if one.finger == name]
            for key in ("observations", "sequences", "curves")
        }
        lists["fingers"] = [finger for finger in self.study.fingers if finger.name == name]
        study = self.study.model_copy(update=lists)
        scales = set(study.named_scales())
        study = study.model_copy(update={"scales": _chosen(study.scales, scales)})
        hashes = _chosen(self.provenance["inputs_sha256"], {file for _, file in study.files()})
        own = [summary.finger == name for summary in self.summaries]
        rows = self.rows[self.rows["finger"] == name]
        return replace(
            self,
            study=study,
            fingers={name: self.fingers[name]},
            rows=rows,
            sequences=[sequence for sequence in self.sequences if sequence.manifest.finger == name],
            scales=_chosen(self.scales, scales),
            summaries=[
                replace(one, table=rows, places=rows.index.get_indexer(one.places))
                for one in compress(self.summaries, own)
            ],
            placements=list(compress(self.placements, own)),
            scatter=[],
            by_load=[one for one in self.by_load if one.finger == name],
            curves=[curve for curve in self.curves if curve.manifest.finger == name],
            provenance={**self.provenance, "inputs_sha256": hashes},
            notes=(),
            operator_pairs=[],
        )


def _chosen(mapping: Mapping[str, _Value], keys: Collection[str]) -> dict[str, _Value]:
    return {key: value for key, value in mapping.items() if key in keys}


def _agreement(pairs: Sequence[OperatorPair]) -> summary_file.OperatorAgreementRecord:
    ious = [one.iou or 0.0 for one in pairs]
    quantities = {
        name: uncertainty.agreement([one.first[name] for one in pairs], [one.second[name] for one in pairs])
        for name in QUANTITIES
        if all(one.first[name] > 0 and one.second[name] > 0 for one in pairs)
    }
    return summary_file.OperatorAgreementRecord(
        synthetic=pairs[0].synthetic,
        first_operators=sorted({one.first_operator for one in pairs}),
        second_operators=sorted({one.second_operator for one in pairs}),
        count=len(pairs),
        iou_mean=float(np.mean(ious)),
        iou_least=min(ious),
        **{name: summary_file.AgreementRecord.of(one) for name, one in quantities.items()},
    )


def result_of(
    measured: Measured, *, origin: dict[str, Any], notes: tuple[str, ...], perform: Perform
) -> StudyResult:
    """Return what a study comes to once all is measured: the model of each contact, and pooled radii."""
    study = measured.items.context.study
    repeatability = contact_repeatability(study, measured.fingers, measured)
    rows = Rows(study, measured.fingers, measured, repeatability)
    scatter = study_scatter(study, rows.table)
    found = pool_contacts(rows)
    validities = validity_of(rows, found, measured.curves)
    table = with_verdicts(rows.table, found, validities)
    found = [replace(summary, table=table) for summary in found]
    checks = _checks([rows.highest_load.get(summary.key) for summary in found], perform)
    return StudyResult(
        study=study,
        folder=measured.items.context.folder,
        fingers=measured.fingers,
        rows=table,
        sequences=measured.sequences,
        scales={name: measured.items.context.scale(name) for name in study.scales},
        summaries=found,
        placements=[_placement(*one, measured.curves) for one in zip(found, checks, validities, strict=True)],
        repeatability=repeatability,
        scatter=scatter,
        by_load=pool_by_load(
            rows,
            scatter,
            {summary.key: validity for summary, validity in zip(found, validities, strict=True)},
        ),
        curves=measured.curves,
        provenance=origin,
        notes=notes,
        operator_pairs=measured.operator_pairs,
    )


def _placement(
    summary: Summary,
    check: summary_file.UncertaintyCheckRecord | None,
    validity: summary_file.ValidityRecord,
    curves: Sequence[CurveResult],
) -> summary_file.PlacementRecord:
    loading = loading_radius(curves, summary.finger_and_wedge)
    framed = summary.column("frame").notna()
    counts = summary.places[summary.column("pooled") & (summary.column("load_N") > 0)]
    # Places are by load: the last is that of the highest.
    of_highest = summary.table[["load_N", "gross_area_mm2", "gross_area_mm2_std"]].iloc[counts[-1:]]
    load, area, area_std = of_highest.max()  # of one row; NaN of none
    radius = validity.headlines[RADIUS]
    return summary_file.PlacementRecord.of(
        summary,
        summary.first,  # of the undeformed pad, the same in all rows
        count=int((~framed).sum()),
        frames=int(framed.sum()),
        **_pooled("radius_from_indentation", summary.corrected_radius),
        **_pooled("radius_from_compliance", summary.compliance_radius),
        loading_radius_mm=loading and loading.value,
        loading_radius_mm_std=loading and loading.std,
        highest_load_N=load,
        highest_area_mm2=area,
        highest_area_mm2_std=area_std,
        **exponent_keys(summary.areas),
        uncertainty_check=check,
        radius_from_indentation_mm_model_std=radius.model_std,
        radius_from_indentation_mm_total_std=radius.total_std,
        radius_from_indentation_mm_verdict=radius.verdict,
        validity=validity,
    )


def _pooled(name: str, pooled: PooledRadius | None) -> dict[str, Any]:
    if pooled is None:
        return {f"{name}_mm": None, f"{name}_count": 0}
    return {
        f"{name}_mm": pooled.value,
        f"{name}_mm_std": pooled.total_std,
        f"{name}_mm_fixed_geometry_std": pooled.fixed_geometry,
        f"{name}_mm_ci95": pooled.interval,
        f"{name}_count": pooled.count,
        f"{name}_effective_count": pooled.effective_count,
        f"{name}_largest_weight": pooled.largest_weight,
        f"{name}_birge_ratio": pooled.fixed.birge_ratio,
        f"{name}_same_for_all_mm": pooled.fixed.value,
        f"{name}_same_for_all_mm_std": pooled.fixed.total_std,
        f"{name}_between_std_mm": pooled.between_std,
        f"{name}_scatter_within_loads_mm": pooled.scatter.components["repeat"].std,
        f"{name}_scatter_between_loads_mm": pooled.scatter.components["load"].std,
        f"{name}_variance_shares": pooled.budget,
    }


def _checks(
    highest_load: Sequence[HighestLoad | None], perform: Perform
) -> list[summary_file.UncertaintyCheckRecord | None]:
    """Look closely at the uncertainty of some contacts."""
    tasks = [
        Task(
            name=f"/check {one.observation}",  # no item's name begins like this
            item=one.observation,
            file=one.observation,
            key=digest_of_values(
                summary_file.UncertaintyCheckRecord.__name__,
                one.observation,
                one.inputs,
                versions_of("uncertainty"),
            ),
            work=partial(_checked, one),
            inputs=(),
        )
        for one in highest_load
        if one is not None
    ]
    checks = (record.get("check") for record in perform(tasks).values())
    found = (None if one is None else next(checks) for one in highest_load)
    return [None if one is None else summary_file.UncertaintyCheckRecord.model_validate(one) for one in found]


def _checked(highest_load: HighestLoad, _folder: Path, _out: Path) -> Record:
    return {"check": check_uncertainty(highest_load.observation, highest_load.inputs).model_dump()}
