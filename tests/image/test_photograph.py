"""Photographs of fingers: semi-axes against rendered truth, directions, marks, a mesh, and bad input."""

import math
from functools import cache

import cv2
import numpy as np
import pytest

from fingerpad.exceptions import ImageError
from fingerpad.flags import FLAGS
from fingerpad.image import FACE_AXES, Scale, measure_photograph
from fingerpad.image.photograph.faces import face_axes
from fingerpad.image.photograph.silhouette import opponent_light
from fingerpad.simulate import render_coin, render_finger

SEMI_AXES = {"palmar": (11.8, 13.8), "distal": (11.8, 7.9), "radial": (7.9, 13.8), "ulnar": (7.9, 13.8)}
MM_PER_PX = 0.08
SCALE = Scale(MM_PER_PX)


def rendered(face="palmar", **changes):
    usual = {"arc_deg": 160.0, "mm_per_px": MM_PER_PX, "blur_px": 1.0, "seed": 3}
    return render_finger(face, **usual | changes)


def measured(truth, **changes):
    given = {"tip": truth.tip, "palmar": None if truth.face == "palmar" else truth.palmar} | changes
    return measure_photograph(truth.pixels, truth.face, Scale(truth.mm_per_px), **given)


@cache
def truth_of(face):
    return rendered(face)


@cache
def found_of(face):
    return measured(truth_of(face))


def with_coin(truth, radius_mm):
    """Return the picture of a finger with one of a coin to its right."""
    radius = radius_mm / truth.mm_per_px
    coin = render_coin(radius=radius, shape=(truth.pixels.shape[0], round(2.4 * radius)), noise_std=0)
    beside = np.repeat(truth.pixels[:, -1:], coin.pixels.shape[1], axis=1)
    rows, columns = np.indices(coin.pixels.shape)
    on_coin = np.hypot(rows - coin.centre[0], columns - coin.centre[1]) <= radius
    beside[on_coin] = coin.pixels[on_coin][:, None]
    return np.concatenate([truth.pixels, beside], axis=1)


def test_a_coin_beside_the_finger_is_not_the_finger():
    truth = rendered("radial", mm_per_px=0.1)
    both = with_coin(truth, 12.0)
    found = measure_photograph(both, "radial", Scale(truth.mm_per_px), tip=truth.tip, palmar=truth.palmar)
    np.testing.assert_allclose(found.semi_axes, truth.semi_axes, rtol=0.02)


@pytest.mark.parametrize("radius_mm", [6.5, 12.0])
def test_a_coin_beside_a_finger_seen_end_on_may_be_the_finger(radius_mm):
    truth = truth_of("distal")
    both = with_coin(truth, radius_mm)
    with pytest.raises(ImageError, match="more than one object stands out .* crop the picture"):
        measure_photograph(both, "distal", SCALE)
    rows, columns = truth.pixels.shape[:2]
    box = (rows / 2, 0, rows - 1, columns - 1)
    found = measure_photograph(both, "distal", SCALE, region_of_interest=box)
    np.testing.assert_allclose(found.semi_axes, truth.semi_axes, rtol=0.03)


def test_which_of_two_fingers_is_meant_is_asked():
    truth = truth_of("palmar")
    both = np.concatenate([truth.pixels, truth.pixels], axis=1)
    with pytest.raises(ImageError, match="more than one object stands out"):
        measure_photograph(both, "palmar", SCALE)


def test_a_distal_face_upside_down_is_flagged():
    assert "dorsal_deeper" not in found_of("distal").flags
    turned = measure_photograph(truth_of("distal").pixels[::-1, ::-1], "distal", SCALE)
    assert "dorsal_deeper" in turned.flags


def test_coarse_colour_of_a_file_does_not_move_the_luma_edge():
    pixels = truth_of("radial").pixels
    coded = cv2.cvtColor(pixels, cv2.COLOR_RGB2YCrCb)
    coded[..., 1:] = cv2.blur(coded[..., 1:], (8, 8))
    coarse = cv2.cvtColor(coded, cv2.COLOR_YCrCb2RGB)
    np.testing.assert_allclose(opponent_light(coarse)[..., 0], opponent_light(pixels)[..., 0], atol=0.007)


@pytest.mark.parametrize("face", SEMI_AXES)
def test_semi_axes_and_centre(face):
    truth, found = truth_of(face), found_of(face)
    assert tuple(found.semi_axes_mm) == FACE_AXES[face]
    np.testing.assert_allclose(list(found.semi_axes_mm.values()), truth.semi_axes, rtol=0.012)
    np.testing.assert_allclose(found.centre, truth.centre, atol=6)
    off = np.abs(found.semi_axes - truth.semi_axes) / list(found.semi_axes_mm_std.values())
    assert off.max() < 3
    assert found.arc_deg > 120
    assert found.outlier_fraction < 0.05
    assert found.flags <= set(FLAGS["photograph"])


@pytest.mark.parametrize(("skin", "backdrop"), [(0.0, "black"), (0.5, "white"), (0.8, "cork")])
def test_skin_tones_and_backdrops(skin, backdrop):
    truth = rendered(skin=skin, backdrop=backdrop, seed=5)
    np.testing.assert_allclose(measured(truth).semi_axes, truth.semi_axes, rtol=0.015)


@pytest.mark.parametrize("tip", ["right", "down"])
def test_tip_directions(tip):
    truth = rendered(tip=tip, tilt_deg=4.0)
    found = measured(truth)
    np.testing.assert_allclose(found.semi_axes, truth.semi_axes, rtol=0.012)
    assert math.degrees(found.tilt) == pytest.approx(4, abs=max(1.0, 3 * math.degrees(found.tilt_std)))


@pytest.mark.parametrize(
    ("tip", "palmar"), [("up", "left"), pytest.param("right", "down", marks=pytest.mark.nightly)]
)
def test_palmar_side_of_side_face(tip, palmar):
    truth = rendered("ulnar", tip=tip, palmar=palmar)
    found = measured(truth, palmar=None)
    np.testing.assert_allclose(found.semi_axes, truth.semi_axes, rtol=0.02)
    np.testing.assert_array_equal(np.rint(found.directions), face_axes("ulnar", tip, palmar))


def test_depth_and_type_invariance():
    truth = truth_of("palmar")
    for pixels in (
        truth.pixels.astype(np.uint16) * 257,
        np.dstack([truth.pixels] * 2)[..., :4] / 255.0,
    ):
        found = measure_photograph(pixels, "palmar", SCALE)
        np.testing.assert_allclose(found.semi_axes, found_of("palmar").semi_axes, rtol=1e-3)


def test_scale_and_its_uncertainty():
    truth = truth_of("palmar")
    wide = measure_photograph(truth.pixels, "palmar", Scale(2 * MM_PER_PX, 0.2 * MM_PER_PX))
    np.testing.assert_allclose(wide.semi_axes, 2 * found_of("palmar").semi_axes)
    np.testing.assert_allclose(wide.edge_covariance, 4 * found_of("palmar").edge_covariance)
    assert wide.semi_axes_mm_std["distal"] == pytest.approx(0.1 * wide.semi_axes_mm["distal"], rel=0.01)


def test_uncertainty_grows_with_shorter_arc():
    truth = rendered(mm_per_px=0.06)
    stds = []
    for degrees in (150, 110, 80):
        t = np.radians(90 + np.array([-degrees, 0, degrees]) / 2)
        marks = truth.centre + np.stack([-13.8 * np.sin(t), 11.8 * np.cos(t)], axis=-1) / truth.mm_per_px
        found = measured(truth, points=marks)
        assert found.arc_deg == pytest.approx(degrees, abs=6)
        stds.append(found.semi_axes_mm_std["distal"])
    # Any arc leaves some doubt whether its curve is an ellipse.
    assert stds[0] < stds[1] / 1.5 < stds[2] / 6
    assert "short_arc" in found.flags


def test_region_of_interest_selects_arc():
    truth = truth_of("palmar")
    row, _ = truth.centre
    found = measured(truth, region_of_interest=(0, 0, row - 40, 1e4))
    assert (found.points[:, 0] < row - 39).all()
    np.testing.assert_allclose(
        found.semi_axes, truth.semi_axes, atol=3 * max(found.semi_axes_mm_std.values())
    )


@pytest.mark.parametrize("side", ["left", "right"])
def test_an_arc_at_the_frame_touches_it(side):
    truth, columns = truth_of("palmar"), found_of("palmar").points[:, 1]
    first, last = int(columns.min()), int(columns.max()) + 1
    for margin, touches in ((0, True), (25, False)):
        cut = np.s_[:, first - margin :] if side == "left" else np.s_[:, : last + margin]
        flags = measure_photograph(truth.pixels[cut], "palmar", SCALE).flags
        assert ("touches_border" in flags) == touches


def test_an_arc_within_a_reduced_copy_does_not_touch_the_frame():
    large = truth_of("palmar").pixels.repeat(3, axis=0).repeat(3, axis=1)
    assert "touches_border" not in measure_photograph(large, "palmar", Scale(MM_PER_PX / 3)).flags


def blank(level=128):
    noise = np.random.default_rng(0).normal(0, 2, (300, 260, 3))
    return np.clip(level + noise, 0, 255).astype(np.uint8)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"pixels": blank()}, "no finger found"),
        ({"pixels": np.zeros((300, 260, 2), np.uint8)}, "shape"),
        ({"pixels": np.zeros((300, 260, 6), np.uint8)}, "shape"),
        ({"pixels": np.zeros((10, 10), np.uint8)}, "too small"),
        ({"pixels": np.zeros((100, 100), bool)}, "bool"),
        (
            {"pixels": np.random.default_rng(0).integers(0, 255, (200, 200, 3), np.uint8)},
            "no finger|plain|specks",
        ),
        ({"face": "radial", "palmar": "up"}, "right or left"),
        ({"tip": "down"}, "cuts the finger on its down side"),
        ({"region_of_interest": (0, 0, 0, 10)}, "empty or outside"),
        ({"region_of_interest": (0, 0, 40, 40)}, "region_of_interest"),
        ({"points": [(10, 10)]}, "two or more"),
        ({"points": [(10, 10), (10, 9999)]}, "outside the picture"),
        ({"points": [(5, 5), (360, 300)]}, "off the finger's outline"),
        *(({"points": [(bad, 0), (5, 5)]}, "points") for bad in (math.nan, 1e300, 10**400)),
        *(({"points": bad}, "points") for bad in ("x", [(0, 0)])),
    ],
)
def test_invalid_input(changes, words):
    given = {"pixels": truth_of("palmar").pixels, "face": "palmar"} | changes
    pixels, face = given.pop("pixels"), given.pop("face")
    with pytest.raises(ImageError, match=words) as caught:
        measure_photograph(pixels, face, SCALE, **given)
    assert len(str(caught.value)) > 20


def test_pad_cut_by_frame_refused():
    truth = truth_of("palmar")
    cut = truth.pixels[int(truth.arc_points(3)[1][0]) + 60 :]
    with pytest.raises(ImageError, match="up side"):
        measure_photograph(cut, "palmar", SCALE)


@pytest.mark.parametrize(("face", "turns", "tip"), [("palmar", 1, "left"), ("radial", 3, "right")])
def test_tip_that_the_picture_contradicts_refused(face, turns, tip):
    turned = np.rot90(truth_of(face).pixels, turns)
    with pytest.raises(ImageError, match=f"give tip {tip}"):
        measure_photograph(turned, face, SCALE)
    assert measure_photograph(turned, face, SCALE, tip=tip).semi_axes == pytest.approx(
        SEMI_AXES[face], rel=0.03
    )
