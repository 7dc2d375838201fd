"""What is imported when, and what it costs.

A headless render must not pay for a window, ``moka --help`` not for NumPy,
and ``import moka`` for next to nothing.
"""

import re
import subprocess
import sys
from pathlib import Path

import pytest

WINDOW = {"glfw", "imgui_bundle", "moderngl_window", "pyglet"}
TOOLS = {"matplotlib", "pytest", "scipy"}
NOTEBOOK = {"IPython", "anywidget", "ipywidgets", "jupyter_rfb", "traitlets"}
WRITER = {"dataclasses_json", "pygltflib"}


def import_log(*arguments: str) -> str:
    """The log of ``python -X importtime`` with ``arguments``."""
    result = subprocess.run(
        [sys.executable, "-X", "importtime", *arguments],
        capture_output=True,
        text=True,
        check=True,
    )
    return result.stderr


def imported(log: str) -> set[str]:
    """The top-level packages that an import log names."""
    names = re.findall(r"\| +([\w.]+)$", log, re.MULTILINE)
    return {name.partition(".")[0] for name in names}


def milliseconds(log: str, module: str) -> float:
    """Time that importing ``module`` took, what it imports included."""
    pattern = rf"\| +(\d+) \| +{re.escape(module)}$"
    (microseconds,) = re.findall(pattern, log, re.MULTILINE)
    return int(microseconds) / 1000.0


def test_import_moka_takes_less_than_30_ms() -> None:
    logs = [import_log("-c", "import moka") for _ in range(5)]
    assert min(milliseconds(log, "moka") for log in logs) < 30.0


def test_import_moka_loads_no_other_package() -> None:
    log = import_log("-c", "import moka")
    assert "moka" in imported(log)
    heavy = {"numpy", "moderngl", "PIL", "OpenEXR", "pyglm", "msgspec"}
    assert not imported(log) & (heavy | WINDOW | TOOLS | WRITER | NOTEBOOK)


@pytest.mark.parametrize("arguments", [["--help"], ["render", "--help"]])
def test_help_does_not_load_numpy(arguments: list[str]) -> None:
    log = import_log("-m", "moka", *arguments)
    assert "moka" in imported(log)
    heavy = {"numpy", "moderngl", "PIL", "OpenEXR", "pyglm", "msgspec"}
    assert not imported(log) & (heavy | WINDOW | TOOLS | WRITER | NOTEBOOK)


def test_a_window_loads_one_window_library() -> None:
    """moderngl-window knows eight, and loaders of scenes beside them."""
    pytest.importorskip("moderngl_window")
    log = import_log("-c", "import moka.app.window_glfw")
    loaded = imported(log)
    assert {"glfw", "moderngl_window"} <= loaded
    others = {"pyglet", "pygame", "PyQt5", "PySide2", "sdl2", "tkinter"}
    assert not loaded & (others | TOOLS | {"pywavefront", "trimesh"})


@pytest.mark.gpu
def test_a_headless_png_pays_for_nothing_else(tmp_path: Path) -> None:
    out = tmp_path / "demo.png"
    log = import_log("-m", "moka", "render", "--size", "16x16", "-o", str(out))
    assert out.exists()
    loaded = imported(log)
    assert {"numpy", "moderngl", "PIL"} <= loaded
    assert not loaded & (WINDOW | TOOLS | WRITER | NOTEBOOK | {"OpenEXR"})
    # Nor for what the file does not have.
    modules = {
        "moka.core.alpha_levels",
        "moka.core.normal_levels",
        "moka.model.instances",
        "moka.model.lines",
        "moka.model.lods",
        "moka.model.validation",
        "moka.model.variants",
        "moka.scene.level_of_detail",
    }
    assert "moka.model.nodes" in log
    assert not {name for name in modules if name in log}


def test_msgspec_does_without_typing_extensions() -> None:
    """And whoever wants them later still gets them."""
    pytest.importorskip("typing_extensions")
    code = (
        "import sys\n"
        "from moka.cli.render import _import_msgspec\n"
        "_import_msgspec()\n"
        "assert 'msgspec' in sys.modules\n"
        "assert 'inspect' not in sys.modules\n"
        "import typing_extensions\n"
        "_import_msgspec()\n"
        "assert sys.modules['typing_extensions'] is typing_extensions"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_msgspec_that_insists_gets_typing_extensions(tmp_path: Path) -> None:
    pytest.importorskip("typing_extensions")
    package = tmp_path / "msgspec"
    package.mkdir()
    text = "import typing_extensions\ninsists = True"
    (package / "__init__.py").write_text(text, encoding="utf-8")
    code = (
        "import sys\n"
        f"sys.path.insert(0, {str(tmp_path)!r})\n"
        "from moka.cli.render import _import_msgspec\n"
        "_import_msgspec()\n"
        "import msgspec\n"
        "assert msgspec.insists"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
