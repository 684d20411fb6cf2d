"""The pad in three dimensions, and the results."""

import re

import pytest
from playwright.sync_api import expect
from tests.end_to_end.page.browser import Late, Tab, changed, enter, numbers, press, served


@pytest.fixture(scope="module")
def reading(run_demo, tmp_path_factory):
    """One bench for all that only looks."""
    with served(run_demo.parent, run_demo) as server:
        yield server


@pytest.fixture(scope="module")
def opened(browser, reading):
    """One tab on it, opened once."""
    tab = Tab(browser, reading)
    tab.open("run")
    yield tab
    tab.close()


@pytest.fixture
def tab(opened):
    """The tab, in a view that no test looks at; what it heard is judged after each test."""
    opened.go("run")
    yield opened
    opened.page.unroute_all(behavior="ignoreErrors")
    opened.page.mouse.move(0, 0)
    opened.judge()


def test_a_run_with_nothing_to_measure_does_not_say_that_nothing_is_measured(tab: Tab) -> None:
    """Before it is known what there is to measure, and once all of it is measured."""
    state = {}

    def answer(route):
        found = route.fetch().json()
        route.fulfill(json={**found, "version": found["version"] + 1000, **state})

    tab.page.route("**/api/studies/*/run", answer)
    for total, done, words in (
        (0, 0, "reading files and scales"),
        (1000, 400, "400 of 1000 measured"),
        (1000, 1000, "evaluating"),
    ):
        state |= {"state": "running", "phase": "measuring", "total": total, "done": done}
        state["version"] = 1_000_000 + done + total
        tab.go("contacts")
        page = tab.go("run")
        line = page.locator(".run-line")
        expect(line).to_contain_text(words)
        expect(line).not_to_contain_text("0 of 0")
        bar = page.get_by_role("progressbar", name="Progress of the run")
        assert bar.get_attribute("value") == (str(done) if 0 < done < total else None)
    # Leave the tab as it was.
    state |= {"state": "idle", "phase": None, "total": 0, "done": 0, "version": 2_000_000}
    tab.go("contacts")
    tab.go("run")


def test_pad_turns_with_its_angles_by_slider_and_by_key(tab: Tab) -> None:
    page = tab.go("pad")
    assert numbers(page, "u").startswith("45.2 ± 3.5")
    was = numbers(page, "u")
    page.get_by_label("Wedge angle θ", exact=True).fill("45")
    assert changed(page, was, "u").startswith("60.2")
    place = page.locator(".marks .contact")
    before = place.get_attribute("cx")
    page.locator(".pad-scene").press("ArrowRight")
    expect(place).not_to_have_attribute("cx", before)
    page.locator("h1").click()
    was = numbers(page, "u")
    page.keyboard.press("w")
    changed(page, was, "u")
    expect(page.get_by_label("Wedge angle θ, degrees")).to_have_value("46")
    page.get_by_label("Finger", exact=True).select_option("")
    enter(page.get_by_label("Palmar", exact=True), "10")
    page.get_by_text("belong to no finger").wait_for()


def test_pad_is_painted_with_its_lines(tab: Tab) -> None:
    page = tab.go("pad")
    numbers(page, "u")
    expect(page.locator(".pad-scene .direction")).to_have_count(2)
    painted = page.locator(".pad-scene canvas").evaluate(
        """canvas => canvas.getContext("2d")
          .getImageData(0, 0, canvas.width, canvas.height).data.filter((_, k) => k % 4 === 3)
          .reduce((sum, alpha) => sum + alpha / 255, 0) / (canvas.width * canvas.height)"""
    )
    assert 0.1 < painted < 0.9


def test_area_and_corrected_radius_against_load_with_their_lines_and_bars(tab: Tab) -> None:
    page = tab.go("results")
    shown = page.get_by_label("Against load", exact=True)
    expect(shown).to_have_value("gross_area_mm2")
    given = page.get_by_role("region", name="left_index_ellipse, wedge 30°").locator(".chart")
    given.locator(".scatterlayer .point").first.wait_for()
    label = "Chart of contact area against load: 1 values from 116.2 to 116.2"
    expect(given).to_have_attribute("aria-label", label)
    assert given.locator(".ytick text").first.text_content() == "0"
    shown.select_option("corrected radius")
    page.locator(".chart .scatterlayer .point").first.wait_for()
    cards = page.locator(".plot-card")
    expect(cards).to_have_count(6)
    for words in ("13.8\u00a0±\u00a04.6 mm", "20.5 mm", "✕ radius fails"):
        expect(cards.first).to_contain_text(re.compile(words.replace(" ", r"\s")), use_inner_text=True)
    expect(cards.first.locator(".shapelayer path")).to_have_count(2)
    expect(cards.first.locator(".errorbar")).to_have_count(1)
    # What the report says, in its words: what to check, what to do about a check, and loading curves.
    expect(page.locator(".results .note").first).to_contain_text("left_index_ellipse: the moduli")
    page.get_by_text("To measure better").click()
    page.get_by_text("Press again under one load, four times or more").wait_for()
    curve = page.locator(".curve-card").last
    for words in (r"R\s?g", r"13\.\d+ ± 0", "m of W", r"1\.\d+ ± 0", "doubt"):
        expect(curve).to_contain_text(re.compile(words), use_inner_text=True)
    page.get_by_label("Finger", exact=True).select_option("synthetic_pad")
    page.locator(".plot-card .synthetic").first.wait_for()
    expect(cards).to_have_count(2)
    cards.first.get_by_text("Does the model hold? strained").click()
    cards.first.get_by_text("E of Hertz theory and the whole pad on a half-space: strained").wait_for()
    shown.select_option("gross_area_mm2")
    page.get_by_text("contact area A (mm²)").first.wait_for()


def test_table_is_filtered_sorted_and_leads_to_the_picture(tab: Tab) -> None:
    page = tab.go("results")
    press(page, "t")
    page.get_by_text("34 of 34 rows").wait_for()
    page.get_by_label("Finger", exact=True).select_option("synthetic_pad")
    page.get_by_label("Wedge", exact=True).select_option("45")
    page.get_by_text("4 of 34 rows").wait_for()
    for way in ("ascending", "descending"):
        page.get_by_role("button", name="Sort by W, N").click()
        header = page.get_by_role("columnheader", name="Sort by W, N")
        header.and_(page.locator(f"[aria-sort={way}]")).wait_for()
    first = page.locator("tbody tr").first
    expect(first).to_have_text(re.compile("^synthetic_45deg_4N"), use_inner_text=True)
    press(page, "/")
    page.keyboard.type("0.5N")
    page.get_by_text("1 of 34 rows").wait_for()
    page.locator("tbody a").press("Enter")
    page.wait_for_url(re.compile("contacts/images/synthetic_45deg_0.5N"))


def test_late_results_of_another_part_are_not_shown(tab: Tab) -> None:
    page = tab.go("pad")
    late = Late(page, "**/api/studies/*/results/rows*")
    tab.go("results/table")
    late.wait()
    tab.go("results/plot")
    page.locator(".plot-card").first.wait_for()
    late.let_go()
    expect(page.locator(".plot-card").first).to_be_visible()
    expect(page.locator(".results > *")).to_have_count(1)


def test_figures_and_one_for_publication(tab: Tab) -> None:
    tab.expected.append("422")
    page = tab.go("results/figures")
    page.get_by_label("Show", exact=True).select_option("corrected_radius")
    page.wait_for_function("() => document.querySelector('figure img')?.naturalWidth > 100")
    page.get_by_role("button", name="Size, axes and colours of").first.click()
    dialog = page.locator("dialog.figure-settings")
    preview = dialog.locator("img.preview")
    page.wait_for_function("() => document.querySelector('img.preview')?.naturalWidth > 100")
    before = preview.get_attribute("src")
    dialog.get_by_label("Journal").select_option("90")
    expect(preview).not_to_have_attribute("src", before)
    expect(dialog.get_by_role("link", name="PDF")).to_have_attribute("href", re.compile("width_mm=90"))
    dialog.get_by_label("From").first.fill("3")
    enter(dialog.get_by_label("To").first, "1")
    dialog.get_by_text("an axis goes from a smaller to a larger number, found 3 to 1").wait_for()
    expect(dialog.get_by_role("link", name="PDF")).to_have_count(0)
    dialog.get_by_role("button", name="Close").click()
    expect(dialog).to_have_count(0)


@pytest.mark.parametrize(
    ("view", "choice", "figure"),
    [
        ("results/plot", "contact area", "synthetic_pad_30deg_synthetic_area"),
        ("contacts/sequence:synthetic_press_30deg", "", "sequence_synthetic_press_30deg_synthetic"),
    ],
)
def test_a_chart_leads_to_its_figure(tab: Tab, view: str, choice: str, figure: str) -> None:
    page = tab.go(view)
    if choice:
        page.get_by_label("Against load", exact=True).select_option(choice)
    page.get_by_role("button", name=f"Size, axes and colours of {figure}").click()
    page.locator("dialog.figure-settings").get_by_role("heading", name=figure.replace("_", " ")).wait_for()
    page.wait_for_function("() => document.querySelector('img.preview')?.naturalWidth > 100")
    before = page.url
    page.keyboard.press("Enter")  # accepts no frame behind the dialog
    assert page.url == before


def test_budget_and_audit(tab: Tab) -> None:
    page = tab.go("results/figures")
    press(page, "b")
    card = page.locator("section.card").first
    card.get_by_text("linear approximation not valid").wait_for()
    expect(card).to_contain_text("98.1 %", use_inner_text=True)
    page.keyboard.press("a")
    page.get_by_text("reproduced with the known misprint").first.wait_for()
    expect(page.locator("table.audit tbody tr")).to_have_count(36)


def test_simulators_are_computed_for_the_fingers_in_view(tab: Tab) -> None:
    page = tab.go("results/budget")
    page.set_viewport_size({"width": 1280, "height": 300})
    press(page, "s")
    page.get_by_text("Table of pressure by depth").first.wait_for()
    cards = page.locator(".plot-grid > section")
    asked = [url for url in tab.asked if "/results/simulator?" in url]
    assert 0 < len(asked) < cards.count()
    cards.last.scroll_into_view_if_needed()
    expect(cards.last.get_by_role("status")).to_have_count(0)
    page.set_viewport_size({"width": 1280, "height": 800})
