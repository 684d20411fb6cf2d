"""Manual semi-axes of a face: handles, and points added to the outline or erased."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from fingerpad.exceptions import FitError, ImageError
from fingerpad.flags import FLAGS
from fingerpad.image import Scale, measure_photograph, photograph_from_ellipse, with_marked_points
from fingerpad.simulate import render_finger

SCALE = Scale(0.05, 0.0005)


@cache
def truth():
    return render_finger("palmar", semi_axes=(11.8, 13.8), mm_per_px=SCALE.mm_per_px, seed=4)


@cache
def found():
    return measure_photograph(truth().pixels, "palmar", SCALE)


def placed(face="palmar", **others):
    given = {"centre": (300.0, 200.0), "semi_axes": (236.0, 276.0)} | others
    return photograph_from_ellipse(face, Scale(0.05, 0.0005), **given)


@pytest.mark.parametrize(
    ("face", "tip", "palmar", "across", "along"),
    [
        ("palmar", "up", None, (0, 1), (-1, 0)),
        ("palmar", "left", None, (-1, 0), (0, -1)),
        ("distal", "up", "down", (0, -1), (1, 0)),
        ("radial", "up", "right", (0, 1), (-1, 0)),
        ("ulnar", "down", "left", (0, -1), (1, 0)),
    ],
)
def test_handles_along_axes(face, tip, palmar, across, along):
    centre, first, second = placed(face, tip=tip, palmar=palmar).handles
    np.testing.assert_allclose(first - centre, 236 * np.array(across), atol=1e-9)
    np.testing.assert_allclose(second - centre, 276 * np.array(along), atol=1e-9)


def test_tilt_sign():
    centre, first, second = placed(tilt=math.radians(90)).handles
    np.testing.assert_allclose(first - centre, (-236, 0), atol=1e-9)
    np.testing.assert_allclose(second - centre, (0, -276), atol=1e-9)


def test_fit_round_trip():
    again = photograph_from_ellipse(
        "palmar",
        SCALE,
        centre=found().centre,
        semi_axes=tuple(found().semi_axes / SCALE.mm_per_px),
        tilt=found().tilt,
    )
    np.testing.assert_allclose(again.handles, found().handles, atol=1e-9)
    np.testing.assert_allclose(again.ellipse_points(), found().ellipse_points(), atol=1e-9)
    assert again.semi_axes_mm == pytest.approx(found().semi_axes_mm)
    # A hand is less sure than a fit to four hundred points, and surer than a tenth.
    for name, std in again.semi_axes_mm_std.items():
        assert found().semi_axes_mm_std[name] < std < 0.1 * again.semi_axes_mm[name]
    assert again.flags == {"fitted_manually"} <= set(FLAGS["photograph"])


@pytest.mark.parametrize("fit", [found, placed])
def test_covariance_is_the_sum_of_named_terms(fit):
    seen = fit()
    np.testing.assert_allclose(sum(seen.covariance_terms.values()), seen.covariance)
    by_scale = SCALE.relative_std * seen.semi_axes
    for axis, (name, std) in enumerate(seen.semi_axes_mm_std.items()):
        by_term = {term: stds[name] for term, stds in seen.uncertainty_mm_std.items()}
        assert math.hypot(*by_term.values()) == pytest.approx(std)
        assert by_term["scale"] == pytest.approx(by_scale[axis])


def test_implausible_manual_size_flagged():
    large = photograph_from_ellipse("palmar", Scale(0.5), centre=(300, 300), semi_axes=(236, 276))
    assert large.flags == {"fitted_manually", "implausible_size"}
    doubted = replace(found(), flags=found().flags | {"implausible_size"}, semi_axes=10 * found().semi_axes)
    back = with_marked_points(doubted, erased=[(found().points[:1], 20.0)])
    assert "implausible_size" not in back.flags


def test_no_edits():
    assert with_marked_points(found()) is found()
    assert with_marked_points(found(), erased=[([(0, 0)], 5)]) is found()


def bulged():
    """The fit as it were if a wart had pushed a piece of the outline outwards."""
    points = found().points.copy()
    wart = slice(len(points) // 4, len(points) // 4 + 50)
    away = (points[wart] - found().centre) / np.linalg.norm(
        points[wart] - found().centre, axis=1, keepdims=True
    )
    return points, points[wart] + 14 * away, wart


def test_wart_erased():
    points, wart, where = bulged()
    plain = with_marked_points(found(), added=[], erased=[(points[where], 1.5)])
    dirty = with_marked_points(plain, added=wart)
    clean = with_marked_points(dirty, erased=[(wart, 2.0)])
    truth = {"radial_ulnar": 11.8, "distal": 13.8}
    for name, value in truth.items():
        assert abs(clean.semi_axes_mm[name] - value) < 2.5 * clean.semi_axes_mm_std[name]
    assert abs(dirty.semi_axes_mm["radial_ulnar"] - 11.8) > 2 * abs(clean.semi_axes_mm["radial_ulnar"] - 11.8)
    assert len(clean.points) == len(plain.points)
    assert {"fitted_manually"} <= clean.flags


def stds(fit):
    return np.append(np.sqrt(np.diagonal(fit.covariance)) / fit.semi_axes, fit.tilt_std)


def test_edits_one_after_another_are_as_sure_as_all_at_once():
    strokes = [([found().points[k]], 0.3) for k in (40, 90, 140)]
    at_once, chained = with_marked_points(found(), erased=strokes), found()
    for stroke in strokes:
        chained = with_marked_points(chained, erased=[stroke])
    np.testing.assert_allclose(stds(chained), stds(at_once), rtol=1e-6)
    np.testing.assert_allclose(chained.semi_axes, at_once.semi_axes, rtol=1e-6)
    np.testing.assert_allclose(stds(chained), stds(found()), rtol=0.05)


def test_flags_are_those_of_the_arc_that_is_left():
    points, (row, _) = found().points, found().centre
    level = row - 0.78 * found().semi_axes[1] / SCALE.mm_per_px
    low = points[points[:, 0] > level]
    short = with_marked_points(found(), erased=[(low, 1.0)])
    assert short.arc_deg < 90
    assert {"short_arc", "uncertain"} <= short.flags
    ellipse = found().ellipse_points(721)
    marks = ellipse[(ellipse[:, 0] < row) & (ellipse[:, 0] > level)][::12]
    longer = with_marked_points(short, added=marks)
    assert longer.arc_deg > 120
    assert "short_arc" not in longer.flags
    for name, std in longer.semi_axes_mm_std.items():
        assert std < short.semi_axes_mm_std[name]
        assert longer.semi_axes_mm[name] == pytest.approx(found().semi_axes_mm[name], rel=0.01)


def marked(**edits):
    return with_marked_points(found(), **edits)


@pytest.mark.parametrize(
    ("act", "words"),
    [
        (lambda: placed(semi_axes=(0, 5)), "two positive semi-axes"),
        (lambda: placed(centre=(math.nan, 5)), "centre must be two finite"),
        (lambda: placed(centre="middle"), "centre must be numeric"),
        (lambda: placed(palmar="up"), "leave palmar out"),
        (lambda: marked(added="abc"), "added points must be numeric"),
        (lambda: marked(added=[1, 2, 3]), "pairs"),
        (lambda: marked(added=[(1, math.inf)]), "finite"),
        (lambda: marked(added=[(1e200, 5)]), "within 1000000 px"),
        (lambda: marked(erased=[([(1e200, 0), (0, 0)], 5)]), "within 1000000 px"),
        (lambda: marked(erased=[([(1, 1)], 0)]), "positive radius"),
        (lambda: marked(erased=[([(1, 1)], "wide")]), "radius must be numeric"),
        (lambda: marked(erased=[([], 3)]), "needs a point"),
        (lambda: marked(erased=[([found().centre], 1e4)]), "eight finite"),
    ],
)
def test_invalid_input(act, words):
    with pytest.raises((ImageError, FitError), match=words):
        act()
