"""What ``moka.model`` offers, and what it costs to ask."""

import subprocess
import sys

import pytest

import moka.model


def test_every_name_can_be_imported() -> None:
    for name in moka.model.__all__:
        assert getattr(moka.model, name) is not None
    assert set(moka.model.__all__) <= set(dir(moka.model))


def test_there_are_no_other_names() -> None:
    with pytest.raises(AttributeError, match="has no 'nonsense'"):
        _ = moka.model.nonsense  # type: ignore[attr-defined]


def loaded_by(code: str) -> set[str]:
    """The top-level modules that a fresh interpreter has after ``code``."""
    output = subprocess.run(
        [sys.executable, "-c", f"{code}\nimport sys\nprint(*sys.modules)"],
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    return {name.partition(".")[0] for name in output.split()}


def test_importing_loads_no_heavy_library() -> None:
    heavy = {"PIL", "pygltflib", "glm", "pyglm", "moderngl", "OpenEXR"}
    assert not loaded_by("import moka.model") & (heavy | {"numpy", "msgspec"})
    names = ", ".join(moka.model.__all__)
    everything = loaded_by(
        f"from moka.model import {names}\ndescribe(demo_model())"
    )
    assert not everything & heavy
