"""The ellipse of an arc with unknown ends, against outlines that depart from the ellipse beyond them."""

import math

import numpy as np
import pytest
from scipy.integrate import cumulative_simpson
from scipy.ndimage import gaussian_filter1d

from fingerpad.image.photograph.arc import fit_arc
from fingerpad.image.photograph.ends import average_over_ends

SEMI_AXES = np.array([197.0, 230.0])
TILT = (0.0, math.radians(2))


def half_outline(half_deg, departure):
    """Return points 1 px apart from the ellipse's top on, whose curvature changes beyond an angle."""
    a, b = SEMI_AXES
    turn = np.linspace(0, math.radians(98), 20001)
    speed = np.hypot(a * np.cos(turn), b * np.sin(turn))
    bend = a * b / speed**2 * (1 + departure * (turn > math.radians(half_deg)))
    along, heading = (cumulative_simpson(one, x=turn, initial=0) for one in (speed, bend))
    x = cumulative_simpson(np.cos(heading) * speed, x=turn, initial=0)
    y = b - cumulative_simpson(np.sin(heading) * speed, x=turn, initial=0)
    places = np.arange(0, along[-1])
    return np.stack([np.interp(places, along, x), np.interp(places, along, y)], axis=-1)


def outline(half_deg, departures, seed):
    """Return an outline about a middle of 90 degrees, and each point's angle from there, degrees."""
    right, left = (half_outline(half_deg, one) for one in departures)
    points = np.concatenate([right[::-1], left[1:] * (-1, 1)])
    rough = gaussian_filter1d(np.random.default_rng(seed).normal(0, 1, points.shape), 1, axis=0)
    angles = np.degrees(np.arctan2(points[:, 1] / SEMI_AXES[1], points[:, 0] / SEMI_AXES[0])) - 90
    return points + 0.2 * rough / rough.std(), angles


def both(half_deg, departures, seed, found_deg):
    points, angles = outline(half_deg, departures, seed)
    return averaged(points, np.abs(angles) < found_deg)


def averaged(points, on_arc):
    """Return the fit of an arc, its average over the ends, and the covariance between these."""
    arc = fit_arc(points, np.flatnonzero(on_arc), TILT)
    kept = np.delete(np.arange(len(points)), arc.rejected)
    return arc.fit, *average_over_ends(points[kept], arc.fit, middle=math.pi / 2, tilt=TILT)


def off(fit):
    return (np.array(fit.ellipse[2:4]) - SEMI_AXES) / SEMI_AXES


@pytest.mark.parametrize(
    ("departures", "found_deg"), [((0.3, 0.3), 60), ((-0.4, -0.4), 60), ((-0.4, -0.4), 78), ((0.8, 0.8), 76)]
)
def test_wrong_ends_are_corrected(departures, found_deg):
    pairs = [both(70, departures, seed, found_deg) for seed in range(6)]
    before, after = (np.sqrt(np.mean([off(pair[k]) ** 2 for pair in pairs])) for k in (0, 1))
    assert after < 0.75 * before
    assert after < 0.005


def test_uncertainty_coverage():
    z = []
    for seed in range(30):
        rng = np.random.default_rng([seed, 7])
        half = rng.uniform(55, 85)
        found_deg = half + rng.normal(0, 5)
        _, fit, ends = both(half, rng.normal(0, 0.6, 2), seed, found_deg)
        shared = fit.shared_error_covariance(0.075, 0.075, math.radians(25))
        z.append((fit.ellipse.semi_y - SEMI_AXES[1]) / math.sqrt((fit.covariance + ends + shared)[3, 3]))
    # Of 30 one or two lie beyond 1.96; seven would be a chance of one in a thousand.
    assert np.sum(np.abs(z) > 1.96) < 7
    assert np.median(np.abs(z)) > 0.2


def test_no_departure():
    before, after, ends = both(70, (0.0, 0.0), 1, 90)
    assert np.abs(off(after)).max() < 0.002
    assert (after.covariance + ends)[3, 3] < 4 * before.covariance[3, 3]


def test_nail_beyond_arc():
    points, angles = outline(70, (0.2, -0.3), 2)
    points[angles > 85] += (-4, 0)
    _, fit, _ = averaged(points, np.abs(angles) < 70)
    assert np.abs(off(fit)).max() < 0.01


def test_too_short_to_average():
    points, _ = outline(70, (0.2, 0.2), 3)
    arc, same, ends = averaged(points[::10], np.ones(len(points[::10]), bool))
    assert same is arc
    assert not ends.any()
