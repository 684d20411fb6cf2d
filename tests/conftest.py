"""Settings of all tests, and what many of them read: made once for all processes that test."""

import os
import shutil
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
import typer.testing
from hypothesis import settings
from tests.once import made_once

DEMO = Path(__file__).parents[1] / "examples" / "dzidek2017"

# The same examples in every run, and no deadline, since a busy machine is no fault.
# HYPOTHESIS_PROFILE=nightly draws new examples each time, and more of them.
settings.register_profile("default", derandomize=True, deadline=None)
settings.register_profile("nightly", derandomize=False, deadline=None, max_examples=1000)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "default"))

# To build the commands takes five times as long as most of them: once for all that run in this process.
typer.testing._get_command = cache(typer.main.get_command)


def pytest_xdist_auto_num_workers(config: pytest.Config) -> int:
    """Return one process more than there are cores, since many tests wait for others."""
    return (os.cpu_count() or 1) + 1


@pytest.fixture(scope="session")
def session_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder that all processes of these tests share, and no others."""
    folder = tmp_path_factory.getbasetemp()
    return folder.parent if "PYTEST_XDIST_WORKER" in os.environ else folder


@pytest.fixture(scope="session")
def run_demo(session_folder: Path) -> Path:
    """Return the demo study with the results of a run, which no test may change."""
    return made_once(session_folder / "run-demo", lambda folder: run_of(shutil.copytree(DEMO, folder)))


@pytest.fixture(scope="session")
def run_example(session_folder: Path) -> Path:
    """Return the example of `fingerpad init` with the results of a run, which no test may change."""
    from fingerpad.study.editing.template import write_example  # noqa: PLC0415

    return made_once(session_folder / "run-example", lambda folder: run_of(write_example(folder).parent))


def run_of(folder: Path) -> None:
    """Run a study into its folder ``results``."""
    # The process that only distributes the tests need not import them.
    from fingerpad.report import write_report  # noqa: PLC0415
    from fingerpad.study.pipeline import run_study  # noqa: PLC0415

    run_study(folder / "study.toml", folder / "results", write_report=write_report)


@pytest.fixture
def coarse_elements(monkeypatch: pytest.MonkeyPatch) -> None:
    """Press finite elements of a coarser mesh, which takes a tenth of the time."""
    for name, number in (("_RINGS", 3), ("_LAYERS", 2)):
        monkeypatch.setattr(f"fingerpad.simulator.law.{name}", number)


@pytest.fixture
def own_laws() -> Iterator[None]:
    """Forget the contact laws that a test registers."""
    from fingerpad.loading.laws import LAWS  # noqa: PLC0415 (few tests need it)

    known = dict(LAWS)
    yield
    LAWS.clear()
    LAWS.update(known)
