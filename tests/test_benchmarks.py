"""What the documentation states can be made again: modules, their entry, and the names that texts use."""

import importlib
import inspect
import re
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


def test_help_names_the_keys_with_their_defaults(capsys):
    command.explain("photographs")
    shown = capsys.readouterr().out
    assert shown.startswith("usage: python -m benchmarks photographs [count=96] [first=75000] [--store]")
    assert "rendered fingers" in shown


def test_a_table_is_printed_and_stored_only_when_asked(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(command, "RESULTS", tmp_path)
    command.measure("area_exponents", {"repeats": 2})
    assert "| of each frame |" in capsys.readouterr().out
    assert not list(tmp_path.iterdir())
    command.measure("area_exponents", {"repeats": 2}, store=True)
    table, foot = (tmp_path / "area_exponents.md").read_text(encoding="utf-8").rsplit("\n\n", 1)
    assert "| of each frame |" in table
    assert foot.startswith("*`python -m benchmarks area_exponents repeats=2`, 20")
    assert foot.endswith("; repeats 2.*\n")


def test_a_key_that_is_not_there_leads_to_help():
    with pytest.raises(SystemExit, match=r"'seeds'; `python -m benchmarks coins --help` lists its keys"):
        command.measure("coins", {"seeds": 3})


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
    """Without keys its command draws the sample that it states."""
    *_, last = (RESULTS / f"{name}.md").read_text(encoding="utf-8").splitlines()
    assert re.match(rf"\*`python -m benchmarks {name}`, 20\d\d-\d\d-\d\d, commit [0-9a-f]{{8}}", last)
    sample = command.drawn(name, importlib.import_module(modules()[name]), {})
    assert command.sample_words(sample) in last or "; copied from the documentation" in last


# What README, paper and the page on accuracy state, and the cells of stored results that say so.
CLAIMS = {
    "README.md": {
        "1.0 to 2.3 % (rms)": ("contact_areas", ["+0.28 %, 2.3 %", "+0.58 %, 1.0 %"]),
        "in 94 to 100 %": ("contact_areas", ["2.3 % | 1.8 %, 94 %", "1.4 % | 2.1 %, 100 %"]),
        "ridge areas are 6 to 13 % too large": ("contact_areas", ["+6.5 %, 7.7 %", "+13 %, 14 %"]),
        "median error of 0.23 %": ("photographs", ["| 96 | 0.23 % |"]),
        "4 to 13 % rms on other shapes": ("anatomic_fingers", ["| all | 192 | -2.3 %, 13 % |"]),
    },
    "paper/paper.md": {
        "with an rms error of 17 %": ("peers", ["largest region | -2.7 %, 17 %"]),
        "Otsu's threshold with 10 %": ("peers", ["as MATLAB scripts do | -8.7 %, 10 %"]),
        "an ImageJ macro with 8 %, `fingerpad` with 2 %": ("peers", ["-7.4 %, 8.3 %", "-0.19 %, 2.1 %"]),
        "where ink spreads (50 %)": ("contact_areas", ["+13 %, 14 % | 4.2 %, 50 %"]),
        "sensor warms up (75 %)": (
            "loading_truth",
            ["force warms up by 40 mN | 0 % | 0 | -1.7 %; 75 % (75 %)"],
        ),
        "94 to 100 % where the theory does": (
            "validity",
            [
                "| Hertz theory | 200 | 94 %",
                "with curve | 30 | 100 %",
                "| 4 mm of tissue over bone | 200 | 0 % | 0 % | 100 %",
            ],
        ),
    },
    "docs/reference/accuracy.md": {
        "| rms 0.50 % without a flag | 93 % | a fifth": (
            "coins",
            ["| all with a coin | 242 | 48 | 56 | 1.4 % | 93 % | 0.50 % |"],
        ),
        "| rms 2.9–7.0 % | 94–99 % |": ("contact_areas", ["2.9 % | 5.3 %, 99 %", "7.0 % | 5.3 %, 94 %"]),
        "| bias below 0.1 of its uncertainty | 94 % |": ("studies", ["| 94.2 % | -0.04 |"]),
    },
}


@pytest.mark.parametrize(
    ("page", "claim"), [(page, claim) for page, some in CLAIMS.items() for claim in some]
)
def test_a_claim_stands_in_a_stored_result(page, claim):
    assert claim in " ".join((ROOT / page).read_text(encoding="utf-8").split())
    name, cells = CLAIMS[page][claim]
    result = (RESULTS / f"{name}.md").read_text(encoding="utf-8")
    assert [cell for cell in cells if cell not in result] == []
