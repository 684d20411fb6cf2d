"""Loading curves in studies: fitted whole, by their slope alone, or with a radius from elsewhere."""

import html
import math
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
from tests import command, studies
from tests.studies import PAD, Table, contact, finger, run_watched, write_numbers, write_outlines

from fingerpad._digest import digest_of_values
from fingerpad._rounding import value_with_uncertainty
from fingerpad.contact import Tissue, fast_contact
from fingerpad.flags import FLAGS
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.report.text import doubtful_results, to_measure_better
from fingerpad.simulate import simulate_loading_curve
from fingerpad.study.measuring.curves import CurveResult, PlacedPad, loading_radius
from fingerpad.study.pipeline import run_study
from fingerpad.study.results.output import summary_of
from fingerpad.study.results.study_result import StudyResult
from fingerpad.study.results.table import records
from fingerpad.study.results.validity.model_checks import ROUTES
from fingerpad.study.status import study_status

HEADER = "time_s,force_N,displacement_mm,area_mm2"
UNCERTAINTY = {"wedge_angle_deg_std": 0.3}


def of_file(file: str = "a.csv", **keys: object) -> Table:
    return studies.curve(file=file, **keys)


def on_half_space(file: str = "a.csv", **keys: object) -> Table:
    """Return a curve to which no layer is fitted, which takes twice the time of all else."""
    return of_file(file, thickness_mm=np.inf, **keys)


def of_radius(radius: float, **keys: object) -> Table:
    return studies.curve(loading_radius_mm=radius, **keys)


def write_curve(path: Path, *, area: bool = True, points: int = 100, **truth: float) -> None:
    """Write a curve, of few points where its numbers do not matter."""
    noise = {"force_std": 0.004, "displacement_std": 0.003, "area_std": 0.8 if area else 0}
    studies.write_curve(path, simulate_loading_curve(with_area=area, points=points, **noise, **truth))


@pytest.fixture(scope="module")
def on_layer(tmp_path_factory) -> Path:
    """Return the folder of what the fast law makes of the pad on 6 mm of tissue; its fit is stored there."""
    folder = tmp_path_factory.mktemp("layer")
    placement = Placement(Ellipsoid(7.9, 13.8, 11.8), wedge_angle=np.radians(30))
    travel, rng = np.linspace(-0.3, 1.6, 120), np.random.default_rng(4)
    tissue = Tissue(youngs_modulus=0.045, thickness=6.0)
    press = fast_contact(placement, tissue, indentation=np.maximum(travel, 1e-6))
    noise = rng.normal(0, [[0.004], [0.8]], (2, 120))
    columns = travel + 0.3, press.load + noise[0], travel, np.where(travel > 0, press.area + noise[1], 0)
    write_numbers(folder / "a.csv", HEADER, np.transpose(columns))
    return folder


def write_study(
    folder: Path, *curves: Table, of: Table | None = None, load: float = 2, **more: object
) -> Path:
    """Write a study of curves beside one contact."""
    pressed = contact("c", load, axis="", **more)
    return studies.write_study(folder, of or finger(), pressed, *curves, uncertainty=UNCERTAINTY)


def study(folder: Path, *curves: Table, **uncertainty: float) -> StudyResult:
    tables = finger(), contact("c", axis=""), *curves
    return studies.run(folder, *tables, uncertainty=UNCERTAINTY | uncertainty)


def test_a_curve_tells_radius_modulus_and_velocity(tmp_path):
    truth = {"loading_radius": 15.0, "initial_modulus": 0.04, "load_coefficient": 0.02, "rate": 3.0}
    write_curve(tmp_path / "a.csv", points=250, **truth)
    result = study(tmp_path, of_file())
    (curve,) = result.curves
    assert abs(curve.loading_radius - 15) < 4 * curve.loading_radius_std
    assert curve.velocity == pytest.approx(3.0, rel=0.01)
    assert abs(curve.fit.initial_modulus.value - 0.04) < 4 * curve.fit.initial_modulus.std
    (record,) = summary_of(result).model_dump()["curves"]
    assert record["fit"]["initial_modulus_kpa"] == pytest.approx(1000 * curve.fit.initial_modulus.value)
    # With areas and semi-axes the curve says what it can of the tissue over bone.
    assert record["layer"]["thickness_mm_ci95"][0] == curve.layer.thickness.lower
    # The true ellipsoid reads a higher modulus from the area than from the indentation, the more so loaded.
    assert (curve.shape.ratio > 1).all()
    assert curve.shape.ratio[-1] > curve.shape.ratio[0]


def test_columns_that_were_not_read_are_noted_with_the_line_to_write(tmp_path):
    path = tmp_path / "a.csv"
    write_curve(path)
    text = path.read_text()
    path.write_text(text.replace("area_mm2", "aera_mm2"))
    (note,) = study(tmp_path, of_file()).notes
    assert note.startswith("a.csv: column 'aera_mm2' was not read; if it is the area: file_columns = {")
    line = note.partition("area: ")[2]
    mapped = study(tmp_path, on_half_space(**tomllib.loads(line)))
    assert mapped.notes == ()
    assert mapped.curves[0].loading_radius > 0

    path.write_text(text.replace("force_N", "Fz (N)"))
    reason = study(tmp_path, of_file()).curves[0].reason or ""
    assert reason.endswith('file_columns = { force = "Fz (N):N" }')


def test_a_doubtful_curve_is_told(tmp_path):
    write_curve(tmp_path / "a.csv", loading_radius=15.0, initial_modulus=8.0)
    result = study(tmp_path, on_half_space())
    assert FLAGS["curve"]["implausible_modulus"].words in "\n".join(doubtful_results(result))
    _, out, _ = command.run("run", tmp_path / "study.toml", "--out", tmp_path / "out")
    doubt = "doubtful: a.csv: the modulus lies beyond any finger pad's: the curve tests none; to do: check"
    assert doubt in out
    # Nor does a radius of no finger, as of a displacement in micrometres, test that of contacts.
    rows = np.loadtxt(tmp_path / "a.csv", delimiter=",", skiprows=1) * [1, 1, 1000, 1]
    write_numbers(tmp_path / "a.csv", HEADER, rows)
    (curve,) = study(tmp_path, on_half_space()).curves
    assert "implausible_radius" in curve.fit.flags
    assert loading_radius([curve], ("f", 30.0, False)) is None


def test_a_curve_of_a_finger_without_semi_axes_has_radius_and_modulus(tmp_path):
    write_curve(tmp_path / "a.csv", loading_radius=15.0, initial_modulus=0.04)
    studies.write_study(tmp_path, finger(std=0), of_file())
    _, out, _ = command.run("run", tmp_path / "study.toml", "--out", tmp_path / "out")
    assert re.search(r"f, wedge 30°: R_g 1\S+ ± \S+ mm, E \d+\S* ± \S+ kPa at \S+ N from loading data", out)


def test_a_stated_instrument_is_corrected_for(tmp_path):
    write_curve(tmp_path / "a.csv", points=100, loading_radius=15.0, initial_modulus=0.04)
    rows = np.loadtxt(tmp_path / "a.csv", delimiter=",", skiprows=1)
    rows[:, 2] += 0.06 * rows[:, 1]  # the stage yields by this much, and its encoder counts it as indentation
    write_numbers(tmp_path / "a.csv", HEADER, rows)
    stated = {"stage_compliance_mm_per_N": 0.06, "stage_compliance_mm_per_N_std": 0.002}
    given, plain = study(tmp_path, on_half_space(**stated), on_half_space()).curves
    assert abs(given.loading_radius - 15) < 3 * given.loading_radius_std
    assert plain.loading_radius < 14.6


def test_a_curve_says_that_it_pressed_a_half_space(tmp_path):
    """What has no layer leaves the force alone to tell its modulus."""
    write_curve(tmp_path / "a.csv", points=200, loading_radius=15.0, initial_modulus=0.04, area=False)
    known = {"loading_radius_mm": 15, "stage_compliance_mm_per_N": 0}
    on_layer = of_file(**known, thickness_mm=8, thickness_mm_std=1)
    deep, layer, unknown = study(tmp_path, on_half_space(**known), on_layer, of_file(**known)).curves
    assert "hertz_inverse_thickness" in unknown.fit.alternatives
    assert not deep.fit.alternatives
    assert not layer.fit.alternatives
    assert "untested_without_area" in unknown.fit.flags
    assert "untested_without_area" not in deep.fit.flags
    assert layer.fit.initial_modulus.value < 0.8 * deep.fit.initial_modulus.value
    assert layer.fit.initial_modulus.std > deep.fit.initial_modulus.std


def test_the_radius_of_a_curve_is_as_uncertain_as_that_of_a_contact(tmp_path):
    """No finger is an ellipsoid, which outlines alone do not tell of the radius across it."""
    pad = finger(photographs=write_outlines(tmp_path))
    result = run_study(write_study(tmp_path, of=pad), tmp_path / "out")
    placed = PlacedPad(result.fingers["f"], 30.0, result.study.uncertainty)
    first, second = placed.placement.curvature.principal_radii
    (row,) = records(result.rows)
    assert 2 / (1 / first + 1 / second) == pytest.approx(row["mean_curvature_radius_mm"])
    assert placed.radius_std == pytest.approx(row["mean_curvature_radius_mm_std"], rel=1e-3)
    assert placed.radius_ratio_std > 0.03


def test_a_curve_that_tells_the_layer_says_how_to_state_it(on_layer):
    pressed = contact("c", 2, (7, 6), std=0.1), of_file()
    thick = finger(effective_thickness_mm=6, effective_thickness_mm_std=0.6)
    bare, stated = (studies.run(on_layer, of, *pressed, uncertainty=UNCERTAINTY) for of in (finger(), thick))
    layer = bare.curves[0].layer
    value, std = value_with_uncertainty(layer.thickness.value, layer.thickness.std).split(" ± ")
    modulus = layer.youngs_modulus.times(1000)
    keys = f"state effective_thickness_mm = {value}, effective_thickness_mm_std = {std}, "
    keys += f"with which the curve gives E = {modulus} kPa"
    better = "; ".join(to_measure_better(bare))
    assert f"{keys}, for f (a.csv)" in better
    assert "thickness of the tissue over bone of f" not in better
    said, said_of_stated = ("\n".join(doubtful_results(one)) for one in (bare, stated))
    assert keys in said
    assert keys not in said_of_stated
    assert "believe the layer's E" in said_of_stated
    assert "semi-axes" not in said + said_of_stated


def test_what_the_study_states_is_in_the_layer_of_a_curve(on_layer):
    plain, loose = (
        study(on_layer, of_file(), **stated).curves[0].layer
        for stated in ({}, {"load_relative_std": 0.1, "poisson_ratio_std": 0.03})
    )
    for name, least in (("thickness", 0.0), ("youngs_modulus", 0.095)):
        stds = [getattr(one, name).std / getattr(one, name).value for one in (plain, loose)]
        assert np.sqrt(stds[1] ** 2 - stds[0] ** 2) > least, name


def test_only_curves_that_changed_are_fitted_again(tmp_path):
    for name in ("a", "b"):
        write_curve(tmp_path / f"{name}.csv", area=name == "a", loading_radius=15.0, initial_modulus=0.04)
    curves = (on_half_space(), of_file("b.csv"), of_file("b.csv", fit_load_range_N=[0.2, 1.5]))
    manifest = write_study(tmp_path, *curves)

    def fitted() -> tuple[list[str], list[CurveResult]]:
        result, measured = run_watched(manifest)
        return [name for name in measured if name.startswith("f/")], result.curves

    def stale() -> int:
        found = study_status(manifest, tmp_path / "out")
        assert found.total == len(curves) + 1
        return found.stale

    first, fresh = fitted()
    assert first == ["f/a.csv", "f/b.csv", "f/b.csv (2)"]
    again, kept = fitted()
    assert again == []
    assert digest_of_values(kept) == digest_of_values(fresh)
    write_curve(tmp_path / "a.csv", loading_radius=14.0, initial_modulus=0.04)
    assert stale() == 1
    changed, other = fitted()
    assert changed == ["f/a.csv"]
    assert other[0].loading_radius < kept[0].loading_radius
    # the pad's shape is drawn beside the data, so that other semi-axes ask for another comparison
    write_study(tmp_path, *curves, of=finger(semi_axes_mm=PAD | {"palmar": 8.1}))
    assert stale() == len(curves)


def test_uncertainty_is_checked_again_only_where_something_bears_on_it(tmp_path):
    def checked(**keys: object) -> int:
        seen: list[str] = []
        manifest = write_study(tmp_path, **keys)
        result = run_study(manifest, tmp_path / "out", on_progress=lambda one: seen.append(one.status))
        assert result.placements[0].uncertainty_check.observation == "c"
        return seen.count("checked")

    assert [checked(), checked(), checked(load=3), checked(load=3, notes="calm")] == [1, 0, 1, 0]


def test_without_area_a_radius_from_elsewhere_gives_moduli(tmp_path):
    write_curve(tmp_path / "a.csv", area=False, loading_radius=15.0)
    result = study(tmp_path, of_file())
    (alone,), validity = result.curves, result.placements[0].validity
    assert not alone.fit.initial_modulus.known
    assert "no contact area" in alone.reason
    advice = "; ".join(to_measure_better(result))
    assert "record contact areas along the loading curve of f" in advice
    assert "record a loading curve" not in advice
    # The contact's area and the curve's ξ make R_g: all that Hertz theory says is off as ξ is.
    checks = {check.check: check for check in validity.checks if check.check in ROUTES.values()}
    assert {check.verdict for check in checks.values()} == {"strained"}
    ratio = checks["indentation_against_curve"].value / checks["indentation_against_curve"].reference
    for name in ("radius_against_loading", "modulus_against_curve"):
        assert checks[name].reference / checks[name].value == pytest.approx(ratio)
    deviation = math.log(ratio) * (1 - checks["indentation_against_curve"].deviations ** -2) ** 0.5
    for headline in validity.headlines.values():
        assert headline.model_relative_std == pytest.approx(math.expm1(abs(deviation) / 2**0.5))
    known = {"loading_radius_mm": 15, "loading_radius_mm_std": 1.5, "stage_compliance_mm_per_N": 0}
    helped = study(tmp_path, on_half_space(**known)).curves[0]
    assert helped.loading_radius == 15
    assert helped.fit.initial_modulus.known
    # E goes as R^-1/2: a tenth of the radius is a twentieth of the modulus.
    assert helped.fit.youngs_modulus.std / helped.fit.youngs_modulus.value == pytest.approx(0.05, rel=0.15)


def test_what_cannot_be_fitted_whole_may_still_have_a_slope(tmp_path):
    load = np.linspace(0.5, 2.0, 6)
    depth = load ** (2 / 3)
    rows = np.stack([load, depth, np.pi * 14.0 * depth], axis=-1)
    write_numbers(tmp_path / "a.csv", "force_N,displacement_mm,area_mm2", rows)
    result = study(tmp_path, of_file())
    (curve,) = result.curves
    assert curve.loading_radius == pytest.approx(14.0, rel=1e-3)
    assert not curve.failed
    assert result.failures == []


def test_curves_of_one_placement_are_pooled(tmp_path):
    for seed in (1, 2):
        write_curve(tmp_path / f"{seed}.csv", loading_radius=15.0, seed=seed)
    result = study(tmp_path, on_half_space("1.csv"), on_half_space("2.csv"))
    pooled = loading_radius(result.curves, ("f", 30, False))
    low, high = sorted(curve.loading_radius for curve in result.curves)
    assert low < pooled.value < high
    assert abs(pooled.value - 15) < 4 * pooled.std
    assert loading_radius(result.curves, ("f", 30, True)) is None
    assert loading_radius(result.curves, ("f", 45, False)) is None
    # A radius that came out small does not count for more.
    for stated, std in (({}, None), ({"loading_radius_mm_std": 0.1}, 1.5 / np.sqrt(2))):
        given = (of_radius(r, **{name: each * r for name, each in stated.items()}) for r in (14.0, 16.0))
        found = loading_radius(study(tmp_path, *given).curves, ("f", 30, False))
        assert found.value == pytest.approx(15.0)
        assert std is None or found.std == pytest.approx(std)
    # One without an uncertainty would make all of them exact.
    result = study(tmp_path, of_radius(14.0, loading_radius_mm_std=1.0), of_radius(20.0))
    found = loading_radius(result.curves, ("f", 30, False))
    assert (found.value, found.std) == (14.0, pytest.approx(1.0))
    assert any(note.startswith("f at 30°, R_g as given: does not count") for note in result.notes)


def test_a_bad_curve_costs_itself_only_and_the_report_shows_fits_and_reasons(tmp_path):
    (tmp_path / "bad.csv").write_text("force_N,displacement_mm\n" + "0.0,1.0\n" * 30)
    write_curve(tmp_path / "a.csv", area=False)
    for rate in (1.0, 4.0):
        write_curve(tmp_path / f"{rate:g}.csv", rate=rate)
    given = of_file("bad.csv"), of_file(cycle=3), of_file(), of_file("1.csv"), on_half_space("4.csv")
    result = study(tmp_path, *given)
    bad, missing, alone, whole, _ = result.curves
    assert bad.failed
    assert bad.reason.startswith("bad.csv: ")
    assert "cycle" in missing.reason
    assert alone.fit is not None
    assert str(tmp_path) not in "".join(result.failures)
    page = html.unescape(studies.page_of(result, tmp_path / "out"))
    assert "no contact area in the curve" in page
    assert "a.csv: a.csv" not in page
    assert whole.layer.advice in page  # of two moduli a word which to believe
    assert "Young's modulus at no load against velocity" in page
    names = {path.name for path in (tmp_path / "out" / "figures").glob("curve4*.svg")}
    assert len(names) == 7
    assert "curve4_f_30deg_simulator.svg" in names


# What is measured in a curve or outline whose scale has a name: one uncertain number for all of them

CAMERA = {"mm_per_px": 0.05, "relative_std": 0.03}
LOST = {"coin": "none.png", "diameter_mm": 23.25}


@pytest.fixture(scope="module")
def run_of_curves(tmp_path_factory) -> StudyResult:
    """Run a curve without a scale, by its name, by its uncertainty and lost; and another by its name."""
    folder = tmp_path_factory.mktemp("fitted")
    for seed in (0, 1):
        write_curve(folder / f"{seed}.csv", seed=seed)
    np.savetxt(folder / "none.png", [[0]])
    ways = {}, {"scale": "camera"}, {"area_relative_std": 0.06}, {"scale": LOST}
    curves = *(on_half_space("0.csv", **keys) for keys in ways), on_half_space("1.csv", scale="camera")
    return studies.run(folder, finger(), *curves, scales={"camera": CAMERA})


@pytest.fixture
def fitted(run_of_curves) -> list[CurveResult]:
    return run_of_curves.curves


def test_curves_given_twice_and_without_a_layer(run_of_curves):
    assert "0.csv: press 0 is given 4 times, and counts once" in run_of_curves.notes
    plain, *_, other = run_of_curves.curves
    every, once = (
        loading_radius(curves, ("f", 30.0, False)) for curves in (run_of_curves.curves, [plain, other])
    )
    assert every == once
    assert all(curve.layer is None for curve in run_of_curves.curves)


def test_a_curve_given_twice_makes_no_check_more_certain(tmp_path):
    write_curve(tmp_path / "a.csv")
    once, twice = (
        study(tmp_path, *many * [on_half_space()]).placements[0].validity.checks for many in (1, 2)
    )
    assert {one.check for one in once if one.reference_std > 0} >= set(ROUTES.values())
    assert twice == once


def test_radius_and_moduli_are_as_uncertain_as_the_scale_of_the_areas(fitted):
    plain, named, stated, *_ = fitted
    # R_g goes with the areas, which have twice the scale's uncertainty, and E with its square root.
    for name, added in (("loading_radius", 0.06), ("youngs_modulus", 0.03), ("initial_modulus", 0.03)):
        before, after = (getattr(one.fit, name) for one in (plain, named))
        assert after.value == pytest.approx(before.value, rel=1e-6)
        assert np.sqrt(after.std**2 - before.std**2) / after.value == pytest.approx(added, rel=0.05), name
        assert getattr(stated.fit, name).std == pytest.approx(after.std), name
    before, after = (one.fit.contact_offset for one in (plain, named))
    assert after.std == pytest.approx(before.std, rel=1e-2)


def test_moduli_of_curves_are_as_uncertain_as_the_gain_of_the_force_and_poissons_ratio(tmp_path, fitted):
    write_curve(tmp_path / "0.csv", seed=0)
    stated = study(tmp_path, on_half_space("0.csv"), load_gain_relative_std=0.03, poisson_ratio_std=0.03)
    # E goes with the force, and at ν = 1/2 as 1 − ν² does: -4/3 times ν.
    of = {"loading_radius": 0, "reduced_modulus": 0.03, "youngs_modulus": 0.05, "initial_modulus": 0.05}
    for name, added in of.items():
        before, after = (getattr(one.fit, name) for one in (fitted[0], stated.curves[0]))
        assert after.value == before.value
        assert np.sqrt(after.std**2 - before.std**2) / after.value == pytest.approx(added, abs=1e-6), name


def test_curves_of_one_scale_do_not_average_its_error_out(fitted):
    pooled = loading_radius([fitted[1], fitted[4]], ("f", 30.0, False))
    assert pooled is not None
    assert pooled.std / pooled.value > 0.06


def test_a_scale_that_is_not_found_costs_its_curve(fitted):
    assert fitted[3].reason is not None
    assert "none.png" in fitted[3].reason
    assert fitted[3].fit is None
    assert all(one.fit is not None for one in fitted if one is not fitted[3])


# Outlines in millimetres whose scale has a name: one uncertain number for all of them

AXES = np.array(list(PAD.values()))


def with_outlines(folder: Path, scale: dict[str, object], *more: Table) -> StudyResult:
    folder.mkdir(exist_ok=True)
    return studies.run(
        folder,
        finger(photographs=write_outlines(folder, **scale)),
        contact(load=1, axis=""),
        *more,
        uncertainty={"wedge_angle_deg_std": 0.3},
        scales={"camera": CAMERA, "other": CAMERA},
    )


def test_an_error_of_a_named_scale_moves_all_semi_axes_alike(tmp_path):
    results = [
        with_outlines(tmp_path / name, scale)
        for name, scale in (("own", {"outline_relative_std": 0.03}), ("shared", {"scale": "camera"}))
    ]
    own, shared = (one.fingers["f"] for one in results)
    exact = " ".join(results[1].study.taken_as_exact())
    assert "outlines" not in exact
    assert "scale" not in exact
    assert (own.scale, shared.scale) == (None, "camera")
    relative = np.sqrt(np.diagonal(shared.covariance)) / AXES
    assert (relative > 0.03).all()  # three faces of one scale do not average its error out
    size = np.ones(3) / (3 * AXES)  # of the logarithm of the geometric mean
    assert np.sqrt(size @ shared.covariance @ size) > 0.03 > 1.2 * np.sqrt(size @ own.covariance @ size)


def test_the_scale_that_outlines_and_areas_share_is_one_error(tmp_path):
    spreads, radii = {}, {}
    for scale in ("camera", "other"):
        (folder := tmp_path / scale).mkdir()
        write_curve(folder / "curve.csv", points=50)
        result = with_outlines(folder, {"scale": "camera"}, of_file("curve.csv", scale=scale))
        validity, (of_curve,) = result.placements[0].validity, result.curves
        radii[scale] = of_curve.layer.radius
        (check,) = (one for one in validity.checks if one.check == "radius_against_loading")
        spreads[scale] = check.relative_std
    # The pad's radius goes with the scale of its outlines, R_g with the square of that of the areas.
    first, second = 1 + 0.03 * np.random.default_rng(0).normal(size=(2, 100_000))
    shared, apart = np.log(first / first**2).var(), np.log(first / second**2).var()
    assert spreads["other"] ** 2 - spreads["camera"] ** 2 == pytest.approx(apart - shared, rel=0.05)
    # In the fit of a layer areas that are wrong by the scale tell how wrong the radius is.
    assert radii["camera"].std < 0.95 * radii["other"].std
