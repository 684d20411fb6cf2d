"""A browser, a study that has been run, and tabs on it."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, sync_playwright
from tests.end_to_end.page.browser import Tab, served


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    chromium = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if chromium is None:
        pytest.skip("no Chromium on this machine: sudo apt install chromium")
    options = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=chromium, args=options)
        yield browser
        browser.close()


@pytest.fixture
def demo(run_demo, tmp_path) -> Path:
    """A copy of the run study that a test may change."""
    shutil.copytree(run_demo, tmp_path / "demo")
    return tmp_path / "demo"


@pytest.fixture
def tab(browser, demo) -> Iterator[Tab]:
    with served(demo.parent, demo) as server:
        tab = Tab(browser, server)
        yield tab
        tab.close()


@pytest.fixture
def empty_tab(browser, tmp_path) -> Iterator[Tab]:
    """A bench without a study."""
    folder = tmp_path / "workspace"
    folder.mkdir()
    with served(folder) as server:
        tab = Tab(browser, server)
        tab.folder = folder
        yield tab
        tab.close()
