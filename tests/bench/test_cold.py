"""``moka bench cold``: processes and stages in one file."""

import json
import os
import sys
from pathlib import Path

import pytest

from moka.cli.main import main


@pytest.mark.gpu
def test_cold_runs_of_the_demo(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "cold.json"
    arguments = ["bench", "cold", "--runs", "1", "--size", "16x16"]
    arguments += ["--against", f"{sys.executable} -c pass"]
    assert main([*arguments, "--json", str(out)]) == 0
    found = json.loads(out.read_text())
    assert found["base"] == "against"
    kinds = found["kinds"]
    assert list(kinds) == ["against", "not cached", "cached"]
    assert kinds["against"]["wall_ms"]["ratio"] == 1
    assert kinds["cached"]["wall_ms"]["ratio"] > 1
    assert "stages_ms" not in kinds["against"]
    for kind, is_cached in (("not cached", False), ("cached", True)):
        assert kinds[kind]["lighting"]["cached"] is is_cached
        stages = kinds[kind]["stages_ms"]
        assert {"import", "context", "frame", "encode"} <= set(stages)
        assert "store" not in stages
        assert kinds[kind]["wall_ms"]["count"] == 1
    assert "stage, median ms" in capsys.readouterr().out
    # Its own cache, not the user's.
    assert not Path(os.environ["MOKA_CACHE_DIR"]).exists()


def test_a_model_that_is_missing_is_one_line(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["bench", "cold", "missing.glb", "--runs", "1"]) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    assert "missing.glb" in message
