"""Corrections: none is lost by concurrent pages or a killed server."""

from concurrent.futures import ThreadPoolExecutor

import pytest
from tests.web.conftest import Client

PRINT = "synthetic_30deg_2N"
PHOTO = "synthetic_pad/synthetic/photograph_palmar.jpg"
FRAME = "synthetic_press_30deg#12"
PHASES = {"phases": {"starts": [{"phase": "loading", "start_s": 0.1}], "why": "slipped"}}


def correct(client, item, expected, change, who="ada"):
    body = {"item": item, "expected": expected, "who": who, "change": change}
    return client.study_post("corrections", **body)


def now(client, item):
    return client.ask("corrections", item=item)


@pytest.mark.parametrize(
    ("item", "change"),
    [
        (PRINT, {"threshold": 40.0, "accepted": True}),
        (FRAME, {"rejected": "smeared"}),
        ("synthetic_press_30deg#phases", PHASES),
        (PHOTO, {"ellipse_px": {"centre": [300.0, 300.0], "semi_axes": [230.0, 270.0]}}),
    ],
)
def test_a_correction_is_saved_with_author_and_time_undone_and_redone(client, item, change):
    assert {"last_id": 0, "change": {}, "can_undo": False}.items() <= now(client, item).items()
    kept = correct(client, item, 0, change)
    assert kept.status_code == 201, kept.text
    found = kept.json()
    assert found == now(client, item)
    assert found["change"] == change
    assert found["history"][-1]["who"] == "ada"
    assert found["history"][-1]["when"].startswith("20")
    step = {"item": item, "who": "bob"}
    undone = client.tell("corrections/undo", **step, expected=found["last_id"])
    assert (undone["change"], undone["can_undo"], undone["can_redo"]) == ({}, False, True)
    redone = client.tell("corrections/redo", **step, expected=undone["last_id"])
    assert redone["change"] == change
    assert [record["who"] for record in redone["history"]] == ["ada", "bob", "bob"]
    assert client.study_post("corrections/redo", **step, expected=redone["last_id"]).status_code == 422


def test_the_state_shows_reviews(client):
    correct(client, PRINT, 0, {"accepted": True})
    correct(client, FRAME, 0, {"rejected": "smeared"})
    correct(client, PHOTO, 0, {"tip": "up", "rejected": "nail in view"})
    state = client.ask("state")
    one = next(one for one in state["observations"] if one["item"] == PRINT)
    assert (one["accepted"], one["corrected"], one["rejected"], one["who"]) == (True, False, None, "ada")
    photograph = state["fingers"][2]["photographs"][0]
    assert (photograph["rejected"], photograph["corrected"]) == ("nail in view", True)
    frames = client.ask("frames", sequence="synthetic_press_30deg")["frames"]
    assert [frame["frame"] for frame in frames if frame["rejected"]] == [12]


def test_a_replaced_image_is_reported_until_it_is_reviewed(client, studies_folder):
    last = correct(client, PRINT, 0, {"accepted": True}).json()["last_id"]
    assert now(client, PRINT)["on_another_image"] is False
    picture = next((studies_folder / "demo").rglob(f"{PRINT}.png"))
    picture.write_bytes(picture.with_name(picture.name.replace("2N", "4N")).read_bytes())
    assert now(client, PRINT)["on_another_image"] is True
    correct(client, PRINT, last, {"accepted": True})
    assert now(client, PRINT)["on_another_image"] is False


def test_concurrent_corrections_are_saved_or_refused(client):
    """Four pages write six corrections each, each on what it saw last: all that were confirmed are there."""
    confirmed, conflicts = [], []

    def write_six(name):
        with Client(base_url=client.base_url, headers=client.headers, timeout=60, trust_env=False) as own:
            seen, levels = 0, [10.0 + number for number in range(6)]
            while levels:
                answer = correct(own, PRINT, seen, {"threshold": levels[0], "accepted": True}, name)
                if answer.status_code == 201:
                    confirmed.append((name, levels.pop(0)))
                    seen = answer.json()["last_id"]
                else:
                    assert answer.status_code == 409
                    conflicts.append(name)
                    seen = now(own, PRINT)["last_id"]

    with ThreadPoolExecutor(4) as pages:
        list(pages.map(write_six, ("page0", "page1", "page2", "page3")))
    history = now(client, PRINT)["history"]
    assert len(history) == 24
    assert sorted((one["who"], one["change"]["threshold"]) for one in history) == sorted(confirmed)
    assert conflicts  # they did meet


def test_settings_apply_to_other_images_of_the_finger_and_device(client):
    correct(client, PRINT, 0, {"threshold": 60.0, "seed_px": [150.0, 150.0], "accepted": True})
    images = [each for each in client.ask("state")["observations"] if each["file"]]
    of = {each["item"]: (each["finger"], each["scale"]) for each in images}
    found = client.ask("corrections/similar", item=PRINT)
    assert found["settings"] == {"threshold": 60.0}
    similar = {item for item, key in of.items() if key == of[PRINT]} - {PRINT}
    assert {image["item"] for image in found["images"]} == similar
    first = found["images"][0]
    kept = correct(client, first["item"], first["last_id"], first["proposed"] | {"accepted": True}, "bob")
    assert kept.json()["change"] == {"threshold": 60.0, "accepted": True}
    again = client.ask("corrections/similar", item=PRINT)["images"]
    assert [image["differs"] for image in again] == [False, *[True] * (len(again) - 1)]
    # What is there stays, but for the verdict.
    correct(client, again[1]["item"], 0, {"ellipse_px": None, "rejected": "smeared", "dark_on_light": True})
    second = client.ask("corrections/similar", item=PRINT)["images"][1]
    assert second["proposed"] == {"dark_on_light": True, "threshold": 60.0}


def test_the_second_operator_has_corrections_of_their_own(client, studies_folder):
    assert client.ask("second-operator")["images"] == []
    correct(client, PRINT, 0, {"accepted": True}, "ada")
    of = {"item": PRINT, "operator": "second"}
    made = client.tell("corrections", **of, expected=0, who="bob", change={"threshold": 60.0})
    assert made["change"] == {"threshold": 60.0}
    assert now(client, PRINT)["change"] == {"accepted": True}
    asked = client.ask("corrections", **of)
    assert [record["who"] for record in asked["history"]] == ["bob"]
    found = client.ask("second-operator")
    assert (found["first_operators"], found["agreement"]) == (["ada"], [])
    (image,) = found["images"]
    assert (image["item"], image["corrected"], image["who"]) == (PRINT, True, "bob")
    state = client.ask("state")
    assert found["unseen"] == sum(one["file"] is not None for one in state["observations"]) - 1
    assert client.tell("corrections/undo", **of, who="bob", expected=asked["last_id"])["change"] == {}
    assert (studies_folder / "demo" / "second_operator.jsonl").read_text().count("\n") == 2
    assert "second_operator.jsonl" not in {one["file"] for one in state["files"]}
