"""What the documentation states can be made again: modules, their entry, and the names that texts use."""

import importlib
import inspect
import re
from pathlib import Path

import pytest
from benchmarks import RESULTS, modules

ROOT = Path(__file__).parents[1]
TEXTS = [ROOT / "README.md", ROOT / "paper" / "paper.md", *sorted((ROOT / "docs").rglob("*.md"))]


@pytest.mark.parametrize("name", modules())
def test_every_benchmark_says_what_it_measures_and_needs_no_argument(name):
    try:
        module = importlib.import_module(modules()[name])
    except ImportError as error:  # its peers are no dependencies
        pytest.skip(str(error))
    assert module.__doc__
    inspect.signature(module.report).bind()


def test_texts_name_benchmarks_that_are_there():
    named = {
        found
        for text in TEXTS
        for found in re.findall(r"python -m benchmarks ([a-z]\w*)", text.read_text(encoding="utf-8"))
    }
    assert named, "no text names a benchmark"
    assert named <= modules().keys() | {"all"}


def test_stored_results_have_their_module():
    assert {path.stem for path in RESULTS.glob("*.md")} <= modules().keys()
