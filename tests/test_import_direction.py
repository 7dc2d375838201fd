"""Imports point one way, and each heavy package has one importer.

The order below is the one that docs/architecture.md draws. Every import
statement counts, also one inside a function or for annotations only: an
arrow that runs up is a cycle in the design before it is one at run time.
"""

import ast
from collections.abc import Iterator
from fnmatch import fnmatchcase
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1] / "moka"

# A package may import those after it, and itself.
ORDER = (
    "cli",
    "survey",
    "bench",
    "notebook",
    "ui",
    "app",
    "renderer",
    "scene",
    "lighting",
    "model",
    "material",
    "graphics",
    "backend",
    "commands",
    "radiometry",
    "core",
    "version",
)

# Who may import what; the patterns match module names.
ONLY_IMPORTERS = {
    "DracoPy": ("moka.model.*",),
    "OpenEXR": ("moka.core.*",),
    "PIL": ("moka.core.*",),
    "flip_evaluator": ("moka.bench.*",),
    "glcontext": ("moka.backend.*",),
    "glfw": ("moka.app.window*", "moka.backend.contexts*"),
    "imgui_bundle": ("moka.ui.*",),
    "jupyter_rfb": ("moka.notebook.*",),
    "matplotlib": ("moka.bench.*", "moka.survey.*"),
    "meshopt": ("moka.model.*",),
    "moderngl": ("moka.backend.*",),
    "moderngl_window": ("moka.app.window*", "moka.backend.contexts*"),
    "opengl_basisu": ("moka.core.*",),
    "pygltflib": ("moka.model.*",),
    "scipy": ("moka.bench.*", "moka.survey.*"),
}


def module_name(path: Path) -> str:
    parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(part for part in parts if part != "__init__")


def imported_modules(
    tree: ast.Module, module: str, *, is_package: bool
) -> Iterator[tuple[int, str]]:
    """Line and absolute name of everything that ``module`` imports.

    ``from a import b`` yields ``a.b``, which may be a module or a name in
    one; both lie in ``a``, and that is what the rules ask about.
    """
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield node.lineno, alias.name
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                parents = module.split(".")
                drop = node.level - is_package
                kept = parents[: len(parents) - drop]
                base = ".".join([*kept, base] if base else kept)
            for alias in node.names:
                yield node.lineno, f"{base}.{alias.name}"
        elif isinstance(node, ast.Call):
            called = ast.unparse(node.func).rpartition(".")[2]
            if called in ("import_module", "__import__") and node.args:
                argument = node.args[0]
                if isinstance(argument, ast.Constant):
                    yield node.lineno, str(argument.value)


def violations(
    source: str, module: str, *, is_package: bool = False
) -> list[str]:
    """What ``module`` imports against the rules, one line for each."""
    found = []
    own = module.split(".")[1] if "." in module else module
    tree = ast.parse(source)
    for line, name in imported_modules(tree, module, is_package=is_package):
        top, *rest = name.split(".")
        where = f"{module}:{line}: imports {name}"
        if top == "moka" and own in ORDER:
            if not rest or rest[0] not in ORDER:
                found.append(f"{where}, which is no package in the order")
            elif ORDER.index(rest[0]) < ORDER.index(own):
                found.append(f"{where}, which lies above {own}")
        allowed = ONLY_IMPORTERS.get(top, ("*",))
        # A package's own module also matches the pattern of its contents.
        if not any(
            fnmatchcase(module, pattern) or fnmatchcase(f"{module}.", pattern)
            for pattern in allowed
        ):
            found.append(f"{where}, left to {', '.join(allowed)}")
    return found


def test_imports_point_one_way() -> None:
    found = []
    paths = sorted(PACKAGE.rglob("*.py"))
    assert len(paths) > len(ORDER)
    for path in paths:
        found += violations(
            path.read_text("utf-8"),
            module_name(path),
            is_package=path.name == "__init__.py",
        )
    assert not found, "\n".join(found)


def test_every_package_has_a_place_in_the_order() -> None:
    names = {
        path.stem if path.is_file() else path.name
        for path in PACKAGE.iterdir()
        if path.suffix == ".py" or (path / "__init__.py").exists()
    }
    assert names - {"__init__", "__main__"} <= set(ORDER)


@pytest.mark.parametrize(
    ("module", "source"),
    [
        ("moka.core.colour", "import moka.commands.handles"),
        ("moka.core.colour", "from moka.commands import handles"),
        ("moka.core.colour", "from moka import commands"),
        ("moka.core.colour", "from ..commands.handles import Handle"),
        ("moka.core.colour", "from .. import commands"),
        ("moka.core.colour", "import moka"),
        ("moka.core.colour", "from moka import Scene"),
        ("moka.scene.scene", "def f():\n    import moka.renderer.passes"),
        ("moka.scene.scene", "if TYPE_CHECKING:\n    import moka.ui.panel"),
        ("moka.model.gltf", "import_module('moka.lighting.environment')"),
        ("moka.material.row", "from moka.model.gltf import Model"),
        ("moka.renderer.passes", "import moderngl"),
        ("moka.graphics.device", "from moderngl import Context"),
        ("moka.graphics.device", "importlib.import_module('moderngl')"),
        ("moka.app.render", "import glfw"),
        ("moka.cli.view", "from moderngl_window import run"),
        ("moka.app.window", "import imgui_bundle"),
        ("moka.model.images", "from PIL import Image"),
        ("moka.lighting.files", "import OpenEXR"),
        ("moka.scene.scene", "import pygltflib.utils"),
        ("moka", "import moderngl"),
    ],
)
def test_a_violation_is_found(module: str, source: str) -> None:
    (message,) = violations(source, module)
    assert message.startswith(f"{module}:")


def test_a_package_resolves_its_relative_imports_against_itself() -> None:
    source = "from ..commands import handles"
    assert violations(source, "moka.core", is_package=True)
    source = "from .commands import handles"
    assert not violations(source, "moka.core", is_package=True)


@pytest.mark.parametrize(
    ("module", "source"),
    [
        ("moka.renderer.passes", "from moka.commands import CommandList"),
        ("moka.model.gltf", "from moka.material.material import Material"),
        ("moka.model.gltf", "import pygltflib"),
        ("moka.backend", "import moderngl"),
        ("moka.backend.contexts.egl", "import glfw"),
        ("moka.app.window", "import moderngl_window"),
        ("moka.core.image_file", "from PIL import Image"),
        ("moka.core.image", "from . import colour\nimport numpy as np"),
        ("moka.__main__", "from moka.cli import main"),
        ("moka.core.colour", "import dataclasses, moka.core.errors"),
    ],
)
def test_a_permitted_import_is_let_through(module: str, source: str) -> None:
    assert not violations(source, module)
