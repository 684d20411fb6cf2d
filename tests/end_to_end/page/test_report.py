"""The report in a browser: it opens short, and is found, linked and printed whole."""

from playwright.sync_api import Page

OPEN = "[...document.querySelectorAll('details[open] h2')].map(one => one.textContent)"


def opened(browser, address: str, **options: object) -> Page:
    page = browser.new_page(**options)
    page.goto("about:blank")
    page.goto(address)
    return page


def test_a_link_and_a_search_open_the_fold(browser, run_demo) -> None:
    address = (run_demo / "results" / "report.html").as_uri()
    page = opened(browser, address)
    assert page.evaluate(OPEN) == []
    page.click("a[href='#missing']")
    page.wait_for_function(f"{OPEN}.length == 1")
    assert page.evaluate(OPEN) == ["What is exact, assumed or missing"]
    page = opened(
        browser, f"{address}#:~:text=Provenance"
    )  # as the browser's own search reveals what it finds
    page.wait_for_function(f"{OPEN}.length == 1")
    assert page.evaluate(OPEN) == ["How the numbers are made"]


def test_printed_whole(browser, run_demo) -> None:
    page = opened(browser, (run_demo / "results" / "report.html").as_uri())
    height = "document.documentElement.scrollHeight"
    folded = page.evaluate(height)
    page.emulate_media(media="print")
    shown = "[...document.querySelectorAll('.fold > div')].every(one => one.checkVisibility())"
    assert page.evaluate(shown)
    assert page.evaluate(height) > 8 * folded
    # The title of a list stands above it, one in a sentence within.
    titles = "[...document.querySelectorAll('.note > strong')]"
    display = f"getComputedStyle({titles}.find(one => one.textContent%s)).display"
    assert page.evaluate(display % ".startsWith('Missing in it')") == "block"
    assert page.evaluate(display % " === 'Repeatability is missing'") == "inline"


def test_fits_a_telephone_and_is_dark_where_asked(browser, run_demo) -> None:
    address = (run_demo / "results" / "report.html").as_uri()
    page = opened(browser, address, viewport={"width": 390, "height": 844}, color_scheme="dark")
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(20, 24, 31)"
    # Of the answers each row is a block, with the names of its columns, and none is out of sight.
    right = "[...document.querySelectorAll('.results td')].map(one => one.getBoundingClientRect().right)"
    assert max(page.evaluate(right)) <= 390
    row = page.locator(".results tbody tr").first
    assert "Corrected radius, mm" in row.evaluate("""row => [...row.cells].map(
        one => getComputedStyle(one, '::before').content).join()""")
    page.evaluate("document.querySelectorAll('details').forEach(one => { one.open = true })")
    assert page.evaluate("document.documentElement.scrollWidth") == 390
