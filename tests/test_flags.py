"""One registry of flags: all that measurements return, and nothing that none returns."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

import fingerpad
from fingerpad.contact.contact import FLAGS as CONTACT_CODES
from fingerpad.flags import FLAGS, flags_in
from fingerpad.study.measuring.contacts import NEVER_POOLED, POOLED_IF_REVIEWED

SRC = Path(fingerpad.__file__).parent
# Where the flags of each kind are set.
PLACES = {
    "contact": ("image/contact_image",),
    "scale": ("image/coin.py", "image/grid.py"),
    "frame": (
        *("image/sequence/measure.py", "image/sequence/result.py"),
        *("study/corrections/apply.py", "study/measuring/contacts.py"),
    ),
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


@pytest.mark.parametrize("kind", PLACES)
def test_every_flag_is_one_that_a_measurement_sets(kind):
    said = {part.value for tree in modules(kind) for part in ast.walk(tree) if isinstance(part, ast.Constant)}
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
