"""Settings of all tests, and what many of them read: made once for all processes that test."""

import os
import shutil
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
import typer.testing
from filelock import FileLock
from hypothesis import settings

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
    # The process that only distributes the tests need not import them.
    from fingerpad.report import write_report  # noqa: PLC0415
    from fingerpad.study.pipeline import run_study  # noqa: PLC0415

    folder = session_folder / "run-demo"
    with FileLock(f"{folder}.lock"):
        if not (folder / "results" / "report.html").exists():
            shutil.rmtree(folder, ignore_errors=True)
            shutil.copytree(DEMO, folder)
            run_study(folder / "study.toml", folder / "results", write_report=write_report)
    return folder


@pytest.fixture(scope="session")
def run_example(session_folder: Path) -> Path:
    """Return the example of `fingerpad init` with the results of a run, which no test may change."""
    from fingerpad.report import write_report  # noqa: PLC0415
    from fingerpad.study.editing.template import write_example  # noqa: PLC0415
    from fingerpad.study.pipeline import run_study  # noqa: PLC0415

    folder = session_folder / "run-example"
    with FileLock(f"{folder}.lock"):
        if not (folder / "results" / "report.html").exists():
            shutil.rmtree(folder, ignore_errors=True)
            run_study(write_example(folder), folder / "results", write_report=write_report)
    return folder


@pytest.fixture
def own_laws() -> Iterator[None]:
    """Forget the contact laws that a test registers."""
    from fingerpad.loading.laws import LAWS  # noqa: PLC0415 (few tests need it)

    known = dict(LAWS)
    yield
    LAWS.clear()
    LAWS.update(known)
