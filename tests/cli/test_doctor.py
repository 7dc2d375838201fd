"""The doctor: what it finds, what it prints, what it returns."""

import argparse
import json
from importlib import metadata

import pytest

from moka.backend.contexts import selection
from moka.cli import doctor
from moka.core.errors import ContextError


@pytest.fixture
def no_context(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing that could be tried works."""
    for name in ("_egl_device", "_surfaceless", "_osmesa", "_hidden"):

        def fail(*_: object, name: str = name) -> None:
            raise ContextError(f"cause of {name}")

        monkeypatch.setattr(selection, name, fail)


@pytest.mark.usefixtures("no_context")
def test_without_a_context_it_says_why_and_exits_with_2(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert doctor.run() == 2
    printed = capsys.readouterr().out
    assert "OSMesa: cause of _osmesa (install libosmesa6)" in printed
    assert printed.endswith("moka cannot render here\n")


@pytest.mark.usefixtures("no_context")
def test_json_holds_the_whole_report(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert doctor.run(as_json=True) == 2
    found = json.loads(capsys.readouterr().out)
    assert found == doctor.report()
    assert [each["backend"] for each in found["contexts"]] == [
        *("egl", "egl", "osmesa", "window")
    ]
    assert found["chosen"] is None


@pytest.mark.usefixtures("no_context")
def test_packages_are_those_of_the_project() -> None:
    found = doctor.report()
    assert found["packages"]["moderngl"] == metadata.version("moderngl")
    assert "glfw" in found["window_packages"]
    assert "pytest" not in found["packages"]


@pytest.mark.usefixtures("no_context")
def test_a_missing_package_says_how_to_install_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def version(name: str) -> str:
        if name == "glfw":
            raise metadata.PackageNotFoundError(name)
        return "1.0"

    monkeypatch.setattr(metadata, "version", version)
    text = doctor.format_report(doctor.report())
    assert (
        "for a window, missing: glfw (pip install 'moka-pbr[window]')" in text
    )


@pytest.mark.usefixtures("no_context")
def test_a_checkout_that_is_not_installed_has_no_packages(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def requires(name: str) -> list[str]:
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr(metadata, "requires", requires)
    assert doctor.report()["packages"] == {}


@pytest.mark.gpu
def test_a_working_context_is_described(
    capsys: pytest.CaptureFixture[str],
) -> None:
    parser = argparse.ArgumentParser()
    doctor.add_arguments(parser)
    assert doctor.execute(parser.parse_args([])) == 0
    printed = capsys.readouterr().out
    found = doctor.report()
    first = next(each for each in found["contexts"] if each["works"])
    assert found["chosen"] == first["label"]
    assert first["uses"]["GL_KHR_debug"] in (True, False)
    for name in ("vendor", "renderer", "version", "glsl"):
        assert first[name] in printed
    assert f"moka renders with {found['chosen']}:" in printed
