"""The wheel: what is in it, what it asks for, and that it works alone.

It is built from the source distribution, so that one that lacks a file is
found out too, and installed into a virtual environment outside the checkout.
That environment finds moka's dependencies where the running one has them,
through a path that comes after its own: nothing is downloaded.
"""

import subprocess
import sys
import sysconfig
import venv
import zipfile
from collections.abc import Iterator
from email.message import Message
from email.parser import BytesParser
from pathlib import Path

import pytest

from moka.version import __version__

CHECKOUT = Path(__file__).resolve().parents[1]
RUNNING = sysconfig.get_path("purelib")

# Renders the demo scene and fails if anything was opened in the checkout,
# whose virtual environment alone may lie there.
RENDER = """
import sys

checkout, running, output = sys.argv[1:]

def refuse_the_checkout(event, arguments):
    if event in ("open", "os.listdir", "os.scandir"):
        path = str(arguments[0])
        if path.startswith(checkout) and not path.startswith(running):
            raise RuntimeError(f"{path} lies in the checkout")

sys.addaudithook(refuse_the_checkout)

import moka
from moka.cli import main

code = main(["render", "--size", "64x48", "-o", output])
for name, module in sys.modules.items():
    if name.partition(".")[0] == "moka" and module.__file__:
        assert module.__file__.startswith(sys.prefix), module.__file__
sys.exit(code)
"""


def python(*arguments: str, executable: Path | str = sys.executable) -> str:
    """Standard output of Python; fails with all that it printed."""
    result = subprocess.run(
        [str(executable), *arguments],
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 0, result.stdout + result.stderr
    return result.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("dist")
    build = ["-m", "build", "--no-isolation", "--outdir", str(folder)]
    python(*build, str(CHECKOUT))
    (path,) = folder.glob("*.whl")
    return path


@pytest.fixture(scope="module")
def contents(wheel: Path) -> Iterator[zipfile.ZipFile]:
    with zipfile.ZipFile(wheel) as archive:
        yield archive


@pytest.fixture(scope="module")
def metadata(contents: zipfile.ZipFile) -> Message:
    name = f"moka_pbr-{__version__}.dist-info/METADATA"
    return BytesParser().parsebytes(contents.read(name))


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of programs of an environment that holds the wheel."""
    folder = tmp_path_factory.mktemp("clean") / "venv"
    venv.create(folder, with_pip=False)
    programs = folder / ("Scripts" if sys.platform == "win32" else "bin")
    python(
        "-m", "pip", "--python", str(folder), "install", "--quiet",
        "--no-deps", "--no-index", str(wheel),
    )  # fmt: skip
    query = "import sysconfig; print(sysconfig.get_path('purelib'))"
    own = python("-c", query, executable=programs / "python").strip()
    Path(own, "dependencies.pth").write_text(f"{RUNNING}\n")
    return programs


def tracked(folder: str) -> set[str]:
    """Files below a folder of the checkout, without caches."""
    return {
        path.relative_to(CHECKOUT).as_posix()
        for path in (CHECKOUT / folder).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }


def test_the_wheel_carries_all_it_needs_and_nothing_else(
    contents: zipfile.ZipFile,
) -> None:
    expected = tracked("moka") | {
        f"moka/{name}" for name in tracked("shaders") | tracked("assets")
    }
    packed = {name for name in contents.namelist() if ".dist-info/" not in name}
    assert "moka/py.typed" in packed
    assert any(name.startswith("moka/shaders/") for name in packed)
    assert packed == expected


def test_the_metadata_name_the_project(
    contents: zipfile.ZipFile, metadata: Message
) -> None:
    assert metadata["Name"] == "moka-pbr"
    assert metadata["Version"] == __version__
    assert metadata["Requires-Python"] == ">=3.11"
    info = f"moka_pbr-{__version__}.dist-info"
    entries = contents.read(f"{info}/entry_points.txt").decode()
    assert "moka = moka.cli:main" in entries
    assert f"{info}/licenses/LICENSE" in contents.namelist()


def test_a_headless_install_asks_for_no_window(metadata: Message) -> None:
    required = metadata.get_all("Requires-Dist") or []
    always = {line.lower() for line in required if "extra ==" not in line}
    assert any(line.startswith("moderngl>") for line in always)
    for name in ("glfw", "moderngl-window", "imgui", "pyglet", "pygame"):
        assert not any(line.startswith(name) for line in always)
    assert set(metadata.get_all("Provides-Extra") or []) == {
        "bench", "completion", "compressed", "dev", "docs", "notebook",
        "video", "window",
    }  # fmt: skip


def test_the_installed_command_says_its_version(
    installed: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    result = subprocess.run(
        [str(installed / "moka"), "--version"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert __version__ in result.stdout


@pytest.mark.gpu
def test_the_installed_wheel_renders_away_from_the_checkout(
    installed: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    from PIL import Image

    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("PYTHONPATH", raising=False)
    python(
        "-c", RENDER, str(CHECKOUT), RUNNING, "demo.png",
        executable=installed / "python",
    )  # fmt: skip
    with Image.open("demo.png") as picture:
        assert picture.size == (64, 48)
        grey = picture.convert("L")
        darkest, brightest = grey.getextrema()
        assert brightest - darkest > 50
