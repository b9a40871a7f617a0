"""In a real browser every kind of page shows its figures, filters, opens what the address names, asks the network for nothing,
fits a narrow screen and has no serious barrier for anyone; with scripts switched off it is complete as well, and on paper.
"""

from __future__ import annotations

import base64
import json
import shutil
import subprocess
from importlib import resources

import numpy as np
import pytest
from click.testing import CliRunner
from report_records import HOSTILE, case, record, study, typical

from fogproof import Film, ImageScene, Medium, Perspective, PointLight
from fogproof.analytic import image
from fogproof.cli.commands import cli
from fogproof.images.compare import compare_image
from fogproof.images.formats import format_of
from fogproof.images.report import write_comparison as write_image
from fogproof.reports import write_comparison, write_gallery, write_report
from fogproof.reports.pages.images import write_relations_page, write_renders_page

webdriver = pytest.importorskip("selenium.webdriver", reason="selenium is not installed: pip install --group test")
CHROMIUM, DRIVER = (shutil.which(name) for name in ("chromium", "chromedriver"))
if not (CHROMIUM and DRIVER):
    pytest.skip("no browser: apt-get install chromium chromium-driver", allow_module_level=True)

from selenium.webdriver.common.by import By  # noqa: E402
from selenium.webdriver.common.keys import Keys  # noqa: E402
from selenium.webdriver.support.wait import WebDriverWait  # noqa: E402


def start(profile, scripts=True):
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    switches = "headless no-sandbox disable-gpu disable-quic disable-dev-shm-usage no-first-run disable-sync"
    switches += " disable-background-networking disable-component-update"
    for switch in [*switches.split(), f"user-data-dir={profile}", "window-size=1200,900"]:
        options.add_argument(f"--{switch}")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    if not scripts:
        options.add_experimental_option("prefs", {"profile.managed_default_content_settings.javascript": 2})
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(executable_path=DRIVER))
    driver.set_page_load_timeout(60)
    driver.set_script_timeout(60)
    return driver


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    driver = start(tmp_path_factory.mktemp("profile"))
    yield driver
    driver.quit()


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    cases = [
        case(text, status, **dict.fromkeys(("title", "reason", "source", "reference", "twin", "reproduce"), text))
        for text, status in zip(HOSTILE.values(), ["rejected", "passed", "error", "skipped"] * 5, strict=False)
    ]
    records = {
        "typical": typical(4),
        "hostile": record(cases, command=HOSTILE["script"]),
        "study": study(HOSTILE["attribute"], HOSTILE["script"]),
    }
    written = {name: write_report(one, tmp_path_factory.mktemp(name)).as_uri() for name, one in records.items()}
    both = write_comparison(records["typical"], records["hostile"], tmp_path_factory.mktemp("comparison"))
    gallery = write_gallery(tmp_path_factory.mktemp("gallery"), names=["fog", "phase-polar"])
    written |= {"comparison": both.as_uri(), "gallery": gallery.as_uri()}
    of_images = image_pages(tmp_path_factory.mktemp("images"))
    return written | {"stability": stability_page(tmp_path_factory.mktemp("stability")).as_uri()} | of_images


def image_pages(folder):
    """Return the pages of an image that is upside down, of renders and of relations."""
    scene = ImageScene(
        Medium(0.02, 0.08),
        Perspective((0, 0, 0), (0, 0, 1), 0.7, Film(32, 24), wall=10.0),
        "single",
        PointLight((0.6, 0.8, 4), 5.0),
    )
    format_of("a.npy").write(folder / "a.npy", {"Y": image(scene).value[::-1].astype(np.float32)})
    one = write_image(compare_image([folder / "a.npy"], scene), folder / "one")
    outcomes = ("rejected", "not rejected", "inconclusive", "not rendered", "error")
    told = {
        "reason": HOSTILE["script"],
        "ratio": "1.01 (0.9 to 1.1)",
        "resolution": "0.004",
        "seconds": "1.5",
        "page": "",
    }
    renders = [{"scene": f"scene-{outcome}", "outcome": outcome, **told} for outcome in outcomes]
    sides = {
        "relation": "reciprocity",
        "isolates": "the phase function",
        "first": "0.1",
        "second": "0.1",
        "difference": "+0.01",
    }
    relations = [row | sides | {"message": HOSTILE["attribute"]} for row in renders]
    return {
        "image": one.as_uri(),
        "renders": write_renders_page(renders, "mine", folder / "renders").as_uri(),
        "relations": write_relations_page(relations, "mine", folder / "relations").as_uri(),
    }


def stability_page(folder):
    command = ["stability", "--short", "phase/rayleigh", "-o", str(folder)]
    CliRunner().invoke(cli, command, standalone_mode=False, catch_exceptions=False)
    return folder / "stability.html"


EVERY_KIND = ("typical", "hostile", "study", "comparison", "gallery", "stability", "image", "renders", "relations")


def visit(browser, address):
    browser.get("about:blank")
    for log in ("browser", "performance"):
        browser.get_log(log)
    browser.get(address)


def open_all(browser):
    browser.execute_script("document.querySelectorAll('details').forEach(it => it.open = true)")


def requests(browser):
    events = [json.loads(entry["message"])["message"] for entry in browser.get_log("performance")]
    return [e["params"]["request"]["url"] for e in events if e["method"] == "Network.requestWillBeSent"]


def names_shown(browser):
    """The cases of the table that are visible, with one question to the browser."""
    script = "return [...document.querySelectorAll('tr[data-status] th')].filter(it => it.offsetParent).map(it => it.innerText)"
    return browser.execute_script(script)


@pytest.mark.parametrize("name", EVERY_KIND)
def test_no_error_no_request_and_no_sideways_scrolling(browser, pages, name):
    """Nothing on the console, nothing asked of the network, and every word reachable on narrow screens."""
    visit(browser, pages[name])
    open_all(browser)
    assert "fogproof" in browser.title
    try:
        for width in (320, 400, 800, 1000):
            screen = {"width": width, "height": 800, "deviceScaleFactor": 1, "mobile": False}
            browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", screen)
            seen, needed = browser.execute_script("return [innerWidth, document.documentElement.scrollWidth]")
            assert needed <= seen == width
    finally:
        browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    assert browser.get_log("browser") == []
    assert [url for url in requests(browser) if not url.startswith("data:")] == [pages[name]]


@pytest.mark.parametrize(("name", "figures"), [("typical", 14), ("study", 3), ("gallery", 2)])
def test_figures_are_visible(browser, pages, name, figures):
    visit(browser, pages[name])
    open_all(browser)
    sizes = browser.execute_script(
        "return [...document.querySelectorAll('figure .drawing > svg')]"
        ".map(it => it.getBoundingClientRect()).map(it => [it.width, it.height])"
    )
    assert len(sizes) == figures
    assert all(width > 300 and height > 150 for width, height in sizes)
    inside = (
        "return [...document.querySelectorAll('figure svg svg')].every(it => it.getBoundingClientRect().height > 10)"
    )
    assert browser.execute_script(inside)


def test_filter_by_status_and_by_word(browser, pages):
    visit(browser, pages["typical"])
    everything = names_shown(browser)
    assert len(everything) == 11
    browser.find_element(By.CSS_SELECTOR, "input[value=rejected]").click()
    assert names_shown(browser) == ["mitsuba/hg/g=0.95", "transmittance/ratio tracking"]
    words = browser.find_element(By.NAME, "words")
    words.send_keys("RATIO tracking")
    assert names_shown(browser) == ["transmittance/ratio tracking"]
    assert browser.find_element(By.TAG_NAME, "output").text == "1 of 11 shown"
    shown = [it for it in browser.find_elements(By.CSS_SELECTOR, "details.case") if it.is_displayed()]
    assert len(shown) == 1
    words.send_keys(" nothing has this")
    WebDriverWait(browser, 10).until(lambda it: names_shown(it) == [])
    words.clear()
    words.send_keys("x", Keys.BACKSPACE)
    browser.find_element(By.CSS_SELECTOR, "input[name=status][value='']").click()
    assert names_shown(browser) == everything
    words.send_keys("factor of two", Keys.ENTER)
    assert names_shown(browser) == ["lecture/surprise"]


def test_filter_of_a_comparison_and_of_a_study(browser, pages):
    visit(browser, pages["comparison"])
    browser.find_element(By.CSS_SELECTOR, "input[value=gone]").click()
    assert len(names_shown(browser)) == 11
    browser.find_element(By.NAME, "words").send_keys("ratio")
    assert names_shown(browser) == ["transmittance/ratio tracking"]
    assert browser.find_element(By.TAG_NAME, "output").text == f"1 of {11 + len(HOSTILE)} shown"
    visit(browser, pages["study"])
    browser.find_element(By.CSS_SELECTOR, "input[value=known]").click()
    assert names_shown(browser) == [f"{HOSTILE['attribute']} / march"]
    shown = [it for it in browser.find_elements(By.CSS_SELECTOR, "details.case") if it.is_displayed()]
    assert [it.text.split("\n")[0].split(" ⚑")[0] for it in shown] == [f"{HOSTILE['attribute']} / march"]


def in_view(browser, element):
    top = browser.execute_script("return arguments[0].getBoundingClientRect().top", element)
    return 0 <= top < browser.execute_script("return innerHeight")


def section(browser, name):
    return next(it for it in browser.find_elements(By.CSS_SELECTOR, "details.case") if it.text.startswith(name))


@pytest.mark.parametrize("fragment", ["case/hg/g=-0.95", "case/hg/g%3D-0.95"])
def test_address_opens_its_case(browser, pages, fragment):
    visit(browser, f"{pages['typical']}#{fragment}")
    opened = section(browser, "hg/g=-0.95")
    assert opened.get_attribute("open")
    assert in_view(browser, opened.find_element(By.TAG_NAME, "summary"))


def test_link_opens_its_case_even_if_filtered_out(browser, pages):
    visit(browser, pages["typical"])
    assert not section(browser, "airlight/equiangular").get_attribute("open")
    browser.find_element(By.CSS_SELECTOR, "input[value=passed]").click()
    browser.find_element(By.CSS_SELECTOR, "li a[href*=equiangular]").click()
    opened = section(browser, "airlight/equiangular")
    assert opened.get_attribute("open")
    assert in_view(browser, opened.find_element(By.TAG_NAME, "summary"))


@pytest.mark.parametrize(("name", "count"), [("hostile", len(HOSTILE)), ("study", 6)])
def test_every_hostile_name_has_a_working_link(browser, pages, name, count):
    visit(browser, pages[name])
    links = browser.find_elements(By.CSS_SELECTOR, "tr[data-status] th a")
    assert len(links) == count
    for link in links:
        before = set(browser.find_elements(By.CSS_SELECTOR, "details.case[open]"))
        link.click()
        after = set(browser.find_elements(By.CSS_SELECTOR, "details.case[open]"))
        target = browser.execute_script("return document.querySelector(':target').closest('details')")
        assert target in after
        assert after - before <= {target}


def paint(browser, scheme):
    features = [{"name": "prefers-color-scheme", "value": scheme}] if scheme else []
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": features})


@pytest.mark.parametrize("name", ["typical", "study", "gallery"])
def test_figures_on_a_narrow_screen_are_legible_and_moved_in_their_own_boxes(browser, pages, name):
    """Letters of 14 px on the sheet stay above 10 px; what is too wide then can be moved without a mouse."""
    look = """
        const done = arguments[arguments.length - 1];
        requestAnimationFrame(() => requestAnimationFrame(() => done([...document.querySelectorAll(".drawing")]
            .filter(it => it.checkVisibility()).map(it => [it.tabIndex, it.scrollWidth > it.clientWidth,
                it.firstElementChild.getBoundingClientRect().width / it.firstElementChild.viewBox.baseVal.width]))))"""
    visit(browser, pages[name])
    try:
        for width, moved in ((400, True), (1200, False)):
            screen = {"width": width, "height": 800, "deviceScaleFactor": 1, "mobile": False}
            browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", screen)
            found = browser.execute_async_script(look)
            assert [(tab, wide) for tab, wide, _ in found] == [(0 if moved else -1, moved)] * len(found) != []
            assert all(14 * scale > 10 for *_, scale in found)
    finally:
        browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


@pytest.mark.parametrize("name", EVERY_KIND)
def test_no_serious_barrier(browser, pages, name):
    """axe-core's findings of impact serious or critical, every section open, in light; in dark what colours can spoil."""
    visit(browser, pages[name])
    open_all(browser)
    browser.execute_script(resources.files("axe_core_python").joinpath("axe.min.js").read_text(encoding="utf-8"))
    try:
        for scheme, colour, rules in (
            ("light", "rgb(255, 255, 254)", {}),
            ("dark", "rgb(20, 24, 29)", {"runOnly": ["color-contrast"]}),
        ):
            paint(browser, scheme)
            assert browser.execute_script("return getComputedStyle(document.body).backgroundColor") == colour
            script = "axe.run(document, arguments[0]).then(arguments[arguments.length - 1])"
            found = browser.execute_async_script(script, {**rules, "resultTypes": ["violations"]})
            assert len(found["passes"]) > (0 if rules else 20)
            serious = [
                (it["id"], it["impact"], [node["html"][:200] for node in it["nodes"][:3]])
                for it in found["violations"]
                if it["impact"] in ("serious", "critical")
            ]
            assert serious == []
    finally:
        paint(browser, "")


@pytest.mark.skipif(not shutil.which("pdftotext"), reason="no pdftotext: apt-get install poppler-utils")
@pytest.mark.parametrize("name", EVERY_KIND)
def test_no_heading_is_stranded_on_paper(browser, pages, name, tmp_path):
    """No page of paper ends with a heading, the first line of a section, or the head of a table."""
    visit(browser, pages[name])
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    try:
        heads, cells = (
            {
                "".join(text.split())
                for text in browser.execute_script(
                    f"return [...document.querySelectorAll('{wanted}')].filter(it => it.offsetParent).map(it => it.innerText)"
                )
            }
            for wanted in ("h2, h3, h4, summary, thead tr", "dd, dd code, tbody td")
        )
    finally:
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})
    printed = browser.execute_cdp_cmd("Page.printToPDF", {"paperWidth": 8.27, "paperHeight": 11.69})
    (tmp_path / "page.pdf").write_bytes(base64.b64decode(printed["data"]))
    subprocess.run(["pdftotext", "-layout", tmp_path / "page.pdf"], check=True, timeout=60)
    sheets = [sheet.split("\n") for sheet in (tmp_path / "page.txt").read_text(encoding="utf-8").split("\f")]
    ends = [["".join(line.split()) for line in sheet if line.strip()][-1:] for sheet in sheets]
    assert len(ends) > 1
    assert not [end for end in ends if end and end[0] in heads - cells]  # a name that heads its case may end it as well


def test_keyboard_reaches_everything(browser, pages):
    visit(browser, pages["typical"])
    focused = []
    for _ in range(120):
        browser.switch_to.active_element.send_keys(Keys.TAB)
        element = browser.switch_to.active_element
        focused.append((element.tag_name, element.text))
        if element.tag_name == "summary" and element.text.startswith("airlight"):
            element.send_keys(Keys.ENTER)
            break
    assert focused[0] == ("a", "Skip to the cases")
    assert {"input", "a", "summary"} <= {tag for tag, _ in focused}
    assert section(browser, "airlight/equiangular").get_attribute("open")


def test_page_is_complete_without_scripts(pages, tmp_path):
    driver = start(tmp_path / "profile", scripts=False)
    try:
        driver.get(f"{pages['typical']}#case/hg/g=-0.95")
        assert not driver.find_element(By.ID, "filter").is_displayed()
        assert all(row.is_displayed() for row in driver.find_elements(By.CSS_SELECTOR, "tr[data-status] th"))
        assert driver.find_element(By.CSS_SELECTOR, "figure svg").is_displayed()
        opened = section(driver, "hg/g=-0.95")
        WebDriverWait(driver, 20).until(lambda _: opened.get_attribute("open"))
    finally:
        driver.quit()
