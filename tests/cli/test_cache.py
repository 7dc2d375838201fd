"""``moka cache``: what is told, and that only entries are deleted."""

import os
from pathlib import Path

import numpy as np
import pytest

from moka.cli.main import main
from moka.lighting.disk_cache import DiskCache


def test_info_and_clear(capsys: pytest.CaptureFixture[str]) -> None:
    folder = Path(os.environ["MOKA_CACHE_DIR"])
    assert main(["cache", "info"]) == 0
    assert capsys.readouterr().out == (
        f"folder   {folder}\nentries  0\nsize     0.0 MiB of at most 512 MiB\n"
    )
    cache = DiskCache()
    cache.store("a", {"x": np.zeros(1 << 20, np.uint8)})
    cache.store("b", {"x": np.zeros(1 << 20, np.uint8)})
    (folder / "mine.txt").write_text("mine")
    assert main(["cache", "info"]) == 0
    assert "entries  2\nsize     2.0 MiB" in capsys.readouterr().out
    assert main(["cache", "clear"]) == 0
    assert capsys.readouterr().out == (
        f"deleted 2 entries, 2.0 MiB, of {folder}\n"
    )
    assert [path.name for path in folder.iterdir()] == ["mine.txt"]


@pytest.mark.parametrize("arguments", [["cache"], ["cache", "burn"]])
def test_a_wrong_action_is_one_line(
    arguments: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    assert capsys.readouterr().err.count("\n") == 1
