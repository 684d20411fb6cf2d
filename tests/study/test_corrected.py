"""Measuring with corrections and by a second operator: what holds, and what is measured again."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from tests import studies
from tests.study import small_study

from fingerpad.image import Scale, combine_faces, measure_contact_image, read_image
from fingerpad.report import write_report
from fingerpad.simulate import render_contact_image, render_finger
from fingerpad.study.corrections.apply import ContactPicture, corrected_photograph
from fingerpad.study.corrections.changes import ContactCorrection
from fingerpad.study.corrections.log import SECOND_OPERATOR_NAME, CorrectionLog
from fingerpad.study.engine.store import STORE_NAME, Store
from fingerpad.study.manifest.load import read_study
from fingerpad.study.manifest.models import ContactSequence, Observation
from fingerpad.study.measuring.contacts import blind_order
from fingerpad.study.measuring.context import RunContext
from fingerpad.study.measuring.fingers import photograph_item
from fingerpad.study.measuring.run import StudyItems
from fingerpad.study.pipeline import run_study
from fingerpad.study.results.output import summary_of
from fingerpad.study.results.study_result import StudyResult
from fingerpad.study.results.table import COLUMNS, records
from fingerpad.study.status import item_states, semi_axes_state, study_status, verify_study

TRUTH = render_contact_image(semi_major=8.0, semi_minor=6.0, margin=4.0, seed=5)
PPI, CAMERA = Scale.of_ppi(500), Scale(0.1)
CONTACT = Observation.model_validate(studies.picture("p", "print.png", 1, scale={"ppi": 500}).keys)
PRESS = ContactSequence.model_validate(studies.sequence("press", "p", force="f", scale={"ppi": 500}).keys)


def seen(change=None, *, pixels=TRUTH.pixels, of=CONTACT, **settings):
    change = ContactCorrection.model_validate(change or {})
    return ContactPicture(pixels, PPI, of, Path(), settings).measured(change)


def remove(row, column, radius_px):
    return {"strokes": [{"action": "remove", "points_px": [[row, column]], "radius_px": radius_px}]}


def test_strokes_and_options_correct_the_automatic_result():
    plain = seen()
    row, column = plain.contact_image.centroid
    found = seen(remove(row - 140, column, 50))
    assert found.contact_image.gross_area < plain.contact_image.gross_area - 5
    assert found.automatic.as_record() == plain.contact_image.as_record()
    expected = measure_contact_image(TRUTH.pixels, PPI, threshold=90)
    assert seen({"threshold": 90}).contact_image.as_record() == expected.as_record()
    assert seen({}).contact_image.as_record() == plain.contact_image.as_record()


def test_a_contact_not_found_automatically_is_measured_manually():
    pixels = np.random.default_rng(0).normal(120, 3, (300, 300))
    assert "no contact found" in seen(pixels=pixels).reason
    found = seen({"ellipse_px": {"centre": [150, 150], "semi_axes": [90, 70]}}, pixels=pixels)
    assert found.automatic is None
    assert float(found.contact_image.ellipse.semi_minor) == pytest.approx(70 * 25.4 / 500, rel=1e-3)
    assert "leave no contact" in seen(remove(5, 5, 5), pixels=pixels).reason


def test_frames_keep_the_sequences_reading():
    """A frame is measured as its sequence is; a stroke changes the region, not the reading."""
    settings = measure_contact_image(TRUTH.pixels, PPI).settings | {"ridge_period": 0.5}
    plain = seen(of=PRESS, **settings)
    expected = measure_contact_image(TRUTH.pixels, PPI, **settings)
    assert plain.contact_image.as_record() == expected.as_record()
    row, column = plain.contact_image.centroid
    found = seen(remove(row - 150, column, 40), of=PRESS, **settings)
    assert found.automatic.as_record() == plain.contact_image.as_record()
    assert found.contact_image.ridge_period == plain.contact_image.ridge_period
    assert found.contact_image.gross_area < plain.contact_image.gross_area


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A study of a finger, the photographs of which are drawn."""
    folder = tmp_path_factory.mktemp("study")
    for number, (face, axes) in enumerate(studies.OUTLINES.items()):
        drawn = render_finger(face, semi_axes=axes, mm_per_px=CAMERA.mm_per_px, seed=number)
        cv2.imwrite(str(folder / f"{face}.png"), drawn.pixels[..., ::-1])
    shown = {"scale": "camera", "synthetic": True}
    photographs = [{"face": face, "file": f"{face}.png", **shown} for face in studies.OUTLINES]
    studies.write_study(
        folder, studies.finger(photographs=photographs), scales={"camera": {"mm_per_px": 0.1}}
    )
    return folder


def test_photographs_fitted_manually_and_rejected(folder):
    plain = studies.run_watched(folder / "study.toml")[0].fingers["f"]
    np.testing.assert_allclose(plain.semi_axes, (7.9, 13.8, 11.8), rtol=0.02)
    studies.correct(folder, "f/palmar.png", {"ellipse_px": {"centre": [200, 190], "semi_axes": [125, 145]}})
    studies.correct(folder, "f/radial.png", {"rejected": "nail in view"})
    result, measured = studies.run_watched(folder / "study.toml")
    found = result.fingers["f"]
    assert measured == ["f/palmar.png"]
    assert [one.manifest.face for one in found.photographs] == ["palmar", "distal"]
    assert found.photographs[0].flags == ("fitted_manually",)
    # The page's joint result is the run's.
    active, faces = CorrectionLog(folder).active_corrections(), []
    for one in result.study.fingers[0].photographs[:2]:
        said = active.get(photograph_item(result.study.fingers[0], one))
        pixels = read_image(folder / one.file, colour=True).pixels
        of_face = corrected_photograph(pixels, one, CAMERA, said and said.change)
        faces.append(replace(of_face.face_semi_axes, scale="camera"))
    joint = combine_faces(faces)
    assert found.scale == "camera"
    np.testing.assert_array_equal(joint.semi_axes, found.semi_axes)
    np.testing.assert_array_equal(joint.covariance, found.covariance)
    assert joint.semi_axes[1] == pytest.approx(145 * CAMERA.mm_per_px, rel=1e-6)


def test_photographs_that_repeat_the_table_of_a_scale_share_its_error(folder, tmp_path):
    shutil.copytree(folder, tmp_path, dirs_exist_ok=True)
    manifest = tmp_path / "study.toml"
    table = "scale = {mm_per_px = 0.1, relative_std = 0.2}"
    manifest.write_text(manifest.read_text().replace('scale = "camera"', table))
    found = run_study(manifest, tmp_path / "out").fingers["f"]
    assert (np.sqrt(np.diagonal(found.covariance)) > 0.2 * found.semi_axes).all()


pytestmark = pytest.mark.usefixtures("small_pieces")
ELLIPSE = {"ellipse_px": {"centre": [60, 60], "semi_axes": [40, 30], "orientation_deg": 10}}


def test_a_corrected_observation_alone_is_measured_anew(finished):
    before, _ = studies.run_watched(finished)
    studies.correct(finished.parent, "o1", ELLIPSE)
    assert study_status(finished, finished.parent / "out").stale == 1
    after, measured = studies.run_watched(finished)
    assert measured == ["o1"]
    row = studies.rows_by(after)["o1"]
    assert (row["measured_by"], row["reviewed"], row["reviewed_by"]) == ("manual", "corrected", "anna")
    assert row["semi_major_mm"] == pytest.approx(40 * 25.4 / 240, rel=1e-3)
    assert row["orientation_deg"] == pytest.approx(10, abs=0.1)
    assert (finished.parent / "out" / row["overlay"]).is_file()
    own = studies.rows_by(before)["o1"]
    for name in ("semi_major_mm", "semi_minor_mm"):
        assert row[f"automatic_{name}"] == own[name] == own[f"automatic_{name}"]
    studies.correct(finished.parent, "o1", {})
    again, measured = studies.run_watched(finished)
    assert measured == ["o1"]
    assert studies.rows_by(again) == studies.rows_by(before)


@pytest.mark.parametrize(
    ("item", "change", "status"),
    [("o2", {"accepted": True}, "measured"), ("p#12", {"rejected": "smeared"}, "rejected")],
)
def test_a_verdict_measures_nothing(finished, item, change, status):
    before, _ = studies.run_watched(finished)
    studies.correct(finished.parent, item, change)
    after, measured = studies.run_watched(finished)
    assert measured == []
    row = studies.rows_by(after)[item]
    assert (row["status"], row["reviewed_by"]) == (status, "anna")
    assert row["reason"] == change.get("rejected")
    assert not (row["pooled"] and status == "rejected")
    assert after.failures == []
    # What the model's checks say is of all contacts of the finger together.
    every = ("_model_std", "_total_std", "model_verdict")
    own = [name for name in COLUMNS if not name.endswith(every)]
    before, after = ({row["observation"]: row for row in records(one.rows, *own)} for one in (before, after))
    assert before | {item: None} == after | {item: None}


def test_the_report_lists_manual_corrections(finished):
    studies.correct(finished.parent, "o1", ELLIPSE)
    studies.correct(finished.parent, "o2", {"rejected": "it <slipped>"})
    result, _ = studies.run_watched(finished)
    page = studies.page_of(result, finished.parent / "out")
    section = page[page.index('<div id="corrections">') : page.index('<div id="methods">')]
    own = studies.rows_by(result)["o1"]["automatic_semi_major_mm"]
    assert all(words in section for words in ("corrected", "it &lt;slipped&gt;", "anna", f"{own:.3f}"))


def test_a_corrected_frame_has_its_piece_measured_anew(finished):
    before, _ = studies.run_watched(finished)
    studies.correct(finished.parent, "p#8", ELLIPSE)
    after, measured = studies.run_watched(finished)
    assert measured == ["p", "p"]  # the piece, and the drawings
    rows, untouched = studies.rows_by(after), studies.rows_by(before)
    row, automatic = rows.pop("p#8"), untouched.pop("p#8")
    assert (row["measured_by"], row["load_N"]) == ("manual", automatic["load_N"])
    assert row["semi_minor_mm"] == pytest.approx(30 * 25.4 / 240, rel=1e-3)
    assert rows == untouched
    # A frame without an automatic contact can be measured manually.
    empty = min(frame for frame in range(2, 24) if f"p#{frame}" not in untouched and frame != 8)
    studies.correct(finished.parent, f"p#{empty}", ELLIPSE)
    frames = studies.rows_by(studies.run_watched(finished)[0])
    assert f"p#{empty}" not in frames or frames[f"p#{empty}"]["measured_by"] == "manual"


def semi_axes_states(finished: Path, run_of: StudyResult | None) -> dict[str, str]:
    """Return the state of each finger's semi-axes in the results of a run."""
    study, log = read_study(finished), CorrectionLog(finished.parent)
    records = {one.finger: one for one in summary_of(run_of).fingers} if run_of else {}
    with Store.reading(finished.parent / "out" / STORE_NAME) as store:
        states = item_states(
            StudyItems(
                RunContext(
                    study=study,
                    folder=finished.parent,
                    active_corrections=log.active_corrections(),
                    store=store,
                )
            )
        )
    return {one.name: semi_axes_state(one, states, records.get(one.name)) for one in study.fingers}


def test_semi_axes_are_out_of_date_once_their_photographs_change(finished):
    assert semi_axes_states(finished, None) == {"f": "given", "g": "left"}
    result, _ = studies.run_watched(finished)
    assert semi_axes_states(finished, result) == {"f": "given", "g": "done"}
    text = finished.read_text()
    finished.write_text(text.replace("mm_per_px = 0.1 }", "mm_per_px = 0.11 }", 1))
    assert semi_axes_states(finished, result)["g"] == "stale"
    finished.write_text(text)
    studies.correct(finished.parent, "g/distal.jpg", {"rejected": "nail in view"})
    assert semi_axes_states(finished, result)["g"] == "stale"
    result, measured = studies.run_watched(finished)
    assert semi_axes_states(finished, result)["g"] == "failed"
    assert "g/distal.jpg" not in measured
    assert "palmar" in (result.fingers["g"].reason or "")


def test_what_is_odd_about_corrections_is_told(finished):
    studies.correct(finished.parent, "o1", ELLIPSE)
    studies.correct(finished.parent, "p#900", {"rejected": "smeared"})
    text = finished.read_text()
    finished.write_text(text.replace('name = "o1"', 'name = "other"'))
    with (finished.parent / "corrections.jsonl").open("a") as file:
        file.write('{"id": 3, "item": "o')
    result, _ = studies.run_watched(finished)
    for words in ("o1 is not in the study", "p#900 is not in the study", "torn"):
        assert any(words in note for note in result.notes)
    assert "corrections.jsonl" in result.provenance["inputs_sha256"]


def test_corrections_of_a_picture_that_was_replaced_are_told(finished):
    for item in ("o1", "o2", "g/distal.jpg", "p#8"):
        studies.correct(finished.parent, item, {"accepted": True})
    assert not studies.run_watched(finished)[0].notes
    pictures = {one.name: finished.parent / one.file for one in read_study(finished).observations}
    pictures["o1"].write_bytes(pictures["o2"].read_bytes() + b"\0")  # of the same bytes a note says so
    notes = studies.run_watched(finished)[0].notes
    assert [note.split()[1] for note in notes] == ["o1"]
    assert "another picture or force" in notes[0]
    studies.correct(finished.parent, "o1", ELLIPSE)
    assert not studies.run_watched(finished)[0].notes
    images = finished.parent / "frames"
    (images / "f8.png").write_bytes((images / "f9.png").read_bytes())
    notes = studies.run_watched(finished)[0].notes
    assert [note.split()[1] for note in notes] == ["p#8"]
    assert "another picture or force" in notes[0]


MM = 25.4 / small_study.PPI


def ellipse(major: float, minor: float, centre: tuple[float, float] = (60, 60)) -> dict:
    return {"ellipse_px": {"centre": [*centre], "semi_axes": [major, minor], "orientation_deg": 0}}


def second(manifest: Path, item: str, change: dict, who: str = "bob") -> None:
    studies.correct(manifest.parent, item, change, who=who, name=SECOND_OPERATOR_NAME)


def test_two_persons_outlines_are_compared(finished):
    for k in range(3):
        studies.correct(finished.parent, f"o{k}", ellipse(40, 30))
    second(finished, "o0", ellipse(44, 30))
    second(finished, "o1", ellipse(40, 30))
    second(finished, "o2", ellipse(40, 27, centre=(60, 62)))
    out = finished.parent / "out"
    result = run_study(finished, out, write_report=write_report)
    (found,) = result.operators
    assert (found.synthetic, found.count) == (True, 3)
    assert (found.first_operators, found.second_operators) == (["anna"], ["bob"])
    area = found.gross_area_mm2
    ratios = np.log([1.1, 1.0, 0.9])
    assert area.bias == pytest.approx(np.expm1(ratios.mean()), abs=2e-3)
    assert area.std == pytest.approx(ratios.std(ddof=1), rel=0.02)
    assert found.semi_major_mm.limits[1] > 0
    ious = {one.observation: one.iou for one in result.compared_pairs(synthetic=True)}
    assert ious["o0"] == pytest.approx(1 / 1.1, abs=0.01)  # one ellipse inside the other
    assert ious["o1"] == 1
    assert 0.8 < ious["o2"] < 0.9
    # The first operator's outlines are the results.
    assert studies.rows_by(result)["o0"]["semi_major_mm"] == pytest.approx(40 * MM, rel=1e-3)
    lines = studies.rows_of(out / "second_operator.csv")
    assert float(lines[0]["second_semi_major_mm"]) == pytest.approx(44 * MM, rel=1e-3)
    summary = json.loads((out / "summary.json").read_text())["second_operator"]
    assert summary[0]["gross_area_mm2"]["count"] == 3
    report = (out / "report.html").read_text()
    assert "Second operator" in report
    assert f"{100 * area.bias:+.1f} %" in report
    assert (out / "figures" / "second_operator_synthetic.svg").is_file()
    verified = verify_study(finished, out)
    assert not verified.faults
    assert SECOND_OPERATOR_NAME in verified.intact


def test_what_is_no_second_opinion_is_left_out(finished):
    studies.correct(finished.parent, "o0", ellipse(40, 30))
    second(finished, "o0", ellipse(41, 30), "anna")  # the same person
    studies.correct(finished.parent, "o1", {"rejected": "smeared"})
    second(finished, "o1", ellipse(41, 30))
    second(finished, "o2", ellipse(41, 30))  # the first has not looked at it
    studies.correct(finished.parent, "o3", {"accepted": True})
    second(finished, "o3", {"rejected": "smeared"})
    result = run_study(finished, finished.parent / "out")
    assert result.operator_pairs == []
    assert not (finished.parent / "out" / "second_operator.csv").exists()
    # What the first accepted as the program measured it counts.
    second(finished, "o3", ellipse(41, 30))
    (pair,) = run_study(finished, finished.parent / "out").operator_pairs
    assert (pair.observation, pair.first_operator) == ("o3", "anna")


def test_random_order_takes_every_part_of_a_study_alike():
    names = [f"print_{k}" for k in range(400)]
    order = blind_order(names)
    assert sorted(order) == sorted(names)
    assert blind_order(names[::-1]) == order
    assert abs(np.corrcoef(np.arange(400), [names.index(name) for name in order])[0, 1]) < 0.15
