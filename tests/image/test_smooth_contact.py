"""Contacts without ridges: fixed small pictures of ellipses under uneven light, with reflections and dust."""

import math
from functools import partial

import cv2
import numpy as np
import pytest
from benchmarks.claims.smooth_contacts import accuracy

from fingerpad.exceptions import ImageError
from fingerpad.image import (
    BrushStroke,
    Frame,
    Scale,
    draw_overlay,
    measure_contact_image,
    measure_sequence,
    prepare_contact_image,
)
from fingerpad.image.ellipse import polygon_moments

_SCALE = Scale(0.03, 0.0)
_measured = partial(measure_contact_image, scale=_SCALE, surface="smooth")
_CENTRE, _AXES, _ANGLE = (118.3, 131.6), (70.2, 52.7), 25.0


def _picture(*, contrast=90.0, reflection=False, contact=True, seed=1, size=1.0, noise=None):
    """Return a picture of a blurred ellipse with dust, grain and perhaps a reflection, and its background."""
    rng = np.random.default_rng(seed)
    rows, columns = np.mgrid[:240, :260].astype(float)
    fine = np.zeros((240 * 8, 260 * 8), np.uint8)
    centre = tuple(round(((c + 0.5) * 8 - 0.5) * 16) for c in _CENTRE[::-1])
    if contact:
        axes = tuple(round(a * size * 8 * 16) for a in _AXES)
        cv2.ellipse(fine, centre, axes, _ANGLE, 0, 360, 255, -1, shift=4)
    inside = cv2.resize(fine, (260, 240), interpolation=cv2.INTER_AREA) / 255
    inside = cv2.GaussianBlur(inside, (0, 0), 1.2)
    light = 1 - 0.4 * ((rows - 90) ** 2 + (columns - 160) ** 2) / 240**2
    dust = np.zeros_like(light)
    for row, column in rng.uniform(0, 240, (25, 2)):
        cv2.circle(dust, (int(column), int(row)), 1, 1, -1)
    ground = 110 * light * (1 - 0.4 * dust)
    shine = np.zeros_like(light)
    if reflection:
        cv2.line(shine, (150, 60), (220, 110), 120, 7)
        shine = cv2.GaussianBlur(shine, (0, 0), 1.5)
    image = ground + contrast * light * inside + shine
    rng = rng if noise is None else np.random.default_rng(noise)
    pictures = [each + rng.normal(0, 1.5, each.shape) for each in (image, ground)]
    return [np.rint(each).clip(0, 255).astype(np.uint8) for each in pictures]


_AREA = math.pi * _AXES[0] * _AXES[1] * 0.03**2


@pytest.mark.parametrize(
    ("contrast", "reflection", "with_background"),
    [(90.0, True, False), (-60.0, False, False), (-60.0, True, True)],
)
def test_area_and_axes_are_within_their_uncertainty(contrast, reflection, with_background):
    image, ground = _picture(contrast=contrast, reflection=reflection)
    found = _measured(image, background=ground if with_background else None)
    assert abs(found.gross_area / _AREA - 1) < 0.015
    assert abs(found.gross_area - _AREA) < 2.5 * found.gross_area_std
    assert found.gross_area_std < 0.021 * _AREA
    for axis, std, true in zip(
        (found.ellipse.semi_major, found.ellipse.semi_minor),
        (found.semi_major_std, found.semi_minor_std),
        _AXES,
        strict=True,
    ):
        assert abs(axis - 0.03 * true) < 3 * std
    assert np.allclose(found.centroid, _CENTRE, atol=0.7)
    assert found.dark_on_light == (contrast < 0)
    assert set(found.flags) <= {"edge_hidden"}


def _uneven(share, *, shift):
    """Return a bright contact with waves of up to this share of its radius, its area and semi-axes, in px."""
    turn = np.linspace(0, 2 * np.pi, 2000, endpoint=False)
    waves = np.cos(3 * turn) + 0.6 * np.cos(5 * turn + shift) + 0.4 * np.cos(7 * turn + 2 * shift)
    size = 1 + share * waves / np.abs(waves).max()
    outline = np.stack([130 + 75 * size * np.cos(turn), 120 + 55 * size * np.sin(turn)], axis=1)
    fine = np.zeros((240 * 8, 260 * 8), np.uint8)
    cv2.fillPoly(fine, [np.rint(((outline + 0.5) * 8 - 0.5) * 16).astype(np.int32)], 255, shift=4)
    inside = cv2.GaussianBlur(cv2.resize(fine, (260, 240), interpolation=cv2.INTER_AREA) / 255, (0, 0), 0.8)
    image = 10 + 150 * inside + np.random.default_rng(3).normal(0, 1, inside.shape)
    moments = polygon_moments(outline)
    return np.rint(image).astype(np.uint8), moments.area, moments.semi_axes


@pytest.mark.parametrize(("share", "shift"), [(0.04, 1.0), (0.08, 2.0), (0.08, 4.0)])
def test_a_contact_that_is_no_ellipse_is_followed_round_its_corners(share, shift):
    image, area, axes = _uneven(share, shift=shift)
    found = _measured(image)
    assert found.flags == ()
    assert found.gross_area == pytest.approx(area * 0.03**2, rel=0.006)
    assert found.gross_area_std < 0.015 * found.gross_area
    measured = (found.ellipse.semi_major, found.ellipse.semi_minor)
    assert measured == pytest.approx(axes * 0.03, rel=0.004)


def test_a_dent_that_a_reflection_draws_in_is_flagged():
    """A window over a dark contact's edge is inside as bright as the ground: the outline follows its side."""
    image, ground = _picture(contrast=-60.0)
    window = cv2.GaussianBlur(cv2.rectangle(np.zeros(image.shape), (60, 80), (105, 150), 60, -1), (0, 0), 1.5)
    image = (image + window).clip(0, 255).round().astype(np.uint8)
    found = _measured(image)
    assert found.gross_area < 0.95 * _AREA
    assert "edge_hidden" in found.flags
    assert abs(found.gross_area - _AREA) < 2.5 * found.gross_area_std
    beside = _measured(image, background=ground + window)
    assert beside.gross_area == pytest.approx(_AREA, rel=0.02)


@pytest.mark.parametrize("level", [0, 255])
def test_an_even_border_that_was_added_is_no_contact(level):
    image, _ = _picture(contrast=-60.0)
    found = _measured(np.pad(image, 60, constant_values=level))
    assert found.flags == ()
    assert found.gross_area == pytest.approx(_AREA, rel=0.005)
    assert found.centroid == pytest.approx(np.add(_CENTRE, 60), abs=0.7)


def test_a_cut_out_on_even_ground_is_cut():
    image, _, _ = _uneven(0.04, shift=1.0)
    rows, columns = np.mgrid[:240, :260]
    image[np.hypot(rows - 120, columns - 130) > 50] = 10
    assert "touches_border" in _measured(image).flags


@pytest.mark.parametrize("with_background", [True, False])
def test_the_body_around_a_contact_is_a_doubt(with_background):
    image, ground = _picture(contrast=-60.0, size=0.5)
    rows, columns = np.mgrid[:240, :260]
    body = np.hypot(rows - _CENTRE[0], columns - _CENTRE[1]) < 80
    seen, true = np.where(body, 0.7 * image, image), 0.25 * _AREA
    found = _measured(seen, background=ground if with_background else None)
    assert "edge_unclear" in found.flags or found.gross_area == pytest.approx(true, rel=0.03)


@pytest.mark.parametrize(("film_px", "contrast"), [(4.0, -20.0), (9.0, -30.0), (12.0, -50.0), (12.0, -18.0)])
def test_a_film_round_a_contact_is_no_contact(film_px, contrast):
    image, ground = _picture(contrast=contrast)
    size = 1 + film_px / math.sqrt(math.prod(_AXES))
    film, none = (picture.astype(float) for picture in _picture(contrast=-80 - contrast, size=size))
    found = _measured(image + film - none, background=ground)
    assert "edge_unclear" in found.flags
    assert abs(found.gross_area - _AREA) < 1.96 * found.gross_area_std
    assert found.gross_area == pytest.approx(_AREA, rel=0.03)


def test_the_bright_rim_of_a_film_is_no_fringe():
    image, ground = _picture(contrast=-45.0)
    inner, outer = (1 + px / math.sqrt(math.prod(_AXES)) for px in (10.0, 15.0))
    for contrast, size, less in ((-45.0, inner, 0.0), (80.0, outer, inner)):
        ring, none = (_picture(contrast=contrast, size=each)[0].astype(float) for each in (size, less))
        image = image + ring - none
    found = _measured(image, background=ground)
    assert "edge_unclear" in found.flags
    assert found.gross_area == pytest.approx(_AREA, rel=0.03)


def test_a_step_so_wide_that_it_may_hide_a_film_is_less_certain():
    image, ground = _picture(contrast=-45.0)
    film, none = (
        picture.astype(float)
        for picture in _picture(contrast=-45.0, size=1 + 4.0 / math.sqrt(math.prod(_AXES)))
    )
    found = _measured(image + film - none, background=ground)
    assert abs(found.gross_area - _AREA) < 1.5 * found.gross_area_std


def test_all_that_concerns_ridges_is_empty():
    image, ground = _picture()
    found = _measured(image, background=ground)
    record = found.as_record()
    assert found.surface == "smooth"
    for name in ("ridge_area_mm2", "ridge_area_mm2_std", "ridge_border_mm", "ridge_period_mm"):
        assert math.isnan(record[name])
    assert math.isfinite(record["gross_area_mm2_std"])
    assert not found.ridges.any()
    assert draw_overlay(image, found).ndim == 3
    with pytest.raises(ImageError, match="no threshold"):
        prepare_contact_image(image, _SCALE, surface="smooth").level_histogram()


def test_colours_show_a_contact_that_grey_levels_do_not():
    """A grey background is refused by name where only colours show the contact."""
    contact, ground = (each.astype(float) for each in _picture(contrast=40.0))
    lift = contact - ground
    colours = np.stack([ground + lift, ground - lift / 2, ground - lift / 2], axis=-1).clip(0, 255)
    plain = np.stack([ground] * 3, axis=-1)
    found = _measured(colours, background=plain)
    assert abs(found.gross_area / _AREA - 1) < 0.02
    drawn = draw_overlay(colours.astype(np.uint8), found)
    assert drawn[0, 0] == pytest.approx(colours[0, 0], abs=3)
    with pytest.raises(ImageError, match="both in colour"):
        _measured(colours, background=ground)


def test_a_picture_without_a_contact_is_refused_and_can_be_drawn():
    image, _ = _picture(contact=False, reflection=True)
    prepared = prepare_contact_image(image, _SCALE, surface="smooth", background=image)
    with pytest.raises(ImageError, match="one compact patch"):
        prepared.measure()
    drawn = prepared.measure([BrushStroke(action="add", points=[_CENTRE], radius=50)])
    assert drawn.flags == ("edited_manually",)
    assert abs(drawn.gross_area / (math.pi * 50**2 * 0.03**2) - 1) < 0.05
    assert math.isnan(drawn.ridge_area)


def test_a_manual_edit_moves_the_outline_and_is_flagged():
    image, ground = _picture()
    prepared = prepare_contact_image(image, _SCALE, surface="smooth", background=ground)
    automatic = prepared.measure()
    row, column = automatic.centroid
    bite = BrushStroke(action="remove", points=[(row - 52, column)], radius=12)
    edited = prepared.measure([bite])
    assert edited.gross_area < automatic.gross_area
    assert "edited_manually" in edited.flags
    assert edited.gross_area_std > automatic.gross_area_std


def test_levels_from_0_to_1_give_the_same_area_under_another_exposure():
    image, ground = _picture()
    found = [
        _measured(picture, background=light).gross_area
        for picture, light in ((image, ground // 2), (image / 255, (ground // 2) / 255))
    ]
    assert found[1] == pytest.approx(found[0], rel=1e-6)


@pytest.mark.parametrize("bits", [8, 10, 12, 14, 16])
def test_a_saturated_ground_is_not_taken_for_cut_out(bits):
    image, _ = _picture(contrast=-60.0)
    top = 2**bits - 1
    brightest = np.where(cv2.medianBlur(image, 7) > 58, 1.0, image / 80)  # but for the contact
    levels = np.round(cv2.GaussianBlur(brightest, (0, 0), 0.5) * top).astype(np.uint16)
    found = _measured(levels)
    assert found.gross_area == pytest.approx(_AREA, rel=0.05)
    assert "touches_border" not in found.flags


def test_a_contact_at_the_frame_is_flagged():
    image, ground = _picture()
    found = _measured(image[100:], background=ground[100:])
    assert "touches_border" in found.flags


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"threshold": 20.0}, "tells ridges from valleys"),
        ({"ridge_period": 0.5}, "tells ridges from valleys"),
        ({"seed": (5.0, 5.0)}, "at seed"),
        ({"seed": 5}, "seed 5 lies outside"),
        ({"contrast": "a"}, "contrast"),
        ({"contrast": math.nan}, "contrast must be one number, positive and finite"),
        ({"background": np.ones((20, 20))}, "picture's shape"),
    ],
)
def test_options_that_do_not_fit_are_refused(options, words):
    image, _ = _picture()
    with pytest.raises(ImageError, match=words):
        _measured(image, **options)


_SIZES = [0.0, 0.0, 0.4, 0.6, 0.8, 1.0, 1.0, 1.0, 0.7]


def _press():
    """Return frames of a press under a reflection, the first two before touch."""
    pictures = [
        _picture(size=size, contact=size > 0, reflection=True, noise=k)[0] for k, size in enumerate(_SIZES)
    ]
    return [Frame(index=k, pixels=pixels) for k, pixels in enumerate(pictures)]


def test_the_first_frame_is_the_background_of_a_sequence():
    frames = _press()
    results = list(measure_sequence(frames, _SCALE, surface="smooth"))
    assert [result.measures is not None for result in results] == [size > 0 for size in _SIZES]
    assert [result.is_first_contact for result in results].index(True) == 2
    for size, result in zip(_SIZES, results, strict=True):
        if size:
            off = result.measures["gross_area_mm2"] - size**2 * _AREA
            assert abs(off) < 2.5 * result.measures["gross_area_mm2_std"]
    given = list(measure_sequence(frames, _SCALE, surface="smooth", background=frames[0].pixels))
    for one, other in zip(given, results, strict=True):
        assert (one.measures or {}).get("gross_area_mm2") == (other.measures or {}).get("gross_area_mm2")


def test_a_sequence_that_begins_in_contact_needs_a_background():
    pictures = [_picture(size=size, reflection=True, noise=k)[0] for k, size in enumerate((0.6, 0.8, 1.0))]
    frames = [Frame(index=k, pixels=pixels) for k, pixels in enumerate(pictures)]
    with pytest.raises(ImageError, match="begins in contact: frame 0 shows one, .*: give background"):
        list(measure_sequence(frames, _SCALE, surface="smooth"))
    empty = _picture(contact=False, reflection=True, noise=7)[0]
    results = list(measure_sequence(frames, _SCALE, surface="smooth", background=empty))
    assert all(result.measures for result in results)


@pytest.mark.parametrize("kind", ["ftir", "ftir_dark"])
def test_pictures_made_from_the_optics_alone_are_held(kind):
    found = accuracy(kind, range(9, 10), 1)
    assert found["flags"].notna().all()  # none is refused
    errors = found["found"] - found["area"]
    assert math.sqrt(((errors / found["area"]) ** 2).mean()) < 0.02
    assert (errors.abs() < 1.96 * found["std"]).all()
