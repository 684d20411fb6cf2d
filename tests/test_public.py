"""The names at the top of the package, and the lines of the README."""

import contextlib
import io
import re
import subprocess
import sys
from pathlib import Path

import pytest

import fingerpad as fp

ROOT = Path(__file__).parents[1]
PARTS = "how-to", "explanation", "tutorial"


def test_public_names_documented() -> None:
    assert dir(fp) == sorted(fp.__all__)
    for name in fp.__all__:
        assert getattr(fp, name).__doc__, name
        assert getattr(fp, name).__name__ == name


def test_every_name_of_the_reference_stands_on_a_page_for_a_task() -> None:
    names = re.findall(
        r"^   ([\w.]+)$", (ROOT / "docs/reference/api.md").read_text(encoding="utf-8"), re.MULTILINE
    )
    pages = [ROOT / "README.md", *(page for part in PARTS for page in (ROOT / "docs" / part).glob("*.md"))]
    texts = "\n".join(page.read_text(encoding="utf-8") for page in pages)
    assert len(names) <= 150
    assert [name for name in names if not re.search(rf"\b{name.split('.')[-1]}\b", texts)] == []


def test_names_are_in_the_files_that_the_page_for_contributors_says() -> None:
    page = (ROOT / "docs/contributing.md").read_text(encoding="utf-8")
    in_paths = re.findall(r"^ {4}.*?([\w.]+) +([\w/]+\.py) {2,}", page, re.MULTILINE)
    named = [*in_paths, *re.findall(r"`(\w+)`\*{0,2} \(`([\w/]+\.py)`", page)]
    assert len(named) > 20
    for name, file in named:
        paths = [ROOT / "src/fingerpad" / part / file for part in ("", "study", "contact")]
        text = "".join(path.read_text(encoding="utf-8") for path in paths if path.is_file())
        assert re.search(rf"(def|class) {name.split('.')[-1]}\b", text), f"{name} is not in {file}"


def test_unknown_name() -> None:
    with pytest.raises(AttributeError, match="No fingerpad attribute elipsoid"):
        fp.elipsoid  # noqa: B018


def test_the_package_and_its_geometry_need_none_of_the_heavy_packages() -> None:
    script = (
        "import sys, fingerpad as fp\n"
        "assert not [name for name in sys.modules if name.startswith(('fingerpad.', 'numpy', 'scipy'))]\n"
        "for name in ('cv2', 'PIL', 'matplotlib', 'pydantic', 'pandas', 'typer'): sys.modules[name] = None\n"
        "contact = fp.hertz_contact(fp.Paraboloid(12, 14), fp.Tissue(0.1), load=2)\n"
        "print(contact._repr_html_())\n"
        "del sys.modules['typer']\n"
        "import fingerpad.cli\n"
        "assert 'rich' not in sys.modules\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert (done.returncode, "semi_major" in done.stdout, "<img" in done.stdout) == (0, True, False), (
        done.stderr
    )


def run_page(page: str) -> tuple[list[str], list[str]]:
    """Run the Python code of a page; return what it prints, and what the page says that it prints."""
    code = "".join(re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(encoding="utf-8"), re.DOTALL))
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        exec(code, {})
    return printed.getvalue().splitlines(), re.findall(r"^print\(.*\)  # (.*)$", code, re.MULTILINE)


def test_readme_example(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)
    printed, said = run_page("README.md")
    assert len(said) == 3
    assert printed == said
    assert Path("overlay.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(("page", "lines"), [("how-to/simulators", 3), ("explanation/pad-to-contact", 6)])
def test_pages_say_what_their_code_prints(page: str, lines: int) -> None:
    printed, said = run_page(f"docs/{page}.md")
    assert len(said) == lines
    assert printed == said
