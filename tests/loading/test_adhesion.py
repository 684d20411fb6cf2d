"""The law of Johnson, Kendall and Roberts: its limits, numbers of others, and records with a pull-off."""

import numpy as np
import pytest
from benchmarks.claims.adhesion import judged
from benchmarks.truth.adhesion import Sphere, records
from numpy.testing import assert_allclose
from tests import command
from tests.studies import write_curve

import fingerpad as fp
from fingerpad.exceptions import FitError, LoadingError
from fingerpad.loading import LoadingCurve, fit_adhesion, tabor_parameter
from fingerpad.loading.law_registry import LAWS
from fingerpad.report.loading import loading_plots
from fingerpad.simulate import simulate_loading_curve

JKR, HERTZ = LAWS["jkr"], LAWS["hertz"]
PAD = {"loading_radius": 10.0, "poisson_ratio": 0.5, "youngs_modulus": 0.04}
REDUCED = 0.04 / 0.75


@pytest.mark.parametrize("work", [0.0, 1e-22, 1e-20])
def test_without_adhesion_it_is_hertz(work) -> None:
    xi = np.geomspace(1e-3, 3, 60)
    assert_allclose(JKR(xi, **PAD, work_of_adhesion=work), HERTZ(xi, **PAD), rtol=1e-9)
    assert_allclose(JKR.area(xi, **PAD, work_of_adhesion=work), np.pi * 10 * xi, rtol=1e-6)
    assert (JKR(np.array([-1.0, -1e-3]), **PAD, work_of_adhesion=work) == 0).all()


def test_both_equations_of_the_contact_radius() -> None:
    work = 50e-6
    xi = np.linspace(JKR.pull_off(**PAD, work_of_adhesion=work) * (1 - 1e-12), 2, 5001)
    a = np.sqrt(JKR.area(xi, **PAD, work_of_adhesion=work) / np.pi)
    assert_allclose(a**2 / 10 - np.sqrt(2 * np.pi * work * a / REDUCED), xi, atol=1e-11)
    load = 4 * REDUCED * a**3 / 30 - np.sqrt(8 * np.pi * work * REDUCED * a**3)
    assert_allclose(JKR(xi, **PAD, work_of_adhesion=work), load, atol=1e-14)
    assert (np.diff(a) > 0).all()  # one branch, without a jump


def test_pull_off() -> None:
    """Maugis (2000), in units of π w R and (π² w² R/K²)^(1/3) with K = 4/3 E*."""
    work = 50e-6
    step = (np.pi**2 * work**2 * 10 / (4 / 3 * REDUCED) ** 2) ** (1 / 3)
    place = JKR.pull_off(**PAD, work_of_adhesion=work)
    assert_allclose(place / step, -3 / 6 ** (2 / 3), rtol=1e-12)
    load = JKR(np.linspace(place, 1, 400_001), **PAD, work_of_adhesion=work)
    assert_allclose(load.min() / (np.pi * work * 10), -1.5, rtol=1e-8)


def test_against_contact_energy() -> None:
    """Loads by the elastic energy of a bonded disc, without a closed law."""
    work = 80e-6
    stage = np.append(0.3, np.linspace(0.3, JKR.pull_off(**PAD, work_of_adhesion=work) * 0.99, 40))
    xi, load, radius = Sphere(10.0, 0.04).cycle(stage, work)
    assert (radius > 0).all()
    assert_allclose(JKR(xi, **PAD, work_of_adhesion=work), load, atol=1e-5 * np.abs(load).max())
    assert_allclose(np.sqrt(JKR.area(xi, **PAD, work_of_adhesion=work) / np.pi), radius, rtol=1e-3)


def test_a_stiff_small_sphere_is_not_for_this_law() -> None:
    stiff = {"loading_radius": 1e-5, "poisson_ratio": 0.3, "youngs_modulus": 70e3, "work_of_adhesion": 50e-6}
    holds, said = JKR.verdict(**stiff)
    assert not holds
    assert "DMT holds" in said


def adhesive(*, seed: int = 0, rows: int = 300, area: bool = True, **truth: float) -> LoadingCurve:
    """Return a record by the law itself: contact, snap-in at ξ = 0, pull-off on the way out."""
    rng = np.random.default_rng(seed)
    given = {"loading_radius": 10.0, "poisson_ratio": 0.5, **truth}
    lost = JKR.pull_off(**given)
    way_in, way_out = np.linspace(lost - 0.3, 0.8, rows // 2), np.linspace(0.8, 3 * lost - 0.2, rows // 2)
    xi = np.append(way_in, way_out)
    free = np.append(way_in < 0, np.zeros(way_out.size, dtype=bool))
    load, size = (np.where(free, 0.0, law(xi, **given)) for law in (JKR, JKR.area))
    clock = 0.02 * np.arange(xi.size)
    return LoadingCurve(
        time=clock,
        load=load + 0.05 + 0.002 * clock + 0.0005 * rng.standard_normal(xi.size),
        indentation=xi + 2 + 0.001 * rng.standard_normal(xi.size),
        area=size + 0.3 * rng.standard_normal(xi.size) if area else None,
    )


@pytest.mark.parametrize(
    "change", [{"loading_radius": -1.0}, {"youngs_modulus": 0.0}, {"work_of_adhesion": -1e-6}]
)
def test_no_body_has_a_tabor_parameter_of_negative_radius_modulus_or_work(change) -> None:
    given = {"loading_radius": 10.0, "youngs_modulus": 0.04, "work_of_adhesion": 50e-6}
    assert np.isnan(tabor_parameter(**given | change))


def test_fit_of_a_record_with_areas() -> None:
    truth = {"youngs_modulus": 0.04, "work_of_adhesion": 150e-6}
    curve = adhesive(**truth)
    fit = fp.fit_loading_curve(curve, law="jkr")
    assert fit.law is not None
    assert fit.law.flags == ()
    known = {**truth, "pull_off_load": 1.5 * np.pi * 150e-6 * 10}
    known |= {"tabor_parameter": tabor_parameter(loading_radius=10, **truth)}
    for name, value in known.items():
        found = {**fit.law.parameters, **fit.law.derived}[name]
        assert abs(found.value - value) < 3 * found.std
        assert found.std < 0.06 * value
    assert fit.law.loading_radius.lower < 10 < fit.law.loading_radius.upper
    assert fit.law.phase == "unloading"
    assert fit.law.preferred_model == "jkr"
    assert "JKR holds" in fit.law.verdict
    # Hertz on the same rows is wrong by far more than its neighbour's uncertainty.
    assert abs(fit.law.models["hertz"].values["youngs_modulus"] / 0.04 - 1) > 0.1
    shown = {each["name"]: each for each in fit.as_record()["law"]["parameters"]}
    assert shown["work_of_adhesion"]["unit"] == "mJ/m²"
    assert abs(shown["work_of_adhesion"]["value"] - 150) < 10
    assert next(iter(loading_plots("press", curve, fit))).name == "press_load_indentation"


def test_the_way_in_need_not_be_fitted(tmp_path) -> None:
    """A record that begins shortly before the platen turns has hardly a way in, and all of the way out."""
    truth = {"youngs_modulus": 0.04, "work_of_adhesion": 150e-6}
    whole = adhesive(**truth)
    columns = {name: getattr(whole, name)[147:] for name in ("time", "load", "indentation", "area")}
    curve = LoadingCurve(**columns)
    with pytest.raises(FitError, match="rows in contact"):
        fp.fit_loading_curve(curve, law="jkr")
    fit = fit_adhesion(curve)
    for name, value in truth.items():
        found = fit.parameters[name]
        assert abs(found.value - value) < 3 * found.std < 0.2 * value
    with pytest.raises(LoadingError, match="hertz is not adhesive"):
        fit_adhesion(curve, law="hertz")
    path = tmp_path / "press.csv"
    write_curve(path, curve)
    code, out, err = command.run("fit", path, "--law", "jkr")
    assert code == 0
    assert "the way out alone" in err
    assert "work_of_adhesion" in out
    assert command.run("fit", path, "--law", "hertz")[0] != 0


def test_without_a_pull_off_nothing_is_guessed() -> None:
    curve = simulate_loading_curve(points=200, unloading=True, force_std=0.005, area_std=0.5, seed=1)
    fit = fp.fit_loading_curve(curve, law="jkr", stage_compliance=0.0)
    assert fit.law is not None
    assert "no_pull_off" in fit.flags
    assert "no pull-off in the record" in fit.law.parameters["work_of_adhesion"].reason
    assert fit.youngs_modulus.known
    one_way = simulate_loading_curve(points=200, force_std=0.005, area_std=0.5, seed=1)
    reason = fp.fit_loading_curve(one_way, law="jkr", stage_compliance=0.0).notes["no_pull_off"]
    assert reason.startswith("the record has no way out")
    with pytest.raises(LoadingError, match="half-space"):
        fp.fit_loading_curve(curve, law="jkr", thickness=8.0)


@pytest.mark.parametrize(("kind", "refused"), [("truncated", True), ("no_contact", True), ("rate", False)])
def test_records_of_others_that_the_law_is_not_for(kind, refused) -> None:
    for record in records(seed=3, count=1, kind=kind):
        one = judged(record)
        assert one["refused"] if refused else one["flagged"]
