"""``moka bench lighting``: making and finding, one line a map."""

import json
import os
from pathlib import Path

import pytest

from moka.cli.main import main


@pytest.mark.gpu
def test_two_maps(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "lighting.json"
    arguments = ["bench", "lighting", "--heights", "64,128", "--runs", "2"]
    assert main([*arguments, "--json", str(out)]) == 0
    found = json.loads(out.read_text())
    assert [point["rows"] for point in found["points"]] == [64, 128]
    for point in found["points"]:
        assert point["find_ms"]["median"] > 0
        assert point["split_ms"]["median"] < point["make_ms"]["median"]
        assert point["counts"]["suns"] == 1
        assert point["counts"]["bytes_in_cache"] > 1000
    assert set(found["exponents"]) == {"split_ms", "make_ms", "find_ms"}
    assert "make: time grows" in capsys.readouterr().out
    # Its own cache, not the user's.
    assert not Path(os.environ["MOKA_CACHE_DIR"]).exists()


@pytest.mark.gpu
@pytest.mark.parametrize("environment", ["none", "furnace", "missing.hdr"])
def test_what_cannot_be_preintegrated_is_one_line(
    environment: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["bench", "lighting", environment]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert environment in error
