"""A browser, a study that has been run, and tabs on it."""

import shutil
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from pathlib import Path

import pytest
from playwright.sync_api import Browser, sync_playwright
from tests.end_to_end.page.browser import Tab, tab_on

from fingerpad.study.editing.template import write_example


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    here = str(Path(__file__).parent)
    for item in items:
        if str(item.path).startswith(here):
            item.add_marker(pytest.mark.slow)


@pytest.fixture(scope="session")
def chromium() -> Iterator[Callable[..., AbstractContextManager[Browser]]]:
    """Starts a browser with some options."""
    # The one without windows is the fastest.
    names = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
    program = next(filter(None, map(shutil.which, names)), None)
    if program is None:
        pytest.skip("no Chromium on this machine: sudo apt install chromium-headless-shell")
    with sync_playwright() as play:
        yield lambda *options: play.chromium.launch(executable_path=program, args=["--no-sandbox", *options])


@pytest.fixture(scope="session")
def browser(chromium) -> Iterator[Browser]:
    """A browser; one process keeps what was compiled, and without a GPU nothing emulates one."""
    with chromium("--disable-gpu", "--disable-software-rasterizer", "--process-per-site") as browser:
        yield browser


@pytest.fixture
def demo(run_demo, tmp_path) -> Path:
    """A copy of the run study that a test may change."""
    shutil.copytree(run_demo, tmp_path / "demo")
    return tmp_path / "demo"


@pytest.fixture
def tab(browser, demo) -> Iterator[Tab]:
    with tab_on(browser, demo.parent, demo) as tab:
        yield tab


@pytest.fixture
def empty_tab(browser, tmp_path) -> Iterator[Tab]:
    """A bench without a study."""
    folder = tmp_path / "workspace"
    folder.mkdir()
    with tab_on(browser, folder) as tab:
        tab.folder = folder
        yield tab


@pytest.fixture(scope="session")
def written_example(tmp_path_factory) -> Path:
    """The example study, before a run."""
    return write_example(tmp_path_factory.mktemp("example") / "example").parent


@pytest.fixture
def example(written_example, tmp_path) -> Path:
    """A copy of the example study that a test may change; it was never run."""
    return Path(shutil.copytree(written_example, tmp_path / "studies" / "example"))


@pytest.fixture
def results(run_example, example) -> Path:
    """The results of a run of the example, in its folder: a run measures only what a test changes."""
    return Path(shutil.copytree(run_example / "results", example / "results"))


@pytest.fixture
def example_tab(browser, example) -> Iterator[Tab]:
    with tab_on(browser, example.parent, example) as tab:
        yield tab
