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


def included() -> dict[str, Path]:
    """Return the stored results that the documentation includes, each with its page."""
    return {
        name: page
        for page in TEXTS
        for name in re.findall(r"{include} \S*benchmarks/results/(\w+)\.md", page.read_text(encoding="utf-8"))
    }


def test_every_stored_result_has_its_module_and_a_page():
    stored = {path.stem for path in RESULTS.glob("*.md")}
    assert stored <= modules().keys()
    assert stored == included().keys()


@pytest.mark.parametrize("name", included())
def test_a_stored_result_says_when_of_what_and_how_it_was_made(name):
    *_, last = (RESULTS / f"{name}.md").read_text(encoding="utf-8").splitlines()
    assert re.match(rf"\*`python -m benchmarks {name}[^`]*`, 20\d\d-\d\d-\d\d, commit [0-9a-f]{{8}}", last)


# What the first pages state of accuracy, and the cells of stored results that say so.
CLAIMS = {
    "1.1 to 2.3 % (rms)": ("contact_areas", ["+0.6, 2.3, 1.8", "+0.3, 1.1, 1.3"]),
    "in 92 to 100 %": ("contact_areas", ["−0.9, 1.7, 1.5 | 92 |", "−0.5, 1.7, 2.2 | 100 |"]),
    "ridge areas are 9 to 13 % too large": ("contact_areas", ["+9.5, 13.4", "+12.5, 13.5"]),
    "median error of 0.24 %": ("photographs", ["| 96 | 0.24 % |"]),
    "5 to 13 % rms on other shapes": ("anatomic_fingers", ["| all | 13 % |"]),
}


@pytest.mark.parametrize("claim", CLAIMS)
def test_a_claim_of_the_readme_stands_in_a_stored_result(claim):
    readme = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
    assert claim in readme
    name, cells = CLAIMS[claim]
    result = (RESULTS / f"{name}.md").read_text(encoding="utf-8")
    assert [cell for cell in cells if cell not in result] == []
