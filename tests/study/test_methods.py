"""The methods section: it says what the study states, and names what it does not."""

from pathlib import Path

from PIL import Image
from tests.studies import contact, finger, picture, run, summary_of

from fingerpad.simulate import render_contact_image
from fingerpad.study.results.methods import methods_section
from fingerpad.study.results.study_result import StudyResult
from fingerpad.study.results.summary_file import MethodsRecord

STATED = {
    "imaging": "a glass prism and a camera",
    "platen": "smooth glass",
    "force_sensor": "a six-axis sensor",
    "stage": "a linear stage",
    "scale_calibration": "a dot grid",
    "poisson_ratio_basis": "as for soft tissue",
    "thickness_basis": "from ultrasound",
    "approach_mm_per_s": 2.5,
    "dwell_s": 3.0,
}


def study(folder: Path, stated: dict[str, object]) -> StudyResult:
    return run(
        folder,
        finger(person="p", effective_thickness_mm=8.0),
        picture("a", "a.png", 1.5, scale="reader"),
        contact("b", 0.5, (4, 3), wedge=45, axis=""),
        poisson_ratio=0.49,
        scales={"reader": {"mm_per_px": 0.1, "relative_std": 0.01}},
        uncertainty={"wedge_angle_deg_std": 3.0},
        **({"apparatus": stated} if stated else {}),
    )


def section(folder: Path, stated: dict[str, object]) -> MethodsRecord:
    truth = render_contact_image(semi_major=5.0, semi_minor=4.0, ppi=254, seed=1)
    Image.fromarray(truth.pixels).save(folder / "a.png")
    return methods_section(study(folder, stated))


def test_everything_stated_is_said(tmp_path):
    found = section(tmp_path, STATED)
    text = " ".join(found.paragraphs)
    assert len(found.missing) == 1  # no contact was repeated
    assert found.missing[0].startswith("repeats")
    for value in STATED.values():
        assert (f"{value:g}" if isinstance(value, float) else value) in text
    for words in (
        "wedge angles of 30 and 45° (± 3°) and a roll of 0° (± 3°)",
        "Assumed to be known: the roll angle to ± 3°.",
        "Normal loads of 0.5 to 1.5 N",
        "2 observations",
        "The pad of f (1 person)",
        "reader, 0.1000 ± 0.0010 mm/px",
        "ratio of 0.49 (taken as exact)",
        "8 mm (f)",
    ):
        assert words in text
    assert summary_of(tmp_path / "out")["methods"]["missing"] == list(found.missing)


def test_a_finger_measured_in_two_ways_is_not_counted_as_two(tmp_path):
    names = ("thumb_ellipse", "thumb_direct")
    result = run(tmp_path, *map(finger, names), *(contact(f"at_{name}", 1, finger=name) for name in names))
    first = methods_section(result).paragraphs[0]
    assert first.startswith("The pads of thumb_ellipse and thumb_direct were modelled as ellipsoidal caps")
    assert "fingers" not in first


def test_what_is_not_stated_is_missing(tmp_path):
    found = section(tmp_path, {})
    assert len(found.missing) == len(STATED) + 1
    for key in STATED:
        assert sum(f"apparatus.{key})" in words for words in found.missing) == 1
