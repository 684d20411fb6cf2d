"""Every endpoint of the API with valid and invalid requests."""

import math
import shutil
from urllib.parse import quote

import cv2
import numpy as np
import pytest
from benchmarks.truth.grids import Scene
from PIL import Image
from tests.smooth_study import area_at, make_smooth_study
from tests.studies import PAD, Table, append_tables, finger, picture, write_study
from tests.web.conftest import client_of, refused, serving
from tests.web.test_files import upload

from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.web import study_session
from fingerpad.web.workspace import Workspace

PRINT = "synthetic_30deg_2N"
PHOTO = "synthetic_pad/synthetic/photograph_palmar.jpg"


def measured(client, item=PRINT, kind="contact", **params):
    answer = client.study_post(f"measure/{kind}", item=item, **params)
    assert answer.status_code == 200, answer.text
    return answer.json()


def levels_of(client, item):
    """The levels of the picture that the page shows of an item."""
    shown = client.study_get("picture/preview", item=item).content
    return cv2.imdecode(np.frombuffer(shown, np.uint8), cv2.IMREAD_UNCHANGED)


def test_the_session_names_what_is_open(standing, studies_folder):
    session = standing.get("/api/session").json()
    assert session["study"]["name"] == "demo"
    assert session["studies"] == [{"name": "demo", "title": session["study"]["title"]}]
    with serving(Workspace(studies_folder)) as client:
        assert client.get("/api/session").json()["study"] is None
        assert client.post("/api/session/open", json={"name": "demo"}).json()["name"] == "demo"


def test_the_state_lists_each_item_once(standing):
    state = standing.ask("state")
    items = {one["item"]: one for one in state["observations"]}
    shown = {"file": "synthetic/synthetic_30deg_2N.png", "load_N": 2.0, "status": "left", "complete": True}
    assert shown.items() <= items[PRINT].items()
    assert items["table3_30deg_ellipse"]["status"] == "given"
    photographs = [one for finger in state["fingers"] for one in finger["photographs"]]
    assert {one["status"] for one in photographs} == {"left"}
    fitted = [one for one in state["curves"] if one["file"]]
    assert {one["status"] for one in fitted} == {"left"}
    assert {one["status"] for one in state["curves"] if not one["file"]} == {"given"}
    measured = len(state["observations"]) + len(state["sequences"]) + len(photographs) + len(fitted)
    assert sum(state["counts"].values()) == measured
    assert state["sequences"][0]["frames"] == 24
    given, _, photographed = state["fingers"]
    assert axes_of(given) == {"palmar": 7.9, "distal": 13.8, "radial_ulnar": 11.8}
    assert given["semi_axes_mm"]["palmar"]["std"] == pytest.approx(0.1)
    assert photographed["semi_axes_mm"] is None  # before any run
    assert photographed["photographs"][0]["item"] == PHOTO
    camera = {"name": "camera", "table": {"mm_per_px": 0.05, "relative_std": 0.002}, "words": "0.05 mm/px"}
    assert state["scales"][0] == camera | {"used_by": 3, "complete": True}
    assert {one["kind"] for one in state["missing"]} <= {"file", "finger"}
    assert not state["results"]["there"]


def test_sixteen_bits_fill_the_whole_range_of_a_preview(client):
    deep = np.linspace(300, 900, 64 * 64).reshape(64, 64).astype(np.uint16)
    file = upload(client, "deep.png", cv2.imencode(".png", deep)[1].tobytes()).json()["file"]
    assert client.ask("picture/info", item=f"file:{file}")["bits"] == 16
    # An observation shows its levels; a file of which nothing is known is shown as a photograph is.
    table = {"finger": "synthetic_pad", "wedge_angle_deg": 30, "load_N": 1.0, "file": file, "scale": "reader"}
    client.edit({"kind": "observation", "key": "deep", "set": table})
    levels = levels_of(client, "deep")
    assert (levels.min(), levels.max()) == (0, 255)


def test_contacts_without_ridges_are_shown_and_measured_in_colour(tmp_path):
    """Their luma is that of the ground: in grey nothing is there."""
    folder = make_smooth_study(tmp_path / "gel", colour=True).parent
    shutil.copy(folder / "frames" / "006.png", folder / "contact.png")
    shutil.copy(folder / "frames" / "000.png", folder / "empty.png")
    with client_of(folder) as client:
        for item in ("contact", "press#6"):
            assert np.ptp(levels_of(client, item), axis=2).max() > 50
            area = measured(client, item)["numbers"]["gross_area_mm2"]
            assert abs(area["value"] - area_at(2.0)) < 3 * area["std"] < 0.3 * area_at(2.0)
        # A browser keeps a preview under its address for ever: said to be ridged, it is another.
        address = client.ask("picture/info", item="contact")["preview"]
        client.edit({"kind": "observation", "key": "contact", "set": {"surface": "ridged"}})
        assert client.ask("picture/info", item="contact")["preview"] != address


def ellipse_of(one):
    """The ellipse between its handles, as the page saves it."""
    centre, major, minor = np.array(one["handles_px"])
    (row, column), sizes = major - centre, np.linalg.norm([major - centre, minor - centre], axis=1)
    turn = math.degrees(math.atan2(column, row))
    return {"centre": centre.tolist(), "semi_axes": sizes.tolist(), "orientation_deg": turn}


def test_a_contact_is_measured_and_modelled(standing):
    one = measured(standing)
    assert one["by"] == "automatic"
    assert one["numbers"]["semi_major_mm"]["value"] > one["numbers"]["semi_minor_mm"]["value"] > 2
    assert one["numbers"]["semi_major_mm"]["std"] > 0
    for name, size in zip(("semi_major_mm", "semi_minor_mm"), ellipse_of(one)["semi_axes"], strict=True):
        assert size * one["mm_per_px"] == pytest.approx(one["numbers"][name]["value"])
    # Before a run the finger's photographs give its semi-axes; they are rendered of 7.9, 13.8 and 11.8 mm.
    truth = Placement(Ellipsoid(7.9, 13.8, 11.8), wedge_angle=math.radians(30), roll_angle=0).curvature
    radius = one["model"]["numbers"]["mean_curvature_radius_mm"]["value"]
    assert radius == pytest.approx(1 / truth.mean_curvature, rel=0.02)


def test_a_contact_without_finger_angle_and_load_has_no_radius(client, studies_folder):
    """A finger that happens to have the name of a placeholder is not taken for it."""
    scale = {"scale": {"ppi": 500}}
    append_tables(
        studies_folder / "demo",
        finger("none"),
        Table("observations", {"name": "draft", "file": f"synthetic/{PRINT}.png", **scale}),
        Table("sequences", {"name": "film", "file": "synthetic/synthetic_press_30deg.tif", **scale}),
    )
    for item in ("draft", "film#12"):
        answer = measured(client, item)
        assert answer["numbers"]["gross_area_mm2"]["value"] > 10
        assert answer["model"] is answer["pooling"] is None
    signal = client.study_get("signal", sequence="film")
    assert refused(signal) == "state the force of the sequence"


def test_an_unchanged_ellipse_changes_nothing(standing):
    one = measured(standing)
    again = measured(standing, change={"ellipse_px": ellipse_of(one)})
    assert again["by"] == "manual"
    before, after = (each["numbers"]["semi_major_mm"]["value"] for each in (one, again))
    assert after == pytest.approx(before, rel=2e-3)
    assert again["handles_px"][1] == pytest.approx(one["handles_px"][1], abs=0.5)
    assert again["automatic"]["semi_major_mm"]["value"] == before


def test_a_step_of_a_drag_checks_no_result_file(done, monkeypatch):
    assert done.ask("state")["results"]["there"]  # checked once for each result set
    checks = []
    monkeypatch.setattr(study_session, "quick_faults", lambda *_: checks.append(1) or [])
    answer = done.tell("measure/contact", item=PRINT, change={"threshold": 100})
    assert answer["model"]["verdicts"]
    assert not checks


def test_an_unused_file_is_measured_with_a_scale(standing):
    item = "file:synthetic/synthetic_30deg_2N.png"
    assert standing.study_post("measure/contact", item=item).status_code == 422
    one = measured(standing, item, scale={"ppi": 500})
    assert one["numbers"] == measured(standing)["numbers"]


def axes_of(photograph):
    return {axis: quantity["value"] for axis, quantity in photograph["semi_axes_mm"].items()}


def test_a_photograph_gives_two_semi_axes_and_its_finger_three(standing):
    one = measured(standing, PHOTO, "photograph", with_finger=True)
    assert one["by"] == "automatic"
    assert axes_of(one)["radial_ulnar"] == pytest.approx(11.8, rel=0.02)
    assert axes_of(one["finger"])["palmar"] == pytest.approx(7.9, rel=0.02)
    assert one["finger"]["degrees_of_freedom"] == 3
    assert one["finger"]["disagree"] is False
    centre, across, along = one["handles_px"]
    assert math.dist(centre, across) * one["mm_per_px"] == pytest.approx(axes_of(one)["radial_ulnar"])
    dragged = measured(standing, PHOTO, "photograph", handles_px=one["handles_px"])
    assert dragged["by"] == "manual"
    assert axes_of(dragged) == pytest.approx(axes_of(one))
    assert dragged["ellipse_px"]["tilt_deg"] == pytest.approx(one["ellipse_px"]["tilt_deg"], abs=1e-6)
    stored = measured(standing, PHOTO, "photograph", change={"ellipse_px": dragged["ellipse_px"]})
    assert axes_of(stored) == pytest.approx(axes_of(one))
    along[0] -= 20
    longer = measured(standing, PHOTO, "photograph", handles_px=[centre, across, along], with_finger=True)
    assert axes_of(longer["finger"])["distal"] > axes_of(one["finger"])["distal"]


def test_a_length_has_its_uncertainty(standing):
    line = {"line_px": [[0, 0], [0, 200]], "ends_px_std": 0}
    found = standing.tell("measure/length", scale="camera", **line)["length_mm"]
    assert (found["value"], found["std"]) == pytest.approx((10, 0.02))
    assert found["words"] == "10.000\u00a0±\u00a00.020 mm"


def test_geometry_is_that_of_the_library(standing):
    axes = {"palmar": 7.9, "distal": 13.8, "radial_ulnar": 11.8}
    found = standing.tell("geometry", semi_axes_mm=[*axes.values()], wedge_angle_deg=30, detail=8)
    pad = Ellipsoid(**axes)
    placement = Placement(pad, wedge_angle=np.radians(30))
    radius = {"value": pytest.approx(placement.curvature.mean_curvature_radius), "std": None}
    assert radius.items() <= found["mean_curvature_radius_mm"].items()
    assert found["u_deg"]["value"] == pytest.approx(np.degrees(placement.u))
    mesh = np.array(found["mesh_mm"])
    np.testing.assert_allclose(((mesh / pad.semi_axes) ** 2).sum(axis=-1), 1)
    corners = np.array(found["platen_mm"]) - found["contact_point_mm"]
    np.testing.assert_allclose(corners @ found["normal"], 0, atol=1e-9)
    by_name = standing.tell("geometry", finger="left_index_ellipse", wedge_angle_deg=30)
    assert by_name["u_deg"]["value"] == pytest.approx(found["u_deg"]["value"])
    assert by_name["mean_curvature_radius_mm"]["std"] > 0
    # tan u = (distal / palmar) tan(wedge), axes to 0.1 mm and the wedge to 3°.
    relative = np.linalg.norm([0.1 / 13.8, 0.1 / 7.9, np.radians(3) / (np.sin(np.pi / 3) / 2)])
    expected = np.degrees(0.5 * np.sin(2 * placement.u) * relative)
    assert by_name["u_deg"]["std"] == pytest.approx(expected, rel=0.01)


def test_signal_without_a_run_or_a_readable_force(client, studies_folder):
    signal = client.ask("signal", sequence="synthetic_press_30deg")
    assert signal["start_s"] is None
    # The sequence is pressed from 0 s, held between 0.55 and 0.75 s, and let go until 1.05 s or so.
    phases = {one["phase"]: one["start_s"] for one in signal["phases"]}
    assert list(phases) == ["loading", "hold", "unloading", "after"]
    assert (phases["hold"], phases["unloading"]) == pytest.approx((0.55, 0.75), abs=0.05)
    force = "synthetic_press_30deg_force.csv"
    for text, message in (
        ("time_s,force_N\n0,x\n", "'x' is not a finite number"),
        ("Time (s),F (mN)\n0,1\n", 'or say which they are: force_columns = { force = "F (mN):mN" }'),
    ):
        (studies_folder / "demo" / "synthetic" / force).write_text(text)
        said = refused(client.study_get("signal", sequence="synthetic_press_30deg"))
        assert force in said
        assert message in said


def test_a_grid_gives_a_scale_and_rectifies_pictures(client, studies_folder):
    board = Scene(tilt=0.3, turn=0.4).picture((7, 9), 4.0, "checkerboard")
    Image.fromarray(board).save(studies_folder / "demo" / "board.png")
    table = {"grid": "board.png", "points": [7, 9], "spacing_mm": 4.0, "spacing_mm_std": 0.004}
    found = client.tell("measure/scale", table=table)
    assert found["flags"] == ["grid_tilted"]
    rectified = found["grid"]["rectified_mm_per_px"]
    assert found["relative_std"] > 0.02 > rectified["std"] / rectified["value"] > 0.001
    assert len(found["grid"]["points_px"]) == 63
    made = client.tell("scale/rectify", table=table, files=["board.png"])
    assert made["files"] == {"board.png": "rectified/board.png"}
    straight = client.tell("measure/scale", table={**table, "grid": "rectified/board.png"})
    assert straight["flags"] == []
    assert straight["mm_per_px"]["value"] == pytest.approx(made["mm_per_px"], rel=2e-3)
    wrong = client.study_post("measure/scale", table={**table, "points": [6, 9]})
    assert "board.png: no grid of 6 × 9 inner corners found" in refused(wrong)


BLUNDER = {"seed_px": [9999, 0]}
ROI = {"region_of_interest_px": [5, 5, 6, 6]}
TITLE = [{"kind": "study", "key": "", "set": {"title": "x"}}]
ADA = {"item": PRINT, "expected": 0, "who": "ada"}
BAD = [
    ("scale/rectify", {"table": {"ppi": 500}, "files": ["x.png"]}, 400),
    ("/api/nothing", None, 404),
    ("state", {}, 405),
    ("frames", None, 400),
    ("frames?sequence=no", None, 404),
    ("signal?sequence=no", None, 404),
    ("picture/preview?item=synthetic_30deg_2N&longest_px=99999", None, 400),
    ("picture/preview?item=table3_30deg_ellipse", None, 404),
    ("picture/preview?item=synthetic_press_30deg%2399", None, 422),
    ("picture/info?item=synthetic_30deg_2N&extra=1", None, 400),
    ("measure/contact", {"item": "table3_30deg_ellipse"}, 404),
    ("measure/contact", {"item": PRINT, "change": {"threshold": -1}}, 400),
    ("measure/contact", {"item": PRINT, "change": {"unknown": 1}}, 400),
    ("measure/contact", {"item": PRINT, "change": {"seed_px": [1e300, 0]}}, 400),
    ("measure/contact", {"item": PRINT, "change": BLUNDER}, 422),
    ("measure/contact", {"item": PRINT, "scale": "no"}, 404),
    ("measure/contact", {"item": PRINT, "scale": {"ppi": 0}}, 400),
    ("measure/photograph", {"item": PRINT}, 404),
    ("measure/photograph", {"item": PHOTO, "face": "dorsal"}, 400),
    ("measure/photograph", {"item": PHOTO, "change": ROI}, 422),
    ("measure/length", {"scale": "camera", "line_px": [[0, 0]]}, 400),
    ("measure/scale", {"table": "nothing"}, 404),
    ("measure/scale", {"table": {"line": [[0, 0], [0, 0]], "length_mm": 50}}, 400),
    ("measure/scale", {"table": {"ppi": 500, "mm_per_px": 0.05}}, 400),
    ("geometry", {}, 400),
    ("geometry", {"finger": "unknown"}, 422),
    ("geometry", {"finger": "left_index_ellipse", "wedge_angle_deg": 91}, 400),
    ("geometry", {"semi_axes_mm": [1, 1, 0]}, 400),
    ("geometry", {"semi_axes_mm": [1, 1, 1e-300]}, 400),
    ("results/rows", None, 404),
    ("results/plot", None, 404),
    ("download/report.html", None, 404),
    ("corrections?item=no", None, 422),
    ("corrections", ADA | {"who": "", "change": {}}, 422),
    ("corrections", ADA | {"change": BLUNDER}, 422),
    ("corrections/undo", ADA, 422),
    ("edits", {"expected": "old", "edits": TITLE}, 409),
    ("edits", {"expected": "", "edits": []}, 400),
    ("/api/session/open", {"name": "nothing"}, 404),
    ("/api/session/new", {"name": "demo"}, 409),
    ("run", {"workers": 0}, 400),
]


@pytest.mark.parametrize(("path", "body", "status"), BAD)
def test_bad_requests_get_messages(standing, path, body, status):
    address = path if path.startswith("/") else f"/api/studies/demo/{path}"
    answer = standing.request("GET" if body is None else "POST", address, json=body)
    assert refused(answer, status)
    assert "Traceback" not in answer.text


@pytest.mark.parametrize(
    "content",
    [b"", b"{", b"[]", b"null", b"\xff\xfe", b'{"item": NaN}', b'{"item": "a", "item": ' + b"[" * 5000],
)
def test_malformed_bodies_get_messages(standing, content):
    assert refused(standing.post("/api/studies/demo/measure/contact", content=content), 400)


def test_a_new_study_lists_missing_entries_until_it_is_complete(client, studies_folder):
    client.study = "mine"
    state = client.post("/api/session/new", json={"name": "mine", "title": "Mine"}).json()
    assert (state["title"], state["ready"]) == ("Mine", False)
    assert state["missing"]
    content = (studies_folder / "demo/synthetic/synthetic_30deg_2N.png").read_bytes()
    file = upload(client, "a.png", content).json()["file"]
    missing = client.ask("state")["missing"]
    assert next(one for one in missing if one["kind"] == "file")["key"] == file
    state = client.edit({"kind": "observation", "key": "a", "set": {"file": file, "load_N": 2.0}})
    known = {"complete": False, "load_N": 2.0, "finger": None}
    assert known.items() <= state["observations"][0].items()
    assert any(one["key"] == "a" and "finger" in one["words"] for one in state["missing"])
    assert client.study_get("picture/thumbnail", item="a").status_code == 200  # already to be seen
    axes = {"semi_axes_mm": PAD, "semi_axes_mm_std": dict.fromkeys(PAD, 0.1)}
    rest = {"finger": "left", "wedge_angle_deg": 30, "scale": "reader"}
    state = client.edit(
        {"kind": "finger", "key": "left", "set": axes},
        {"kind": "scale", "key": "reader", "set": {"ppi": 500}},
        {"kind": "observation", "key": "a", "set": rest},
    )
    assert state["ready"]
    assert state["observations"][0]["complete"]
    assert state["missing"] == []
    radius = measured(client, "a")["model"]["numbers"]["radius_from_indentation_mm"]
    assert radius["value"] == pytest.approx(13.8, rel=0.1)
    assert radius["std"] > 0
    wrong = [{"kind": "observation", "key": "a", "set": {"load_N": -1}}]
    assert "load_N" in refused(client.study_post("edits", expected=state["digest"], edits=wrong))
    assert client.ask("state")["digest"] == state["digest"]


def test_several_studies_are_open_at_once(client, studies_folder):
    client.study = name = "übung"
    shutil.copytree(studies_folder / "demo", studies_folder / name)
    before = (studies_folder / "demo" / "study.toml").read_bytes()
    of = f"/api/studies/{quote(name)}"
    changed = client.edit(*TITLE)
    assert (changed["name"], changed["title"]) == (name, "x")
    preview = client.ask("picture/info", item="synthetic_30deg_1N")["preview"]
    assert preview.startswith(f"{of}/picture/preview")
    assert client.get(preview).headers["content-type"] == "image/png"
    assert client.get("/api/studies/demo/state").json()["name"] == "demo"
    assert (studies_folder / "demo" / "study.toml").read_bytes() == before
    assert client.ask("state")["title"] == "x"
    assert client.get("/api/studies/nowhere/state").status_code == 404
    assert client.get("/api/studies/nowhere").status_code == 404
    assert client.get(f"{of}/state", headers={"authorization": ""}).status_code == 403


def test_an_example_study_is_made_and_another(client):
    made = [client.post("/api/session/example").json() for _ in range(2)]
    assert [one["name"] for one in made] == ["example", "example-2"]
    assert all(one["ready"] and one["fingers"][0]["synthetic"] for one in made)


@pytest.mark.parametrize("name", ["study.toml", "observations.csv"])
def test_what_is_saved_while_it_is_read_is_read_again(studies_folder, monkeypatch, name):
    folder, load = studies_folder / "demo", study_session.load_study
    left = ["once"]

    def load_and_save(path):
        loaded = load(path)
        if left:
            left.clear()
            lines = (folder / name).read_text().splitlines(keepends=True)
            changed = [*lines, "\n# Saved meanwhile.\n"] if name == "study.toml" else lines[:-1]
            (folder / name).write_text("".join(changed))
        return loaded

    monkeypatch.setattr(study_session, "load_study", load_and_save)
    opened = Workspace(studies_folder).open_folder(folder)
    opened.read()
    assert opened.read().digest == load(folder / "study.toml").digest


def test_a_study_of_two_thousand_pictures_opens_without_reading_them(tmp_path):
    (tmp_path / "large" / "frames").mkdir(parents=True)
    names = [f"frames/{number}.png" for number in range(2000)]
    for name in names:
        (tmp_path / "large" / name).write_bytes(b"no picture")
    frames = (picture(f"f{number}", name, scale="small") for number, name in enumerate(names))
    write_study(tmp_path / "large", finger(), *frames, scales={"small": {"ppi": 100}})
    with client_of(tmp_path / "large") as client:
        state = client.study_get("state")
    found = state.json()
    assert len(found["observations"]) == found["counts"]["left"] == len(names)
    assert found["missing"] == []
    assert len(state.content) < 1_500_000
