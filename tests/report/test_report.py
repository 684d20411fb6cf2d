"""The report: one file that needs nothing else, and says what it must; and its remarks in words."""

import html
import math
import re
import shutil
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from tests.studies import Table, contact, curve, finger, page_of, rows_by, run

from fingerpad._rounding import two_digits, value_with_uncertainty
from fingerpad.figures import plot_load_indentation
from fingerpad.figures.publish import plain_text
from fingerpad.image import FaceSemiAxes, combine_faces
from fingerpad.loading import fit_loading_curve
from fingerpad.report import loading, write_report
from fingerpad.report.layer import comparisons
from fingerpad.report.repeatability import borrowed
from fingerpad.report.templates import signed_with_uncertainty, typeset
from fingerpad.report.text import (
    face_differences,
    interval_difference,
    moduli_apart,
    p_words,
    pooling_words,
    probability,
    remedies,
    to_measure_better,
)
from fingerpad.simulate import simulate_loading_curve
from fingerpad.study.pipeline import run_study
from fingerpad.study.results.output import answers_of
from fingerpad.study.results.study_result import StudyResult
from fingerpad.study.results.table import records
from fingerpad.uncertainty.repeats import ContactRepeatability

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "dzidek2017"
VOID = {"meta", "img", "br", "link"}


class Page(HTMLParser):
    """Collects what the page refers to and checks that its elements nest."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.open: list[str] = []
        self.links: list[str] = []
        self.ids: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        if tag not in VOID:
            self.open.append(tag)
        for name, value in attrs:
            if name in {"src", "href", "xlink:href"} and value is not None:
                self.links.append(value)
            if name == "id" and value is not None:
                self.ids.append(value)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


@pytest.fixture(scope="module")
def demo(run_demo, tmp_path_factory) -> tuple[StudyResult, str, Path]:
    out = run_demo / "results"
    stored = shutil.copytree(out, tmp_path_factory.mktemp("report") / "results")
    result = run_study(EXAMPLE / "study.toml", stored)
    return result, (out / "report.html").read_text(encoding="utf-8"), out


def test_self_contained(demo):
    _, text, _ = demo
    page = Page(text)
    assert page.open == []
    assert "script" not in page.tags
    assert all(link.startswith(("data:image/", "#")) for link in page.links)
    assert len(page.ids) == len(set(page.ids))
    assert "default-src 'none'" in text
    assert not re.search(r"url\((?!#)", text)


def test_all_observations_and_overlays_shown(demo):
    result, text, out = demo
    for row in records(result.rows):
        assert (row["observation"] in text) == (row["frame"] is None)
    photographs = sum(len(finger.photographs) for finger in result.fingers.values())
    overlays = sum(row["overlay"] is not None for row in records(result.rows))
    assert text.count("data:image/jpeg;base64,") == overlays + photographs + 3 == 9 + 3 + 3
    assert all(f"synthetic_press_30deg, {role}" in text for role in ("first contact", "largest load"))
    figures = {path.name for path in (out / "figures").iterdir()}
    drawings = {path.removesuffix(".svg") for path in figures if path.endswith(".svg")}
    assert drawings == {path.removesuffix(".json") for path in figures if path.endswith(".json")}
    assert text.count("<figcaption>") == len(figures) // 2 + text.count("data:image/jpeg")


def test_synthetic_is_labelled(demo):
    result, text, _ = demo
    tag = '<span class="synthetic">synthetic</span>'
    assert re.search(rf"<h3>synthetic_press_30deg{tag}</h3>", text)
    for row in (row for row in records(result.rows) if row["frame"] is None):
        cell = re.search(rf"<tr><td>{row['observation']}(<span[^>]*>synthetic</span>)?</td>", text)
        assert cell is not None
        assert bool(cell.group(1)) == row["synthetic"]
    for heading in re.findall(r"<h2[^>]*>(.*?)</h2>", text):
        assert (tag in heading) == heading.startswith("synthetic_pad")


def unfolded(text: str) -> str:
    """Return a page's words as it opens, with a figure as FIGURE."""
    body = re.sub("<svg.*?</svg>", " FIGURE ", text[text.index("<body>") :], flags=re.DOTALL)
    folded = re.sub(r"<details[^>]*>(<summary>.*?</summary>).*?</details>", r"\1", body, flags=re.DOTALL)
    return html.unescape(re.sub("<[^>]*>", " ", folded))


def words(text: str) -> int:
    return sum(bool(re.search(r"\w", word)) for word in text.split())


def test_the_answers_come_first_and_in_few_words(demo):
    result, text, _ = demo
    assert "<details>" not in text[: text.index('<details class="fold">')]
    page = unfolded(text)
    before, *_ = page.split("FIGURE")
    assert page.count("FIGURE") == 3
    assert words(before) <= 150
    assert words(page) <= 1200
    flat = re.sub(r"\s+", " ", before).replace(" synthetic :", " (synthetic):").replace(" :", ":")
    for one in answers_of(result):
        assert one.sentence in flat
    table = text[text.index('<table class="results">') : text.index('<details class="fold">')]
    assert table.count("<th") - table.count("<thead") == 8
    for row, placed in zip(table.split("<tr>")[2:], result.placements, strict=True):
        verdict = placed.validity.verdict
        assert f"</span> {verdict}" in row or f" {verdict}</span></a>" in row
    assert "13.8 ± 4.6</td>" in table
    assert "49.2 ± 5.0<br><small>on bone, layer fails</small>" in table
    checks = [one.uncertainty_check for one in result.placements]
    invalid = [check for check in checks if check and not check.valid]
    assert text.count('<code>method = "monte_carlo"</code>') == len(invalid) > 0
    for check in invalid:
        assert f"{two_digits(interval_difference(check))} mm</span>" in text


def test_what_to_measure_better_stands_on_the_first_page(demo, tmp_path):
    page = re.sub(r"\s+", " ", unfolded(demo[1]))
    assert "To measure better State the thickness of the tissue over bone of left_index_direct" in page
    assert "Measure the wedge angle better: 97 % of the variance of the corrected radius" in page

    def said(folder: str, wedge_std: float, ellipse_std: float, *tables: Table, repeats: int = 1) -> str:
        noise = np.random.default_rng(2).normal(0, ellipse_std, repeats)
        presses = [contact(f"c{k}", 2, (8 + off, 4.5), std=ellipse_std) for k, off in enumerate(noise)]
        stated = {"wedge_angle_deg_std": wedge_std, "roll_angle_deg_std": 0}
        result = run(tmp_path / folder, finger(std=0.01), *presses, *tables, uncertainty=stated)
        return "; ".join(to_measure_better(result))

    loading = curve(loading_radius_mm=14, loading_radius_mm_std=0.2)
    angle = said("angle", 3, 0.01)
    assert "measure the wedge angle better" in angle
    assert "record a loading curve of f" in angle
    assert "press again under one load" in angle
    ellipse = said("ellipse", 0, 0.3, loading, repeats=6)
    assert "take more contacts" in ellipse
    assert "loading curve" not in ellipse
    assert "press again" not in ellipse
    assert "the repeats are too few to tell" in said("few", 0, 0.3, loading, repeats=2)
    (tmp_path / "failed").mkdir()
    (tmp_path / "failed" / "short.csv").write_text("force_N,displacement_mm\n0,0\n1,1\n")
    failed = said("failed", 0, 0.01, curve(file="short.csv"))
    assert "record the loading curve of f at 30° again: it could not be fitted" in failed
    assert "record a loading curve" not in failed


def test_doubtful_input_stands_above_the_figures(demo, tmp_path):
    notes = tuple(f"finger_{k}: are these full widths?" for k in range(5))
    out = shutil.copytree(demo[2], tmp_path / "results")
    doubtful = replace(demo[0].of_finger("left_index_ellipse"), notes=notes)  # quick to draw
    text = write_report(doubtful, out).read_text(encoding="utf-8")
    before = text[: text.index("<figure")]
    assert [note in before for note in notes] == 5 * [True]
    assert "<summary>2 more</summary>" in before
    assert "Check the input" not in demo[1][: demo[1].index("<figure")]


def test_each_link_leads_into_a_fold_not_to_its_lid(demo):
    _, text, _ = demo
    # A browser opens the fold that an element lies in, not one that has the name itself.
    links = set(re.findall(r'href="#([^"]+)"', re.sub("<svg.*?</svg>", "", text, flags=re.DOTALL)))
    assert {"finger1", "missing"} <= links
    assert all(f'</summary><div id="{link}">' in text for link in links)


def test_what_is_missing_or_exact_stands_in_its_fold(demo):
    result, text, _ = demo
    fold = html.unescape(re.search(r'<div id="missing">(.*?)</div>', text, re.DOTALL)[1])  # type: ignore[index]
    assert len(list(result.study.taken_as_exact())) == fold.count("Taken as exact") > 0
    assert "so that the modulus is that of Hertz theory: left_index_direct, 30°" in fold
    assert "no loading radius R<sub>g</sub> to compare with: synthetic_pad, 45°" in fold
    assert fold.count("Missing: repeatability") == 2
    assert f'<a href="#missing">{fold.count("<li>")} inputs are missing' in text


def test_verdicts_stand_beside_the_results_and_say_what_to_do(demo):
    result, text, _ = demo
    headings = re.findall(r'<h3>Does the model hold\? <span class="verdict (\w+)">', text)
    assert headings == [one.validity.verdict for one in result.placements]
    assert {"strained", "fails"} == set(headings)
    for number, validity in enumerate((one.validity for one in result.placements), start=1):
        part = text[text.index(f'<div id="finger{number}">') :]
        table = part[part.index('<table class="checks">') :]
        table = table[: table.index("</table>")]
        off = [one for one in validity.checks if one.verdict in {"strained", "fails"}]
        advice = remedies(off)
        assert off
        assert advice
        for words in advice.values():
            assert html.unescape(re.sub("<[^>]*>", "", table)).count(f"{words[0].upper()}{words[1:]}.") == 1
    assert "does not print folded parts" in text


def test_moduli_of_one_finger_that_differ_between_angles_are_noted(demo):
    result, page, _ = demo
    # Those by Hertz theory differ by 50 % too, but their uncertainty holds the model's discrepancy.
    (words,) = moduli_apart(answers_of(result))
    assert re.match(r"left_index_ellipse: the moduli .* at 30° and .* at 45° are 4\.\d standard", words)
    assert words.partition(" ± ")[0] in page


def test_there_is_one_note_of_moduli_however_many_angles_and_fingers_they_are_of(tmp_path):
    sizes = {20: (4, 3.5), 30: (4.05, 3.55), 40: (3, 2.6), 50: (2.5, 2.2)}
    given = [
        contact(f"{name}{deg}", 1, axes, std=std, wedge=deg, finger=name)
        for name, std in (("a", 0.05), ("b", 0.02))
        for deg, axes in sizes.items()
    ]
    (words,) = moduli_apart(answers_of(run(tmp_path, finger("a"), finger("b"), *given)))
    assert re.search(
        r"^b: .* at 30° and .* at 50° are .* the furthest of 5 pairs, as moduli of a are too;", words
    )


def test_manifest_text_escaped(tmp_path):
    result = run(tmp_path, finger(), title="<script>alert(1)</script> & sons")
    text = write_report(result, tmp_path / "out").read_text(encoding="utf-8")
    assert "<script>" not in text
    assert "&lt;script&gt;alert(1)&lt;/script&gt; &amp; sons" in text
    assert "No contact is given" in text


def test_formulas_and_minus_signs_are_set_as_such(demo):
    _, text, _ = demo
    words = re.sub(r"<[^>]*>", " ", re.sub("<(svg|style).*?</\\1>", "", text, flags=re.DOTALL))
    assert not re.findall(r"R_\w+|R₀g|\^\(", words)
    assert not re.findall(r"[ (]-\d", words)
    assert "(ℓ<sub>d</sub> ℓ<sub>e</sub>)<sup>3/2</sup>" in text


# Remarks of the report in words


def test_pooling_says_who_decided_and_what_speaks_against_it():
    row = {"excluding_flags": "low_contrast", "pooling_corrected_by": None, "pooled": False}
    flag = "the contact has little contrast with the background"
    assert pooling_words(row) == flag
    row |= {"pooled": True, "pooling_corrected_by": "Ada", "pooling_reason": "whole print"}
    assert pooling_words(row) == f"included by Ada: whole print ({flag})"


@pytest.mark.parametrize(
    ("p_value", "words", "with_letter"),
    [(0.04321, "0.043", "p = 0.043"), (1e-9, "< 0.001", "p < 0.001"), (math.nan, "–", "p = –")],
)
def test_probabilities(p_value, words, with_letter):
    assert (probability(p_value), p_words(p_value)) == (words, with_letter)


def test_differences_between_faces_in_percent():
    seen = {"palmar": (11.8, 13.8), "radial": (7.9, 14.0)}
    faces = [FaceSemiAxes(face=f, semi_axes=np.array(s), covariance=np.eye(2)) for f, s in seen.items()]
    assert face_differences(combine_faces(faces)) == (
        "palmar face: radial–ulnar +0.0 %, distal −0.7 %; radial face: palmar +0.0 %, distal +0.7 %"
    )


def test_what_repeats_tell_of_one_impression():
    found = ContactRepeatability(covariance=np.diag([0.01**2, 0.03**2]), freedom=8, groups=4, count=12)
    assert borrowed(found) == (
        "2.0 % in area and 3.0 % in aspect ratio, from 12 repeats of 4 contacts (8 degrees of freedom)"
    )


def test_symbols_and_signs_of_a_page():
    assert typeset("R_g & 4 (ℓd ℓe)^(3/2)") == (
        "R<sub>g</sub> &amp; 4 (ℓ<sub>d</sub> ℓ<sub>e</sub>)<sup>3/2</sup>"
    )
    assert signed_with_uncertainty(-0.512, 0.034) == "−0.512 ± 0.034"
    assert plain_text(r"$R_\mathrm{g}^\mathrm{corr}$ (mm)") == "Rgcorr (mm)"


# Plots of a loading curve: what is drawn lies where the record is


def test_every_force_model_is_drawn_from_the_zero_of_the_points(monkeypatch):
    drawn = []

    def kept(axes, indentation, load, *, phase, fits, **options):
        drawn.append((indentation[phase == "loading"], load[phase == "loading"], fits))
        return plot_load_indentation(axes, indentation, load, phase=phase, fits=fits, **options)

    monkeypatch.setattr(loading.figures, "plot_load_indentation", kept)
    curve = simulate_loading_curve(points=200, force_std=0.004, area_std=0.5, seed=3)
    fit = fit_loading_curve(curve)
    next(loading.loading_plots("press", curve, fit, cycle=0))
    ((indentation, load, lines),) = drawn
    in_contact = indentation > 0.2
    off = {
        name: np.std(load[in_contact] - np.interp(indentation[in_contact], depth, line))
        for name, (depth, line) in lines.items()
    }
    # Where the modulus grows so much a power law and Hertz theory leave 0.02 and 0.08 N.
    assert off["modulus growing with load"] < 0.006
    assert off["free exponent"] < 0.03
    assert off["Hertz"] < 0.1


# The report on tissue over bone: both theories side by side, or what a thickness would change


@pytest.fixture(scope="module")
def report(tmp_path_factory) -> tuple[StudyResult, str]:
    folder = tmp_path_factory.mktemp("layer")
    of = {"finger": "thick"}
    result = run(
        folder,
        finger("thick", effective_thickness_mm=8.0, effective_thickness_mm_std=1.5),
        contact("a", 1, (6.0, 5.0), **of),
        contact("b", 2, (7.4, 5.0), **of),
        contact("wide", 2, (14.0, 5.0), wedge=45, **of),
        curve(loading_radius_mm=19.7, loading_radius_mm_std=0.4, **of),
        uncertainty={"wedge_angle_deg_std": 0, "roll_angle_deg_std": 0},
    )
    return result, page_of(result, folder / "out")


def cells(text: str, quantity: str, of: str) -> list[str]:
    """Return the cells of a line of the table as text."""
    for line in re.findall(r"<tr>.*?</tr>", text, flags=re.DOTALL):
        found = [
            html.unescape(re.sub("<.*?>", "", cell)) for cell in re.findall("<td.*?</td>", line, re.DOTALL)
        ]
        if found[:2] == [quantity, of]:
            return found
    raise AssertionError(quantity)


QUANTITIES = {
    "Young's modulus E from load and area (kPa)": ("youngs_modulus_kpa", "youngs_modulus_on_layer_kpa"),
    "indentation ξ from the area (mm)": ("indentation_mm", "indentation_on_layer_mm"),
    "Rg to expect, A/(πξ) (mm)": ("geometric_radius_from_compliance_mm", "loading_radius_on_layer_mm"),
}


def test_both_theories_side_by_side(report):
    result, text = report
    row = rows_by(result)["b"]
    for quantity, names in QUANTITIES.items():
        found = cells(text, quantity, "b, 2 N")
        assert found[2:4] == [value_with_uncertainty(row[name], row[f"{name}_std"]) for name in names]
        assert found[4].startswith("thickness ")


def test_a_contact_out_of_range_is_named(report):
    _, text = report
    assert "wide is out of the range of the laws: the contact is wider than 0.6 of the pad" in text
    assert cells(text, "Young's modulus E from load and area (kPa)", "wide, 2 N")[3] == "–"
    assert not re.search(r"\bnan\b", re.sub("<svg.*?</svg>", "", text, flags=re.DOTALL), re.IGNORECASE)


def test_one_section_and_no_conditional_figure(report):
    result, text = report
    captions = re.findall("<figcaption>(.*?)</figcaption>", text, flags=re.DOTALL)
    assert sum(caption.startswith("Section along the finger under b") for caption in captions) == 1
    assert not any("Conditional" in caption for caption in captions)
    assert [len(comparisons(result, summary)) for summary in result.summaries] == [4, 3]
