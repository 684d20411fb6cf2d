"""How fast the page draws in a browser: numbers behind a dragged handle, and a long filmstrip.

Needs Chromium.
"""

import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from PIL import Image
from playwright.sync_api import Page, sync_playwright

from fingerpad.simulate import render_contact_image

SIDE, FRAMES = 1024, 2000
# From the first move of the pointer without an answer to the next numbers on the page.
_WATCH = """() => {
  window.waits = [];
  let moved = null;
  document.addEventListener('pointermove', () => { moved ??= performance.now(); }, true);
  new MutationObserver(() => {
    if (moved !== null) window.waits.push(performance.now() - moved);
    moved = null;
  }).observe(document.querySelector('[data-part=numbers]'), { childList: true, subtree: true });
}"""
_SCROLL = """async () => {
  const strip = document.querySelector('.filmstrip');
  const waits = [];
  let last = performance.now();
  for (let step = 0; step < 90; step += 1) {
    strip.scrollLeft += 1800;
    await new Promise(requestAnimationFrame);
    const now = performance.now();
    waits.push(now - last);
    last = now;
  }
  return waits;
}"""
_STUDY = """
title = "Synthetic"
[[fingers]]
name = "f"
semi_axes_mm = {{ palmar = 7.9, distal = 13.8, radial_ulnar = 11.8 }}
semi_axes_mm_std = {{ palmar = 0.1, distal = 0.1, radial_ulnar = 0.1 }}
[[observations]]
name = "one"
finger = "f"
wedge_angle_deg = 30
load_N = 2
file = "one.png"
scale = {{ ppi = {ppi} }}
[[sequences]]
name = "long"
finger = "f"
wedge_angle_deg = 30
file = "frames"
scale = {{ ppi = 500 }}
force = "force.csv"
frames_per_second = 500
"""


def find_chromium() -> str | None:
    """Return the program of a browser, first one without windows, which is the fastest."""
    names = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
    return next(filter(None, map(shutil.which, names)), None)


def report() -> None:
    """Print the times."""
    chromium = find_chromium()
    if chromium is None:
        print("\nThe page in a browser: not measured, there is no Chromium")
        return
    with TemporaryDirectory() as folder:
        _write_study(Path(folder))
        with _served(Path(folder)) as address, sync_playwright() as playwright:
            browser = playwright.chromium.launch(
                executable_path=chromium, args=["--no-sandbox", "--disable-background-networking"]
            )
            page = browser.new_page(viewport={"width": 1280, "height": 800})
            page.goto(address)
            page.locator("#sidebar .brand").wait_for()
            print("\nThe page in a browser, ms")
            drag, opened, scroll = _drag(page), *_scroll(page)
            browser.close()
    for name, median, slow, asked in (
        (f"pointer to numbers at {SIDE} × {SIDE}", *np.percentile(drag, [50, 90]), 50),
        (f"{FRAMES:,} frames opened", opened, opened, 2000),
        (f"{FRAMES:,} frames scrolled, a picture", *np.percentile(scroll, [50, 90]), 17),
    ):
        print(f"  {name:<44} median {median:6.0f}, 90 % under {slow:6.0f}; asked ≤ {asked}")


def _write_study(folder: Path) -> None:
    pixels = render_contact_image(semi_major=8.0, semi_minor=6.0, seed=3).pixels
    big = Image.fromarray(pixels).resize((SIDE, SIDE), Image.Resampling.BICUBIC)
    big.save(folder / "one.png")
    (folder / "frames").mkdir()
    Image.fromarray(pixels).save(folder / "frames" / "f0000.png")
    for number in range(1, FRAMES):
        (folder / "frames" / f"f{number:04d}.png").hardlink_to(folder / "frames" / "f0000.png")
    times = "\n".join(f"{number / 500},1" for number in range(FRAMES))
    (folder / "force.csv").write_text(f"time_s,force_N\n{times}\n", encoding="ascii")
    text = _STUDY.format(ppi=500 * SIDE / pixels.shape[1])
    (folder / "study.toml").write_text(text, encoding="utf-8")


@contextmanager
def _served(folder: Path) -> Iterator[str]:
    command = [sys.executable, "-m", "fingerpad", "app", str(folder / "study.toml"), "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        found = re.search(r"http\S+", process.stdout.readline())
        assert found is not None
        try:
            yield found[0]
        finally:
            process.terminate()


def _go(page: Page, step: str) -> None:
    page.evaluate("step => { location.hash = `#/${step}` }", step)


def _drag(page: Page) -> list[float]:
    _go(page, "contacts/images/one")
    handle = page.get_by_role("button", name="End of the semi-major axis", exact=True)
    page.locator("[data-live=numbers]").wait_for()
    page.evaluate(_WATCH)
    box = handle.bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    for step in range(60):
        page.mouse.move(x + 20 * np.sin(step / 4), y + step / 4)
        page.wait_for_timeout(30)
    waits: list[float] = page.evaluate("() => window.waits")
    page.mouse.up()
    return waits


def _scroll(page: Page) -> tuple[float, list[float]]:
    start = page.evaluate("() => performance.now()")
    _go(page, "contacts/sequence:long")
    page.locator(".filmstrip .cell").first.wait_for()
    opened: float = page.evaluate("() => performance.now()") - start
    waits: list[float] = page.evaluate(_SCROLL)
    return opened, waits
