"""How fast the page answers: a study opened, handles dragged, brushes and points, thumbnails.

Times are round trips over the loopback, as the page sees them.
"""

import json
import shutil
import statistics
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from http.client import HTTPConnection
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import cv2
import uvicorn

from fingerpad.simulate import render_contact_image, render_finger
from fingerpad.web.app import listening, make_app
from fingerpad.web.security import Access
from fingerpad.web.workspace import Workspace

TOKEN = "benchmark"
PICTURES = 2000
SIDE = 1024
FACES = {"palmar": (11.8, 13.8), "distal": (11.8, 7.9), "radial": (7.9, 13.8)}
Ask = Callable[[str, str, Any], Any]


def write_study(folder: Path) -> None:
    """Write a study of 2,000 small contact images, one of 1024 × 1024 pixels, and a photographed finger."""
    (folder / "frames").mkdir(parents=True)
    pixels = render_contact_image(semi_major=8.0, semi_minor=6.0, seed=3).pixels
    cv2.imwrite(str(folder / "one.png"), cv2.resize(pixels, (SIDE, SIDE), interpolation=cv2.INTER_CUBIC))
    small = folder / "frames" / "0.png"
    cv2.imwrite(str(small), cv2.resize(pixels, (256, 256), interpolation=cv2.INTER_AREA))
    for number in range(1, PICTURES):
        shutil.copy(small, folder / "frames" / f"{number}.png")
    for face, axes in FACES.items():
        photograph = render_finger(face, semi_axes=axes, seed=1)  # type: ignore[arg-type]
        cv2.imwrite(str(folder / f"{face}.png"), photograph.pixels[..., ::-1])
    contact = 'finger = "a"\nwedge_angle_deg = 30\nload_N = 2\n'
    faces = "".join(f'{{ face = "{face}", file = "{face}.png", scale = "camera" }},' for face in FACES)
    text = [
        'title = "Large, synthetic"',
        f"[scales.one]\nppi = {500 * SIDE / pixels.shape[1]}",
        "[scales.small]\nppi = 200\n[scales.camera]\nmm_per_px = 0.05",
        '[[fingers]]\nname = "a"\nsemi_axes_mm = { palmar = 7.9, distal = 13.8, radial_ulnar = 11.8 }',
        "semi_axes_mm_std = { palmar = 0.1, distal = 0.1, radial_ulnar = 0.1 }",
        f'[[fingers]]\nname = "b"\nphotographs = [{faces}]',
        f'[[observations]]\nname = "one"\n{contact}file = "one.png"\nscale = "one"',
    ]
    text += [
        f'[[observations]]\nname = "f{number}"\n{contact}file = "frames/{number}.png"\nscale = "small"'
        for number in range(PICTURES)
    ]
    (folder / "study.toml").write_text("\n".join(text), encoding="utf-8")


@contextmanager
def asking(studies_folder: Path) -> Iterator[Ask]:
    """Serve a workspace, and yield what asks it over one connection, as a browser keeps it."""
    workspace, listener = Workspace(studies_folder), listening(0)
    server = uvicorn.Server(uvicorn.Config(make_app(workspace, Access(TOKEN)), log_level="warning"))
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]})
    thread.start()
    connection = HTTPConnection("127.0.0.1", listener.getsockname()[1], timeout=120)
    headers = {"authorization": f"Bearer {TOKEN}", "content-type": "application/json"}

    def ask(method: str, path: str, body: Any = None) -> Any:
        connection.request(method, path, None if body is None else json.dumps(body), headers)
        answer = connection.getresponse()
        content = answer.read()
        assert answer.status < 300, content
        return json.loads(content) if "json" in (answer.getheader("content-type") or "") else content

    try:
        yield ask
    finally:
        connection.close()
        server.should_exit = True
        thread.join()
        listener.close()


def report() -> None:
    """Print the times."""
    with TemporaryDirectory() as folder:
        write_study(Path(folder) / "large")
        with asking(Path(folder)) as ask:
            print(f"\nThe page: {PICTURES:,} pictures, dragging at {SIDE} × {SIDE}; round trips, ms")
            print(f"  {'':<44}{'first':>8}{'median':>8}{'worst':>8}  asked")
            _row("open the study", lambda: ask("POST", "/api/session/open", {"name": "large"}), 1, 2000)
            _row("state of the study", lambda: ask("GET", "/api/studies/large/state", None), 5)
            _report_contacts(ask)
            _report_photographs(ask)


def _report_contacts(ask: Ask) -> None:
    step = count(1)
    _row(
        "a thumbnail",
        lambda: ask("GET", f"/api/studies/large/picture/thumbnail?item=f{next(step)}", None),
        40,
    )

    def contact(**change: Any) -> Any:
        return ask("POST", "/api/studies/large/measure/contact", {"item": "one", "change": change})

    _row("contact: measured", contact, 1)
    ellipse = contact()["ellipse_px"]
    row, column = ellipse["centre"]
    _row(
        "contact: handle of the ellipse",
        lambda: contact(ellipse_px={**ellipse, "centre": [row + next(step), column]}),
        40,
        50,
    )
    path = [[300 + k, 250] for k in range(60)]
    _row(
        "contact: brush",
        lambda: contact(strokes=[{"action": "add", "points_px": path, "radius_px": 10 + next(step) / 10}]),
        40,
        50,
    )
    _row("contact: threshold", lambda: contact(threshold=20.0 + next(step) / 10), 20, 50)


def _report_photographs(ask: Ask) -> None:
    step = count(1)
    asked = {"item": "b/palmar.png", "with_finger": True}

    def photograph(**more: Any) -> Any:
        return ask("POST", "/api/studies/large/measure/photograph", asked | more)

    _row("photograph and its finger: measured", photograph, 1)
    found = photograph()
    handles, (row, column) = found["handles"], found["points_px"][0]
    along, across = handles["along_end_px"], handles["across_end_px"]

    def dragged() -> Any:
        return photograph(
            handles={
                **handles,
                "across_end_px": [across[0], across[1] + next(step) / 10],
                "along_end_px": along,
            }
        )

    _row("photograph: handle, with all three faces", dragged, 40, 50)
    rubber = {"points_px": [[row, column]]}
    _row(
        "photograph: rubber, with all three faces",
        lambda: photograph(change={"erased": [{**rubber, "radius_px": 5 + next(step) / 10}]}),
        20,
        50,
    )


def _row(name: str, ask: Callable[[], Any], rounds: int, asked_ms: float | None = None) -> None:
    times = []
    for _ in range(rounds):
        began = time.perf_counter()
        ask()
        times.append(1000 * (time.perf_counter() - began))
    said = "" if asked_ms is None else f"  ≤ {asked_ms:g}"
    print(f"  {name:<44}{times[0]:8.1f}{statistics.median(times):8.1f}{max(times):8.1f}{said}")
