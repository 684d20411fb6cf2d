"""The surface of contacts: chosen on the page for a contact, a sequence and a study, and said above it."""

import re
import tomllib

import pytest
from playwright.sync_api import expect
from tests.end_to_end.page.browser import Tab, numbers, served
from tests.smooth_study import area_at, make_smooth_study


@pytest.fixture
def smooth(tmp_path):
    return make_smooth_study(tmp_path / "smooth", None).parent


@pytest.fixture
def page_of(browser, smooth):
    with served(smooth.parent, smooth) as server:
        tab = Tab(browser, server)
        yield tab.open
        tab.close()


def area(page) -> float:
    return float(re.search(r"Gross area\s+([\d.]+) ±", numbers(page)).group(1))


def table(smooth, name) -> dict:
    return tomllib.loads((smooth / "study.toml").read_text())[name]


def test_a_contact_is_said_to_be_smooth(page_of, smooth) -> None:
    page = page_of("contacts/images/contact")
    page.get_by_label("Surface", exact=True).select_option("smooth")
    expect(page.get_by_text("smooth surface", exact=True)).to_be_visible()
    expect(page.locator("[data-live=numbers]")).to_contain_text("Gross area")
    assert area(page) == pytest.approx(area_at(2.0), rel=0.02)
    assert "Ridge" not in numbers(page)
    assert page.get_by_label("Threshold, grey levels").count() == 0
    assert table(smooth, "observations")[0]["surface"] == "smooth"
    page.get_by_label("Surface", exact=True).select_option("ridged")
    expect(page.get_by_text("smooth surface", exact=True)).to_have_count(0)
    assert table(smooth, "observations")[0]["surface"] == "ridged"
