import pytest


def test_state(client):
    state = client.get("/api/study").json()
    assert state["ready"], state["missing"]
    assert len(state["observations"]) == 13
    print(state["observations"][0], state["counts"])


def test_correct(client):
    item = "synthetic_30deg_2N"
    first = client.get("/api/corrections", params={"item": item})
    assert first.status_code == 200, first.text
    body = {
        "item": item,
        "expected": 0,
        "who": "ada",
        "change": {"strokes": [{"action": "add", "points_px": [[150, 20], [150, 60]], "radius_px": 20}]},
    }
    kept = client.post("/api/corrections", json=body)
    assert kept.status_code == 201, kept.text
    again = client.post("/api/corrections", json=body)
    assert again.status_code == 409, again.text
    print(again.text)
    one = client.post("/api/measure/contact", json={"item": item})
    assert one.status_code == 200, one.text
    one = one.json()
    assert one["by"] == "program with corrections"
    assert one["numbers"]["gross_area_mm2"] > one["program"]["gross_area_mm2"]


@pytest.mark.parametrize(
    "item",
    [
        "synthetic_press_30deg#12",
        "synthetic_pad/synthetic/photograph_palmar.jpg",
        "file:synthetic/synthetic_30deg_2N.png",
    ],
)
def test_pictures(client, item):
    for kind in ("info", "preview", "thumbnail"):
        answer = client.get(f"/api/picture/{kind}", params={"item": item})
        assert answer.status_code == 200, answer.text
    if "/" not in item:
        one = client.post("/api/measure/contact", json={"item": item})
        assert one.status_code == 200, one.text
