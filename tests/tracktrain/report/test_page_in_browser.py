"""A run's page in a real browser: it draws, moves and obeys keys, without errors or a network."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import WebDriverWait

from fmus.carbody.default_data import default_data
from orchestrator import Header, Variable
from support.tools import need
from tracktrain.car.hopper import parameters_of
from tracktrain.live import Live
from tracktrain.report.modes_page import Drawing, modes_page

BROWSER = shutil.which("chromium") or shutil.which("google-chrome")
DRIVER = shutil.which("chromedriver")
SWITCHES = ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage")

Driver = webdriver.Chrome


@pytest.fixture(scope="module")
def browser(hopper_run: Path) -> Iterator[Driver]:
    need(BROWSER and DRIVER, "chromium and its driver")
    options = Options()
    options.binary_location = str(BROWSER)
    for switch in SWITCHES:
        options.add_argument(switch)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(options=options, service=Service(str(DRIVER)))
    yield driver
    driver.quit()


@pytest.fixture
def show(browser: Driver, hopper_run: Path) -> Callable[..., Driver]:
    """The page at a width [px], opened anew or, for who only looks, as the last test left it."""

    def at(width: int = 1280, fresh: bool = True) -> Driver:
        metrics = {"width": width, "height": 800, "deviceScaleFactor": 1, "mobile": width < 500}
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
        url = (hopper_run / "report.html").as_uri()
        if fresh or browser.current_url != url:
            browser.get(url)
        ready = "return document.documentElement.dataset.ready === 'yes'"
        WebDriverWait(browser, 30).until(lambda d: d.execute_script(ready))
        return browser

    return at


def traces(driver: Driver) -> list[str]:
    return list(
        driver.execute_script("return document.getElementById('time-plot').data.map(t => t.name)")
    )


def pixels(driver: Driver, canvas: str) -> str:
    return str(driver.execute_script(f"return document.getElementById('{canvas}').toDataURL()"))


def clock(driver: Driver) -> str:
    return driver.find_element(By.CSS_SELECTOR, "#car-controls .clock").text


def active(driver: Driver) -> Any:
    return driver.switch_to.active_element


def test_page_draws_everything_without_an_error(show: Callable[..., Driver]) -> None:
    driver = show()
    assert driver.get_log("browser") == []
    assert not driver.find_element(By.ID, "broken").is_displayed()
    for plot, least in (("time-plot", 300), ("spectrum-plot", 40)):
        paths = driver.find_elements(By.CSS_SELECTOR, f"#{plot} path.curve")
        assert len(paths) == 3
        assert all(len(path.get_attribute("d") or "") > least for path in paths)
    for canvas in ("car", "mode"):
        inked = (
            f"const c = document.getElementById('{canvas}');"
            "return c.getContext('2d').getImageData(0, 0, c.width, c.height).data"
            ".filter((v, i) => i % 4 === 3 && v).length"
        )
        assert driver.execute_script(inked) > 5000
    assert len(driver.find_elements(By.CSS_SELECTOR, "#assessment tbody tr")) > 20


def test_picking_a_signal_changes_the_plots(show: Callable[..., Driver]) -> None:
    driver = show()
    before = traces(driver)
    driver.find_element(By.ID, "filter").send_keys("carbody roll cg")
    driver.find_element(By.CSS_SELECTOR, "#choices label:not([hidden]) input").click()
    assert traces(driver) == [*before, "carbody.cg.roll"]
    driver.find_element(By.CSS_SELECTOR, "#chips button").click()
    assert traces(driver) == [*before[1:], "carbody.cg.roll"]


def test_plots_are_zoomed_by_dragging_and_by_keys(show: Callable[..., Driver]) -> None:
    driver = show()
    drawn = "return document.querySelector('#time-plot path.curve').getAttribute('d')"
    chart = driver.find_element(By.CSS_SELECTOR, "#time-plot .chart")
    whole = driver.execute_script(drawn)
    drag = ActionChains(driver).move_to_element(chart).click_and_hold().move_by_offset(90, 0)
    drag.release().perform()
    assert len(part := driver.execute_script(drawn)) < len(whole)
    chart.send_keys(Keys.ARROW_RIGHT)
    assert driver.execute_script(drawn) != part
    chart.send_keys("0")
    assert driver.execute_script(drawn) == whole
    said = driver.find_element(By.CSS_SELECTOR, "#time-plot .tip").text
    assert said.startswith("time ") and said.count(": ") == 3


def test_play_moves_the_car_and_the_clock(show: Callable[..., Driver]) -> None:
    driver = show()
    drawn, said = pixels(driver, "car"), clock(driver)
    button = driver.find_element(By.CSS_SELECTOR, "#car-controls .play")
    assert button.get_attribute("aria-label") == "Play"
    # In one call: on a busy machine the second that is shown may end between two.
    click_and_read = "arguments[0].click(); return arguments[0].getAttribute('aria-label')"
    assert driver.execute_script(click_and_read, button) == "Pause"
    WebDriverWait(driver, 10).until(lambda d: clock(d) > "0.10 s")
    assert clock(driver) != said
    assert pixels(driver, "car") != drawn


def test_modes_move_and_differ(show: Callable[..., Driver]) -> None:
    driver = show()
    first = pixels(driver, "mode")
    driver.find_elements(By.CSS_SELECTOR, "#mode-choices input")[2].click()
    second = pixels(driver, "mode")
    assert second != first
    driver.find_element(By.CSS_SELECTOR, "#mode-controls .play").click()
    WebDriverWait(driver, 10).until(lambda d: pixels(d, "mode") != second)


def test_keys_alone_reach_and_work_the_car(show: Callable[..., Driver]) -> None:
    """Tab goes from the links to the car, its button, time, speed, amplification and views;
    then past the headings of the tables to the signals."""
    driver = show()
    reached = []
    for _ in range(60):
        active(driver).send_keys(Keys.TAB)
        here = active(driver)
        reached.append(here.get_attribute("id") or here.get_attribute("aria-label"))
        if here.get_attribute("id") == "filter":
            break
    order = ("car", "Play", "Time", "car-speed", "car-gain", "filter")
    assert [name for name in reached if name in order] == list(order)

    car = driver.find_element(By.ID, "car")
    driver.execute_script("arguments[0].focus()", car)
    car.send_keys(Keys.ARROW_RIGHT)
    assert clock(driver) == "0.01 s"
    car.send_keys(Keys.SPACE)
    WebDriverWait(driver, 10).until(lambda d: clock(d) > "0.10 s")
    car.send_keys(Keys.SPACE)
    stopped = clock(driver)
    car.send_keys(Keys.HOME)
    assert clock(driver) == "0.00 s" != stopped


def test_space_plays_wherever_the_focus_is_but_where_it_types(show: Callable[..., Driver]) -> None:
    driver = show()
    said = "return document.querySelector('#car-controls .play').getAttribute('aria-label')"
    places = ("h1", "#car-controls .views button:last-child", "#choices details[open] input")
    for place in places:
        driver.find_element(By.CSS_SELECTOR, place).click()
        ActionChains(driver).send_keys(Keys.SPACE).perform()
        assert driver.execute_script(said) == "Pause", place
        ActionChains(driver).send_keys(Keys.SPACE).perform()
        assert driver.execute_script(said) == "Play", place
    box = driver.find_element(By.ID, "filter")
    box.send_keys("axle", Keys.SPACE, "yaw")
    assert box.get_attribute("value") == "axle yaw" and driver.execute_script(said) == "Play"


def test_tables_are_sorted_by_a_press_on_a_heading(show: Callable[..., Driver]) -> None:
    driver = show(fresh=False)
    column = """return [...document.querySelectorAll('#energy tbody tr')]
        .map(row => Number(row.cells[1].textContent))"""
    before = driver.execute_script(column)
    head = driver.find_element(By.CSS_SELECTOR, "#energy th:nth-child(2) button")
    for found in (sorted(before), sorted(before, reverse=True), before):
        driver.execute_script("arguments[0].click()", head)
        assert driver.execute_script(column) == found
    assert before != sorted(before)


def test_rows_of_a_group_stay_with_it_when_a_table_is_sorted(show: Callable[..., Driver]) -> None:
    driver = show(fresh=False)
    rows = """return [...document.querySelectorAll('.assessment tbody')].map(
        body => [...body.rows].map(row => row.cells[0].firstChild.textContent))"""
    before = driver.execute_script(rows)
    head = driver.find_element(By.CSS_SELECTOR, ".assessment th:nth-child(1) button")
    driver.execute_script("arguments[0].click()", head)
    after = driver.execute_script(rows)
    assert after != before
    for (heading, *group), (was, *names) in zip(after, before, strict=True):
        assert (heading, group) == (was, sorted(names, key=str.casefold))


@pytest.mark.parametrize("room", [0.5, 1, 2.8, 12])
@pytest.mark.parametrize("ends", [(0.01, 60), (-3, 4), (7.1, 7.3), (-1e-6, 2e-6)])
def test_an_axis_has_two_marks_at_least(
    show: Callable[..., Driver], ends: tuple[float, float], room: float
) -> None:
    said = show(fresh=False).execute_script(f"return marks({ends[0]}, {ends[1]}, {room}, false)")
    assert len(said) >= 2
    slack = 1e-6 * (ends[1] - ends[0])
    assert all(ends[0] - slack <= at <= ends[1] + slack for at, _ in said)


def test_plots_are_not_enlarged_on_paper(show: Callable[..., Driver]) -> None:
    driver = show(760)
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    try:
        for plot in ("time-plot", "spectrum-plot"):
            drawn, room = driver.execute_script(
                f"const svg = document.querySelector('#{plot} svg');"
                "return [svg.getBoundingClientRect().width, Number(svg.getAttribute('width'))]"
            )
            assert 0 < drawn <= room
    finally:
        driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})


@pytest.mark.parametrize("width", [360, 768])
def test_page_does_not_scroll_sideways(show: Callable[..., Driver], width: int) -> None:
    driver = show(width, fresh=width < 500)
    broad = "return document.documentElement.scrollWidth"
    # Plots follow a new width when the browser has drawn it.
    WebDriverWait(driver, 20).until(lambda d: d.execute_script(broad) <= width)
    assert driver.get_log("browser") == []


def test_everything_to_work_with_has_a_name(show: Callable[..., Driver]) -> None:
    driver = show(fresh=False)
    nameless = driver.execute_script(
        """return [...document.querySelectorAll("main button, main input, main select, canvas")]
        .filter(e => !(e.ariaLabel || e.textContent.trim() || e.labels?.length))
        .map(e => e.outerHTML)"""
    )
    assert nameless == []


def test_colours_follow_the_systems_dark_mode(show: Callable[..., Driver]) -> None:
    driver = show(fresh=False)
    light = driver.execute_script("return getComputedStyle(document.body).backgroundColor")
    features = [{"name": "prefers-color-scheme", "value": "dark"}]
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": features})
    dark = driver.execute_script("return getComputedStyle(document.body).backgroundColor")
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
    assert dark != light


def test_the_page_of_a_run_under_way_follows_it(browser: Driver) -> None:
    names = ["pump.y", "pump.speed"]
    variables = [(n, Variable(n, 0, "Real", "output", unit="m")) for n in names]
    time = np.arange(400) / 100
    rows = np.column_stack([time, np.sin(6 * time), 2 * time])
    said = "return document.getElementById('state').textContent"
    with Live() as live:
        live.begin(Header(variables, {"step": 0.01}, 401))
        live.append(rows[:200])
        browser.get(live.address)
        drawn = "return document.querySelectorAll('#time-plot path.curve').length"
        WebDriverWait(browser, 20).until(lambda d: d.execute_script(drawn) == 2)
        browser.find_element(By.CSS_SELECTOR, "#chips button").click()
        WebDriverWait(browser, 20).until(lambda d: d.execute_script(drawn) == 1)
        assert browser.execute_script(said) == "Running."
        live.append(rows[200:])
        live.finish({})
    WebDriverWait(browser, 20).until(lambda d: d.execute_script(said).startswith("Ended"))
    cells = browser.find_elements(By.CSS_SELECTOR, "#numbers td")
    assert [cell.text for cell in cells[:3]] == ["7.98", "0", "7.98"]
    assert browser.find_element(By.ID, "rows").text == "400"
    assert browser.get_log("browser") == []


def test_a_structures_modes_move_on_their_page(browser, tmp_path):
    data = default_data(parameters_of("empty")["carbody"])
    said = [(mode.name, f"{mode.frequency:.2f} Hz") for mode in data.modes]
    path = tmp_path / "modes.html"
    path.write_text(modes_page("Modes", Drawing.of(data), said, {}, {}))
    browser.get(path.as_uri())
    ready = "return document.documentElement.dataset.ready === 'yes'"
    WebDriverWait(browser, 30).until(lambda d: d.execute_script(ready))
    seen = "return document.getElementById('mode').toDataURL()"
    pictures = [browser.execute_script(seen)]
    for choice in browser.find_elements(By.CSS_SELECTOR, "#mode-choices input")[1:]:
        choice.click()
        pictures.append(browser.execute_script(seen))
    browser.find_element(By.ID, "mode").send_keys(Keys.ARROW_RIGHT)
    pictures.append(browser.execute_script(seen))
    assert len(set(pictures)) == 4
    assert [e for e in browser.get_log("browser") if e["level"] == "SEVERE"] == []
