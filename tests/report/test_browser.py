"""The page in a real browser: no complaint, no request, and the viewer does what its controls say."""

import numpy as np
import pytest
from chromium import SOFTWARE, WITHOUT_WEBGL, Browser, find_browser

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(find_browser() is None, reason="no Chromium on the path or in the variable CHROMIUM"),
]
CANVAS = "#viewer-canvas"


@pytest.fixture(scope="module", params=[SOFTWARE, WITHOUT_WEBGL], ids=["webgl2", "2d"])
def launched(request):
    with Browser(find_browser(), request.param) as browser:
        yield browser


@pytest.fixture
def browser(launched, page):
    launched.open(page)
    launched.wait(f"document.querySelector('{CANVAS}').dataset.shown > 0")
    launched.settle()
    yield launched
    launched.resize(1280, 900)
    assert launched.complaints == []
    assert [url for url in launched.requests if not url.startswith(("file:", "data:"))] == []


def pixels(browser):
    return np.asarray(browser.picture(CANVAS)).astype(int)


def painted(picture):
    """Share of the canvas that is not its background."""
    return (np.abs(picture - picture[2, 2]).sum(axis=2) > 30).mean()


def shown(browser):
    return int(browser.evaluate(f"document.querySelector('{CANVAS}').dataset.shown"))


def change(one, other):
    return (np.abs(one - other).sum(axis=2) > 30).mean()


def test_the_viewer_draws_and_every_control_changes_it(browser, request):
    renderer = browser.evaluate(f"document.querySelector('{CANVAS}').dataset.renderer")
    assert renderer == request.node.callspec.id
    assert ("no WebGL2" in browser.evaluate("document.body.innerText")) == (renderer == "2d")
    first = pixels(browser)
    assert 0.05 < painted(first) < 0.9
    tets = shown(browser)

    browser.click("#viewer-samples button:nth-child(2)")
    second = pixels(browser)
    assert browser.evaluate("document.querySelector('#viewer-status').textContent").startswith("Sample 0001:")
    assert not np.array_equal(first, second)

    browser.drag(CANVAS, 120, 40)
    turned = pixels(browser)
    assert change(second, turned) > 0.02
    browser.click("#viewer-reset")
    assert change(second, pixels(browser)) < 0.001

    browser.choose("#viewer-cut", 0)
    whole = pixels(browser)
    assert shown(browser) > tets
    assert painted(whole) > painted(second)
    browser.choose("#viewer-cut", 1)
    assert shown(browser) == 0
    assert painted(pixels(browser)) == 0
    browser.choose("#viewer-cut", 0.5)

    browser.choose("#viewer-colour", "plain")
    plain = pixels(browser)
    assert browser.evaluate("document.querySelector('#viewer-legend').hidden")
    browser.choose("#viewer-colour", "ratio")
    assert change(plain, pixels(browser)) > 0.02
    assert not browser.evaluate("document.querySelector('#viewer-legend').hidden")

    ratio = pixels(browser)
    browser.choose("#viewer-axis", "view")
    assert change(ratio, pixels(browser)) > 0.01

    browser.choose("#viewer-set", 1)
    assert browser.evaluate("document.querySelector('#viewer-status').textContent").startswith("Sample 0000:")


def test_the_shown_count_is_that_of_the_plane(browser, ball):
    vertices, tets = ball
    browser.choose("#viewer-axis", "y")
    browser.choose("#viewer-cut", 0.25)
    along = vertices[tets].mean(axis=1)[:, 1]
    # Those beyond three quarters of the way; a tet on the plane itself may fall on either side.
    limit = along.max() - 0.25 * (along.max() - along.min())
    assert (along < limit - 1e-3).sum() <= shown(browser) <= (along < limit + 1e-3).sum()


def test_a_dark_page_is_dark_and_keeps_its_solid(browser):
    browser.resize(1280, 900, dark=True)
    dark = pixels(browser)
    assert dark[2, 2].sum() < 150
    assert painted(dark) > 0.05
