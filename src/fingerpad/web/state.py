"""The state of a study in one document: what is there, what is missing, how far each item is."""

from collections import Counter
from collections.abc import Mapping
from typing import Annotated, Any, Final

from pydantic import BaseModel, Field

from fingerpad.image import PHOTOGRAPH_FLAGS
from fingerpad.report.text import FLAG_WORDS
from fingerpad.study.columns import COLUMNS
from fingerpad.study.corrections import Ruling, frames_of
from fingerpad.study.manifest import ContactSequence, Finger, Observation, Study
from fingerpad.study.rows import RANGE_NOTES
from fingerpad.web.bench import Bench
from fingerpad.web.engine import item_states
from fingerpad.web.fingers import known_finger
from fingerpad.web.open_study import Manifest, OpenStudy
from fingerpad.web.operations import Operation, Question
from fingerpad.web.pictures import kind_of_file
from fingerpad.web.results import last_results

_WORDS: Final[Mapping[str, Any]] = {
    "flags": dict(FLAG_WORDS),
    "photograph_flags": dict(PHOTOGRAPH_FLAGS),
    "range_notes": dict(RANGE_NOTES),
    "columns": dict(COLUMNS),
}


def document(opened: OpenStudy) -> dict[str, Any]:
    """Return the state document; nothing is measured for it."""
    manifest = opened.read()
    study = manifest.study
    rulings = opened.corrections.rulings()
    states: dict[str, str] = {} if study is None else item_states(study, opened)
    found = last_results(opened)
    seen = {row["observation"]: row for row in found.rows if row["frame"] is None} if found else {}
    counts = Counter(states.values())
    return {
        "name": opened.name,
        "title": manifest.title,
        "description": study.description if study else "",
        "digest": manifest.digest,
        "poisson_ratio": study.poisson_ratio if study else 0.5,
        "uncertainty": study.uncertainty.model_dump() if study else None,
        "ready": study is not None and not manifest.missing,
        "missing": list(manifest.missing),
        "scales": _scales(study),
        "fingers": [_finger(opened, one, rulings) for one in study.fingers] if study else [],
        "observations": [_observation(one, states, seen, rulings) for one in study.observations]
        if study
        else [],
        "sequences": [_sequence(opened, one, states, rulings) for one in study.sequences] if study else [],
        "curves": [
            {
                "key": str(number),
                "complete": True,
                "table": said(one),
                **_of(one, ("finger", "wedge_angle_deg", "file", "effective_radius_mm", "synthetic")),
            }
            for number, one in enumerate(study.curves if study else ())
        ],
        "files": _files(opened, manifest),
        "words": _WORDS,
        "counts": {
            **{name: counts[name] for name in ("done", "failed", "stale", "left")},
            "total": len(states),
        },
        "run": opened.running.describe(),
        "results": {
            "there": found is not None,
            "finished": found and found.finished,
            "fresh": found is not None and not (counts["stale"] + counts["left"]),
        },
    }


def judged(ruling: Ruling | None) -> dict[str, Any]:
    """Return what a person has said of an item."""
    return {
        "corrected": ruling is not None and bool(ruling.change.edits),
        "accepted": ruling is not None and ruling.change.accepted,
        "rejected": ruling and ruling.change.rejected,
        "who": ruling and ruling.who,
    }


def said(table: BaseModel) -> dict[str, Any]:
    """Return what the manifest says in a table, without defaults."""
    return table.model_dump(mode="json", exclude_unset=True)


def _of(table: BaseModel, names: tuple[str, ...]) -> dict[str, Any]:
    return {name: getattr(table, name) for name in names}


def _scale(key: Any) -> Any:
    return said(key) if isinstance(key, BaseModel) else key


def _scales(study: Study | None) -> list[dict[str, Any]]:
    if study is None:
        return []
    uses = Counter(name for _, name in study.named_scales())
    return [
        {"name": name, "table": said(table), "used_by": uses[name], "complete": True}
        for name, table in study.scales.items()
    ]


def _finger(opened: OpenStudy, finger: Finger, rulings: Mapping[str, Ruling]) -> dict[str, Any]:
    known = known_finger(opened, finger.name)
    axes = ("palmar", "distal", "radial_ulnar")
    return {
        "name": finger.name,
        "table": said(finger),
        "complete": True,
        "synthetic": finger.synthetic,
        "semi_axes_mm": known and dict(zip(axes, known.semi_axes.tolist(), strict=True)),
        "semi_axes_mm_std": known
        and dict(zip(axes, (float(v) ** 0.5 for v in known.covariance.diagonal()), strict=True)),
        "photographs": [
            {
                "item": f"{finger.name}/{one.image or one.outline}",
                "face": one.face,
                "file": one.image or one.outline,
                "outline": one.outline is not None,
                "scale": _scale(one.scale),
                "synthetic": one.synthetic,
                **judged(rulings.get(f"{finger.name}/{one.image}")),
                "complete": True,
            }
            for one in finger.photographs
        ],
    }


def _observation(
    one: Observation,
    states: Mapping[str, str],
    seen: Mapping[str, Mapping[str, Any]],
    rulings: Mapping[str, Ruling],
) -> dict[str, Any]:
    row = seen.get(one.name, {})
    return {
        "item": one.name,
        **_of(one, ("finger", "wedge_angle_deg", "roll_angle_deg", "load_N", "synthetic", "notes")),
        "file": one.image,
        "scale": _scale(one.scale),
        "status": "given" if one.image is None else states.get(one.name, "left"),
        "flags": (row.get("flags") or "").split(),
        "reason": row.get("reason"),
        **judged(rulings.get(one.name)),
        "from_csv": False,
        "complete": True,
    }


def _sequence(
    opened: OpenStudy, one: ContactSequence, states: Mapping[str, str], rulings: Mapping[str, Ruling]
) -> dict[str, Any]:
    found = last_results(opened)
    frames = (
        [row for row in found.rows if row["sequence"] == one.name and row["frame"] is not None]
        if found
        else []
    )
    of_frames = frames_of(rulings, one.name).values()
    return {
        "name": one.name,
        **_of(one, ("finger", "wedge_angle_deg", "roll_angle_deg", "force", "synthetic")),
        "file": one.path,
        "scale": _scale(one.scale),
        "status": states.get(one.name, "left"),
        "frames": opened.count_frames(one),
        "flags": Counter(flag for row in frames for flag in row["flags"].split()),
        "corrected": sum(bool(ruling.change.edits) for ruling in of_frames),
        "rejected": sum(ruling.change.rejected is not None for ruling in of_frames),
        "reviewed": len(of_frames),
        "table": said(one),
        "complete": True,
    }


def _files(opened: OpenStudy, manifest: Manifest) -> list[dict[str, Any]]:
    study = manifest.study
    used = {name for _, name in study.named_files()} if study else set()
    return [
        {
            "file": name,
            "kind": kind_of_file(name),
            "bytes": status.st_size,
            "used": name in used or any(name.startswith(f"{one}/") for one in used),
        }
        for name, status in opened.files().items()
    ]


def state(bench: Bench, _: Any, __: Any) -> dict[str, Any]:
    """Return the state of the study that is open."""
    return document(bench.study)


class FramesQuestion(Question):
    """Which frames of which film."""

    sequence: Annotated[str, Field(max_length=100)]
    offset: Annotated[int, Field(ge=0, le=10**9)] = 0
    limit: Annotated[int, Field(ge=1, le=5000)] = 2000


def frames(bench: Bench, asked: FramesQuestion, _: Any) -> dict[str, Any]:
    """Return the frames of a film, as far as the last run has seen them."""
    opened = bench.study
    sequence = opened.sequence(asked.sequence)
    found = last_results(opened)
    rows = {row["frame"]: row for row in found.rows if row["sequence"] == sequence.name} if found else {}
    total = opened.count_frames(sequence) or 0
    shown = range(min(asked.offset, total), min(asked.offset + asked.limit, total))
    ruled = frames_of(opened.corrections.rulings(), sequence.name)
    return {
        "total": total,
        "frames": [_frame(sequence.name, number, rows.get(number), ruled.get(number)) for number in shown],
    }


def _frame(
    sequence: str, number: int, row: Mapping[str, Any] | None, ruling: Ruling | None
) -> dict[str, Any]:
    known = row or {}
    return {
        "item": f"{sequence}#{number}",
        "frame": number,
        "status": known.get("status", "none"),
        "flags": (known.get("flags") or "").split(),
        **{key: known.get(key) for key in ("phase", "time_s", "load_N")},
        "pooled": bool(known.get("pooled")),
        **judged(ruling),
    }


OPERATIONS: Final = (
    Operation(
        method="GET", path="/api/study", answer=state, summary="What is there, what is missing, how far"
    ),
    Operation(
        method="GET",
        path="/api/study/frames",
        answer=frames,
        query=FramesQuestion,
        summary="Frames of a film",
    ),
)
