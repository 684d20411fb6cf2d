"""Thickness and modulus of a layer, on curves that the fast laws had no part in."""

from dataclasses import replace

import numpy as np
import pytest
from benchmarks.claims.layer_inverse import PLACED, whole_pad
from benchmarks.claims.loading_truth import Condition, make_curve
from benchmarks.truth.loading_physics import Pad, hertz, layer

from fingerpad import Estimate
from fingerpad.exceptions import LoadingError
from fingerpad.geometry import Ellipsoid, Paraboloid, Placement
from fingerpad.loading import LoadingCurve, fit_layer_thickness
from fingerpad.loading.joint import Prior, fit_joint, prepare
from fingerpad.loading.layer import THICKER_THAN_FINGER, LayerThicknessFit

PAD = Pad(radius=14.0, modulus=0.05)
SPHERE = Paraboloid(14.0, 14.0)


def curve_on(thickness: float | None, seed: int = 1, pad: Pad = PAD) -> LoadingCurve:
    contact = layer(thickness) if thickness else hertz
    return make_curve(Condition(contact=contact), pad, 0.3, np.random.default_rng(seed))


@pytest.fixture(scope="module")
def on_6_mm():
    return fit_layer_thickness(curve_on(6.0), placement=SPHERE, radius_std=0.4)


def test_intervals_hold_thickness_modulus_contact_and_radius(on_6_mm) -> None:
    truths = {"thickness": 6.0, "youngs_modulus": 0.05, "contact_offset": 0.3, "radius": 14.0}
    for name, truth in truths.items():
        found = getattr(on_6_mm, name)
        assert found.lower < truth < found.upper, name
    assert on_6_mm.thickness.upper / on_6_mm.thickness.lower < 1.5
    assert on_6_mm.radius.std < 0.4  # the curve adds to what the geometry knows
    assert on_6_mm.layer_weight > 0.999
    assert on_6_mm.preferred_model.startswith("layer")
    assert "mm thick" in on_6_mm.conclusion
    thin = Estimate(value=0.8, std=0.2, interval=(0.5, np.inf))
    assert replace(on_6_mm, thickness=thin).conclusion.startswith("tissue thicker than 0.5 mm")
    beyond = replace(on_6_mm, notes={THICKER_THAN_FINGER: "…"}).conclusion
    assert beyond.startswith("this curve tells no thickness of the tissue: the best fit, ")
    assert not on_6_mm.flags


def test_a_half_space_leaves_the_thickness_open_above() -> None:
    deep = fit_layer_thickness(curve_on(None), placement=SPHERE, radius_std=0.4)
    assert deep.thickness.upper == np.inf
    assert deep.thickness.lower > 15
    assert deep.youngs_modulus.lower < PAD.modulus < deep.youngs_modulus.upper
    assert deep.layer_weight < 0.6
    record = deep.as_record()
    assert record["thickness_mm_ci95"] == [deep.thickness.lower, None]
    assert record["thickness_mm"] is None  # a best value of a kilometre tells nothing
    assert deep.conclusion.startswith(f"tissue thicker than {deep.thickness.lower:.3g} mm")


def test_a_whole_pad_takes_its_own_gap() -> None:
    pad = Pad(radius=float(PLACED.curvature.mean_curvature_radius), modulus=0.05)
    curve = make_curve(Condition(contact=whole_pad(12.0)), pad, 0.3, np.random.default_rng(3))
    whole, paraboloid = (
        fit_layer_thickness(curve, placement=one, radius_std=0.2)
        for one in (PLACED, Paraboloid(*PLACED.curvature.principal_radii))
    )
    assert whole.thickness.lower < 12 < whole.thickness.upper
    assert whole.youngs_modulus.lower < 0.05 < whole.youngs_modulus.upper
    assert paraboloid.thickness.lower > 12  # the pad's own flattening hides a part of the layer


def relative_std(quantity: Estimate) -> float:
    return quantity.std / quantity.value


@pytest.mark.parametrize(
    ("known", "wider", "kept"),
    [
        ({"poisson_ratio_std": 0.03}, ("thickness", "youngs_modulus"), ()),
        ({"area_relative_std": 0.1}, ("thickness", "youngs_modulus"), ()),
        ({"load_relative_std": 0.1}, ("youngs_modulus",), ("thickness",)),
        ({"stage_compliance": Estimate.symmetric(0.0, 0.05)}, ("thickness", "youngs_modulus"), ()),
    ],
)
def test_all_that_is_uncertain_widens_what_depends_on_it(on_6_mm, known, wider, kept) -> None:
    found = fit_layer_thickness(curve_on(6.0), placement=SPHERE, radius_std=0.4, **known)
    for name in wider:
        assert relative_std(getattr(found, name)) > 1.03 * relative_std(getattr(on_6_mm, name)), name
    for name in kept:
        assert getattr(found, name) == getattr(on_6_mm, name)
    if "load_relative_std" in known:  # E goes as the force
        added = relative_std(found.youngs_modulus) ** 2 - relative_std(on_6_mm.youngs_modulus) ** 2
        assert added == pytest.approx(0.1**2, rel=0.02)


def test_hertz_theory_that_explains_a_curve_leaves_no_thickness() -> None:
    # A = πRξ and W ∝ ξ^(3/2) of R = 12 mm, where the geometry has an ellipsoid of 1/H = 13.2 ± 1 mm.
    placement = Placement(Ellipsoid(8.94, 12.0, 10.0), wedge_angle=0.0)
    rng = np.random.default_rng([13, 0])
    travel = np.linspace(-0.4, 2.0, 240)
    xi = np.maximum(travel, 0)
    stiffness = 4 / 3 * 0.06 / (1 - 0.48**2) * np.sqrt(12)
    curve = LoadingCurve(
        load=stiffness * xi**1.5 + rng.normal(0, 0.005, 240),
        indentation=travel + rng.normal(0, 0.002, 240),
        area=np.where(xi > 0, np.pi * 12 * xi + rng.normal(0, 0.8, 240), 0),
        time=travel + 0.4,
    )
    found = fit_layer_thickness(curve, placement=placement, radius_std=1.0, poisson_ratio=0.48)
    assert not found.thickness.known
    assert not found.youngs_modulus.known
    assert "Hertz theory" in found.conclusion
    assert found.hertz_weight > found.layer_weight
    assert found.advice.startswith("believe E and the place of contact of Hertz theory")


def test_one_modulus_is_to_be_believed(on_6_mm) -> None:
    assert on_6_mm.advice.startswith("believe the layer's E and place of contact, not those")
    for other in (
        replace(on_6_mm, notes={THICKER_THAN_FINGER: "…"}),
        replace(on_6_mm, thickness=replace(on_6_mm.thickness, interval=(on_6_mm.thickness.lower, np.inf))),
        replace(on_6_mm, weights={"layer": 0.5, "half_space": 0.5}),
    ):
        assert other.advice.startswith("believe the layer's E")
    unknown = LayerThicknessFit.undetermined("no contact area")
    assert unknown.advice.startswith("E of Hertz theory is that of a half-space")


def test_a_radius_surer_than_a_third_of_its_geometry_is_flagged(on_6_mm) -> None:
    assert "radius_narrowed" not in on_6_mm.notes
    exact = {"area_relative_std": 0.0, "stage_compliance": 0.0}
    narrow = fit_layer_thickness(curve_on(3.0), placement=SPHERE, radius_std=3.0, **exact)
    assert narrow.radius.std < 1
    assert "a third of the geometry's 3 mm" in narrow.notes["radius_narrowed"]
    assert "radius_narrowed" in narrow.flags


def test_without_areas_nothing_is_told() -> None:
    curve = curve_on(6.0)
    bare = LoadingCurve(load=curve.load, indentation=curve.indentation, time=curve.time, area=None)
    fit = fit_layer_thickness(bare, placement=SPHERE)
    assert not fit.thickness.known
    assert "no contact area" in fit.thickness.reason
    assert fit.weights == {}


def test_a_prior_goes_from_a_free_to_a_held_parameter() -> None:
    record = prepare(curve_on(None), 0.5, 0).record
    start = {"contact_offset": 0.3, "youngs_modulus": 0.05, "loading_radius": 14.0, "force_zero": 0.0}
    known = Estimate.symmetric(15.0, 0.0)
    free = fit_joint(record, "hertz", start, {})
    held = fit_joint(record, "hertz", start, {"loading_radius": known}, free.noise)

    def with_prior(std: float):
        prior = Prior(values={"loading_radius": 15.0}, covariance=np.array([[std**2]]))
        return fit_joint(record, "hertz", start, {}, free.noise, prior=prior).estimate("youngs_modulus")

    for std, limit in ((1e4, free), (1e-5, held)):
        expected, found = limit.estimate("youngs_modulus"), with_prior(std)
        for name in ("value", "lower", "upper", "std"):
            assert getattr(found, name) == pytest.approx(getattr(expected, name), rel=2e-3), (std, name)


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("placement", Placement(PLACED.ellipsoid, wedge_angle=[0.5, 0.6])),
        ("radius_std", -1.0),
        ("radius_ratio_std", np.inf),
        ("poisson_ratio", 0.2),
        ("poisson_ratio_std", np.nan),
        ("load_relative_std", -0.1),
        ("area_relative_std", np.inf),
        ("shared_scale_std", -0.1),
        ("shared_scale_std", 0.02),
    ],
)
def test_bad_arguments_are_named(name, wrong) -> None:
    with pytest.raises(LoadingError, match=name):
        fit_layer_thickness(curve_on(6.0), **{"placement": SPHERE, name: wrong})


def test_an_error_of_one_scale_is_one_error_of_pad_and_areas() -> None:
    """Radius and areas wrong together by a scale are no evidence of another layer."""
    curve, scale = curve_on(6.0), 1.04
    scaled = replace(curve, area=scale**2 * curve.area)
    placement = Paraboloid(scale * 14.0, scale * 14.0)
    known = {"radius_std": 0.9, "area_relative_std": 0.08}
    apart = fit_layer_thickness(scaled, placement=placement, **known)
    shared = fit_layer_thickness(scaled, placement=placement, **known, shared_scale_std=0.04)
    assert shared.thickness.lower < 6 < shared.thickness.upper
    assert relative_std(shared.radius) < 0.7 * relative_std(apart.radius)
