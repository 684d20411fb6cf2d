"""The page in Chromium.

Each tab records its requests and console messages; each test ends by checking that there were no requests to
other machines and no messages.
"""

import json
import re
import subprocess
import sys
import tomllib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple
from weakref import WeakKeyDictionary

from playwright.sync_api import Browser, Locator, Page, Request, Route, expect
from tests.web.conftest import TOKEN, serving

from fingerpad.exceptions import FingerpadError
from fingerpad.web.app import listening
from fingerpad.web.security import START
from fingerpad.web.workspace import Workspace

ROOT = Path(__file__).resolve().parents[3]
DEMO = ROOT / "examples" / "dzidek2017"
PATIENCE_MS = 60_000  # test machines may be slow
expect.set_options(timeout=PATIENCE_MS)


class Served(NamedTuple):
    """One launch of the page: its address with the token, and its host."""

    address: str
    host: str


@contextmanager
def served(folder: Path, study: Path | None = None) -> Iterator[Served]:
    """Serve the page of a folder, with a study open, from a thread of this process."""
    workspace = Workspace(folder)
    if study is not None:
        workspace.open_folder(study)
    with serving(workspace, port=_free_port()) as client:
        host = str(client.base_url).rstrip("/")
        yield Served(f"{host}{START}?token={TOKEN}", host)


@cache
def _usual_port() -> int:
    with listening(0) as listener:
        return listener.getsockname()[1]


def _free_port() -> int:
    """Return the port of the servers before, if free: a browser keeps the page's files of one address."""
    try:
        with listening(_usual_port()):
            return _usual_port()
    except FingerpadError:
        return 0


@contextmanager
def launched(study: Path, port: int = 0) -> Iterator[tuple[Served, subprocess.Popen]]:
    """Serve a study by `fingerpad app` in a process of its own, which can be killed."""
    process = subprocess.Popen(
        [sys.executable, "-m", "fingerpad", "app", str(study), "--no-browser", "--port", str(port)],
        cwd=study.parent,
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        found = re.search(r"(http://[^/]+)\S+", process.stdout.readline())
        assert found, "the program printed no address"
        yield Served(found.group(0), found.group(1)), process
    finally:
        process.kill()
        process.communicate()


# Tabs that tests are done with, by browser: to open another takes four times as long as to empty one.
_IDLE: WeakKeyDictionary[Browser, list[Page]] = WeakKeyDictionary()
_VIEWPORT = {"width": 1280, "height": 800}


# The page may still be at work, and must store nothing any more.
_EMPTY_STORES = """() => {
  Storage.prototype.setItem = () => {};
  localStorage.clear();
  sessionStorage.clear();
}"""


class Tab:
    """A tab of the browser, and what it heard."""

    def __init__(self, browser: Browser, server: Served, **options) -> None:
        self.server = server
        self.idle = None if options else _IDLE.setdefault(browser, [])
        if self.idle:
            self.page: Page = self.idle.pop()
        else:
            context = browser.new_context(viewport=_VIEWPORT, reduced_motion="reduce", **options)
            self.page = context.new_page()
        self.context = self.page.context
        self.page.set_default_timeout(PATIENCE_MS)
        self.said: list[str] = []
        self.asked: list[str] = []
        self.expected: list[str] = []
        self.heard = {
            "console": lambda m: (
                self.said.append(f"{m.text} {m.location['url']}") if m.type in ("error", "warning") else None
            ),
            "pageerror": lambda error: self.said.append(str(error)),
            "request": lambda request: self.asked.append(request.url),
        }
        for event, hear in self.heard.items():
            self.page.on(event, hear)

    def open(self, step: str = "study") -> Page:
        self.page.goto(self.server.address)
        self.page.locator("#sidebar .brand").wait_for()
        if step != "study":
            self.go(step)
        return self.page

    def go(self, step: str) -> Page:
        """Go to a step, and wait until it is the one that hears keys."""
        self.page.evaluate("step => { location.hash = `#/${step}` }", step)
        self.page.locator(f"#work.view-{step.partition('/')[0]}").wait_for()
        return self.page

    def off_host(self) -> list[str]:
        return [url for url in self.asked if not url.startswith((self.server.host, "data:", "blob:"))]

    def close(self) -> None:
        if self.idle is None:
            self.context.close()
        else:
            self._empty()
            self.idle.append(self.page)
        self.judge()

    def judge(self) -> None:
        """Judge what was heard since the last time."""
        unexpected = [
            words for words in self.said if not any(re.search(each, words) for each in self.expected)
        ]
        abroad = self.off_host()
        for heard in (self.said, self.asked, self.expected):
            heard.clear()
        assert not unexpected, unexpected
        assert not abroad, abroad

    def _empty(self) -> None:
        """Leave nothing of a test to the next."""
        for page in self.context.pages:
            if page != self.page:
                page.close()
        self.context.unroute_all(behavior="ignoreErrors")
        self.page.unroute_all(behavior="ignoreErrors")
        if self.page.url.startswith(self.server.host):
            self.page.evaluate(_EMPTY_STORES)
        self.page.goto("about:blank")
        for event, hear in self.heard.items():
            self.page.remove_listener(event, hear)
        self.context.clear_cookies()
        self.page.set_viewport_size(_VIEWPORT)
        self.page.mouse.move(0, 0)


@contextmanager
def tab_on(browser: Browser, folder: Path, study: Path | None = None, **options) -> Iterator[Tab]:
    """Open a tab on the page of a folder, with a study open; what it heard is judged at the end."""
    with served(folder, study) as server:
        tab = Tab(browser, server, **options)
        yield tab
        tab.close()


class Late:
    """The next answer to what a page asks at an address, held back until it is let go."""

    def __init__(
        self, page: Page, address: str, wanted: Callable[[Request], bool] = lambda request: True
    ) -> None:
        self.page = page
        self.wanted = wanted
        self.held: Route | None = None
        page.route(address, self._hold)

    def _hold(self, route: Route) -> None:
        if self.held or not self.wanted(route.request):
            route.continue_()
        else:
            # The server may just have closed the idle connection that this would use.
            self.answer = route.fetch(max_retries=3)
            self.held = route

    def wait(self) -> None:
        patience = PATIENCE_MS // 20
        while self.held is None:
            assert patience, f"what was to be held back is not there, at {self.page.url}"
            self.page.wait_for_timeout(20)
            patience -= 1

    def let_go(self) -> None:
        """Let the answer come, and the page take it in."""
        self.wait()
        with self.page.expect_event("requestfinished", lambda done: done == self.held.request):
            self.held.fulfill(response=self.answer)
        settle(self.page)


def manifest(folder: Path) -> dict[str, Any]:
    """Return what a study states."""
    return tomllib.loads((folder / "study.toml").read_text())


def corrections(folder: Path) -> list[dict[str, Any]]:
    """Return the corrections of a study, the last one at the end."""
    log = folder / "corrections.jsonl"
    return [json.loads(line) for line in log.read_text().splitlines()] if log.exists() else []


def numbers(page: Page, part: str = "numbers") -> str:
    """The numbers of an inspector once they are those of the newest state."""
    page.wait_for_function(
        "part => document.querySelector(`[data-live=${part}]`)"
        " && !document.querySelector('[aria-busy=true]')",
        arg=part,
    )
    return page.locator(f"[data-live={part}]").inner_text().replace("\N{NO-BREAK SPACE}", " ")


def changed(page: Page, before: str, part: str = "numbers") -> str:
    """The numbers of the newest state, which are others than before."""
    now = numbers(page, part)
    assert now != before
    return now


def moving(page: Page, before: str, part: str = "numbers") -> str:
    """The numbers while a hand holds a handle, once they are others than before."""
    page.wait_for_function(
        "([part, before]) => document.querySelector(`[data-live=${part}]`)"
        ".innerText.replaceAll('\\u00a0', ' ') !== before",
        arg=[part, before],
    )
    return page.locator(f"[data-live={part}]").inner_text().replace("\N{NO-BREAK SPACE}", " ")


def box(place: Locator) -> dict[str, float]:
    """Where something is on the screen, though it may be redrawn meanwhile."""
    patience = PATIENCE_MS // 20
    while (found := place.bounding_box()) is None:
        assert patience, f"{place} is not shown"
        place.page.wait_for_timeout(20)
        patience -= 1
    return found


def middle(place: Locator) -> tuple[float, float]:
    x, y, width, height = box(place).values()
    return x + width / 2, y + height / 2


def stroke(page: Page, start: tuple[float, float], end: tuple[float, float]) -> None:
    """Press the button at one place and let it go at another."""
    page.mouse.move(*start)
    page.mouse.down()
    page.mouse.move(*end, steps=6)
    lift(page)


def lift(page: Page) -> None:
    """Let the button go, and wait until the page has taken in what the hand did: a busy one lags behind."""
    page.mouse.up()
    settle(page)


def settle(page: Page) -> None:
    """Wait until the page has drawn what has come so far."""
    page.evaluate("() => new Promise((seen) => requestAnimationFrame(() => requestAnimationFrame(seen)))")


def drag(page: Page, place: Locator, dx: float, dy: float) -> None:
    x, y = middle(place)
    stroke(page, (x, y), (x + dx, y + dy))


def enter(field: Locator, words: str) -> None:
    """Fill in a field and confirm it."""
    field.fill(words)
    field.press("Enter")


def press(page: Page, key: str) -> None:
    """Press a key of the page, while no field has the focus."""
    page.locator("h1").click()
    page.keyboard.press(key)


def focus(page: Page, name: str, role: str = "button") -> Locator:
    """Put the focus on a mark by its name, as the tabulator would."""
    place = page.get_by_role(role, name=name, exact=True)
    place.focus()
    return place


def unexplained(page: Page) -> list[str]:
    """The symbols in view that have no explanation, and those that a keyboard does not reach."""
    return page.evaluate(
        """() => [...document.querySelectorAll('.symbol')]
          .filter((one) => !one.dataset.term || !(one.tabIndex === 0 || one.closest('button')))
          .map((one) => one.textContent)"""
    )


def require_picture(page: Page) -> None:
    """Wait until the picture of the newest state is there."""
    page.wait_for_function(
        """() => document.querySelector('.stage .picture').naturalWidth
          && !document.querySelector('.stage.waiting')"""
    )
