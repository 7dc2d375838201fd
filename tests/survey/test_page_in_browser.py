"""The survey as a participant sees it, in a real browser."""

import functools
import http.server
import json
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from moka.cli.main import main
from tests.support.browser import open_browser, requested
from tests.survey.pictures import write_pictures

if TYPE_CHECKING:
    from selenium.webdriver import Chrome
    from selenium.webdriver.remote.webelement import WebElement

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def downloads(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("downloads")


@pytest.fixture(scope="module")
def chrome(
    tmp_path_factory: pytest.TempPathFactory, downloads: Path
) -> Iterator["Chrome"]:
    profile = tmp_path_factory.mktemp("profile")
    with open_browser(profile, downloads) as browser:
        yield browser


@pytest.fixture(scope="module")
def survey(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("survey")
    pictures = write_pictures(folder / "pictures")
    credits_file = folder / "credits.txt"
    credits_file.write_text("Model by <Somebody> & co\n")
    arguments = ["-o", str(folder / "out"), "--credits", str(credits_file)]
    assert main(["survey", "make", *map(str, pictures), *arguments]) == 0
    return folder / "out"


@pytest.fixture
def page(chrome: "Chrome", survey: Path) -> Iterator["Chrome"]:
    requested(chrome)
    chrome.get((survey / "index.html").as_uri())
    yield chrome
    # Else the page asks whether to leave while answers are not saved.
    chrome.execute_script(
        "window.addEventListener('beforeunload',"
        " (event) => event.stopImmediatePropagation(), {capture: true})"
    )
    chrome.get("about:blank")
    faults = [
        entry["message"]
        for entry in chrome.get_log("browser")
        if entry["level"] == "SEVERE"
    ]
    assert not faults


def find(page: "Chrome", selector: str) -> "WebElement":
    return page.find_element("css selector", selector)


def find_all(page: "Chrome", selector: str) -> list["WebElement"]:
    return page.find_elements("css selector", selector)


def visible_section(page: "Chrome") -> str | None:
    (shown,) = (each for each in find_all(page, "main") if each.is_displayed())
    return shown.get_attribute("id")


def begin(page: "Chrome") -> None:
    find(page, "#agree").click()
    find(page, "#begin").click()


def press(page: "Chrome", keys: str) -> None:
    from selenium.webdriver import ActionChains

    ActionChains(page).send_keys(keys).perform()


def saved_file(downloads: Path, count: int) -> dict[str, Any]:
    """The newest download, as soon as there are ``count``."""
    deadline = time.monotonic() + 20
    while time.monotonic() < deadline:
        files = sorted(
            downloads.glob("*.json"), key=lambda path: path.stat().st_mtime_ns
        )
        if len(files) >= count and files[-1].stat().st_size:
            found: dict[str, Any] = json.loads(files[-1].read_text("utf-8"))
            return found
        time.sleep(0.05)
    raise AssertionError("the browser saved no file")


def test_nothing_is_shown_before_consent(page: "Chrome") -> None:
    assert visible_section(page) == "consent"
    assert not find(page, "#begin").is_enabled()
    press(page, "5")
    assert visible_section(page) == "consent"
    agree = find(page, "#agree")
    agree.click()
    assert find(page, "#begin").is_enabled()
    agree.click()
    assert not find(page, "#begin").is_enabled()
    assert not find_all(page, "#pictures img")


def test_every_picture_is_loaded_and_none_is_named(page: "Chrome") -> None:
    begin(page)
    for _ in range(2):
        images = find_all(page, "#pictures img")
        assert len(images) == 3
        for image in images:
            page.execute_async_script(
                "arguments[0].decode().then(arguments[1])", image
            )
            assert image.get_property("naturalWidth") == 48
        names = [each.text for each in find_all(page, "legend")]
        assert names == ["Picture A", "Picture B", "Picture C"]
        press(page, "123")
        find(page, "#next").click()
    for word in ("moka", "unity", "frostbite", "bottle", "helmet"):
        assert word not in find(page, "body").text.lower()
    source = page.page_source
    for word in ("moka", "unity", "frostbite", "bottle", "helmet"):
        assert word not in source.lower()


def test_a_survey_by_mouse_ends_in_a_file_that_can_be_analysed(
    page: "Chrome", survey: Path, downloads: Path, tmp_path: Path
) -> None:
    before = len(list(downloads.iterdir()))
    begin(page)
    given = {}
    for number in range(2):
        following = find(page, "#next")
        assert not following.is_enabled()
        for index, fieldset in enumerate(find_all(page, "fieldset")):
            source = fieldset.find_element("css selector", "img")
            name = (source.get_attribute("src") or "").rpartition("/")[2]
            given[name] = 3 * number + index + 2
            labels = fieldset.find_elements("css selector", ".scale label")
            labels[given[name] - 1].click()
        assert following.text == ("Next", "Finish")[number]
        following.click()
    assert visible_section(page) == "end"
    assert "Model by <Somebody> & co" in find(page, "#end").text
    find(page, "#save").click()
    found = saved_file(downloads, before + 1)
    assert set(found) == {
        "survey_answers", "survey", "consent", "ratings"
    }  # fmt: skip
    assert found["consent"] is True
    assert {
        each["picture"]: each["rating"] for each in found["ratings"]
    } == given
    assert all(
        set(each) == {"set", "picture", "rating"} for each in found["ratings"]
    )

    answers = tmp_path / "answers.json"
    answers.write_text(json.dumps(found))
    key = survey.with_name("out.key.json")
    assert main(["survey", "analyse", str(answers), "--key", str(key)]) == 0


def test_a_survey_by_keys_alone(page: "Chrome", downloads: Path) -> None:
    from selenium.webdriver.common.keys import Keys

    before = len(list(downloads.iterdir()))
    press(page, Keys.TAB + Keys.SPACE + Keys.TAB + Keys.ENTER)
    assert visible_section(page) == "rating"
    press(page, Keys.ENTER)
    assert find(page, "#heading").text == "Page 1 of 2"
    press(page, "109")
    checked = find_all(page, "#pictures input:checked")
    assert [each.get_property("value") for each in checked] == ["1", "10", "9"]
    # Back among the pictures, arrows change a rating.
    press(page, Keys.ARROW_LEFT)
    assert (
        find_all(page, "#pictures input:checked")[2].get_property("value")
        == "8"
    )
    press(page, Keys.ENTER)
    assert find(page, "#heading").text == "Page 2 of 2"
    press(page, "567" + Keys.ENTER)
    assert visible_section(page) == "end"
    press(page, Keys.TAB + Keys.ENTER)
    ratings = saved_file(downloads, before + 1)["ratings"]
    assert [each["rating"] for each in ratings] == [1, 10, 8, 5, 6, 7]


def test_going_back_keeps_the_ratings(page: "Chrome") -> None:
    begin(page)
    sources = [
        each.get_attribute("src") for each in find_all(page, "#pictures img")
    ]
    press(page, "234")
    find(page, "#next").click()
    find(page, "#back").click()
    checked = find_all(page, "#pictures input:checked")
    assert [each.get_property("value") for each in checked] == ["2", "3", "4"]
    assert sources == [
        each.get_attribute("src") for each in find_all(page, "#pictures img")
    ]
    assert not find(page, "#back").is_enabled()
    assert find(page, "#next").is_enabled()


def test_a_click_enlarges_a_picture(page: "Chrome") -> None:
    begin(page)
    fieldset = find_all(page, "fieldset")[1]
    width = fieldset.size["width"]
    button = fieldset.find_element("css selector", ".picture")
    button.click()
    assert fieldset.size["width"] > 1.5 * width
    button.click()
    assert fieldset.size["width"] == width


def test_the_orders_differ_from_person_to_person(
    page: "Chrome", survey: Path
) -> None:
    orders = set()
    for _ in range(6):
        begin(page)
        orders.add(
            tuple(
                each.get_attribute("src")
                for each in find_all(page, "#pictures img")
            )
        )
        page.get((survey / "index.html").as_uri())
    # 2 sets in 6 orders each: all alike once in 12^5 runs.
    assert len(orders) > 1


def test_only_the_page_and_its_pictures_are_asked_for(
    page: "Chrome", survey: Path
) -> None:
    begin(page)
    press(page, "555")
    find(page, "#next").click()
    press(page, "555")
    find(page, "#next").click()
    find(page, "#save").click()
    own = survey.as_uri()
    for address in requested(page):
        assert address.startswith((own, "about:", "data:", f"blob:{own[:7]}"))
    # The policy holds, even for a script that tried.
    blocked = page.execute_async_script(
        "const done = arguments[0];"
        "fetch('https://example.invalid/').then("
        "  () => done('sent'), (error) => done(error.name));"
    )
    assert blocked == "TypeError"
    entries = page.get_log("browser")
    assert any("Content Security" in each["message"] for each in entries)
    assert not [address for address in requested(page) if "example" in address]


def test_it_works_from_a_web_server_too(chrome: "Chrome", survey: Path) -> None:
    class Quiet(http.server.SimpleHTTPRequestHandler):
        def log_message(self, *_: object) -> None:
            pass

    handler = functools.partial(Quiet, directory=str(survey))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            chrome.get(f"http://127.0.0.1:{server.server_port}/index.html")
            begin(chrome)
            image = find(chrome, "#pictures img")
            chrome.execute_async_script(
                "arguments[0].decode().then(arguments[1])", image
            )
            assert image.get_property("naturalWidth") == 48
            chrome.get("about:blank")
        finally:
            server.shutdown()
            thread.join()
