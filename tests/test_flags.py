"""One registry of flags: all that measurements return, and nothing that none returns."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import fingerpad
from fingerpad.contact.contact import FLAGS as CONTACT_CODES
from fingerpad.flags import FLAGS, flags_in
from fingerpad.study.measuring.contacts import NEVER_POOLED, POOLED_IF_REVIEWED

SRC = Path(fingerpad.__file__).parent
CODE = re.compile(r"[a-z]+(_[a-z]+)*")
# Names that hold flags in code, and where the flags of each kind are set.
NAMES = {"doubts", "flags", "notes", "flag"}
PLACES = {
    "contact": ("image/contact_image",),
    "scale": ("image/coin.py", "image/grid.py"),
    "frame": ("image/sequence/measure.py", "image/sequence/result.py", "study/corrections/apply.py"),
    "photograph": ("image/photograph",),
    "curve": ("loading",),
    "layer": ("contact", "study/results/layer.py"),
    "row": ("study/results/rows.py",),
}


def modules(kind: str) -> Iterator[ast.Module]:
    for place in PLACES[kind]:
        path = SRC / place
        for file in sorted(path.rglob("*.py")) if path.is_dir() else [path]:
            yield ast.parse(file.read_text(encoding="utf-8"))


def codes(node: ast.AST) -> set[str]:
    """Return what looks like a code in an expression: of a dictionary, its keys."""
    if isinstance(node, ast.Dict):
        return set().union(*(codes(key) for key in node.keys if key is not None), set())
    if isinstance(node, ast.Constant):
        return {node.value} if isinstance(node.value, str) and CODE.fullmatch(node.value) else set()
    if isinstance(node, ast.Call | ast.Compare | ast.Subscript):  # what decides is no flag
        return set()
    return set().union(*(codes(part) for part in ast.iter_child_nodes(node)), set())


def set_in(tree: ast.Module) -> set[str]:
    """Return the flags that a module sets."""
    found: set[str] = set()
    for node in ast.walk(tree):
        match node:
            case ast.FunctionDef(name="flags" | "doubts" | "size_flags" | "_flags"):
                found |= set().union(
                    *(codes(part) for part in ast.walk(node) if isinstance(part, ast.Dict | ast.Set))
                )
            case ast.Assign(targets=[ast.Name(id=name)]) | ast.AnnAssign(target=ast.Name(id=name)) if (
                name in NAMES
            ):
                found |= codes(node.value) if node.value else set()
            case ast.Assign(targets=[ast.Subscript(value=ast.Name(id=name), slice=key)]) if name in NAMES:
                found |= codes(key)
            case ast.keyword(arg="flags"):
                found |= codes(node.value)
            case ast.Call(
                func=ast.Attribute(value=ast.Name(id=name), attr="append" | "add"), args=[only]
            ) if name in NAMES:
                found |= codes(only)
    return found


@pytest.mark.parametrize("kind", PLACES)
def test_flags_that_are_set_and_flags_that_are_registered_are_the_same(kind):
    trees = list(modules(kind))
    assert set().union(*map(set_in, trees)) <= set(FLAGS[kind])
    said = {part.value for tree in trees for part in ast.walk(tree) if isinstance(part, ast.Constant)}
    assert set(FLAGS[kind]) <= said


def test_codes_of_contacts():
    assert set(FLAGS["layer"]) == {*CONTACT_CODES, "uncertainty_out_of_range"} - {""}


def test_what_is_kept_out_of_pooled_results():
    flags = [*FLAGS["contact"].values(), *FLAGS["frame"].values()]
    kept_out = {flag.code for flag in flags if flag.excludes.startswith("pooling")}
    assert kept_out == NEVER_POOLED | POOLED_IF_REVIEWED
    assert FLAGS["row"]["implausible_size"].excludes == "pooling"


def test_each_says_what_it_means_and_what_to_do():
    for flag in (flag for flags in FLAGS.values() for flag in flags.values()):
        for text in (flag.words, flag.to_do):
            assert len(text) > 8
            assert not text.endswith(".")
            assert text[0].islower() or text.startswith(("Young", "Hertz", "Poisson"))


def test_the_first_kind_says_what_a_code_means():
    (of_contact,) = flags_in("low_contrast", "contact", "photograph")
    (of_photograph,) = flags_in(["low_contrast"], "photograph", "contact")
    assert of_contact.words != of_photograph.words
