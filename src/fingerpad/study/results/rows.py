"""One row of results per contact: what was seen of it, and what the model says."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import fields
from functools import cache
from itertools import islice, repeat
from operator import length_hint
from types import MappingProxyType
from typing import Any, Final, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, FloatArray
from fingerpad._plausible import PLAUSIBLE_MODULUS_KPA
from fingerpad.image import implausible_size
from fingerpad.study.manifest.models import CORRECTIONS, Contact, Observation, Study
from fingerpad.study.measuring.contacts import Measurement, excluding_flags, is_pooled
from fingerpad.study.measuring.fingers import FingerResult, pad_placement
from fingerpad.study.results.layer import LAYER_PART_SOURCES, POOLED_ON_LAYER, layer_columns, unit_of
from fingerpad.study.results.model import GEOMETRY, PART_SOURCES, POOLED_OUTPUTS, Modelled, contact_inputs
from fingerpad.study.results.summary_file import PLACEMENT, PlacementKey
from fingerpad.study.results.table import COLUMNS, ColumnArray, GrowingArray, Indices, Row, table_of
from fingerpad.uncertainty import PAD_SOURCES, Inputs
from fingerpad.uncertainty.repeats import ContactRepeatability

# Share of the pad's half-width from which a contact is as wide as the finger.
_AS_WIDE: Final = 0.9
# Columns that a measurement has as they are.
_MEASURED: Final = tuple(field.name for field in fields(Measurement) if field.name in COLUMNS)
_OF_THE_CONTACT: Final = np.isin(PART_SOURCES, [source for source in PAD_SOURCES if source not in GEOMETRY])
# The model's derivatives at so many contacts take tens of megabytes.
_AT_ONCE: Final = 500

Seen: TypeAlias = Sequence[tuple[Contact, Measurement]]


class HighestLoad(NamedTuple):
    """The contact under the largest load of those that count at one placement."""

    observation: str
    load: float
    inputs: Inputs  # the model's inputs for it


class Parts:
    """Signed contributions to the uncertainty of some outputs, by part; what is zero takes no memory."""

    def __init__(self, outputs: Sequence[str], sources: npt.NDArray[np.str_], capacity: int) -> None:
        self._arrays = [[GrowingArray(np.empty(0), capacity) for _ in sources] for _ in outputs]

    def add(self, parts: FloatArray) -> None:
        """Add those of some contacts."""
        for arrays, output in zip(self._arrays, np.swapaxes(parts, 0, 1), strict=True):
            for array, part in zip(arrays, output.T, strict=True):
                array.add(part)

    def __getitem__(self, places_and_output: tuple[Indices, int]) -> FloatArray:
        """Return those of some contacts to one output."""
        places, output = places_and_output
        return np.stack([array.array[places] for array in self._arrays[output]], axis=-1)


class Rows:
    """All rows of a study: placement, model and uncertainty of its contacts, with what pooling needs.

    No more than a batch of measurements is held.
    """

    def __init__(
        self,
        study: Study,
        fingers: Mapping[str, FingerResult],
        seen: Iterable[tuple[Contact, Measurement]],
        repeatability: Mapping[bool, ContactRepeatability] = MappingProxyType({}),
    ) -> None:
        self.study, self.fingers, self.repeatability = study, fingers, repeatability
        stream, capacity = iter(seen), length_hint(seen)
        pooled = GrowingArray(np.empty(0, dtype=np.intp), capacity)
        elongation_std = GrowingArray(np.empty(0), capacity)
        # Of the rows that count: signed contributions to the uncertainty of their radii, as `Modelled` has
        # them, and to that of `POOLED_ON_LAYER`, of the sources `LAYER_PART_SOURCES`, NaN without them.
        self.parts = Parts(POOLED_OUTPUTS, PART_SOURCES, capacity)
        self.layer_parts = Parts(POOLED_ON_LAYER, LAYER_PART_SOURCES, capacity)
        # By the values of `PLACEMENT`, without those at which nothing counts; the latter among contacts on a
        # layer, in the range of its laws.
        self.highest_load: dict[PlacementKey, HighestLoad] = {}
        self.highest_on_layer: dict[PlacementKey, HighestLoad] = {}

        def modelled() -> Iterator[dict[str, ColumnArray]]:
            """Yield batches of rows, and keep what else is needed of them."""
            start = 0
            while batch := list(islice(stream, _AT_ONCE)):
                done = _Batch(study, fingers, batch, repeatability)
                yield done.columns
                counts = done.columns["pooled"][done.good]
                pooled.add(start + done.good[counts])
                self.parts.add(done.modelled.parts[counts])
                elongation = done.inputs.places(["elongation", "elongation_deviation"])
                elongation_std.add(np.hypot(*done.inputs.std[counts][:, elongation].T))
                self.layer_parts.add(done.layer_parts[counts])
                done.weigh(self.highest_load, counts)
                done.weigh(self.highest_on_layer, counts & np.isfinite(done.layer_parts).all(axis=(-2, -1)))
                start += len(batch)

        # One row per observation and frame, in the manifest's order.
        self.table = table_of(modelled(), read_only=True, capacity=capacity)
        # Indices in it of the rows that count in pooled radii, ascending; and standard uncertainty of the
        # elongation ln(ℓd/ℓe) of each of their ellipses, with repeatability.
        self.pooled, self.elongation_std = pooled.array, elongation_std.array


def model_contact(
    study: Study, finger: FingerResult, contact: Contact, measured: Measurement, names: Iterable[str]
) -> Row:
    """Return some columns of the row of one contact, as `Rows` does, without making a table."""
    columns = _Batch(study, {finger.name: finger}, [(contact, measured)], {}).columns
    known = ((name, columns[name].tolist()[0] if name in columns else None) for name in names)
    return {name: None if value != value else value for name, value in known}  # noqa: PLR0124


class _Batch:
    """Some rows by column, with inputs and answer of the model for the `good` ones among them."""

    def __init__(
        self,
        study: Study,
        fingers: Mapping[str, FingerResult],
        seen: Seen,
        repeatability: Mapping[bool, ContactRepeatability],
    ) -> None:
        reasons = [measured.rejected or measured.reason for _, measured in seen]
        for row, (_, measured) in enumerate(seen):
            if reasons[row] is None and measured.load_N <= 0:  # a frame, where a force is late or offset
                load = f"the load of a contact must be positive, found {measured.load_N:.3g} N"
                reasons[row] = f"{load}: check force zero and timing"
        has_pad = {name: finger.has_semi_axes for name, finger in fingers.items()}
        sound = np.array(
            [n for n, (contact, _) in enumerate(seen) if has_pad[contact.finger] and reasons[n] is None],
            dtype=np.intp,
        )
        covariance = {synthetic: of.covariance for synthetic, of in repeatability.items()}
        inputs = contact_inputs(study, fingers, [seen[place] for place in sound], covariance)
        self.modelled = Modelled(inputs, study.uncertainty)
        answered = self.modelled.answered
        for place in sound[~answered]:
            reasons[place] = "the model has no finite answer for these values; check their units"
        # Places of the good rows in the batch; inputs, answers and parts are of these alone.
        self.good, self.inputs = sound[answered], inputs.at(answered)
        self.columns = _described(fingers, seen, reasons)
        pads = [fingers[seen[place][0].finger] for place in self.good]
        layer, self.layer_parts = layer_columns(pads, self.inputs, study.uncertainty)
        if self.good.size:
            described = {name: column[self.good] for name, column in self.columns.items()}
            answers = _modelled(described | layer, pads, self.modelled, self.inputs) | layer
            for name, answer in answers.items():
                self.columns[name] = COLUMNS[name].unknown(len(seen))
                self.columns[name][self.good] = answer
        self.columns |= _pooling(seen, self.columns)

    def weigh(self, highest_load: dict[PlacementKey, HighestLoad], counts: BoolArray) -> None:
        """Keep the contact of the highest load at each placement, of those that count; of equals the last."""
        loads = self.columns["load_N"][self.good].tolist()
        keys = list(zip(*(self.columns[name][self.good].tolist() for name in PLACEMENT), strict=True))
        found: dict[PlacementKey, int] = {}
        for place in np.flatnonzero(counts).tolist():
            key = keys[place]
            if key not in found or loads[place] >= loads[found[key]]:
                found[key] = place
        for key, place in found.items():
            if key not in highest_load or loads[place] >= highest_load[key].load:
                name = self.columns["observation"][self.good[place]]
                highest_load[key] = HighestLoad(name, loads[place], self.inputs.at(place))


def _described(
    fingers: Mapping[str, FingerResult], seen: Seen, reasons: Sequence[str | None]
) -> dict[str, ColumnArray]:
    """Return the columns known before any model."""
    contacts, measured = zip(*seen, strict=True)
    known: dict[str, Iterable[Any]] = {
        **{name: [getattr(one, name) for one in measured] for name in _MEASURED},
        "finger": (contact.finger for contact in contacts),
        "status": (
            "rejected" if one.rejected is not None else "measured" if reason is None else "failed"
            for one, reason in zip(measured, reasons, strict=True)
        ),
        "reason": reasons,
        "synthetic": (contact.synthetic or fingers[contact.finger].synthetic for contact in contacts),
        "flags": (" ".join(one.flags) for one in measured),
        "measured_by": (one.measured_by or _measured_by(contact) for contact, one in seen),
        "wedge_angle_deg": (contact.wedge_angle_deg for contact in contacts),
        "roll_angle_deg": (contact.roll_angle_deg for contact in contacts),
        "session": (contact.session if isinstance(contact, Observation) else None for contact in contacts),
        "file": (contact.file for contact in contacts),
    }
    columns = {name: COLUMNS[name].array(items) for name, items in known.items()}
    load, major, minor = (columns[name] for name in ("load_N", "semi_major_mm", "semi_minor_mm"))
    variance = np.array([np.diag(one.covariance_mm2) for one in measured]).T
    scale_std = np.array([one.relative_scale_std for one in measured])
    with np.errstate(all="ignore"):
        semi_major_std, semi_minor_std = np.sqrt(variance)
        edge_std = np.where(np.isfinite(major), columns["edge_offset_mm_std"], np.nan)
        noise = variance - np.square(scale_std * [major, minor]) - edge_std**2
        semi_major_noise_std, semi_minor_noise_std = np.sqrt(np.maximum(noise, 0))
        return {
            **columns,
            "load_N": np.where(np.isfinite(load), load, np.nan),
            "semi_major_mm_std": semi_major_std,
            "semi_minor_mm_std": semi_minor_std,
            "semi_major_mm_noise_std": semi_major_noise_std,
            "semi_minor_mm_noise_std": semi_minor_noise_std,
            "edge_offset_mm_std": edge_std,
            "aspect_ratio": major / minor,
        }


def _pooling(seen: Seen, columns: Mapping[str, ColumnArray]) -> dict[str, ColumnArray]:
    """Return whether rows count in pooled results, and the flags and range notes that keep them out."""
    noted = [(words or "").split() for words in columns.get("range_notes", repeat(None, len(seen)))]
    excluding = [excluding_flags(*one, notes) for one, notes in zip(seen, noted, strict=True)]
    return {
        "pooled": np.array(
            [
                reason is None and is_pooled(measured, flags)
                for reason, (_, measured), flags in zip(columns["reason"], seen, excluding, strict=True)
            ]
        ),
        "excluding_flags": COLUMNS["excluding_flags"].array(
            " ".join(flag for flag in (*measured.flags, *notes) if flag in flags)
            for (_, measured), notes, flags in zip(seen, noted, excluding, strict=True)
        ),
    }


def _measured_by(contact: Contact) -> str:
    if isinstance(contact, Observation) and contact.ellipse_mm is not None:
        return "manual"
    corrected = any(getattr(contact, key) is not None for key in CORRECTIONS)
    return "corrected" if corrected else "automatic"


def _modelled(
    seen: Mapping[str, ColumnArray], pads: Sequence[FingerResult], modelled: Modelled, inputs: Inputs
) -> dict[str, ColumnArray]:
    """Return the columns that follow from the model for the rows `seen` on `pads`."""
    value, std = modelled.value, modelled.std
    semi_axes = np.reshape([pad.semi_axes for pad in pads], (-1, 3))
    placement = pad_placement(semi_axes.T, seen["wedge_angle_deg"], seen["roll_angle_deg"])
    elongation = value["predicted_elongation"]
    sides = COLUMNS["predicted_long_axis"].array((None, "along", "across"))
    of_contact = modelled.parts[:, POOLED_OUTPUTS.index("radius_from_indentation"), _OF_THE_CONTACT]
    deviation_std = inputs.std[:, inputs.places(["radius_deviation"])[0]]
    thickness = COLUMNS["indentation_over_thickness"].array([pad.manifest.pad_thickness_mm for pad in pads])
    columns: dict[str, ColumnArray] = {
        "u_deg": np.degrees(placement.u),
        "v_deg": np.degrees(placement.v),
        "in_plane_radius_mm": placement.curvature.in_plane_radius,
        **_outline_radii(seen, pads),
        "transverse_radius_mm": placement.curvature.transverse_radius,
        "contact_radius_ratio": value["contact_radius_ratio"],
        "predicted_aspect_ratio": np.exp(np.abs(elongation)),
        "predicted_long_axis": sides[np.sign(elongation).astype(int)],
        "radius_from_indentation_mm_fixed_geometry_std": np.sqrt(np.sum(of_contact**2, axis=-1)),
        "gross_area_mm2_repeatability_std": 2 * seen["gross_area_mm2"] * deviation_std,
        "indentation_over_thickness": value["indentation"] / thickness,
    }
    for name in value:
        unit, factor = unit_of(name)
        if f"{name}_{unit}" not in COLUMNS:
            continue
        columns[f"{name}_{unit}"] = factor * value[name]
        columns[f"{name}_{unit}_std"] = factor * std[name]
        for part, by_output in modelled.std_from.items():
            if f"{name}_{unit}_{part}_std" in COLUMNS:
                columns[f"{name}_{unit}_{part}_std"] = factor * by_output[name]
    columns["range_notes"] = _range_notes({**seen, **columns}, pads, semi_axes)
    return columns


def _outline_radii(seen: Mapping[str, ColumnArray], pads: Sequence[FingerResult]) -> dict[str, ColumnArray]:
    """Return the radius along the finger that side faces show where each contact is, unless it is rolled."""
    angles = np.where(seen["roll_angle_deg"] == 0, seen["wedge_angle_deg"], np.nan).tolist()
    found = np.full((len(pads), 2), np.nan)
    radius = cache(FingerResult.outline_radius)  # a sequence has thousands of rows at one angle
    for place, (pad, angle) in enumerate(zip(pads, angles, strict=True)):
        if not np.isnan(angle):
            found[place] = radius(pad, angle)
    return {"outline_radius_mm": found[:, 0], "outline_radius_mm_std": found[:, 1]}


def _curvature_disagrees(row: Mapping[str, ColumnArray], pads: Sequence[FingerResult]) -> BoolArray:
    """Return where the radii of outline and ellipsoid differ by more than their 95 % intervals allow."""
    own = np.array(list(map(cache(FingerResult.in_plane_radius_std), pads, row["wedge_angle_deg"].tolist())))
    apart = np.abs(row["outline_radius_mm"] - row["in_plane_radius_mm"])
    return np.asarray(apart > 1.96 * np.hypot(own, row["outline_radius_mm_std"]))


def _range_notes(
    row: Mapping[str, ColumnArray], pads: Sequence[FingerResult], semi_axes: FloatArray
) -> ColumnArray:
    """Return the notes that hold for each row, separated by spaces."""
    disagree = [pad.outlines is not None and pad.outlines.disagree for pad in pads]
    least, most = PLAUSIBLE_MODULUS_KPA
    across = np.where(row["long_axis"] == "across", row["semi_major_mm"], row["semi_minor_mm"])
    notes: dict[str, BoolArray] = {
        "faces_disagree": np.array(disagree, dtype=bool),
        "curvature_disagrees": _curvature_disagrees(row, pads),
        "implausible_size": np.asarray(implausible_size(semi_axes).any(axis=-1)),
        "implausible_modulus": (row["youngs_modulus_kpa"] < least) | (row["youngs_modulus_kpa"] > most),
        "deeper_than_pad": row["indentation_mm"] > semi_axes[:, 0],
        "as_wide_as_pad": across > _AS_WIDE * semi_axes[:, 2],
        "layer_out_of_range": np.array([bool(flag) for flag in row["layer_flag"]], dtype=bool),
    }
    kinds, kind = np.unique(np.array(list(notes.values())), axis=1, return_inverse=True)
    words = [" ".join(note for note, holds in zip(notes, some, strict=True) if holds) for some in kinds.T]
    return COLUMNS["range_notes"].array(words)[kind.reshape(-1)]
