"""The example notebook in JupyterLab in a browser, dragged by a mouse."""

import io
import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image as PillowImage

from tests.support.browser import open_browser
from tests.support.jupyter import serve_notebooks

if TYPE_CHECKING:
    from selenium.webdriver import Chrome

pytest.importorskip("jupyter_rfb", reason="jupyter_rfb is not installed")

pytestmark = [pytest.mark.browser, pytest.mark.gpu]

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "notebook.ipynb"

SECONDS = 40.0

# The notebook is open, and then: run all of it once its kernel is there.
IS_OPEN = """
const app = window.jupyterapp;
return Boolean(app?.shell.currentWidget?.context);
"""
RUN_ALL = """
const app = window.jupyterapp;
const done = arguments[arguments.length - 1];
app.shell.currentWidget.context.sessionContext.ready
    .then(() => app.commands.execute("notebook:run-all-cells"))
    .then(() => done("ran"), (error) => done(String(error)));
"""
FRAME = "return document.querySelector('.jp-OutputArea img.renderview-view')"


def test_the_viewer_of_the_example_orbits(tmp_path: Path) -> None:
    document = json.loads(EXAMPLE.read_text(encoding="utf-8"))
    # Its other cells would move what the mouse is to drag.
    document["cells"] = [
        cell
        for cell in document["cells"]
        if "viewer = Viewer(" in "".join(cell["source"])
    ]
    (tmp_path / EXAMPLE.name).write_text(json.dumps(document), "utf-8")
    with (
        open_browser(tmp_path / "profile", tmp_path) as browser,
        serve_notebooks(tmp_path) as address,
    ):
        from selenium.webdriver import ActionChains

        browser.set_script_timeout(SECONDS)
        browser.get(f"{address}/lab/tree/{EXAMPLE.name}")
        until(browser, lambda: browser.execute_script(IS_OPEN))
        assert browser.execute_async_script(RUN_ALL) == "ran"
        view = until(browser, lambda: element(browser))
        before = until(browser, lambda: picture(view))
        ActionChains(browser).drag_and_drop_by_offset(view, 60, 10).perform()

        def turned() -> NDArray[np.int_] | None:
            now = picture(view)
            difference = 0 if now is None else np.abs(now - before).max()
            return now if difference > 60 else None

        until(browser, turned)


def element(browser: "Chrome") -> Any:
    return browser.execute_script(FRAME)


def picture(view: Any) -> NDArray[np.int_] | None:
    """What is seen of the widget, (H, W, 3), once that is not one colour."""
    with PillowImage.open(io.BytesIO(view.screenshot_as_png)) as image:
        pixels = np.asarray(image.convert("RGB"), np.int_)
    return pixels if np.ptp(pixels) > 60 else None


def until(browser: "Chrome", ask: Callable[[], Any]) -> Any:
    """What ``ask`` answers once it is true; fails with what is on the page."""
    deadline = time.monotonic() + SECONDS
    while time.monotonic() < deadline:
        answer = ask()
        if answer is not None and answer is not False:
            return answer
        time.sleep(0.1)
    text = browser.execute_script("return document.body.innerText")
    pytest.fail(f"nothing after {SECONDS} s; the page says:\n{text[-2000:]}")
