"""The public names: complete, importable, documented, known to checkers."""

import ast
import functools
import importlib
import inspect
import pkgutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import moka
from moka.core import errors

PUBLIC = sorted(set(moka.__all__) - {"__version__"})
CALLED = (property, classmethod, staticmethod, functools.cached_property)


def own_members(cls: type) -> Iterator[tuple[str, object]]:
    """Public methods and properties that moka itself wrote."""
    for base in cls.__mro__:
        if base.__module__.startswith("moka."):
            for name, value in vars(base).items():
                is_called = inspect.isfunction(value) or isinstance(
                    value, CALLED
                )
                if is_called and not name.startswith("_"):
                    yield name, value


def test_all_is_sorted_and_has_no_repetition() -> None:
    assert list(moka.__all__) == sorted(set(moka.__all__))


def test_all_names_exactly_what_can_be_had() -> None:
    assert set(PUBLIC) == set(moka._HOMES)


def test_type_checkers_see_the_names_that_python_finds() -> None:
    tree = ast.parse(Path(moka.__file__).read_text("utf-8"))
    seen = {
        alias.asname: node.module
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
        if alias.asname
    }
    assert seen == moka._HOMES


def test_every_error_is_public() -> None:
    assert set(errors.__all__) <= set(moka.__all__)
    for name in errors.__all__:
        assert issubclass(getattr(moka, name), moka.MokaError)


@pytest.mark.parametrize("name", PUBLIC)
def test_a_public_name_is_documented(name: str) -> None:
    value = getattr(moka, name)
    assert getattr(moka, name) is value
    assert value.__module__.startswith("moka.")
    own_words = value.__doc__ or ""
    assert len(own_words.strip()) > 20
    if inspect.isclass(value):
        undocumented = [
            member
            for member, kind in own_members(value)
            if not inspect.getdoc(kind)
        ]
        assert not undocumented, f"moka.{name}: {undocumented}"


@pytest.mark.parametrize("name", PUBLIC)
def test_a_public_name_is_listed_by_its_own_module(name: str) -> None:
    home = importlib.import_module(moka._HOMES[name])
    assert name in home.__all__


def test_every_module_has_a_docstring_and_a_true_all() -> None:
    for info in pkgutil.walk_packages(moka.__path__, "moka."):
        if info.name == "moka.__main__":
            continue
        module = importlib.import_module(info.name)
        assert module.__doc__, f"{info.name} has no docstring"
        for name in getattr(module, "__all__", ()):
            assert hasattr(module, name), f"{info.name}.__all__: {name}"


def test_dir_lists_names_that_are_not_yet_imported() -> None:
    assert set(moka.__all__) <= set(dir(moka))


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="'moka' has no attribute 'scen'"):
        _ = moka.scen


def test_a_checker_infers_types_through_the_lazy_names(
    tmp_path: Path,
) -> None:
    program = tmp_path / "program.py"
    program.write_text(
        "import moka\n"
        "reveal_type(moka.ModelError)\n"
        "reveal_type(moka.load_model)\n"
        "moka.scen\n"
    )
    result = subprocess.run(
        [
            sys.executable, "-m", "mypy", "--follow-imports=silent",
            f"--cache-dir={tmp_path / 'cache'}", str(program),
        ],
        capture_output=True, text=True, check=False,
        cwd=tmp_path,
        env={"MYPYPATH": str(Path(moka.__file__).parents[1])},
    )  # fmt: skip
    assert "moka.core.errors.ModelError" in result.stdout
    assert "Any" not in result.stdout.splitlines()[1]
    assert 'has no attribute "scen"' in result.stdout
