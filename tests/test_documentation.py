"""The Python of README and documentation works, and what they name exists.

Blocks run page by page and one after the other, on stand-ins for the files
that they name. tests/test_documented_commands.py does the same for commands.
"""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import moka
from tests.support.pages import PAGES, ROOT, blocks, id_of
from tests.support.stand_ins import write_stand_ins

pytestmark = pytest.mark.gpu

SMALL = (48, 27)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, with everything that pages name."""
    folder = tmp_path / "here"
    folder.mkdir()
    write_stand_ins(folder)
    monkeypatch.chdir(folder)
    return folder


@pytest.fixture
def headless(monkeypatch: pytest.MonkeyPatch) -> None:
    """Small pictures, and no windows."""
    render, run, frames = moka.render, moka.run, moka.render_frames

    def small(source: Any = None, **options: Any) -> moka.Image:
        return render(source, **{**options, "size": SMALL})

    def few(source: Any = None, **options: Any) -> Iterator[moka.Image]:
        return frames(source, **{**options, "size": SMALL, "frames": 2})

    def without_window(app: Any, **options: Any) -> moka.App:
        kept = {"settings"} & options.keys()
        return run(
            app,
            headless=True,
            frames=2,
            size=SMALL,
            **{name: options[name] for name in kept},
        )

    monkeypatch.setattr(moka, "render", small)
    monkeypatch.setattr(moka, "run", without_window)
    monkeypatch.setattr(moka, "render_frames", few)


@pytest.mark.parametrize(
    "path", [path for path in PAGES if blocks(path, "python")], ids=id_of
)
@pytest.mark.usefixtures("folder", "headless")
def test_python_blocks_run(path: Path) -> None:
    names: dict[str, Any] = {"__name__": "documentation"}
    for match in blocks(path, "python"):
        exec(match["before"] or "", names)
        exec(compile(match["text"], id_of(path), "exec"), names)


def test_what_the_report_is_compared_with_is_there() -> None:
    """Each path that the page names exists, also where it shortens one."""
    text = (ROOT / "docs" / "parity.md").read_text(encoding="utf-8")
    paths = re.findall(r"`((?:moka|shaders|tests|examples)/[\w/.]+)`", text)
    assert len(paths) > 40
    for path in paths:
        assert (ROOT / path).exists(), path
