"""What the documentation states can be made again: modules, their entry, and the names that texts use."""

import importlib
import inspect
import re
import tomllib
from pathlib import Path

import benchmarks.__main__ as command
import pytest
from benchmarks import RESULTS, modules

ROOT = Path(__file__).parents[1]
TEXTS = [ROOT / "README.md", ROOT / "paper" / "paper.md", *sorted((ROOT / "docs").rglob("*.md"))]


@pytest.mark.parametrize("name", modules())
def test_every_benchmark_says_what_it_measures_and_needs_no_argument(name):
    module = importlib.import_module(modules()[name])
    assert module.__doc__
    assert module.report.__doc__
    inspect.signature(module.report).bind()


def test_a_table_is_printed_and_stored_only_when_asked(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(command, "RESULTS", tmp_path)
    command.measure("area_exponents", ["--repeats", "2"])
    assert "| of each frame |" in capsys.readouterr().out
    assert not list(tmp_path.iterdir())
    command.measure("area_exponents", ["--repeats", "2", "--store"])
    table, foot = (tmp_path / "area_exponents.md").read_text(encoding="utf-8").rsplit("\n\n", 1)
    assert "| of each frame |" in table
    assert foot.startswith("*`python -m benchmarks area_exponents --repeats 2`, 20")
    assert foot.endswith("; repeats 2.*\n")


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
    """Without options its command draws the sample that it states."""
    *_, last = (RESULTS / f"{name}.md").read_text(encoding="utf-8").splitlines()
    assert re.match(rf"\*`python -m benchmarks {name}`, 20\d\d-\d\d-\d\d, commit [0-9a-f]{{8}}", last)
    sample = vars(command.options_of(name, importlib.import_module(modules()[name])).parse_args([]))
    assert command.sample_words(sample) in last or "; copied from the documentation" in last


STATED = tomllib.loads((RESULTS.parent / "stated.toml").read_text(encoding="utf-8"))
NO_CLAIMS = STATED.pop("no_claims")


def words(page):
    """Return the text of a page on one line, without what it includes."""
    text = re.sub(r"```{include}.*?```", "", (ROOT / page).read_text(encoding="utf-8"), flags=re.DOTALL)
    return " ".join(text.split())


@pytest.mark.parametrize(
    ("page", "claim"), [(page, claim) for page, claims in STATED.items() for claim in claims]
)
def test_a_claim_stands_in_a_stored_result(page, claim):
    assert claim in words(page)
    for name, cells in STATED[page][claim].items():
        result = (RESULTS / f"{name}.md").read_text(encoding="utf-8")
        assert [cell for cell in cells if cell not in result] == []


@pytest.mark.parametrize("page", NO_CLAIMS)
def test_each_percentage_stands_in_a_stored_result(page):
    text = words(page)
    spans = [
        found.span()
        for known in (*STATED[page], *NO_CLAIMS[page])
        for found in re.finditer(re.escape(known), text)
    ]
    unknown = [
        text[max(0, found.start() - 60) : found.end()]
        for found in re.finditer(r"[\d.]+ ?%", text)
        if not any(start <= found.start() and found.end() <= end for start, end in spans)
    ]
    assert unknown == []
