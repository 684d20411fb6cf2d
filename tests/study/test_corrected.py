"""Measuring with corrections: the correction holds, and the automatic result stands beside it."""

import math
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from tests.studies import OUTLINES, correct, finger, picture, run_watched, sequence, write_study

from fingerpad.image import Scale, combine_faces, measure_contact_image, read_colour_image, read_image
from fingerpad.simulate import render_contact_image, render_finger
from fingerpad.study.corrections.apply import corrected_contact_image, corrected_photograph
from fingerpad.study.corrections.changes import ContactCorrection, PhotographCorrection
from fingerpad.study.corrections.log import CorrectionLog
from fingerpad.study.manifest.models import ContactSequence, Observation, Photograph
from fingerpad.study.measuring.fingers import photograph_item

TRUTH = render_contact_image(semi_major=8.0, semi_minor=6.0, margin=4.0, seed=5)
PPI, CAMERA = Scale.of_ppi(500), Scale(0.1)
CONTACT = Observation.model_validate(picture("p", "print.png", 1, scale={"ppi": 500}).keys)
PRESS = ContactSequence.model_validate(sequence("press", "p", force="f", scale={"ppi": 500}).keys)


def seen(change=None, *, pixels=TRUTH.pixels, of=CONTACT, **settings):
    change = ContactCorrection.model_validate(change or {})
    return corrected_contact_image(pixels, PPI, of, Path(), change, settings=settings)


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
    for number, (face, axes) in enumerate(OUTLINES.items()):
        drawn = render_finger(face, semi_axes=axes, mm_per_px=CAMERA.mm_per_px, seed=number)
        cv2.imwrite(str(folder / f"{face}.png"), drawn.pixels[..., ::-1])
    shown = {"scale": "camera", "synthetic": True}
    photographs = [{"face": face, "file": f"{face}.png", **shown} for face in OUTLINES]
    write_study(folder, finger(photographs=photographs), scales={"camera": {"mm_per_px": 0.1}})
    return folder


def test_photographs_fitted_manually_and_rejected(folder):
    plain = run_watched(folder / "study.toml")[0].fingers["f"]
    np.testing.assert_allclose(plain.semi_axes, (7.9, 13.8, 11.8), rtol=0.02)
    correct(folder, "f/palmar.png", {"ellipse_px": {"centre": [200, 190], "semi_axes": [125, 145]}})
    correct(folder, "f/radial.png", {"rejected": "nail in view"})
    result, measured = run_watched(folder / "study.toml")
    found = result.fingers["f"]
    assert measured == ["f/palmar.png"]
    assert [one.manifest.face for one in found.photographs] == ["palmar", "distal"]
    assert found.photographs[0].flags == ("fitted_manually",)
    # The page's joint result is the run's.
    active, faces = CorrectionLog(folder).active_corrections(), []
    for one in result.study.fingers[0].photographs[:2]:
        said = active.get(photograph_item(result.study.fingers[0], one))
        pixels = read_colour_image(folder / one.file)
        of_face = corrected_photograph(pixels, one, CAMERA, said and said.change)
        faces.append(replace(of_face.face_semi_axes, scale="camera"))
    joint = combine_faces(faces)
    assert found.scale == "camera"
    np.testing.assert_array_equal(joint.semi_axes, found.semi_axes)
    np.testing.assert_array_equal(joint.covariance, found.covariance)
    assert joint.semi_axes[1] == pytest.approx(145 * CAMERA.mm_per_px, rel=1e-6)


def test_points_of_a_photograph_are_edited(folder):
    photograph = Photograph.model_validate({"face": "palmar", "file": "palmar.png", "scale": "camera"})
    pixels = read_colour_image(folder / "palmar.png")
    plain = corrected_photograph(pixels, photograph, CAMERA)
    rubber = {"points_px": plain.points[40:60].tolist(), "radius_px": 2}
    change = PhotographCorrection.model_validate({"erased": [rubber]})
    fewer = corrected_photograph(pixels, photograph, CAMERA, change)
    assert len(fewer.points) < len(plain.points) - 19
    assert "fitted_manually" in fewer.flags
    whole = PhotographCorrection.model_validate({"region_of_interest_px": [0, 0, *pixels.shape[:2]]})
    assert corrected_photograph(pixels, photograph, CAMERA, whole).arc_deg > plain.arc_deg


def test_an_observation_states_that_its_contact_is_smooth(tmp_path):
    ground = np.full((200, 200, 3), 90, np.uint8)
    drawn = cv2.ellipse(ground.copy(), (100, 95), (60, 45), 20, 0, 360, (90, 90, 200), -1)
    cv2.imwrite(str(tmp_path / "gel.png"), cv2.GaussianBlur(drawn, (0, 0), 1))
    cv2.imwrite(str(tmp_path / "empty.png"), ground)
    stated = {"file": "gel.png", "background": "empty.png", "surface": "smooth"}
    observation = CONTACT.model_copy(update=stated)
    pixels = read_image(tmp_path / "gel.png").pixels
    found = corrected_contact_image(pixels, CAMERA, observation, tmp_path).contact_image
    assert found.surface == "smooth"
    assert abs(found.gross_area / (math.pi * 6.05 * 4.55) - 1) < 0.03
    assert math.isnan(found.ridge_area)
