"""How fast the page answers; the bounds are wide, for machines that do other things meanwhile."""

import time

import cv2
import numpy as np
import pytest
from tests.web.conftest import serving

from fingerpad.image import render_finger, render_imprint
from fingerpad.web.bench import Bench

COUNT = 2000
AXES = "semi_axes_mm = { palmar = 7.9, distal = 13.8, radial_ulnar = 11.8 }"
STD = "semi_axes_std_mm = { palmar = 0.1, distal = 0.1, radial_ulnar = 0.1 }"


@pytest.fixture(scope="module")
def large(tmp_path_factory):
    """Return a client of a study of 2,000 contact images, one of a megapixel, and a photographed finger."""
    workspace = tmp_path_factory.mktemp("large")
    folder = workspace / "large"
    (folder / "frames").mkdir(parents=True)
    print_ = render_imprint(semi_major=8.0, semi_minor=6.0, seed=3).pixels
    cv2.imwrite(str(folder / "one.png"), cv2.resize(print_, (1024, 1024), interpolation=cv2.INTER_CUBIC))
    ppi = 500 * 1024 / print_.shape[1]
    small = cv2.imencode(".png", cv2.resize(print_, (128, 128), interpolation=cv2.INTER_AREA))[1].tobytes()
    for face, axes in (("palmar", (11.8, 13.8)), ("distal", (11.8, 7.9))):
        photograph = render_finger(face, semi_axes=axes, seed=1)
        cv2.imwrite(str(folder / f"{face}.png"), photograph.pixels[..., ::-1])
    text = [
        'title = "Large"',
        f"[scales.one]\nppi = {ppi}\n[scales.small]\nppi = 100\n[scales.camera]\nmm_per_px = 0.05",
        f'[[fingers]]\nname = "a"\n{AXES}\n{STD}',
        '[[fingers]]\nname = "b"\nphotographs = [',
        *(f'{{ face = "{face}", image = "{face}.png", scale = "camera" }},' for face in ("palmar", "distal")),
        "]",
    ]
    contact = 'finger = "a"\nwedge_angle_deg = 30\nload_N = 2\n'
    text.append(f'[[observations]]\nname = "one"\n{contact}image = "one.png"\nscale = "one"')
    for number in range(COUNT):
        (folder / f"frames/{number}.png").write_bytes(small)
        name = f'name = "f{number}"\n{contact}image = "frames/{number}.png"\nscale = "small"'
        text.append(f"[[observations]]\n{name}")
    (folder / "study.toml").write_text("\n".join(text))
    bench = Bench(workspace)
    with serving(bench) as client:
        yield client


def seconds(ask):
    began = time.perf_counter()
    answer = ask()
    assert answer.status_code == 200, answer.text
    return time.perf_counter() - began


def median(ask, rounds=15):
    return float(np.median([seconds(ask) for _ in range(rounds)]))


def test_a_study_of_two_thousand_pictures_opens_in_seconds_and_reads_none_of_them(large):
    assert seconds(lambda: large.post("/api/session/open", json={"name": "large"})) < 6
    state = large.get("/api/study")
    assert len(state.json()["observations"]) == COUNT + 1
    assert len(state.content) < 1_500_000


def test_thumbnails_come_fast_enough_to_scroll(large):
    large.post("/api/session/open", json={"name": "large"})
    numbers = iter(range(COUNT))
    assert median(lambda: large.get("/api/picture/thumbnail", params={"item": f"f{next(numbers)}"})) < 0.1


def drags(kind, start):
    steps = iter(range(1, 1000))
    if kind == "ellipse":
        (row, column), (major, minor) = start["ellipse_px"]["centre"], start["ellipse_px"]["semi_axes"]
        return lambda: {"ellipse_px": {"centre": [row + next(steps), column], "semi_axes": [major, minor]}}
    if kind == "brush":
        return lambda: {
            "strokes": [
                {"action": "add", "points_px": [[300 + next(steps), 200], [400, 210]], "radius_px": 20}
            ]
        }
    return lambda: {"threshold": 20.0 + next(steps)}


@pytest.mark.parametrize("kind", ["ellipse", "brush", "threshold"])
def test_a_contact_of_a_megapixel_follows_the_pointer(large, kind):
    large.post("/api/session/open", json={"name": "large"})
    start = large.post("/api/measure/contact", json={"item": "one"}).json()
    change = drags(kind, start)
    assert median(lambda: large.post("/api/measure/contact", json={"item": "one", "change": change()})) < 0.25


def test_a_photograph_follows_the_pointer(large):
    large.post("/api/session/open", json={"name": "large"})
    start = {"item": "b/palmar.png", "with_finger": True}
    handles = large.post("/api/measure/photograph", json=start).json()["handles"]

    def drag():
        handles["across_end_px"][1] += 1
        return large.post("/api/measure/photograph", json=start | {"handles": handles})

    assert median(drag) < 0.2
