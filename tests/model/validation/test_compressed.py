"""Compressed data are not told as missing, nor looked for where none are."""

from pathlib import Path
from typing import Any

import pytest

from moka.model.validation.validate import validate

pytest.importorskip("DracoPy")
pytest.importorskip("meshopt")


@pytest.mark.assets
@pytest.mark.parametrize("codec", ["meshopt", "draco"])
@pytest.mark.parametrize("name", ["CesiumMilkTruck.glb", "Duck.glb"])
def test_compressed_files_are_valid(
    assets: Path, codec: str, name: str
) -> None:
    from tests.support import compressed

    compress: Any = getattr(compressed, f"with_{codec}")
    assert validate(compress(assets / "models" / name)).issues == []
