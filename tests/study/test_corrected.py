"""Measuring with corrections: the correction holds, and the automatic result stands beside it."""

import math
from dataclasses import replace

import cv2
import numpy as np
import pytest
from benchmarks.claims.engine import measured_scales
from tests.studies import contact, finger, picture, sequence, study_of

from fingerpad._records import to_record
from fingerpad.image import Scale, combine_faces, measure_contact_image, read_colour_image, read_image
from fingerpad.simulate import render_contact_image, render_finger
from fingerpad.study.corrections.apply import (
    contact_correction,
    corrected_contact_image,
    corrected_photograph,
)
from fingerpad.study.corrections.changes import ContactCorrection, PhotographCorrection
from fingerpad.study.corrections.log import CorrectionLog
from fingerpad.study.manifest.models import Observation
from fingerpad.study.measuring.contacts import measure_observation, reviewed
from fingerpad.study.measuring.context import RunContext, scale_key
from fingerpad.study.measuring.fingers import finger_result, photograph_item, photograph_items

TRUTH = render_contact_image(semi_major=8.0, semi_minor=6.0, margin=4.0, seed=5)
MM_PER_PX = 0.1
FACES = {"palmar": (11.8, 13.8), "distal": (11.8, 7.9), "radial": (7.9, 13.8)}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study")
    cv2.imwrite(str(folder / "print.png"), np.rint(TRUTH.pixels).clip(0, 255).astype(np.uint8))
    cv2.imwrite(str(folder / "empty.png"), np.full((300, 300), 200, np.uint8))
    for number, (face, axes) in enumerate(FACES.items()):
        truth = render_finger(face, semi_axes=axes, mm_per_px=MM_PER_PX, seed=number)
        cv2.imwrite(str(folder / f"{face}.png"), truth.pixels[..., ::-1])
    return folder


STUDY = study_of(
    finger(
        photographs=[
            {"face": face, "file": f"{face}.png", "scale": "camera", "synthetic": True} for face in FACES
        ]
    ),
    picture("p", "print.png", 1, scale="reader", synthetic=True),
    picture("none", "empty.png", 1, scale="reader"),
    contact("given", 1, (5, 4), axis=""),
    sequence("press", "p", force="f", scale="reader"),
    scales={"camera": {"mm_per_px": MM_PER_PX}, "reader": {"ppi": 500}},
)


def measured(folder, tmp_path, name, change=None):
    log = CorrectionLog(tmp_path)
    if change is not None:
        log.append(name, change, who="anna", expected=log.history(name).last_id, study=STUDY)
    observation = next(one for one in STUDY.observations if one.name == name)
    scales = measured_scales(STUDY, folder)
    active_correction = log.active_correction(name)
    scale = None if observation.scale is None else scales[scale_key(observation.scale)]
    found = measure_observation(
        observation, scale, folder, tmp_path / "out", contact_correction(active_correction)
    )
    return reviewed(found, active_correction)


def finger_of(finger, scales, folder, out, active_corrections):
    """Measure a finger's photographs as a run does, and combine them."""
    context = RunContext(study=STUDY, folder=folder, active_corrections=active_corrections, scales=scales)
    tasks = (task for one in photograph_items(finger, context) for stage in one.stages() for task in stage)
    records = {task.item: to_record(task.work(folder, out)) for task in tasks}
    return finger_result(finger, scales, folder, records, active_corrections)


def test_strokes_and_options_correct_the_automatic_result(folder, tmp_path):
    plain = measured(folder, tmp_path, "p")
    middle = [plain.centroid_row_px - 140, plain.centroid_column_px]
    stroke = {"action": "remove", "points_px": [middle], "radius_px": 50}
    found = measured(folder, tmp_path, "p", {"strokes": [stroke]})
    assert found.gross_area_mm2 < plain.gross_area_mm2 - 5
    assert found.measured_by == "corrected"
    assert found.automatic_semi_major_mm == plain.semi_major_mm
    other = measured(folder, tmp_path, "p", {"threshold": 90})
    pixels = cv2.imread(str(folder / "print.png"), cv2.IMREAD_GRAYSCALE)
    assert (
        other.semi_major_mm
        == measure_contact_image(pixels, Scale.of_ppi(500), threshold=90).ellipse.semi_major
    )
    # Back to the program.
    assert measured(folder, tmp_path, "p", {}).semi_major_mm == plain.semi_major_mm


def test_a_contact_not_found_automatically_is_measured_manually(folder, tmp_path):
    assert "no contact found" in measured(folder, tmp_path, "none").reason
    pixels = np.random.default_rng(0).normal(120, 3, (300, 300))
    drawn = ContactCorrection.model_validate({"ellipse_px": {"centre": [150, 150], "semi_axes": [90, 70]}})
    contact = STUDY.observations[1]
    seen = corrected_contact_image(pixels, Scale.of_ppi(500), contact, folder, drawn)
    assert seen.automatic is None
    assert float(seen.contact_image.ellipse.semi_minor) == pytest.approx(70 * 25.4 / 500, rel=1e-3)
    nothing = ContactCorrection.model_validate(
        {"strokes": [{"action": "remove", "points_px": [[5, 5]], "radius_px": 5}]}
    )
    assert (
        "leave no contact"
        in corrected_contact_image(pixels, Scale.of_ppi(500), contact, folder, nothing).reason
    )


def test_frames_keep_the_sequences_reading(folder):
    """A frame is measured as its sequence is; a stroke changes the region, not the reading."""
    scale, sequence = Scale.of_ppi(500), STUDY.sequences[0]
    settings = measure_contact_image(TRUTH.pixels, scale).settings | {"ridge_period": 0.5}
    plain = corrected_contact_image(TRUTH.pixels, scale, sequence, folder, settings=settings)
    assert (
        plain.contact_image.as_record() == measure_contact_image(TRUTH.pixels, scale, **settings).as_record()
    )
    row, column = plain.contact_image.centroid
    stroke = {"action": "remove", "points_px": [[row - 150, column]], "radius_px": 40}
    change = ContactCorrection.model_validate({"strokes": [stroke]})
    found = corrected_contact_image(TRUTH.pixels, scale, sequence, folder, change, settings=settings)
    assert found.automatic.as_record() == plain.contact_image.as_record()
    assert found.contact_image.ridge_period == plain.contact_image.ridge_period
    assert found.contact_image.gross_area < plain.contact_image.gross_area


def test_photographs_fitted_manually_and_rejected(folder, tmp_path):
    scales, finger = measured_scales(STUDY, folder), STUDY.fingers[0]
    plain = finger_of(finger, scales, folder, tmp_path / "out", {})
    np.testing.assert_allclose(plain.semi_axes, (7.9, 13.8, 11.8), rtol=0.02)
    items = [photograph_item(finger, one) for one in finger.photographs]
    assert items[0] == "f/palmar.png"
    log = CorrectionLog(tmp_path)
    drawn = {"centre": [200, 190], "semi_axes": [125, 145]}
    log.append(items[0], {"ellipse_px": drawn}, who="ben", expected=0, study=STUDY)
    log.append(items[2], {"rejected": "nail in view"}, who="ben", expected=0, study=STUDY)
    found = finger_of(finger, scales, folder, tmp_path / "out", log.active_corrections())
    assert [one.manifest.face for one in found.photographs] == ["palmar", "distal"]
    assert found.photographs[0].flags == ("fitted_manually",)
    # The page's joint result is the run's.
    scale = scales["camera"].scale
    faces = [
        replace(
            corrected_photograph(
                read_colour_image(folder / one.file),
                one,
                scale,
                active_correction.change if (active_correction := log.active_correction(item)) else None,
            ).face_semi_axes,
            scale="camera",
        )
        for item, one in list(zip(items, finger.photographs, strict=True))[:2]
    ]
    joint = combine_faces(faces)
    assert found.scale == "camera"
    np.testing.assert_array_equal(joint.semi_axes, found.semi_axes)
    np.testing.assert_array_equal(joint.covariance, found.covariance)
    assert joint.semi_axes[1] == pytest.approx(145 * scale.mm_per_px, rel=1e-6)


def test_points_of_a_photograph_are_edited(folder):
    photograph = STUDY.fingers[0].photographs[0]
    pixels = read_colour_image(folder / "palmar.png")
    scale = measured_scales(STUDY, folder)["camera"].scale
    plain = corrected_photograph(pixels, photograph, scale)
    rubber = {"points_px": plain.points[40:60].tolist(), "radius_px": 2}
    change = PhotographCorrection.model_validate({"erased": [rubber]})
    fewer = corrected_photograph(pixels, photograph, scale, change)
    assert len(fewer.points) < len(plain.points) - 19
    assert "fitted_manually" in fewer.flags
    box = [0, 0, *(pixels.shape[:2])]
    whole = PhotographCorrection.model_validate({"region_of_interest_px": box})
    assert corrected_photograph(pixels, photograph, scale, whole).arc_deg > plain.arc_deg


def test_an_observation_states_that_its_contact_is_smooth(tmp_path):
    ground = np.full((200, 200, 3), 90, np.uint8)
    image = cv2.GaussianBlur(
        cv2.ellipse(ground.copy(), (100, 95), (60, 45), 20, 0, 360, (90, 90, 200), -1), (0, 0), 1
    )
    cv2.imwrite(str(tmp_path / "gel.png"), image)
    cv2.imwrite(str(tmp_path / "empty.png"), ground)
    table = {"name": "p", "finger": "f", "wedge_angle_deg": 30, "load_N": 1, "file": "gel.png"}
    observation = Observation.model_validate(
        {**table, "scale": {"mm_per_px": 0.1}, "background": "empty.png", "surface": "smooth"}
    )
    pixels = read_image(tmp_path / "gel.png").pixels
    seen = corrected_contact_image(pixels, Scale(0.1), observation, tmp_path)
    assert seen.contact_image.surface == "smooth"
    assert abs(seen.contact_image.gross_area / (math.pi * 6.05 * 4.55) - 1) < 0.03
    assert math.isnan(seen.contact_image.ridge_area)
